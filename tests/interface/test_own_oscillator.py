"""A law of one's own on a free decay: its damping belongs to the recorded motion, and no fault is a traceback."""

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.errors import InputError

RATE, STIFFNESS, DAMPING = 600.0, 9e5, 6.0
FREE = ["stiffness", "viscous_damping.damping_coefficient"]


@pytest.fixture(scope="module")
def decay(tmp_path_factory):
    """The acceleration of a linear decay of 0.1 mm and 0.3 % of critical, by scipy."""
    folder, time = tmp_path_factory.mktemp("decay"), np.arange(420) / RATE

    def rates(_, state):
        return [state[1], -STIFFNESS * state[0] - DAMPING * state[1]]

    states = solve_ivp(rates, (0, time[-1]), [1e-4, 0.0], t_eval=time, rtol=1e-10, atol=1e-14).y
    shown = -STIFFNESS * states[0] - DAMPING * states[1]
    shown += 0.03 * np.random.default_rng(1).normal(size=time.size)
    np.savetxt(folder / "a.csv", shown, header="a", comments="")
    channels = {"sampling_rate": f"{RATE:g} Hz", "acceleration": {"column": "a", "unit": "m/s^2"}}
    declared = {"system": "oscillator", "records": [{"file": "a.csv", "channels": channels}]}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(declared))
    return gd.load(folder / "measurement.yaml")


def test_the_damping_of_a_hysteresis_is_that_of_the_motion_recorded(decay):
    """It was told at an amplitude of 1 m, where the sum over a cycle of one that yields at 0.05 mm ran away."""
    hysteresis = gd.HystereticDamping(share=0.01, yield_deflection=5e-5, exponent=1.0)
    model = gd.Model(gd.Oscillator(stiffness=STIFFNESS), [gd.ViscousDamping(damping_coefficient=3.0), hysteresis])
    found = gd.identify(decay, model, free=[*FREE, "hysteretic_damping.share"]).content["damping_ratio_percent"]
    assert found["value"] == pytest.approx(100 * DAMPING / (2 * STIFFNESS**0.5), rel=0.1)
    envelope = 1e-4 * np.exp(-DAMPING / 2 * np.arange(420) / RATE)  # of the whole record, all of which is fitted
    rms = np.sqrt(np.mean(envelope**2) / 2) * STIFFNESS**0.5
    assert found["reference_velocity"] == pytest.approx(rms, rel=0.3), "integrated with four samples to a period"


@pytest.mark.parametrize("role", ["", "    role: fit\n"])
def test_nothing_of_a_record_is_held_out_that_is_not_declared_so(role, tmp_path):
    """A half of it was, and the interval was 2.8 times that of the linear fit."""
    time = np.arange(2000) / 200
    decay = 5e-3 * np.exp(-0.4 * time) * np.cos(np.sqrt(400 - 0.16) * time + 0.4)
    decay += 2e-5 * np.random.default_rng(3).standard_normal(2000)
    np.savetxt(tmp_path / "a.csv", np.c_[time, decay], delimiter=",", header="t,x", comments="")
    records = f"  - name: r\n    file: a.csv\n{role}    channels:\n      time: {{column: t, unit: s}}\n"
    text = f"system: oscillator\nrecords:\n{records}      displacement: {{column: x, unit: m}}\n"
    (tmp_path / "measurement.yaml").write_text(text)
    record = gd.load(tmp_path / "measurement.yaml")
    model = gd.Model(gd.Oscillator(stiffness=390.0), [gd.ViscousDamping(damping_coefficient=0.7)])
    own, linear = gd.identify(record, model), gd.identify(record)
    assert {name: one["role"] for name, one in own.content["records"].items()} == {"r": "fit"}
    assert own.content["residual"]["holdout"] is None
    assert own.damping_ratio_percent["value"] == pytest.approx(linear.damping_ratio_percent["value"], rel=1e-4)
    assert own.damping_ratio_percent["interval95"] == pytest.approx(
        linear.damping_ratio_percent["interval95"], rel=1e-4
    )
    assert own.table()
    assert own.plot().axes


def test_what_is_declared_to_be_held_out_is_predicted(tmp_path):
    time = np.arange(800) / 200
    for name, seed in (("a", 1), ("b", 2)):
        decay = 5e-3 * np.exp(-0.4 * time) * np.cos(np.sqrt(400 - 0.16) * time)
        decay += 2e-5 * np.random.default_rng(seed).standard_normal(800)
        np.savetxt(tmp_path / f"{name}.csv", np.c_[time, decay], delimiter=",", header="t,x", comments="")
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: m}}"
    records = [f"  - {{name: {n}, file: {n}.csv, {role}channels: {channels}}}\n" for n, role in
               (("a", ""), ("b", "role: holdout, "))]  # fmt: skip
    (tmp_path / "measurement.yaml").write_text(f"system: oscillator\nrecords:\n{''.join(records)}")
    model = gd.Model(gd.Oscillator(stiffness=390.0), [gd.ViscousDamping(damping_coefficient=0.7)])
    found = gd.identify(gd.load(tmp_path / "measurement.yaml"), model).content
    assert {name: one["role"] for name, one in found["records"].items()} == {"a": "fit", "b": "holdout"}
    assert found["residual"]["holdout"]["rmse"] == pytest.approx(2e-5, rel=0.1)


def test_what_runs_away_is_said(decay):
    model = gd.Model(
        gd.Oscillator(stiffness=STIFFNESS),
        [
            gd.ViscousDamping(damping_coefficient=5.0),
            gd.CubicStiffness(coefficient=-1e17),
            gd.PowerLawDamping(coefficient=131.797425),
        ],
    )
    with pytest.raises(InputError, match="runs away when it is simulated"):
        gd.identify(decay, model, free=[*FREE, "cubic_stiffness.coefficient"])


def test_a_pendulum_in_degrees_is_one_in_radians(tmp_path):
    """The sine asks what a radian is in the unit of the response, which the record knows."""
    time = np.arange(900) / 100

    def rates(_, state):
        return [state[1], -40.0 * np.sin(state[0]) - 0.2 * state[1]]

    angle = np.degrees(solve_ivp(rates, (0, time[-1]), [1.5, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0])
    angle += 0.05 * np.random.default_rng(2).normal(size=time.size)
    np.savetxt(tmp_path / "a.csv", angle, header="a", comments="")
    channels = {"sampling_rate": "100 Hz", "displacement": {"column": "a", "unit": "deg", "datum": "absolute"}}
    declared = {"system": "oscillator", "records": [{"file": "a.csv", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    sine, damping = gd.SineRestoring(stiffness=38.0), gd.ViscousDamping(damping_coefficient=0.3)
    model = gd.Model(gd.Oscillator(stiffness=0.0), [damping, sine])
    found = gd.identify(gd.load(tmp_path / "measurement.yaml"), model).content["parameters"]
    assert found["sine_restoring.stiffness"]["value"] == pytest.approx(40.0, rel=1e-3)
    assert found["viscous_damping.damping_coefficient"]["value"] == pytest.approx(0.2, rel=0.02)


def test_a_model_that_was_given_nothing_is_the_linear_one(decay):
    found = gd.identify(decay, gd.Model(gd.Oscillator(), [gd.ViscousDamping()]))
    assert found.parameters["stiffness"]["value"] == pytest.approx(STIFFNESS, rel=1e-3)
    assert found.damping_ratio_percent["value"] == pytest.approx(100 * DAMPING / (2 * STIFFNESS**0.5), rel=0.1)


def test_a_stiffness_that_nobody_knows_is_not_held_at_its_default(decay):
    """It was held at 1 1/s^2, and a damping of 2500 % came out of 2 %."""
    model = gd.Model(gd.Oscillator(), [gd.ViscousDamping()])
    with pytest.raises(InputError, match="free: lacks 'stiffness', which is not known and would be held at 1"):
        gd.identify(decay, model, free="damping_ratio")
    free_too = gd.identify(decay, model, free=["damping_ratio", "stiffness"])
    assert free_too.parameters["stiffness"]["value"] == pytest.approx(STIFFNESS, rel=1e-3)


@pytest.fixture(scope="module")
def drag(tmp_path_factory):
    """Decays in millimetres of a rig with a viscous damping and a drag by the square of its speed, by scipy."""
    folder, time = tmp_path_factory.mktemp("drag"), np.arange(1000) / 100

    def rates(_, state):
        return [state[1], -142.5 * state[0] - 0.095 * state[1] - 0.0014 * abs(state[1]) * state[1]]

    for number, start in enumerate((40.0, 25.0)):
        place = solve_ivp(rates, (0, time[-1]), [start, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
        place += 0.01 * np.random.default_rng(number).normal(size=time.size)
        np.savetxt(folder / f"{number}.csv", place, header="x", comments="")
    channels = {"sampling_rate": "100 Hz", "displacement": {"column": "x", "unit": "mm", "datum": "absolute"}}
    records = [{"file": f"{number}.csv", "channels": channels} for number in range(2)]
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return gd.load(folder / "measurement.yaml")


def test_a_law_without_a_coefficient_begins_at_a_size_that_shows_in_these_records(drag):
    """It began at its default in SI, 1e5 times too large in a rig of millimetres, and ran away."""
    model = gd.Model(gd.Oscillator(), [gd.ViscousDamping(), gd.PowerLawDamping()])
    law = ["power_law_damping.coefficient", "power_law_damping.exponent"]
    found = gd.identify(drag, model, free=[*FREE, *law])
    assert found.parameters[law[0]]["value"] == pytest.approx(0.0014, rel=0.05)
    assert found.parameters[law[1]]["value"] == pytest.approx(2.0, rel=0.02)
    assert found.parameters[FREE[1]]["value"] == pytest.approx(0.095, rel=0.05)
    alone = gd.identify(drag, gd.Model(gd.Oscillator(), [gd.PowerLawDamping()]), free=["stiffness", *law])
    assert alone.damping_ratio_percent["value"] == pytest.approx(found.damping_ratio_percent["value"], rel=0.05)


def test_a_damping_that_nobody_knows_is_not_held_at_its_default(drag):
    """64.5 1/s, the default of a gear pair in N s/m, are 270 % of this rig."""
    model = gd.Model(gd.Oscillator(), [gd.ViscousDamping(), gd.CoulombFriction()])
    with pytest.raises(InputError, match=r"lacks 'viscous_damping.damping_coefficient', which is not known"):
        gd.identify(drag, model, free=["stiffness", "coulomb_friction.force"])
