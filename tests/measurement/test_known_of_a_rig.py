"""What people know of a rig and no key says: a mass, a length, a frequency, a gear, a period, and where it belongs."""

import math

import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.load import check_declaration, load_measurement
from gear_damping.units import to_si


def plan_of(folder, parameters=None, channels=None, system="oscillator", **record):
    """What a file of one record declares."""
    own = {"sampling_rate": "100 Hz", "displacement": {"column": "y", "unit": "rad"}} | (channels or {})
    own = {name: value for name, value in own.items() if value is not None}
    content = {"system": system, "records": [{"file": "a.csv", "channels": own, **record}]}
    content |= {"parameters": parameters} if parameters else {}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return check_declaration(folder / "measurement.yaml")


def problems_of(folder, *what, **more):
    with pytest.raises(InputError) as caught:
        plan_of(folder, *what, **more)
    return caught.value.problems


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("mass", {"value": 2, "unit": "kg"}, "force_gain: 1/m"),
        ("inertia", {"value": 2, "unit": "kg*m^2"}, "force_gain: 1/J"),
        ("length", "0.5 m", "g/l"),
        ("natural_frequency", "1.3 Hz", "(2 pi f)^2"),
        ("gear_ratio", 60, "gain of the channel"),
    ],
)
def test_what_is_known_of_an_oscillator_is_told_its_place(tmp_path, key, value, said):
    (problem,) = problems_of(tmp_path, {key: value})
    assert problem.key == f"parameters.{key}"
    assert said in problem.remedy


def test_the_numbers_of_these_remedies_are_right(tmp_path):
    (pendulum,) = problems_of(tmp_path, {"length": "0.5 m"})
    assert "19.6, unit: 1/s^2" in pendulum.remedy
    assert abs(9.80665 / 0.5 - 19.6) < 0.05
    (swing,) = problems_of(tmp_path, {"natural_frequency": "1.3 Hz"})
    assert "66.7, unit: 1/s^2" in swing.remedy
    assert abs((2 * math.pi * 1.3) ** 2 - 66.7) < 0.05
    assert to_si(1.0, "1/kg", "m/s^2/N") == 1.0  # as the remedy of a mass has it


def test_the_ratio_of_a_gear_pair_is_that_of_its_teeth(tmp_path):
    problems = problems_of(tmp_path, {"gear_ratio": 60, "n_teeth_pinion": 1}, system="gear_pair")
    ratio, teeth = (next(p for p in problems if p.key.endswith(key)) for key in ("gear_ratio", "n_teeth_pinion"))
    assert "n_teeth_pinion and n_teeth_gear" in ratio.remedy
    assert str(teeth).startswith("parameters.n_teeth_pinion = 1: lies outside 5 to 500")


@pytest.mark.parametrize("said", [{"value": -100, "unit": "1/s^2"}, "-100 1/s^2", -100])
def test_a_spring_that_pushes_away_is_outside_of_an_oscillator(said, tmp_path):
    (problem,) = problems_of(tmp_path, {"stiffness": said})
    assert problem.rule == "must not be negative"
    assert "a spring that pulls back" in problem.remedy
    assert "leave the key out" in problem.remedy


@pytest.mark.parametrize("period", [{"value": 3, "unit": "ms"}, "3 ms", "0.003 s"])
def test_a_period_is_a_rate(tmp_path, period):
    (record,) = plan_of(tmp_path, channels={"sampling_rate": period}).records
    assert record.timing.sampling_rate == pytest.approx(1000 / 3, rel=1e-12)
    (record,) = plan_of(tmp_path, channels={"sampling_rate": None}, sampling_rate=period).records
    assert record.timing.sampling_rate == pytest.approx(1000 / 3, rel=1e-12)


@pytest.mark.parametrize("period", ["0 ms", "-3 ms"])
def test_a_period_that_is_none_is_refused(tmp_path, period):
    (problem,) = problems_of(tmp_path, channels={"sampling_rate": period})
    assert problem.rule == "must be positive"


@pytest.mark.parametrize("name", ["sampling_time", "sampling_period", "dt"])
def test_a_period_under_another_name_is_told_its_place(tmp_path, name):
    (problem,) = problems_of(tmp_path, channels={"sampling_rate": None, name: "3 ms"})
    assert "write sampling_rate, which may be the time from one sample to the next" in problem.remedy
    (problem,) = problems_of(tmp_path, **{name: "3 ms"})
    assert "write sampling_rate" in problem.remedy


@pytest.mark.parametrize(
    ("name", "said"), [("base_velocity", "as force"), ("angle", "displacement"), ("voltage", "force")]
)
def test_what_an_oscillator_is_measured_by_is_told_its_channel(tmp_path, name, said):
    (problem,) = problems_of(tmp_path, channels={name: {"column": "u", "unit": "V"}})
    assert problem.key == f"records[0].channels.{name}"
    assert said in problem.remedy


def test_a_constant_force_is_told_that_it_may_not_be_uncertain(tmp_path):
    force = {"value": 3, "unit": "N", "uncertainty": 0.1}
    problems = problems_of(tmp_path, conditions={"force": force})
    assert "conditions of a gear_pair" in problems[0].rule


@pytest.mark.parametrize(("stated", "notes"), [("1500 %", 1), ("120 %", 1), ("100 %", 0), ("15 %", 0), (0.15, 0)])
@pytest.mark.parametrize("system", ["oscillator", "gear_pair"])
def test_a_damping_beyond_the_critical_one_is_said_once(tmp_path, system, stated, notes):
    """A heavily damped oscillator is possible, so that it is no more than said."""
    known, own, record = {"damping_ratio": stated}, {"displacement": {"column": "y", "unit": "mm"}}, {}
    if system == "gear_pair":
        known |= {"n_teeth_pinion": 23, "n_teeth_gear": 41}
        own = {"displacement": None, "transmission_error": {"column": "y", "unit": "um"}}
        record = {"conditions": {"pinion_speed": "1100 rpm", "pinion_torque": "60 Nm", "gear_torque": "balanced"}}
    (tmp_path / "a.csv").write_text("y\n" + "\n".join(f"{math.sin(0.3 * k):.6f}" for k in range(300)))
    plan_of(tmp_path, known, own, system, **record)
    found = [one for one in load_measurement(tmp_path / "measurement.yaml").findings if one.kind == "overdamped"]
    assert [one.severity for one in found] == ["note"] * notes
    for one in found:
        said = stated.partition(" ")[0]
        assert one.message.startswith(f"parameters.damping_ratio states {said} %, beyond critical")
        assert one.message.endswith(f"write {int(said) / 100:g} % where that was meant")
        assert ("teeth in mesh" in one.message) == (system == "gear_pair")
