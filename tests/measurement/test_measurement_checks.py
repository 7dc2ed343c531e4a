"""Suspicious data is found and named; sound data raises nothing."""

import numpy as np
import pytest

from gear_damping.measurement.checks import clipped_at


def _errors(bench) -> np.ndarray:
    return bench.columns["dte"]


def test_sound_data_raises_nothing(bench):
    assert bench.load().findings == ()


def test_dropped_samples_are_counted_where_they_are(bench):
    keep = np.r_[0:100, 103:250, 251:400]
    bench.columns = {name: values[keep] for name, values in bench.columns.items()}
    record = bench.load().records[0]
    (finding,) = record.findings
    assert (finding.kind, finding.sample, finding.severity) == ("dropped_samples", 100, "note")
    assert "about 4 sample(s) were dropped in 2 gap(s)" in finding.message
    assert "samples are taken at their stamps" in finding.message
    assert not record.uniform
    np.testing.assert_array_equal(record.time, bench.columns["t"])
    assert record.sampling_rate == pytest.approx(20000 * 395 / 399)  # a grid of as many samples over the same time


def test_of_many_gaps_the_longest_is_told(bench):
    lost = np.r_[20, 60, 100, 140, 180, 220, 221, 222, 223, 260]
    keep = np.setdiff1d(np.arange(400), lost)
    bench.columns = {name: values[keep] for name, values in bench.columns.items()}
    (finding,) = [one for one in bench.load().records[0].findings if one.kind == "dropped_samples"]
    row = int(np.flatnonzero(keep == 224)[0])
    assert f"and others, the longest before row {row} (at" in finding.message


def test_stamps_that_the_values_contradict_are_a_problem(bench):
    bench.columns["t"] = bench.columns["t"] + 0.1 / 20000 * np.sin(np.arange(400))
    bench.columns["theta1"] = 188.5 * bench.columns["t"]
    assert bench.kinds() == ["uneven_stamps"]
    record = bench.load().records[0]
    assert not record.uniform
    np.testing.assert_array_equal(record.time, bench.columns["t"])


def test_a_rate_that_changes_within_the_record_is_said(bench):
    bench.columns["t"][250:] += (np.arange(150) + 1) / 20000 * 0.5
    bench.columns["theta1"] = 188.5 * bench.columns["t"]
    assert bench.kinds() == []
    (note,) = bench.load().records[0].findings
    assert (note.kind, note.severity, note.sample) == ("uneven_stamps", "note", 250)


def test_stamps_within_a_hundredth_of_a_step_of_a_grid_are_put_there_and_others_kept(bench):
    step = np.full(399, 1 / 20000)
    step[7] *= 1.009
    bench.columns["t"] = np.r_[0, np.cumsum(step)]
    assert bench.load().records[0].uniform
    step[7] = 1.011 / 20000
    bench.columns["t"] = np.r_[0, np.cumsum(step)]
    bench.write_csv()
    record = bench.load().records[0]
    assert not record.uniform
    assert [(finding.kind, finding.severity) for finding in record.findings] == [("uneven_stamps", "note")]


def test_records_of_different_rate_are_noted(bench):
    bench.write_csv()
    bench.columns = {name: values[::2] for name, values in bench.columns.items()}
    bench.write_csv("run_2.csv")
    bench.add_record(file="run_2.csv")
    (finding,) = bench.load().findings
    assert (finding.kind, finding.record, finding.severity) == ("mixed_rates", "run_2", "note")


def test_stamps_of_events_have_no_rate_that_another_record_s_could_differ_from(bench):
    """One row for each turn of a wheel that coasts: the rate is what it happened to have."""
    bench.write_csv()
    turned = np.linspace(0, 1, 400) ** 1.5 * 0.1
    bench.columns["t"] = turned
    bench.write_csv("run_2.csv")
    bench.add_record(file="run_2.csv")
    loaded = bench.load()
    assert [record.uniform for record in loaded.records] == [True, False]
    assert "mixed_rates" not in [finding.kind for finding in loaded.findings]


def test_a_constant_response_is_a_problem_and_a_constant_torque_is_not(bench):
    _errors(bench)[:] = 3.0
    bench.columns["T1"][:] = 150.0
    found = {finding.channel: finding.severity for finding in bench.load().findings}
    assert found == {"transmission_error": "data_problem", "pinion_torque": "note"}


@pytest.mark.parametrize("side", [1, -1])
def test_a_clipped_response_is_found(bench, side):
    signal = _errors(bench)
    signal[:] = side * np.minimum(side * signal, np.quantile(side * signal, 0.95))
    assert bench.kinds() == ["clipped"]


def test_a_single_saturated_stretch_is_found(bench):
    _errors(bench)[200:212] = 15.0
    finding = bench.load().findings[0]
    assert (finding.kind, finding.sample) == ("clipped", 200)


def test_a_coarse_converter_is_not_taken_for_clipping(bench):
    signal = _errors(bench)
    for levels in (8, 16, 50, 200):
        bench.columns["dte"] = np.round(signal * levels / np.ptp(signal)) * np.ptp(signal) / levels
        bench.write_csv()
        assert bench.kinds() == [], levels


@pytest.mark.parametrize(("limit", "clipped"), [(2.0, "minimum"), (3.0, "minimum"), (6.0, None)])
@pytest.mark.parametrize("bits", [8, 10])
def test_a_fast_decay_that_a_coarse_converter_cut_is_clipped(limit, clipped, bits):
    step, time = limit / 2 ** (bits - 1), np.arange(1200) / 200
    decay = 5 * np.exp(-0.031 * 45.87 * time) * np.cos(45.87 * time - 0.3)
    found = clipped_at(np.clip(step * np.round(decay / step), -limit, limit - step))
    assert (found and found[0]) == clipped


@pytest.mark.parametrize("period", [5.3, 9.7, 27.4, 100.3])
@pytest.mark.parametrize("levels", [2.4, 5.3, 40.2])
def test_a_whole_swing_of_few_steps_is_not_clipped(period, levels):
    time = np.arange(1200)
    for damping in (0.0, 0.004, 0.03):
        swing = levels * np.exp(-damping * 2 * np.pi * time / period) * np.cos(2 * np.pi * time / period)
        assert clipped_at(np.round(swing)) is None, damping


def test_what_rests_until_a_drive_moves_it_off_is_not_clipped():
    """A motor that winds a load: half of a record at rest, then a lag of a sample to its speed."""
    fall = [36, 172, 349, 555, 769, 986, 1207, 1421, 1638, 1860, 2077, 2299, 2517, 2738, 2958, 3179, 3395, 3617, 3836]
    assert clipped_at(5013.0 - np.r_[np.zeros(24), fall]) is None


@pytest.mark.parametrize(("reads", "found"), [(1, None), (4, "maximum")])
def test_a_speed_that_is_read_more_often_than_measured_is_clipped_where_it_stays_for_longer(reads, found):
    """Of an axis each speed was read ten to twenty times, and the highest one, of a coarse counter, in many places."""
    rng = np.random.default_rng(3)
    speed = rng.uniform(0, 8, 300)
    highest = np.arange(0, 300, 20)
    speed[(highest[:, None] + np.arange(reads)).ravel()] = 10
    said = clipped_at(np.repeat(speed, rng.integers(10, 20, speed.size)))
    assert (said and said[0]) == found


def test_a_torque_that_steps_or_ramps_and_holds_is_not_clipped(bench):
    ramp = np.interp(np.arange(400), [0, 100, 200, 399], [100, 100, 150, 150])
    for torque in (ramp, np.where(np.arange(400) < 200, 100.0, 150.0)):
        bench.columns["T1"] = torque
        bench.write_csv()
        assert bench.kinds() == []


def test_a_torque_that_returns_to_its_limit_is_what_was_applied(bench):
    bench.columns["T1"] = np.minimum(150 + 20 * np.sin(np.arange(400) / 11), 165)
    assert bench.load().findings == ()
    bench.channels["pinion_torque"]["range"] = {"value": 165, "unit": "N*m"}
    assert bench.kinds() == ["clipped"]


def test_the_declared_range_shows_clipping_that_noise_hides(bench):
    bench.channels["transmission_error"]["range"] = {"value": 9.5, "unit": "um"}
    assert bench.kinds() == ["clipped"]
    bench.channels["transmission_error"]["range"] = {"value": 20, "unit": "um"}
    assert bench.kinds() == []


@pytest.mark.parametrize(("nominal", "kinds"), [(1.01, ["clipped"]), (1.5, [])])
def test_a_sensor_that_is_cut_off_just_below_its_nominal_range_is_clipped(bench, nominal, kinds):
    signal = _errors(bench)
    signal[:] = np.minimum(signal, np.quantile(signal, 0.95))
    bench.channels["transmission_error"]["range"] = {"value": nominal * float(np.abs(signal).max()), "unit": "um"}
    assert bench.kinds() == kinds


def test_the_range_of_a_speed_without_its_mean_is_that_of_its_fluctuation(bench):
    speed = {"column": "dte", "unit": "rpm", "coupling": "AC", "range": {"value": 20, "unit": "rpm"}}
    bench.columns["dte"], bench.channels["pinion_speed"] = 10 * np.sin(np.arange(400) / 7), speed
    for name in ("pinion_angle", "transmission_error"):
        del bench.channels[name]
    bench.record["conditions"] = {"pinion_speed": "3000 rpm"}
    bench.write_csv()
    assert "clipped" not in bench.kinds()
    speed["range"]["value"] = 9.5
    assert "clipped" in bench.kinds()


def test_values_far_beyond_a_declared_range_are_no_clipping(bench):
    bench.channels["transmission_error"]["range"] = {"value": 2, "unit": "um"}
    said = [finding for finding in bench.load().records[0].findings if finding.kind == "clipped"]
    assert len(said) == 1
    assert "beyond its declared range of 2 um: state the range" in said[0].message


@pytest.mark.parametrize(
    ("unit", "kinds"), [("um", []), ("mm", ["implausible_magnitude"]), ("m", ["implausible_magnitude"])]
)
def test_a_unit_slip_of_the_transmission_error_is_found(bench, unit, kinds):
    bench.channels["transmission_error"]["unit"] = unit
    assert bench.kinds() == kinds


def test_an_arbitrary_datum_is_not_taken_for_a_large_error(bench):
    _errors(bench)[:] += 5000.0
    bench.channels["transmission_error"]["datum"] = "arbitrary"
    assert bench.kinds() == []
    bench.channels["transmission_error"]["datum"] = "absolute"
    assert bench.kinds() == ["implausible_magnitude"]


def test_a_header_that_names_another_unit_is_found(bench):
    bench.columns["dte (nm)"] = bench.columns.pop("dte")
    bench.channels["transmission_error"]["column"] = "dte (nm)"
    assert bench.kinds() == ["unit_conflict"]
    del bench.channels["transmission_error"]["unit"]
    record = bench.load().records[0]
    assert record.findings == ()
    np.testing.assert_allclose(
        record.channels["transmission_error"].values, 1e-9 * bench.columns["dte (nm)"], rtol=1e-15
    )


@pytest.mark.parametrize(
    ("rpm", "kinds"), [(1800, []), (1830, []), (1850, ["speed_mismatch"]), (-1800, ["speed_mismatch"])]
)
def test_angle_and_speed_must_agree(bench, rpm, kinds):
    bench.record["conditions"] = {"pinion_speed": {"value": rpm, "unit": "rpm"}}
    assert bench.kinds() == kinds


def test_an_angle_in_degrees_read_as_radians_is_found(bench):
    bench.columns["theta1"] = np.degrees(bench.columns["theta1"])
    bench.record["conditions"] = {"pinion_speed": {"value": 1800, "unit": "rpm"}}
    assert bench.kinds() == ["speed_mismatch"]


def test_torque_and_angle_exchanged_are_found(bench):
    rng = np.random.default_rng(3)
    bench.columns["T1"] = 0.5 + 0.1 * rng.standard_normal(400)
    bench.channels["pinion_torque"]["column"] = "theta1"
    bench.channels["pinion_angle"]["column"] = "T1"
    assert "angle_not_turning" in bench.kinds()


def test_oversampling_is_a_note(bench):
    _errors(bench)[:] = 8 + 2 * np.sin(2 * np.pi * 100 * bench.columns["t"])
    (finding,) = bench.load().findings
    assert (finding.kind, finding.severity) == ("oversampled", "note")
    assert (
        "so that 20000 Hz is far more than is needed; resample: {value: 6000, unit: Hz} saves time" in finding.message
    )


def test_a_record_is_not_oversampled_beside_one_of_its_rate_that_is_not(bench):
    bench.add_record(file="run_2.csv")
    bench.write_csv("run_2.csv")
    _errors(bench)[:] = 8 + 2 * np.sin(2 * np.pi * 100 * bench.columns["t"])
    assert "oversampled" not in [finding.kind for finding in bench.load().findings]


def test_what_answers_slowly_to_a_fast_load_is_not_oversampled(bench):
    _errors(bench)[:] = 8 + 2 * np.sin(2 * np.pi * 100 * bench.columns["t"])
    bench.columns["T1"] = 150 + 10 * np.sin(2 * np.pi * 900 * bench.columns["t"])
    assert bench.load().findings == ()


def test_a_slow_load_beside_the_whole_speed_of_a_shaft_says_nothing_of_oversampling(bench):
    del bench.channels["transmission_error"]
    speed = 10 * np.pi + 0.01 * np.sin(2 * np.pi * 2000 * bench.columns["t"])
    bench.columns["w2"] = speed
    bench.channels["gear_speed"] = {"column": "w2", "unit": "rad/s"}
    bench.columns["T1"] = 150 + 10 * np.sin(2 * np.pi * 100 * bench.columns["t"])
    assert "oversampled" not in [finding.kind for finding in bench.load().findings]


@pytest.mark.parametrize("teeth", [33, 34])
def test_teeth_that_mesh_beyond_the_band_are_a_note(bench, teeth):
    bench.content["parameters"]["n_teeth_pinion"] = {"value": teeth}
    bench.columns["theta1"] = bench.columns["theta1"] * 10.1  # 303 turns a second, at 20 kHz
    kinds = [finding.kind for finding in bench.load().findings if finding.severity == "note"]
    assert kinds == ["mesh_beyond_band"] * (teeth == 34)


@pytest.mark.parametrize("factor", [2, 10])
def test_a_file_that_was_interpolated_is_said(bench, factor):
    rows = np.arange(400)
    knots = np.arange(0, 400 + factor, factor)
    bench.columns["dte"] = np.interp(rows, knots, 1e-6 * np.random.default_rng(0).normal(size=len(knots)))
    (finding,) = bench.load().findings
    assert (finding.kind, finding.severity) == ("interpolated", "data_problem")
    assert f"{factor} times coarser" in finding.message


def test_coarse_steps_of_a_converter_are_no_interpolation(bench):
    bench.columns["dte"] = 1e-8 * np.round(100 * np.sin(np.arange(400) / 40))
    assert "interpolated" not in {finding.kind for finding in bench.load().findings}


@pytest.mark.parametrize(("stated", "kind"), [(150.5, "not_used"), (160.0, "not_used"), (300.0, "condition_mismatch")])
def test_a_condition_that_the_channel_of_its_name_never_reaches_is_found(bench, stated, kind):
    bench.record["conditions"] = {"pinion_torque": {"value": stated, "unit": "N*m"}}  # the channel holds 149 to 151
    (found,) = (one for one in bench.load().records[0].findings if one.channel == "pinion_torque")
    assert found.kind == kind
    assert found.severity == "note"
    assert ("never reaches (1" in found.message) is (kind == "condition_mismatch")


@pytest.mark.parametrize(("rpm", "problems"), [(1790.0, []), (1500.0, ["condition_mismatch"])])
def test_a_stated_speed_that_the_measured_one_never_reaches_is_to_be_cured(bench, rpm, problems):
    bench.columns["n"] = np.full(400, 1800.0)
    bench.channels["pinion_speed"] = {"column": "n", "unit": "rpm"}
    del bench.channels["pinion_angle"]
    bench.record["conditions"] = {"pinion_speed": {"value": rpm, "unit": "rpm"}}
    assert bench.kinds() == problems
