"""Damaged files end in a data problem or in one error that names the file; no physics is ever blamed."""

from dataclasses import replace

import pytest
from hidden import FAULTS, draw_case, write_case

from gear_damping.errors import InputError
from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement

SAYS = {  # words that the message must hold: what is wrong, or what cures it
    "nan_run": "dte", "dropped_samples": "sample", "repeated_stamps": "time", "mm_for_m": "unit",
    "rpm_for_rad_s": "speed", "swapped_channels": "", "wrong_tooth_count": "teeth", "clipped_sensor": "clip",
    "uneven_stamps": "time", "oversampled": "", "empty_file": "empty",
}  # fmt: skip


@pytest.fixture(scope="module")
def sound():
    case = draw_case("null", 3, duration=0.03, snr_db=30.0)
    return replace(case, records=tuple(case.records[i] for i in (0, 3, 4, 6)))


DAMAGE = [fault for fault in FAULTS if fault != "mixed_rates"]  # records may differ in rate


@pytest.mark.parametrize("fault", DAMAGE)
def test_a_damaged_measurement_is_no_physics(fault, sound, tmp_path):
    path = write_case(replace(sound, fault=fault), tmp_path / "measured")
    before = {file: file.read_bytes() for file in path.parent.rglob("*") if file.is_file()}
    try:
        content = explain(load_measurement(path)).content
    except InputError as error:
        said = str(error)
        assert str(path.parent) in said
    else:
        assert content["verdict"] == "data_problem"
        assert content["causes"] == []
        said = " ".join([*content["sentences"], *(f["message"] for f in content["findings"])])
    assert SAYS[fault] in said.lower()
    assert {file: file.read_bytes() for file in path.parent.rglob("*") if file.is_file()} == before
