"""The package in a user's own Python: what is there, how models are made and written, what is done with records."""

import ast
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import closed_forms
import numpy as np
import pytest
import torch
import yaml
from hidden import draw_case, write_case
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.simulation.simulate import simulate as integrate

RATE, OMEGA, DAMPING, CUBIC = 500.0, 40.0, 2.0, 4e6
TIME = np.arange(1500) / RATE


def rig(**gap):
    law = gd.PowerLawDamping(coefficient=240, exponent=2)
    return gd.Model(gd.GearPair(pinion_speed=300), [gd.FourierMeshStiffness(), law, gd.Backlash(**gap)])


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """A noisy decay of a hardening oscillator, as its measurement.yaml."""

    def slope(_, state):
        return [state[1], -DAMPING * state[1] - OMEGA**2 * state[0] - CUBIC * state[0] ** 3]

    motion = solve_ivp(slope, (0, TIME[-1]), [1e-2, 0], "DOP853", TIME, rtol=1e-10, atol=1e-14).y[0]
    noisy = motion + 2e-5 * np.random.default_rng(5).standard_normal(len(motion))
    folder = tmp_path_factory.mktemp("decay")
    np.savetxt(folder / "decay.csv", np.column_stack([TIME, noisy]), "%.12g", ",", header="t,x", comments="")
    text = "system: oscillator\nrecords:\n- file: decay.csv\n  channels:\n    time: {column: t, unit: s}\n"
    (folder / "measurement.yaml").write_text(text + "    displacement: {column: x, unit: m}\n")
    return gd.load(folder / "measurement.yaml")


def test_importing_it_imports_nothing_heavy():
    code = (
        "import sys, time; t = time.perf_counter(); import gear_damping; used = time.perf_counter() - t; "
        "print(used, 'torch' in sys.modules, 'numpy' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    used, *heavy = run.stdout.split()
    assert heavy == ["False", "False"]
    assert float(used) < 2.0  # a tenth of that alone; machines that run tests are busy


def test_everything_that_is_offered_is_there():
    assert set(gd._PLACES) | {"__version__"} == set(gd.__all__)
    for name in (*gd.__all__, *gd._EFFECTS):
        assert getattr(gd, name) is not None
        assert name in dir(gd)
    assert {kind.__name__: name for name, kind in builtin_effects().items()} == gd._EFFECTS
    with pytest.raises(AttributeError, match="did you mean 'PowerLawDamping'"):
        _ = gd.PowerLawDampin


@pytest.mark.parametrize("name", sorted(builtin_effects()))
def test_an_effect_is_made_with_its_parameters_and_compares_by_them(name):
    kind = builtin_effects()[name]
    given = {p.name: p.default for p in kind.parameters if p.default is not None}
    one, same = kind(**given), kind(**given)
    assert one == same
    assert hash(one) == hash(same)
    assert one.given == {k: tuple(map(float, v)) if isinstance(v, tuple) else float(v) for k, v in given.items()}
    assert str(one) == f"{name}: {kind.equation}"
    assert repr(one).startswith(f"{kind.__name__}(")
    if given:
        assert one != kind()
    with pytest.raises(gd.InputError, match="no such parameter or option"):
        kind(no_such_thing=1.0)


def test_what_is_wrong_with_an_effect_is_said_at_once():
    with pytest.raises(gd.InputError) as caught:
        gd.PowerLawDamping(coefficent=2, exponent=17, as_printed="yes", coefficient=float("nan"))
    said = str(caught.value)
    assert "power_law_damping.coefficent: no such parameter or option; remedy: did you mean 'coefficient'?" in said
    assert "power_law_damping.exponent = 17.0: must lie within 0.2 … 5" in said
    assert "power_law_damping.as_printed = 'yes': must be one of False, True" in said
    assert "power_law_damping.coefficient = nan: must be a finite number in N" in said
    assert "remedy: leave it out where it is not known" in said
    with pytest.raises(gd.InputError, match="must be finite numbers in m"):
        gd.ProfileError(amplitudes=["a"], phases=[0.0])


@pytest.mark.parametrize("kind", [gd.GearPair, gd.Oscillator, gd.ViscousDamping, gd.PowerLawDamping])
@pytest.mark.parametrize("name", ["damping_ratio", "damping_ratio_percent", "zeta"])
def test_where_a_ratio_is_given_is_said(kind, name):
    with pytest.raises(
        gd.InputError, match=rf"{name}: no such .*; remedy: a ratio is .* gd\.Model\.from_config"
    ) as caught:
        kind(**{name: 2})
    node = str(caught.value).partition("from_config({…, ")[2].rstrip(")}")
    given = {"system": "oscillator"} | ast.literal_eval(f"{{{node}}}")
    assert gd.Model.from_config(given).given["viscous_damping.damping_coefficient"] == pytest.approx(0.04)


def test_a_model_prints_its_equation_and_values():
    assert repr(rig(gap=8e-5)) == (
        "Model(GearPair(pinion_speed=300), [FourierMeshStiffness(), PowerLawDamping(coefficient=240, exponent=2), "
        "Backlash(gap=8e-05)])"
    )
    lines = str(rig(gap=8e-5)).splitlines()
    assert lines[2] == "  power_law_damping: F_d = alpha sign(delta') |delta'|^n"
    assert lines[-1] == "    backlash.gap = 8e-05 m"


def test_the_configuration_says_the_same(tmp_path):
    model = gd.Model(
        gd.GearPair(pinion_speed=300, gear_torque_mode="held", gear_torque=290.0),
        [
            gd.FourierMeshStiffness(weighting="lanczos"),
            gd.ViscousDamping(),
            gd.ProfileError(amplitudes=[1e-6, 2e-7], phases=[0, 1]),
        ],
    )
    again = gd.Model.from_config(model.to_config())
    assert again == model
    assert again != rig()
    path = model.write(tmp_path / "new" / "model.yaml")
    assert gd.Model.from_config(path) == model
    assert yaml.safe_load(path.read_text())["profile_error"]["amplitudes"] == [1e-6, 2e-7]
    with pytest.raises(FileExistsError, match="is there and stays as it is: give another path"):
        model.write(path)
    wrong = {"system": "gear_pair", "fourier_mesh_stiffness": {}, "backlash": {"gap": {"value": 8, "unit": "kg"}}}
    with pytest.raises(gd.InputError, match="the unit 'kg' is not one of the kind of 'm'"):
        gd.Model.from_config(wrong)


def test_the_command_line_simulates_the_written_model(tmp_path):
    from gear_damping.tasks.command import main

    path = rig(gap=8e-5).write(tmp_path / "model.yaml")
    rest = ["simulator.n_runs=2", "simulator.n_samples=200", "progress=false", f"data_folder={tmp_path / 'data'}"]
    place = f"hydra.run.dir={tmp_path / 'run'}"
    assert main(["task=simulate", f"simulator.extended={path}", "family=none", place, *rest]) == 0
    with np.load(tmp_path / "run" / "runs.npz") as written:
        assert written["parameters/backlash.gap"][0] == 8e-5
        assert written["parameters/pinion_speed"][0] == 300


def test_a_simulation_is_that_of_the_engine():
    model = rig(gap=8e-5)
    found = gd.simulate(model, sampling_rate=40e3, n_samples=300, batch=3, **{"backlash.gap": [5e-5, 8e-5, 9e-5]})
    values = model.values(3, **{"backlash.gap": torch.tensor([5e-5, 8e-5, 9e-5], dtype=torch.float64)})
    plain = integrate(model, values, sampling_rate=40e3, n_samples=300)
    np.testing.assert_array_equal(found.transmission_error, plain.response.numpy())
    assert found.names[0] == "transmission_error"
    assert len(found) == 3
    assert repr(found) == "<3 runs of 300 samples, 0.0075 s at 40000 Hz>"
    coefficients, frequencies = found.cwt(frequencies_hz=[2000.0, 5000.0])
    assert coefficients.shape == (3, 2, 300)
    assert frequencies.tolist() == [2000.0, 5000.0]
    assert found.cwt("morlet")[0].dtype == np.complex128
    assert found.plot(2).axes
    with pytest.raises(AttributeError, match="no channel 'twist'; there are transmission_error"):
        _ = found.twist
    with pytest.raises(gd.InputError, match="pinion_sped: no such parameter"):
        gd.simulate(model, sampling_rate=40e3, n_samples=20, pinion_sped=300)
    with pytest.raises(gd.InputError, match=r"backlash.gap = -1.0: must lie within"):
        gd.simulate(model, sampling_rate=40e3, n_samples=20, **{"backlash.gap": -1.0})
    with pytest.raises(ValueError, match="no wavelet 'haar'"):
        found.cwt("haar")
    few = gd.simulate(model, sampling_rate=40e3, n_samples=9)
    with pytest.raises(ValueError, match="9 samples hold no 4 periods of any frequency; simulate 11"):
        few.cwt()


def test_a_simulation_follows_the_closed_form():
    model = gd.Model(gd.Oscillator(stiffness=OMEGA**2), [gd.ViscousDamping(damping_coefficient=DAMPING)])
    runs = gd.simulate(model, sampling_rate=RATE, n_samples=300, initial_displacement=1e-2)
    exact, _ = closed_forms.free_decay(TIME[:300], 1.0, DAMPING, OMEGA**2, 1e-2, 0.0)
    np.testing.assert_allclose(runs.displacement[0], exact, atol=1e-7)
    assert runs.damping_ratio_percent[0] == pytest.approx(100 * DAMPING / (2 * OMEGA))


def test_the_linear_model_is_fitted_where_none_is_given(record):
    fit = gd.identify(record)
    assert fit.damping_ratio_percent["value"] == pytest.approx(2.5, rel=0.1)
    assert "lack of fit: the linear oscillator leaves" in fit.table()
    assert fit.plot().axes
    assert fit.model is None


def test_a_model_of_ones_own_is_fitted(record):
    parts = [gd.ViscousDamping(damping_coefficient=1.0), gd.CubicStiffness(coefficient=1e6)]
    model = gd.Model(gd.Oscillator(stiffness=1500.0), parts)
    free = ["stiffness", "damping_ratio", "cubic_stiffness.coefficient"]
    fit = gd.identify(record, model, free=free)
    for name, truth in (("stiffness", OMEGA**2), ("viscous_damping.damping_coefficient", DAMPING),
                        ("cubic_stiffness.coefficient", CUBIC)):  # fmt: skip
        low, high = fit.parameters[name]["interval95"]
        assert fit.parameters[name]["value"] == pytest.approx(truth, rel=0.02)
        assert low - 0.5 * (high - low) < truth < high + 0.5 * (high - low)
    assert fit.converged
    assert fit.model.given["cubic_stiffness.coefficient"] == pytest.approx(CUBIC, rel=0.02)
    assert "lack of fit" not in fit.table()
    assert fit.plot().axes


def test_a_damping_coefficient_that_the_file_states_holds_where_the_model_has_none(record):
    file = record.source.with_name("damped.yaml")
    file.write_text(record.source.read_text() + "parameters: {damping_coefficient: 3 1/s}\n")
    given = gd.load(file)
    model = gd.Model(gd.Oscillator(stiffness=1500.0), [gd.ViscousDamping(), gd.CubicStiffness(coefficient=1e6)])
    fit = gd.identify(given, model, free=["stiffness", "cubic_stiffness.coefficient"])
    assert fit.model.given["viscous_damping.damping_coefficient"] == 3.0


@pytest.mark.parametrize(
    ("free", "said"),
    [
        (["stifness"], "did you mean 'stiffness'?"),
        (["cubic_stiffness.coefficient"], "begins at zero"),
    ],
)
def test_what_cannot_be_free_is_said(record, free, said):
    model = gd.Model(gd.Oscillator(), [gd.ViscousDamping(), gd.CubicStiffness(coefficient=0.0)])
    with pytest.raises(gd.InputError, match=said):
        gd.identify(record, model, free=free)
    with pytest.raises(gd.InputError, match="is a gear_pair, the records are those of an oscillator"):
        gd.identify(record, rig(), free=["pinion_speed"])
    with pytest.raises(gd.InputError, match="give the model too"):
        gd.identify(record, free=["stiffness"])


def test_a_gear_pair_that_was_given_nothing_has_nothing_to_be_fitted(tmp_path):
    """An oscillator's linear model is found from nothing; which of a gear pair's many values are doubted is not."""
    record = gd.load(write_case(draw_case("null", 6, duration=0.02, snr_db=30.0), tmp_path / "measured"))
    with pytest.raises(gd.InputError, match="names nothing to be fitted, and the model was given no values"):
        gd.identify(record, gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.ViscousDamping()]))


def test_a_gear_pair_of_ones_own_is_fitted_with_what_the_file_states(tmp_path):
    case = draw_case("null", 6, duration=0.02, snr_db=30.0)
    silent = {name: value for name, value in case.nominal.items() if name != "contact_ratio"}
    case = replace(case, records=tuple(case.records[i] for i in (0, 3, 6)), nominal=silent)
    measured = gd.load(write_case(case, tmp_path / "measured"))
    model = gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.ViscousDamping(damping_coefficient=300.0)])
    ends = ["fourier_mesh_stiffness.maximum", "fourier_mesh_stiffness.minimum"]
    fit = gd.identify(measured, model, free=["damping_ratio", "mesh_phase", *ends])
    assert fit.model.given["inertia_pinion"] == pytest.approx(case.nominal["inertia_pinion"]["value"])
    assert fit.parameters["mesh_phase"]["value"] == pytest.approx(case.truth["rig"]["mesh_phase"], abs=0.15)
    assert "lack of fit" in fit.table()  # its stiffness has edges that two levels do not have
    ratio = "fourier_mesh_stiffness.contact_ratio"  # of which the file says nothing, and the model its default
    assert fit.model.given.get(ratio, model.parameters()[ratio].default) == model.parameters()[ratio].default


def test_an_explanation_names_the_spring(record, tmp_path):
    answer = gd.explain(record, minutes=5)
    assert answer.verdict == "explained"
    assert [cause["name"] for cause in answer.causes] == ["cubic_stiffness"]
    assert answer.content["verdict"] == answer.verdict
    assert answer.model.given["cubic_stiffness.coefficient"] == pytest.approx(CUBIC, rel=0.05)
    assert "cubic_stiffness" in answer._repr_html_()
    told = str(answer).splitlines()
    assert told[0] == "explained"
    assert any(line.startswith("cubic_stiffness (established): coefficient ") for line in told)
    assert told[-1].startswith("The damping ratio came out at ")
    low, high = answer.damping_ratio["interval95"]
    assert low < answer.damping_ratio["value"] < high
    assert not answer.damping_ratio["conditional"]
    report = answer.report(tmp_path / "report.html")
    assert "cubic" in report.read_text(encoding="utf-8")
    with pytest.raises(FileExistsError, match="is there and stays as it is: give another path"):
        answer.report(report)


@pytest.mark.slow
def test_the_lines_of_the_readme_run(tmp_path, monkeypatch):
    readme = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    lines = readme.split("```python\n")[1].split("```")[0]
    assert "gd.simulate(" in lines
    case = draw_case("null", 6, duration=0.02, snr_db=30.0)
    case = replace(case, records=tuple(case.records[i] for i in (0, 3, 4, 6)))
    monkeypatch.chdir(write_case(case, tmp_path / "measured").parent)
    exec(compile(lines, "README.md", "exec"), {})
    assert Path("report.html").exists()


def test_what_is_wrong_with_a_question_is_said(record):
    with pytest.raises(gd.InputError) as caught:
        gd.explain(record, ruled_out=["cubic_stifness"], acepted_t=3, level=2.0)
    said = str(caught.value)
    assert "ruled_out = 'cubic_stifness': no such effect; remedy: did you mean 'cubic_stiffness'?" in said
    assert "acepted_t: no argument and no threshold; remedy: did you mean 'accepted_t'?" in said
    assert "level = 2.0: must lie within" in said


@pytest.mark.parametrize(
    ("given", "key", "rule"),
    [
        ({"n_samples": 1}, "n_samples", "within 2 and"),  # no interval to integrate over
        ({"n_samples": 0}, "n_samples", "within 2 and"),
        ({"n_samples": 1.5}, "n_samples", "whole number"),
        ({"n_samples": True}, "n_samples", "whole number"),
        ({"sampling_rate": 0.0}, "sampling_rate", "positive, finite number in Hz"),
        ({"sampling_rate": float("nan")}, "sampling_rate", "positive, finite number in Hz"),
        ({"sampling_rate": "40 kHz"}, "sampling_rate", "positive, finite number in Hz"),
        ({"batch": 0}, "batch", "within 1 and"),
        ({"batch": 2.0}, "batch", "whole number"),
    ],
)
def test_what_nothing_can_be_sampled_with_is_refused_by_its_name(given, key, rule):
    with pytest.raises(gd.InputError) as raised:
        gd.simulate(rig(), **{"sampling_rate": 40e3, "n_samples": 10, **given})
    [problem] = raised.value.problems
    assert problem.key == key
    assert rule in problem.rule
    assert problem.value is given[key] or problem.value == given[key]
    assert problem.remedy


def test_two_samples_and_counts_of_numpy_are_enough():
    runs = gd.simulate(rig(), sampling_rate=np.float64(40e3), n_samples=np.int64(2), batch=np.int64(3))
    assert runs.transmission_error.shape == (3, 2)
