"""Lists of texts beside a matrix that name its columns, and texts beside numbers that state a rate."""

import json

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table

h5py = pytest.importorskip("h5py")
TIME = np.arange(200.0)
MATRIX = np.stack([TIME, np.cos(0.3 * TIME)], axis=1)
NAMES = ["time [ms]", "x [mm]"]


def stored(path, **content):
    if path.suffix == ".mat":
        listed = {name: np.array(one, dtype=object) if isinstance(one, list) else one for name, one in content.items()}
        savemat(path, listed)
    elif path.suffix == ".npz":
        np.savez(path, **{name: np.array(one) for name, one in content.items()})
    elif path.suffix == ".h5":
        with h5py.File(path, "w") as file:
            for name, one in content.items():
                file[name] = one
    return read_table(path)


@pytest.mark.parametrize("ending", [".mat", ".npz", ".h5"])
@pytest.mark.parametrize("called", ["names", "channel_names", "labels", "columns"])
def test_a_list_of_names_beside_a_matrix_names_its_columns(tmp_path, ending, called):
    table = stored(tmp_path / f"a{ending}", data=MATRIX, **{called: NAMES})
    found = inspect_table(table)
    assert table.names == tuple(NAMES)
    assert (found.time.unit, found.columns[1].unit) == ("ms", "mm")
    assert np.array_equal(found.columns[1].values, MATRIX[:, 1])
    assert table.index("data[1]", "column") == table.index("x", "column") == 1


@pytest.mark.parametrize("ending", [".mat", ".npz", ".h5"])
def test_a_list_of_units_beside_that_of_names_gives_the_units(tmp_path, ending):
    table = stored(tmp_path / f"a{ending}", data=MATRIX, names=["t", "x"], units=["ms", "mm"])
    assert [table.unit(k) for k in range(2)] == ["ms", "mm"]


@pytest.mark.parametrize(
    "content",
    [
        {"data": MATRIX, "names": ["a"]},
        {"data": MATRIX, "names": ["a", "a"]},
        {"data": MATRIX, "other": MATRIX, "names": NAMES},
        {"data": MATRIX, "remarks": NAMES},
        {"data": MATRIX, "names": NAMES, "labels": NAMES},
    ],
)
def test_a_list_that_names_no_matrix_or_not_all_of_one_leaves_its_columns(tmp_path, content):
    table = stored(tmp_path / "a.npz", **content)
    assert [name for name in table.names if name.startswith("data")] == ["data[0]", "data[1]"]


def test_attributes_of_a_dataset_may_name_its_columns(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["run/data"] = MATRIX
        file["run/data"].attrs["columns"] = ["t", "x"]
        file["run/data"].attrs["units"] = ["ms", "mm"]
    table = read_table(tmp_path / "a.h5")
    assert table.names == ("t", "x")
    assert [table.unit(k) for k in range(2)] == ["ms", "mm"]


@pytest.mark.parametrize("ending", [".mat", ".npz"])
@pytest.mark.parametrize("stated", [{"dt": 0.5, "dt_unit": "ms"}, {"fs": "2 kHz"}, {"fs": 2.0, "fs_unit": "kHz"}])
def test_a_text_says_the_unit_of_a_rate_beside_arrays(tmp_path, ending, stated):
    assert stored(tmp_path / f"a{ending}", x=MATRIX[:, 1], **stated).stated_rate[1] == pytest.approx(2000.0)


@pytest.mark.parametrize(
    "stated", [{"dt": 0.5, "dt_unit": "ms"}, {"sampling_rate": {"value": 2, "unit": "kHz"}}, {"fs": "2 kHz"}]
)
def test_a_text_says_the_unit_of_a_rate_in_json(tmp_path, stated):
    (tmp_path / "a.json").write_text(json.dumps({"x": list(MATRIX[:, 1]), **stated}), encoding="utf-8")
    assert read_table(tmp_path / "a.json").stated_rate[1] == pytest.approx(2000.0)
