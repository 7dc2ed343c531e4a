"""JSON files as loggers, web services and pandas write them: all hold the same motion."""

import json

import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.load import load_measurement

RATE = 200.0
TIME = [k / RATE for k in range(60)]
WAVE = [round(5 * (0.98**k) * (-1) ** (k // 7), 4) for k in range(60)]
ROWS = [{"t": t, "x": x} for t, x in zip(TIME, WAVE, strict=True)]
CLOCKS = [f"2026-03-01T12:00:{t:06.3f}Z" for t in TIME]
WRITTEN = {
    "columns": {"t": TIME, "x": WAVE},
    "columns of pandas": {name: {str(k): row[name] for k, row in enumerate(ROWS)} for name in ("t", "x")},
    "rows": ROWS,
    "rows below a name": {"logger": "L5", "data": ROWS},
    "pandas, apart": {"columns": ["t", "x"], "index": list(range(60)), "data": [[r["t"], r["x"]] for r in ROWS]},
    "pandas, a table": {"schema": {"fields": [{"name": "t"}, {"name": "x"}]}, "data": ROWS},
    "nested rows": [{"t": row["t"], "axle": {"x": row["x"]}} for row in ROWS],
    "channels": {"t": {"unit": "s", "values": TIME}, "x": {"units": "mm", "data": WAVE}},
    "clocks": [{"t": clock, "x": row["x"]} for clock, row in zip(CLOCKS, ROWS, strict=True)],
    "numbers as texts": [{key: str(value) for key, value in row.items()} for row in ROWS],
    "lists of two": [[row["t"], row["x"]] for row in ROWS],
}


def _table(folder, content, name: str = "run.json"):
    text = content if isinstance(content, str) else json.dumps(content)
    (folder / name).write_text(text, encoding="utf-8")
    return read_table(folder / name)


@pytest.mark.parametrize("kind", WRITTEN)
def test_every_layout_gives_the_columns(tmp_path, kind):
    table = _table(tmp_path, WRITTEN[kind])
    time, wave = (k for k, length in enumerate(table.lengths) if not table.names[k].startswith("index"))
    assert table.lengths == (60,) * len(table.lengths)
    assert table.values(time).tolist() == pytest.approx(TIME)
    assert table.values(wave).tolist() == WAVE
    assert [name.rpartition(".")[2] for name in table.names if name][-1:] in ([], ["x"])


def test_one_object_a_line_and_a_mark_of_the_byte_order(tmp_path):
    table = _table(tmp_path, "\ufeff" + "\n".join(map(json.dumps, ROWS)) + "\n", "run.jsonl")
    assert (table.names, table.values(1).tolist()) == (("t", "x"), WAVE)


def test_units_rates_and_when_clocks_began_are_the_files_own(tmp_path):
    channels = _table(tmp_path, WRITTEN["channels"])
    assert [channels.unit(k) for k in (0, 1)] == ["s", "mm"]
    clocks = _table(tmp_path, WRITTEN["clocks"])
    assert clocks.begins(0) % 86400 == 12 * 3600
    assert _table(tmp_path, {"sample_rate": 200, "x": WAVE}).stated_rate == ("sample_rate", 200.0)
    assert _table(tmp_path, {"sample_rate": 200, "x": WAVE}).names == ("x",)


def test_channels_in_a_list_of_objects_go_by_their_names_with_unit_and_rate(tmp_path):
    pos = {"name": "pos", "unit": "mm", "gain": 2, "data": WAVE}
    speed = {"name": "speed", "units": "m/s", "data": WAVE[::-1]}
    table = _table(tmp_path, {"meta": {"fs": 200, "sensor": "laser"}, "channels": [pos, speed]})
    assert table.names == ("pos", "speed")
    assert [table.unit(k) for k in (0, 1)] == ["mm", "m/s"]
    assert table.values(0).tolist() == WAVE
    assert table.stated_rate == ("fs", RATE)


def test_channels_without_names_go_by_their_numbers(tmp_path):
    table = _table(tmp_path, {"channels": [{"data": WAVE, "unit": "mm"}, {"data": TIME, "unit": "s"}]})
    assert (table.names, table.lengths, table.unit(1)) == (("channels[0]", "channels[1]"), (60, 60), "s")


@pytest.mark.parametrize("runs", [1, 2])
def test_long_lists_within_objects_of_a_list_are_columns_of_their_number(tmp_path, runs):
    one = {"type": "drop", "targets": ["friction"], "actions": [*TIME[:-1], None], "sensor_data": WAVE}
    table = _table(tmp_path, {"dataset": "real", "config": {"hz": 50, "limits": [-1, 1]}, "data": [one] * runs})
    own = [f"data[{k}].{name}" for k in range(runs) for name in ("actions", "sensor_data")]
    assert table.names == ("config.limits", *own)
    for k in range(runs):
        assert table.values(table.index(f"data[{k}].sensor_data", "column")).tolist() == WAVE
    assert table.values(1).tolist()[:-1] == TIME[:-1]


def test_short_vectors_in_rows_are_no_channels(tmp_path):
    rows = [{"t": t, "acc": [x, 0.0, 9.8]} for t, x in zip(TIME, WAVE, strict=True)]
    assert _table(tmp_path, rows).names == ("t", "acc[0]", "acc[1]", "acc[2]")


@pytest.mark.parametrize(
    ("stated", "rate"),
    [
        ({"fs": 500}, 500.0), ({"sample_rate": 500.0}, 500.0), ({"dt": 0.002}, 500.0), ({"rate_hz": 500}, 500.0),
        ({"rate": 500}, 500.0), ({"Ts": 0.002}, 500.0), ({"rate_khz": 0.5}, 500.0),
        ({"heart rate": 70}, None), ({"ts": 3}, None), ({"rates": 3}, None),
    ],
)  # fmt: skip
@pytest.mark.parametrize("others", [{}, {"unit": "mm"}, {"unit": "mm", "sensor": "laser"}])
def test_a_rate_is_seen_whatever_stands_beside_it(stated, rate, others, tmp_path):
    table = _table(tmp_path, {**others, **stated, "data": WAVE})
    assert table.stated_rate == (None if rate is None else (next(iter(stated)), rate))
    assert (table.names, table.unit(0)) == (("data",), others.get("unit"))


def test_what_is_missing_is_missing_and_texts_are_left_out(tmp_path):
    table = _table(tmp_path, [{**row, "x": None if k == 5 else row["x"], "state": "run"} for k, row in enumerate(ROWS)])
    assert [k for k, one in enumerate(table.values(1).tolist()) if one != one] == [5]
    assert table.left_out == ("state (objects)",)


def test_two_sensors_by_turns_leave_gaps_where_the_other_speaks(tmp_path):
    rows = [{"t": t, name: x} for t, x in zip(TIME, WAVE, strict=True) for name in ("a", "b")]
    table = _table(tmp_path, rows)
    assert table.names == ("t", "a", "b")
    assert sum(one == one for one in table.values(1).tolist()) == 60


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"t": [0, 1', "not a readable JSON file"),
        ("{}", "holds no array of real numbers"),
        ('{"name": "rig", "notes": ["a", "b"]}', r"holds no array of real numbers, only name \(objects\)"),
        ("[" * 100000, "not a readable JSON file"),
        ("\x00\xff", "not a readable JSON file"),
    ],
)
def test_what_is_no_table_ends_in_one_message(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        _table(tmp_path, text)


def test_a_record_is_loaded_from_it(tmp_path):
    _table(tmp_path, WRITTEN["nested rows"])
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "axle.x", "unit": "m"}}
    declared = {"system": "oscillator", "records": [{"file": "run.json", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    record = load_measurement(tmp_path / "measurement.yaml").records[0]
    assert record.sampling_rate == pytest.approx(RATE)
    assert record.channels["displacement"].values.tolist() == WAVE
