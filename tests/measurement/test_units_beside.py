"""Texts beside arrays that say their unit: structures of dSPACE and Simcenter, `x_unit` beside `x`."""

import json

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.load import load_measurement
from tests.measurement.stored import TIME, WAVE


def structure(**fields):
    one = np.zeros((1, 1), dtype=[(name, "O") for name in fields])
    one[0, 0] = tuple(fields.values())
    return one


def dspace(path):
    """A recording of ControlDesk: the abscissa, and a structure for each channel."""
    channels = np.zeros((1, 2), dtype=[(name, "O") for name in ("Name", "Type", "Data", "Unit", "XIndex")])
    channels[0, 0] = ("pos", 1.0, WAVE, "mm", 1.0)
    channels[0, 1] = ("note", 1.0, 2 * WAVE, "as it is", 1.0)
    time = structure(Name="time", Type=1.0, Data=TIME, Unit="s")
    savemat(path, {"rec1": structure(X=time, Y=channels, Description="run")})


def units_of(table):
    return {name: table.unit(k) for k, name in enumerate(table.names) if table.lengths[k] == WAVE.size}


def test_a_field_beside_the_data_of_a_structure_is_its_unit(tmp_path):
    dspace(tmp_path / "run.mat")
    table = read_table(tmp_path / "run.mat")
    assert units_of(table) == {"rec1.X.Data": "s", "pos": "mm", "note": None}
    assert table.unit(table.index("rec1.Y.Data[0]", "")) == "mm"


def test_it_contradicts_another_unit(tmp_path):
    dspace(tmp_path / "run.mat")
    (tmp_path / "a.yaml").write_text(
        "system: oscillator\nrecords:\n- file: run.mat\n  channels:\n    time: {column: rec1.X.Data}\n"
        "    displacement: {column: pos, unit: m}\n"
    )
    found = load_measurement(tmp_path / "a.yaml")
    assert found.records[0].sampling_rate == pytest.approx(1000.0)
    assert "the header of column 'pos' says 'mm' and the YAML 'm'" in next(
        one.message for one in found.findings if one.kind == "unit_conflict"
    )


def test_of_several_vectors_beside_one_unit_none_is_told(tmp_path):
    savemat(tmp_path / "run.mat", {"run": structure(x=WAVE, y=2 * WAVE, Unit="mm")})
    assert units_of(read_table(tmp_path / "run.mat")) == {"run.x": None, "run.y": None}


def test_the_label_of_a_quantity_of_simcenter_is_the_unit_of_its_values(tmp_path):
    quantity = structure(label="m/s^2", quantity_terms=1.0)
    savemat(tmp_path / "run.mat", {"Signal_0": structure(y_values=structure(values=WAVE, quantity=quantity))})
    assert units_of(read_table(tmp_path / "run.mat")) == {"Signal_0.y_values.values": "m/s^2"}


@pytest.mark.parametrize("ending", ["mat", "npz", "json"])
def test_a_text_of_the_same_name_and_unit_is_its_unit(tmp_path, ending):
    content = {"x": WAVE, "x_unit": "um", "v": WAVE, "v_units": "of its own", "w": WAVE, "z_unit": "mm"}
    path = tmp_path / f"run.{ending}"
    if ending == "json":
        path.write_text(
            json.dumps({name: one if isinstance(one, str) else one.tolist() for name, one in content.items()})
        )
    else:
        (savemat(path, content) if ending == "mat" else np.savez(path, **content))
    assert units_of(read_table(path)) == {"x": "um", "v": None, "w": None}
