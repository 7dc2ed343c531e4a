"""No false alarm at shafts: the ratio of two encoders, an angle that stops, a speed that runs up."""

import numpy as np
import pytest

from gear_damping.errors import InputError

TURN = 2 * np.pi


def _problems(record) -> list[str]:
    return [finding.kind for finding in record.findings if finding.severity == "data_problem"]


def _two_encoders(bench, pinion: np.ndarray, gear: np.ndarray, teeth=(15, 30), rate=20000.0):
    """A gear pair of which two encoders of 4096 and 5000 counts are read, 15/30 teeth declared."""
    time = np.arange(pinion.size) / rate
    counts = {"p": np.round(pinion * 4096 / TURN), "g": np.round(gear * 5000 / TURN)}
    bench.columns = {"t": time, **counts}
    bench.content["parameters"] = {
        "n_teeth_pinion": teeth[0], "n_teeth_gear": teeth[1],
        "module": {"value": 3, "unit": "mm"}, "pressure_angle": {"value": 20, "unit": "deg"},
    }  # fmt: skip
    bench.content["records"] = [
        {
            "file": "run_1.csv",
            "channels": {"time": {"column": "t", "unit": "s"}},
            "conditions": {"pinion_torque": {"value": 150, "unit": "N*m"}},
            "encoders": {
                "pinion": {"column": "p", "counts_per_revolution": 4096},
                "gear": {"column": "g", "counts_per_revolution": 5000},
            },
        }
    ]
    bench.write_csv()
    return bench.load_as_it_is().records[0]


@pytest.fixture
def turned():
    return 188.5 * np.arange(20000) / 20000.0


def test_the_ratio_that_two_encoders_see_is_compared_with_the_teeth_first(bench, turned):
    record = _two_encoders(bench, turned, turned * 16 / 31)
    (problem,) = [finding for finding in record.findings if finding.severity == "data_problem"]
    assert problem.kind == "tooth_ratio"
    for words in ("1.9375", "30/15 = 2", "31/16", "n_teeth_gear"):
        assert words in problem.message
    assert "read as m" not in problem.message


def test_two_encoders_on_the_declared_teeth_raise_nothing(bench, turned):
    wobble = 2e-5 * np.sin(TURN * 450 * np.arange(turned.size) / 20000)
    assert _problems(_two_encoders(bench, turned, turned / 2 + wobble)) == []
    assert _problems(_two_encoders(bench, turned[:200], turned[:200] / 2)) == []  # a third of a turn


@pytest.mark.parametrize("ratio", [-2.0, 1.9375], ids=["a direction", "a count"])
def test_encoders_that_contradict_each_other_tell_no_mean_rotation(bench, turned, ratio):
    """What both together would make is no rotation of anything, nor is the way that they part a straight response."""
    bench.content["parameters"] |= {"inertia_pinion": "1e-3 kg*m^2", "inertia_gear": "4e-3 kg*m^2"}
    record = _two_encoders(bench, turned, turned / ratio)
    turns = float(np.ptp(record.channels["pinion_angle"].values))
    assert turns == pytest.approx(188.5, rel=1e-3)
    assert {finding.kind for finding in record.findings} == {"tooth_ratio"}


def test_an_encoder_that_counts_backwards_and_exchanged_ones_are_said_so(bench, turned):
    assert "direction: -1" in _two_encoders(bench, turned, -turned / 2).findings[0].message
    assert "exchanged" in _two_encoders(bench, turned / 2, turned).findings[0].message


def test_an_error_that_runs_away_is_not_called_a_wrong_unit(bench):
    bench.columns["dte"] = bench.columns["dte"] + np.linspace(0, 3000, 400)
    assert bench.kinds() == ["drifting_error"]


def _shaft(bench, angle: np.ndarray, **conditions) -> list[str]:
    bench.columns["theta1"] = angle
    bench.record["conditions"] = conditions
    bench.write_csv()
    return [kind for kind in bench.kinds() if kind in ("angle_not_turning", "speed_mismatch")]


def test_a_shaft_may_stop_or_turn_back_but_not_tremble(bench):
    part = np.arange(400) / 400
    assert _shaft(bench, 40 * np.minimum(part, 0.5)) == []  # runs out and stands
    assert _shaft(bench, 9 * np.interp(5 * part % 1, [0.4, 1], [0, 1]) + 9 * np.floor(5 * part)) == []  # stops often
    assert _shaft(bench, 40 * np.sin(3 * part)) == []  # turned back once
    assert _shaft(bench, 3.0 + 0.3 * np.sin(3 * part)) == ["angle_not_turning"]  # a torque, less than a turn
    assert _shaft(bench, 40 * np.sin(70 * part)) == ["angle_not_turning"]


def test_a_speed_known_to_five_percent_may_be_four_off(bench):
    angle = 1.04 * 188.495559 * np.arange(400) / 20000
    speed = {"value": 1800, "unit": "rpm"}
    assert _shaft(bench, angle, pinion_speed=speed) == ["speed_mismatch"]
    assert _shaft(bench, angle, pinion_speed=speed | {"uncertainty": 0.05}) == []


def test_a_measured_speed_that_runs_up_agrees_with_its_angle(bench):
    part = np.arange(400) / 400
    bench.columns["omega"] = 200 * part**3
    bench.channels["pinion_speed"] = {"column": "omega", "unit": "rad/s"}
    assert _shaft(bench, 200 * part**4 / 4 * 0.02) == []
    bench.columns["omega"] = 230 * part**3
    assert _shaft(bench, 200 * part**4 / 4 * 0.02) == ["speed_mismatch"]


def test_a_speed_whose_mean_is_lost_says_nothing_against_the_angle(bench):
    part = np.arange(400) / 400
    bench.channels["pinion_speed"] = {"column": "omega", "unit": "rad/s"}
    bench.columns["omega"] = 0.5 * np.sin(90 * part) + 0.01 * np.random.default_rng(3).standard_normal(400)
    assert _shaft(bench, 3.8 * part) == []
    bench.columns["omega"] = 20.0 + bench.columns["omega"]
    assert _shaft(bench, 3.8 * part) == ["speed_mismatch"]


def _in_arc_seconds(bench, shaft: str, teeth: int):
    """The bench's record with its transmission error told as the angle of a shaft of so many teeth."""
    bench.content["parameters"] = {
        "n_teeth_pinion": 18, "n_teeth_gear": 55,
        "module": {"value": 4, "unit": "mm"}, "pressure_angle": {"value": 20, "unit": "deg"},
    }  # fmt: skip
    radius = 4e-3 * teeth * np.cos(np.pi / 9) / 2
    length = 1e-6 * bench.columns["dte"]
    bench.columns["dte"] = length / radius * 180 / np.pi * 3600
    noise = {"value": float(0.1 / radius), "unit": "urad"}
    bench.channels["transmission_error"] = {"column": "dte", "unit": "arcsec", "shaft": shaft, "noise": noise}
    return length


@pytest.mark.parametrize(("shaft", "teeth"), [("pinion", 18), ("gear", 55)])
def test_a_transmission_error_in_arc_seconds_is_a_length_by_its_shaft(bench, shaft, teeth):
    length = _in_arc_seconds(bench, shaft, teeth)
    channel = bench.load().records[0].channels["transmission_error"]
    assert channel.values == pytest.approx(length, rel=1e-9)
    assert channel.noise == pytest.approx(1e-7, rel=1e-9)


def test_a_transmission_error_in_arc_seconds_says_what_it_lacks(bench):
    _in_arc_seconds(bench, "pinion", 18)
    del bench.content["parameters"]["module"]
    (problem,) = bench.problems()
    assert "give module under parameters" in problem
    bench.channels["transmission_error"].pop("shaft")
    (problem,) = bench.problems()
    assert "transmission_error.shaft" in problem
    assert "nothing says of which" in problem
    bench.channels["transmission_error"] |= {"unit": "um", "shaft": "gear", "noise": {"value": 1, "unit": "um"}}
    (problem,) = bench.problems()
    assert "only for a transmission error in a unit of an angle" in problem


@pytest.mark.parametrize("said", ["arcsec", "um"])
def test_the_unit_of_the_header_tells_whether_it_is_an_angle(bench, said):
    """It was refused, with a remedy that leads to a length in arc seconds."""
    length = _in_arc_seconds(bench, "gear", 55)
    column, channel = f"dte [{said}]", bench.channels["transmission_error"]
    bench.columns = {column if name == "dte" else name: values for name, values in bench.columns.items()}
    channel |= {"column": column}
    del channel["unit"]
    if said == "arcsec":
        assert bench.load().records[0].channels["transmission_error"].values == pytest.approx(length, rel=1e-9)
        return
    (problem,) = bench.problems()
    assert "only for a transmission error in a unit of an angle, and the header says 'um'" in problem


def test_a_threshold_beyond_a_pulse_train_says_what_the_train_holds(bench):
    bench.columns["pulse"] = 0.2 * (np.mod(bench.columns["theta1"] / TURN, 1) < 0.5)
    del bench.channels["pinion_angle"]
    threshold = {"value": 2, "unit": "V"}
    bench.record["encoders"] = {
        "tacho": {"column": "pulse", "unit": "V", "pulses_per_revolution": 1, "threshold": threshold}
    }
    (problem,) = bench.problems()
    for words in ("encoders.tacho.threshold", "0 to 0.2; remedy"):
        assert words in problem


@pytest.mark.parametrize(("said", "kinds"), [("arcsec", []), ("mrad", ["unit_conflict"])])
def test_the_angle_of_a_shaft_is_held_against_the_unit_of_its_header(bench, said, kinds):
    _in_arc_seconds(bench, "gear", 55)
    bench.columns = {f"dte [{said}]" if name == "dte" else name: values for name, values in bench.columns.items()}
    bench.channels["transmission_error"]["column"] = f"dte [{said}]"
    assert [kind for kind in _problems(bench.load().records[0]) if kind == "unit_conflict"] == kinds


@pytest.mark.parametrize(("unit", "factor", "radius"), [("rad/s^2", 1.0, None), ("deg/s^2", np.pi / 180, 0.04)])
def test_an_angular_acceleration_needs_no_radius(bench, unit, factor, radius):
    values = 300 * np.cos(np.arange(400) / 7)
    bench.columns["alpha"] = values
    channel = {"column": "alpha", "unit": unit, "mounting": "tangential", "shaft": "gear"}
    bench.channels["acceleration"] = channel | ({} if radius is None else {"radius": {"value": radius, "unit": "m"}})
    del bench.channels["transmission_error"]
    found = bench.load().records[0].channels["acceleration"]
    assert found.radius == (radius or 1.0)
    np.testing.assert_allclose(found.values / found.radius, factor * values, rtol=1e-12)
    channel["unit"] = "m/s^2"
    bench.channels["acceleration"] = channel
    assert "state the unit of an angular acceleration, unit: rad/s^2" in " ".join(bench.problems())


@pytest.mark.parametrize(("header", "conflicts"), [("alpha_rad/s^2", False), ("alpha_deg/s^2", True)])
def test_an_angular_acceleration_is_held_against_its_header_in_its_own_unit(bench, header, conflicts):
    bench.columns[header] = 300 * np.cos(np.arange(400) / 7)
    channel = {"column": header, "unit": "rad/s^2", "mounting": "tangential", "shaft": "gear"}
    bench.channels["acceleration"] = channel
    found = [one.message for one in bench.load().records[0].findings if one.kind == "unit_conflict"]
    assert len(found) == conflicts
    assert all("which was used to read acceleration in rad/s^2;" in message for message in found)


@pytest.mark.parametrize(("sign", "is_said"), [(1, False), (-1, True)])
def test_a_pinion_that_turns_against_its_torque_is_a_note(bench, turned, sign, is_said):
    record = _two_encoders(bench, sign * turned, sign * turned / 2)
    assert [found.severity for found in record.findings if found.kind == "turns_backwards"] == ["note"] * is_said


@pytest.mark.parametrize(("counts", "is_said"), [(360, False), (3600, True)])
def test_a_header_in_degrees_contradicts_another_number_in_a_turn(bench, turned, counts, is_said):
    _two_encoders(bench, turned, turned / 2)
    angles = {"p [deg]": np.degrees(turned), "g [deg]": np.degrees(turned / 2)}
    bench.columns = {"t": bench.columns["t"], **angles}
    for shaft, column in (("pinion", "p"), ("gear", "g")):
        bench.content["records"][0]["encoders"][shaft] = {"column": column, "counts_per_revolution": counts}
    bench.write_csv()
    found = [one.message for one in bench.load_as_it_is().records[0].findings if one.kind == "unit_conflict"]
    assert len(found) == 2 * is_said
    assert all("of which a turn has 360" in message for message in found)


def test_a_tacho_that_never_rises_is_one_message(bench):
    bench.columns |= {"tacho": np.full(400, 5.0)}
    bench.record["encoders"] = {"tacho": {"column": "tacho", "pulses_per_revolution": 1}}
    bench.write_csv()
    with pytest.raises(InputError, match="0 pulse"):
        bench.load_as_it_is()


def test_an_encoder_that_is_not_declared_in_full_is_told_without_another_fault(bench, turned):
    _two_encoders(bench, turned, turned / 2)
    for shaft in ("pinion", "gear"):
        del bench.content["records"][0]["encoders"][shaft]["counts_per_revolution"]
    bench.content["records"][0]["channels"] = {"sampling_rate": "20 kHz"}
    bench.write_csv()
    with pytest.raises(InputError, match="360 of a column in degrees") as caught:
        bench.load_as_it_is()
    assert {problem.key.rpartition(".")[2] for problem in caught.value.problems} == {"counts_per_revolution"}


def test_counts_of_an_angle_are_answered_with_the_counts_of_a_turn(bench):
    bench.columns["theta1"] = np.arange(400.0) * 100
    bench.record["channels"]["pinion_angle"] = {"column": "theta1", "unit": "counts", "gain": 4096}
    bench.write_csv()
    with pytest.raises(InputError, match="write unit: rev, and gain: the counts of one rev") as caught:
        bench.load_as_it_is()
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize(("speed", "is_said"), [("600 rpm", False), ("-600 rpm", True)])
def test_a_stated_speed_against_the_torque_is_a_note(bench, speed, is_said):
    bench.record["conditions"] = {"pinion_speed": speed, "pinion_torque": "60 Nm"}
    for name in ("pinion_angle", "pinion_torque", "pinion_speed"):
        bench.record["channels"].pop(name, None)
    bench.write_csv()
    assert ("turns_backwards" in [one.kind for one in bench.load_as_it_is().records[0].findings]) is is_said


@pytest.mark.parametrize("mounting", [{}, {"mounting": "casing"}])
def test_an_angular_acceleration_is_none_of_a_casing(bench, mounting):
    bench.channels["acceleration"] = {"column": "dte", "unit": "rad/s^2"} | mounting
    (problem,) = bench.problems()
    assert "which a casing has none of; remedy: say whose it is: mounting: tangential, shaft: pinion" in problem


@pytest.mark.parametrize(
    ("unit", "height", "remedy"), [("rad", 360.0, "deg"), ("deg", TURN, "rad"), ("deg", 1.0, "rev")]
)
def test_an_angle_that_falls_back_by_a_turn_of_another_unit_is_refused(bench, unit, height, remedy):
    turns = bench.columns["theta1"] / TURN * 12 / np.ptp(bench.columns["theta1"] / TURN)
    bench.columns["theta1"] = height * (turns % 1)
    bench.channels["pinion_angle"] = {"column": "theta1", "unit": unit}
    (problem,) = bench.problems()
    assert f"a turn in {remedy}, and none in '{unit}'; remedy: write unit: {remedy}" in problem
    bench.channels["pinion_angle"]["unit"] = remedy
    assert np.ptp(bench.load_as_it_is().records[0].channels["pinion_angle"].values) == pytest.approx(
        12 * TURN, rel=1e-6
    )
