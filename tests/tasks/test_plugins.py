"""A user's own effect file: simulated, identified, documented, and clearly refused where it is broken."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement
from gear_damping.own_files import errors_in
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.effect_files import load_effects
from gear_damping.reporting.effects_page.__main__ import main as write_effects_page
from gear_damping.reporting.effects_page.declarations import parameter_row
from gear_damping.tasks.command import main

DOCS = Path(__file__).resolve().parents[2] / "docs"
EXAMPLE = DOCS / "examples" / "my_effect.py"
NAME = "shear_thinning_damping"
COSTLY = ("second_mode", "hysteretic_damping", "asymmetric_friction")  # in its place, and of many numbers
STIFFNESS, COEFFICIENT, VELOCITY, START = 1000.0, 3.0, 0.5, 0.05


def decay(folder, *more, plugin=EXAMPLE):
    return [
        "task=simulate", "simulator=oscillator", "family=none", f"simulator.plugins=[{plugin}]",
        "simulator.damping_law=null", "simulator.viscous_damping=null", f"simulator.stiffness={STIFFNESS}",
        f"simulator.initial_displacement={START}", "simulator.n_samples=3000", "progress=false",
        f"simulator.{NAME}.damping_coefficient={COEFFICIENT}", f"simulator.{NAME}.thinning_velocity={VELOCITY}",
        f"hydra.run.dir={folder / 'run'}", f"data_folder={folder / 'data'}", *more,
    ]  # fmt: skip


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The run folder of a noisy decay that was simulated with the example file."""
    folder = tmp_path_factory.mktemp("decay")
    assert main(decay(folder, "simulator.sensor_noise.snr_db=40", "write_measurement=true")) == 0
    return folder / "run"


def test_it_simulates_what_its_equation_says(tmp_path):
    assert main(decay(tmp_path, "simulator.solver.accuracy=1e-7")) == 0
    with np.load(tmp_path / "run" / "runs.npz") as runs:
        times, response = runs["t"], runs["displacement"][0]
        velocity, acceleration = runs["velocity"][0], runs["acceleration"][0]
        assert runs[f"parameters/{NAME}.thinning_velocity"] == [VELOCITY]

    def slope(_, state):
        drag = COEFFICIENT * state[1] / (1 + abs(state[1]) / VELOCITY)
        return [state[1], -STIFFNESS * state[0] - drag]

    truth = solve_ivp(slope, (0, times[-1]), [START, 0], "DOP853", times, rtol=1e-10, atol=1e-13).y
    np.testing.assert_allclose(response, truth[0], atol=1e-6 * START)
    np.testing.assert_allclose(velocity, truth[1], atol=1e-6 * START * STIFFNESS**0.5)
    np.testing.assert_allclose(acceleration, [slope(0, state)[1] for state in truth.T], atol=1e-5 * START * STIFFNESS)


def test_the_run_remembers_the_file(recorded):
    plan = json.loads((recorded / "manifest.json").read_text())["plan"]
    assert NAME in plan["model"]
    assert plan["plugins"]
    assert str(EXAMPLE) in json.loads((recorded / "run.json").read_text())["inputs"]


@pytest.mark.parametrize("ruled_out", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_it_is_found_as_the_cause_unless_it_is_ruled_out(tmp_path, ruled_out):
    size = ["simulator.n_runs=2", "write_measurement=true"]
    assert main(decay(tmp_path, "simulator.sensor_noise.snr_db=40", *size)) == 0
    measurement = tmp_path / "run" / "measurement" / "measurement.yaml"
    explain = [
        "task=explain", "simulator=oscillator", "family=none", f"simulator.plugins=[{EXAMPLE}]", "progress=false",
        f"measurement.path={measurement}", f"hydra.run.dir={tmp_path / 'explained'}",
    ]  # fmt: skip
    assert main([*explain, *([f"ruled_out=[{','.join((NAME, *COSTLY))}]"] if ruled_out else [])]) == 0
    found = json.loads((tmp_path / "explained" / "explanation.json").read_text())
    named = {cause["name"]: cause["parameters"] for cause in found["causes"] if cause["status"] == "established"}
    assert (NAME in named) is not ruled_out
    if not ruled_out:
        assert found["verdict"] == "explained"
        assert named[NAME]["damping_coefficient"]["value"] == pytest.approx(COEFFICIENT, rel=0.05)
        assert named[NAME]["thinning_velocity"]["value"] == pytest.approx(VELOCITY, rel=0.05)


def test_without_its_file_it_is_asked_for(tmp_path, caplog):
    arguments = [one for one in decay(tmp_path) if "plugins" not in one]
    assert main(arguments) == 1
    assert "an effect of your own needs simulator.plugins=[its file]" in caplog.text


def test_what_is_ruled_out_must_exist(caplog):
    assert main(["task=explain", "measurement=silverbox", "ruled_out=[backlsh]"]) == 1
    assert "did you mean 'backlash'?" in caplog.text


def test_it_is_identified_from_the_record(recorded):
    identify = runpy.run_path(str(EXAMPLE.with_name("identify_my_effect.py")))["identify"]
    measurement = recorded / "measurement" / "measurement.yaml"
    assert load_measurement(measurement).system == "oscillator"
    found = identify(measurement)
    truth = {
        "stiffness": STIFFNESS, f"{NAME}.damping_coefficient": COEFFICIENT, f"{NAME}.thinning_velocity": VELOCITY,
    }  # fmt: skip
    assert found.keys() == truth.keys()
    for name, (value, (low, high)) in found.items():
        assert value == pytest.approx(truth[name], rel=0.03)
        assert low < value < high
        assert high - low < 0.1 * value


def test_its_documentation_row_appears(tmp_path):
    assert write_effects_page(["--plugins", str(EXAMPLE), "--folder", str(tmp_path)]) == 0
    text = (tmp_path / "effects.md").read_text()
    kind = effect_class(NAME, [EXAMPLE])
    assert f"[`{NAME}`](#{NAME}) | the damping force | gear pair, oscillator | yes" in text
    assert f"### {NAME}" in text
    assert kind.equation in text
    for parameter in kind.parameters:
        assert parameter_row(parameter) in text
    assert (tmp_path / "figures" / "effects" / f"{NAME}.png").stat().st_size < 40_000
    assert "### backlash" not in text


def test_the_page_about_it_holds_the_files_as_they_are():
    text = (DOCS / "your_own_effect.md").read_text()
    assert f"```python\n{EXAMPLE.read_text()}```" in text
    assert "examples/identify_my_effect.py" in text


BROKEN = {
    "no_python": (lambda text: text.replace("def damping_force(", "def damping_force"), "SyntaxError"),
    "wrong_import": (lambda text: text.replace("import Tensor", "import Tensr"), "ImportError"),
    "no_effect": (lambda text: "x = 1\n", "declares no effect"),
    "taken_name": (lambda text: text.replace(f'"{NAME}"', '"viscous_damping"'), "repeats the name ['viscous_damping']"),
    "misspelt_method": (
        lambda text: text.replace("def damping_force(", "def dampingforce("),
        "the class ShearThinningDamping lacks the method damping_force",
    ),
    "no_slot": (lambda text: text.replace("import DampingForce", "import Effect as DampingForce"), "fills no slot"),
    "no_parameters": (lambda text: text.replace("parameters: ClassVar", "numbers: ClassVar"), "lacks parameters"),
    "no_equation": (lambda text: text.replace("equation = ", "formula = "), "lacks equation"),
    "no_reference": (lambda text: text.replace("reference = ", "source = "), "lacks reference"),
    "no_name": (lambda text: text.replace("name = ", "title = "), "lacks name"),
    "odd_name": (lambda text: text.replace(f'"{NAME}"', '"shear thinning"'), "has the name 'shear thinning'"),
    "name_of_a_parameter": (lambda text: text.replace(f'"{NAME}"', '"stiffness"'), "repeats the name ['stiffness']"),
    "unknown_unit": (
        lambda text: text.replace('"m/s"', '"m/sekk"'),
        "gives the parameter thinning_velocity an unknown unit 'm/sekk'",
    ),
    "default_out_of_bounds": (
        lambda text: text.replace("200.0", "-200.0"),
        "gives the parameter damping_coefficient the default -200.0: must lie within 0 … 1e+12",
    ),
    "recipe_of_another": (
        lambda text: text.replace('scanned={"thinning_velocity"', 'scanned={"velocity"'),
        "has a recipe with 'velocity', which is none of its parameters",
    ),
    "unknown_experiment": (lambda text: text.replace('"ring_down"', '"ringdown"'), "is separated by 'ringdown'"),
    "no_cause": (lambda text: text.replace("= Cause(", '= "thin"\n    other = Cause('), "has a cause that is no Cause"),
    "empty": (lambda text: "", "declares no effect"),
    "fails_while_it_loads": (lambda text: text + "\n1 / 0\n", "line 34: ZeroDivisionError"),
    "stops": (lambda text: "import sys\nsys.exit(3)\n", "line 2: SystemExit"),
    "wrong_parameter": (
        lambda text: text.replace('p["thinning_velocity"]', 'p["velocity"]'),
        "line 32, in damping_force",
    ),
    "wrong_field": (lambda text: text.replace("at.delta_rate.abs", "at.rate.abs"), "no attribute 'rate'"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_ends_in_one_clear_message(name, tmp_path, caplog, capsys):
    change, said = BROKEN[name]
    path = tmp_path / f"{name}.py"
    path.write_text(change(EXAMPLE.read_text()))
    assert main(decay(tmp_path, plugin=path)) == 1
    text = caplog.text + capsys.readouterr().err
    assert text.count("This cannot run") == 1
    assert f"simulator.plugins = '{path}'" in text
    assert said in text
    assert "remedy: " in text
    assert "no such effect or parameter" not in text
    assert "Traceback" not in text
    assert "a defect of gear_damping" not in text


def test_a_missing_file_is_named(tmp_path, caplog, capsys):
    assert main(decay(tmp_path, plugin=tmp_path / "nope.py")) == 1
    text = caplog.text + capsys.readouterr().err
    assert "nope.py" in text
    assert "no such file" in text
    assert write_effects_page(["--plugins", str(tmp_path / "nope.py"), "--folder", str(tmp_path)]) == 1
    assert "nope.py" in capsys.readouterr().err


def test_all_that_is_wrong_in_a_file_is_said_at_once_beside_the_other_problems(tmp_path, caplog):
    path = tmp_path / "two_faults.py"
    path.write_text(EXAMPLE.read_text().replace("reference = ", "source = ").replace('"m/s"', '"m/sekk"'))
    assert main(decay(tmp_path, "simulator.n_runs=0", plugin=path)) == 1
    assert "3 problems" in caplog.text
    for words in ("lacks reference", "'m/sekk'", "simulator.n_runs = 0"):
        assert words in caplog.text
    assert caplog.text.count("(from command line: simulator.plugins=[") == 2


def test_a_base_that_effects_of_the_file_share_is_none_itself(tmp_path):
    path = tmp_path / "shared.py"
    base = EXAMPLE.read_text().replace("name = ", "title = ")
    derived = "".join(f"\n\nclass E{i}(ShearThinningDamping):\n    name = 'own_{i}'\n" for i in range(2))
    path.write_text(base + derived)
    assert set(load_effects(path)) == {"own_0", "own_1"}
    path.write_text(base + derived.replace("own_1", "own_0"))
    with pytest.raises(InputError, match=r"2 effects under the names \['own_0'\]"):
        load_effects(path)


def test_errors_of_the_package_itself_are_not_blamed_on_the_file():
    with pytest.raises(ZeroDivisionError), errors_in({str(EXAMPLE): "simulator.plugins"}):
        raise ZeroDivisionError


def test_a_file_is_run_once_in_a_process_until_it_changes(tmp_path):
    path, notes = tmp_path / "counted.py", tmp_path / "notes"
    text = EXAMPLE.read_text() + f"\nwith open({str(notes)!r}, 'a') as notes:\n    notes.write('x')\n"
    path.write_text(text)
    assert main(decay(tmp_path, plugin=path)) == 0
    assert notes.read_text() == "x"
    load_effects(path)
    path.write_text(text.replace("write('x')", "write('y')"))  # as long as before, and within the same second
    load_effects(path)
    assert notes.read_text() == "xy"
