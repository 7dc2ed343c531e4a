"""Units that names of columns end in: one that contradicts the declared unit is said, other names are not read so."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.named_units import gravity_at_end, time_at_end, unit_at_end

SECONDS = np.arange(400) * 0.01
MOTION = np.exp(-0.4 * SECONDS) * np.cos(12 * SECONDS)


def loaded(folder, name, unit, stamps=SECONDS, channel="displacement", motion="x", of_motion="mm", column=0, more=""):
    """The record of a table of a clock and a motion, the clock named by its place."""
    rows = "\n".join(f"{t:.9g},{x:.6f}" for t, x in zip(stamps, MOTION, strict=True))
    (folder / "a.csv").write_text(f"{name},{motion}\n{rows}\n")
    said = f"{{column: {column!r}" + (f", unit: {unit}}}" if unit else "}")
    (folder / "m.yaml").write_text(
        f"system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      time: {said}\n"
        f"      {channel}: {{column: {more or 1}, unit: {of_motion}}}\n"
    )
    return load_measurement(folder / "m.yaml").records[0]


TIMES = {
    "t_min": "min", "Zeit_min": "min", "temps_min": "min", "minutes": "min", "elapsed_minutes": "min",
    "Zeit in Minuten": "min", "t_h": "h", "hours": "h", "msec": "ms", "time_msec": "ms", "TimeMs": "ms", "tMs": "ms",
    "TimeMS": "ms", "time.ms": "ms", "t_ms_1": "ms", "run1/t_us": "us",
}  # fmt: skip


@pytest.mark.parametrize(("name", "unit"), TIMES.items(), ids=TIMES)
def test_the_name_of_a_clock_is_read_alike_by_all(name, unit, tmp_path):
    """It contradicts a unit, is the remedy where none is given, and inspection reads the same."""
    stamps = SECONDS / {"min": 60, "h": 3600, "ms": 1e-3, "us": 1e-6}[unit]
    with pytest.raises(InputError, match=f"is named '{name}'; remedy: write unit: {unit}, or give sampling_rate"):
        loaded(tmp_path, name, "s", stamps)
    with pytest.raises(InputError, match=f"is missing; remedy: give unit: {unit}, as its name says"):
        loaded(tmp_path, name, None, stamps)
    assert loaded(tmp_path, name, unit, stamps).sampling_rate == pytest.approx(100)
    assert inspect_table(read_table(tmp_path / "a.csv")).rate == pytest.approx(100)


@pytest.mark.parametrize(
    "name", ["t", "tMin", "time of day", "time_tag", "Hora", "data.s", "h", "s", "t_1", "x_value", "rhythms", "forms"]
)
def test_other_names_of_clocks_say_no_unit(name, tmp_path):
    assert time_at_end(name) is None
    assert loaded(tmp_path, name, "s").sampling_rate == pytest.approx(100)


def test_the_least_beside_the_most_is_in_no_minutes(tmp_path):
    assert time_at_end("t_min", ("t_min", "T_max", "x")) is None
    assert loaded(tmp_path, "t_min", "s", motion="t_max").sampling_rate == pytest.approx(100)


CHANNELS = {  # the name, the unit that is declared and the channel
    "x_um": ("mm", "displacement"), "x_inch": ("mm", "displacement"), "x_mil": ("mm", "displacement"),
    "pos_microns": ("mm", "displacement"), "posMm": ("m", "displacement"), "x_mm_filtered": ("m", "displacement"),
    "disp_mm_1": ("m", "displacement"), "mm": ("m", "displacement"), "Weg mm": ("m", "displacement"),
    "deg": ("rad", "displacement"), "angleDeg": ("rad", "displacement"), "theta_rad": ("deg", "displacement"),
    "x_mV": ("V", "displacement"), "v_kmh": ("m/s", "velocity"), "v_kmph": ("m/s", "velocity"),
    "v_mm_s": ("m/s", "velocity"), "v_mmps": ("m/s", "velocity"), "gyro_dps": ("rad/s", "velocity"),
    "gyro_deg_per_s": ("rad/s", "velocity"), "omega_rpm": ("rad/s", "velocity"), "acc_mg": ("g", "acceleration"),
    "acc_ms2": ("g", "acceleration"), "a_mm_s2": ("m/s^2", "acceleration"), "x_meters": ("mm", "displacement"),
    "torque_lbf_in": ("N*m", "displacement"), "torque_ftlb": ("N*m", "displacement"),
    "T_in_oz": ("N*m", "displacement"),
    "T_mNm": ("N*m", "displacement"), "torque_N_cm": ("N*m", "displacement"), "force_lbf": ("N", "displacement"),
    "force_daN": ("N", "displacement"), "omega_radps": ("rpm", "velocity"), "speed_krpm": ("rpm", "velocity"),
    "v_mph": ("m/s", "velocity"), "angle_turns": ("deg", "displacement"),
}  # fmt: skip


@pytest.mark.parametrize(("name", "declared"), CHANNELS.items(), ids=CHANNELS)
@pytest.mark.parametrize("by_place", [True, False])
def test_a_unit_in_the_name_of_a_channel_is_heeded(name, declared, by_place, tmp_path):
    unit, channel = declared
    record = loaded(tmp_path, "t", "s", motion=name, of_motion=unit, channel=channel, more=1 if by_place else name)
    (found,) = [one for one in record.findings if one.kind == "unit_conflict"]
    assert found.severity == "data_problem"
    assert found.message.startswith(f"column '{name}' is named like one in ")
    more = f"{1 if by_place else name}, gain: 1"
    assert not loaded(tmp_path, "t", "s", motion=name, of_motion=unit, channel=channel, more=more).findings


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("x_m", "mm"), ("x_in", "mm"), ("Winkel_Rad", "deg"), ("Rad", "deg"), ("m_s", "kg"), ("x_mms", "m"),
        ("x_rms", "mm"),
        ("m", "mm"), ("s", "mm"), ("x_min", "mm"), ("program", "mm"), ("x_film", "m"), ("x_g", "mm"), ("grad", "rad"),
    ],
)  # fmt: skip
def test_names_that_mean_something_else_say_nothing(name, unit, tmp_path):
    record = loaded(tmp_path, "t", "s", motion=name, of_motion=unit)
    assert [one for one in record.findings if one.kind == "unit_conflict"] == []


@pytest.mark.parametrize(
    ("name", "named", "unit"),
    [
        ("x_mV", "mV", "mm"),
        ("pos_volts", "V", "m"),
        ("force_kN", "kN", "mm"),
        ("x_mm", "mm", "V"),
        ("v_mm_s", "mm/s", "mm"),
    ],
)
@pytest.mark.parametrize("by_place", [True, False])
def test_a_unit_of_another_kind_in_the_name_of_a_channel_is_a_note(name, named, unit, by_place, tmp_path):
    column = 1 if by_place else name
    record = loaded(tmp_path, "t", "s", motion=name, of_motion=unit, more=column)
    (found,) = [one for one in record.findings if one.kind == "unit_conflict"]
    assert (found.severity, found.channel) == ("note", "displacement")
    said = f"column '{name}' is named like one in {named} and the YAML says '{unit}', a unit of another kind, "
    assert found.message.startswith(said)
    for gain in (1, 0.05):
        record = loaded(tmp_path, "t", "s", motion=name, of_motion=unit, more=f"{column}, gain: {gain}")
        assert not record.findings


@pytest.mark.parametrize(("name", "unit"), [("x_nm", "nm"), ("x_mV [mm]", "mm"), ("x_rad", "deg"), ("acc_mg", "mg")])
def test_a_name_that_ends_in_the_unit_that_is_declared_is_no_other(name, unit, tmp_path):
    record = loaded(tmp_path, "t", "s", motion=name, of_motion=unit)
    assert "of another kind" not in str([one.message for one in record.findings])


@pytest.mark.parametrize("name", ["a_g", "acc.g", "acc_g_x"])
def test_a_g_behind_an_acceleration_may_be_one_and_is_a_note(name, tmp_path):
    """It may be the ground's or the gear's."""
    assert gravity_at_end(name)
    record = loaded(tmp_path, "t", "s", motion=name, of_motion="m/s^2", channel="acceleration")
    (found,) = [one for one in record.findings if one.kind == "unit_conflict"]
    assert (found.severity, found.channel) == ("note", "acceleration")
    assert not loaded(tmp_path, "t", "s", motion=name, of_motion="g", channel="acceleration").findings


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("T_N_m", "N*m"), ("M_kNm", "kN*m"), ("F_kN", "kN"), ("speed_kn", None), ("pos_mm_min", None),
        ("n_rev_min", "rpm"), ("v_m_s", "m/s"), ("m_s", None), ("mm_s", "mm/s"), ("acc_ms-2", "m/s^2"),
        ("torque_lbf_in", "lbf*in"), ("T_ft_lb", "lbf*ft"), ("torque_ozin", "ozf*in"), ("T_MNm", "MN*m"),
        ("zoo_in", None), ("oz", None), ("torque_meter", None), ("x_lb", None),
        ("speedRPM", "rpm"), ("xRMS", None), ("mm_x", "mm"), ("", None), (3, None),
    ],
)  # fmt: skip
def test_the_end_of_a_name(name, unit):
    assert unit_at_end(name) == unit


def test_a_missing_unit_is_the_one_of_the_name(tmp_path):
    loaded(tmp_path, "t", "s", motion="pos_mm")
    (tmp_path / "m.yaml").write_text((tmp_path / "m.yaml").read_text().replace("column: 1, unit: mm", "column: 1"))
    with pytest.raises(InputError, match="give the unit of the column, as unit: mm"):
        load_measurement(tmp_path / "m.yaml")


@pytest.mark.parametrize("name", ["gFx", "gFz", "TgF"])
def test_forces_of_gravity_of_a_phone_are_accelerations_in_g(name):
    assert unit_at_end(name) == "g"
