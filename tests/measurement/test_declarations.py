"""What keys must be together, why a key is refused, and that a YAML alone is enough to be told."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.channels import AnyChannel, Response
from gear_damping.measurement.load import check_declaration, load_measurement
from gear_damping.measurement.record import Quantity
from gear_damping.measurement.vocabulary import CHANNEL_MODELS
from gear_damping.schema.mappings import names

TIME = "sampling_rate: {value: 1, unit: kHz}"
MOTION = "displacement: {column: x, unit: m}"
DRIVEN = f"{TIME}, {MOTION}, force: {{column: F, unit: N}}"
ERROR = f"{TIME}, transmission_error: {{column: x, unit: um}}"
LOAD = "pinion_torque: {value: 150, unit: N*m}"
SPEED = "pinion_speed: {value: 1800, unit: rpm}"
SET = f"conditions: {{{LOAD}, {SPEED}}}"


def _problems(folder: Path, text: str) -> list[str]:
    path = folder / "measurement.yaml"
    path.write_text(text)
    try:
        check_declaration(path)
    except InputError as error:
        return [str(problem) for problem in error.problems]
    return []


def _gear(channels: str, more: str = SET, top: str = "") -> str:
    return f"system: gear_pair\n{top}\nrecords:\n  - {{file: a.csv, channels: {{{channels}}}, {more}}}\n"


def _oscillator(*channels: str, top: str = "", more: str = "") -> str:
    listed = "".join(f"  - {{file: a.csv, channels: {{{one}}}{more}}}\n" for one in channels)
    return f"system: oscillator\n{top}\nrecords:\n{listed}"


SHAFT = "acceleration: {column: x, unit: m/s^2, mounting: tangential, shaft: gear, radius: {value: 3, unit: cm}}"
CASING = "acceleration: {column: c, unit: m/s^2, mounting: casing}"
BASE = "base_acceleration: {column: b, unit: m/s^2}"


@pytest.mark.parametrize(
    "text",
    [
        _gear(ERROR),
        _gear(f"{TIME}, {SHAFT}"),
        _gear(f"{TIME}, gear_speed: {{column: x, unit: rpm, highpass: {{value: 2, unit: Hz}}}}"),
        _gear(f"{TIME}, pinion_speed: {{column: x, unit: rpm}}", f"conditions: {{{LOAD}}}"),
        _gear(f"{TIME}, pinion_speed: {{column: x, unit: rpm, coupling: AC}}"),
        _gear(f"{TIME}, acceleration: {{column: x, unit: gn}}", "role: holdout, encoders: {tacho: {column: t, "
              "pulses_per_revolution: 1}}"),
        _gear(f"{TIME}, acceleration: {{column: x, unit: gn}}", "encoders: {tacho: {column: t, unit: mV, "
              "threshold: {value: 2, unit: V}, pulses_per_revolution: 1}}, mesh_index: true"),
        _gear(f"{TIME}, acceleration: {{column: x, unit: gn}}", "encoders: {tacho: {column: t, unit: V, "
              "pulses_per_revolution: 1}}"),  # said of a column, and needed for none of its pulses
        _gear(f"{TIME}", "encoders: {pinion: {column: p, unit: counts, counts_per_revolution: 9}, gear: {column: g, "
              f"unit: '1', counts_per_revolution: 9}}}}, {SET}"),
        _oscillator(DRIVEN, top="parameters: {force_gain: {value: 2}, damping_ratio: {value: 2, unit: '%'}}"),
        _oscillator(f"{TIME}, {BASE}, acceleration: {{column: x, unit: gn, frame: relative}}"),
        _oscillator(DRIVEN, f"{TIME}, {MOTION}, force: {{column: F, unit: mN}}"),
        _gear(ERROR.replace("{value: 1, unit: kHz}", "1 kHz"), "conditions: {pinion_torque: 9 Nm, pinion_speed: 9rpm}"),
    ],
)  # fmt: skip
def test_what_holds_together_is_accepted(tmp_path, text):
    assert _problems(tmp_path, text) == []


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        (_gear(TIME), "records[0].channels", "lacks a transmission_error"),
        (_gear(ERROR, f"conditions: {{{LOAD}}}"), "records[0].channels", "lacks pinion_speed"),
        (_gear(ERROR, f"conditions: {{{SPEED}}}"), "records[0].channels", "lacks pinion_torque"),
        (_gear(f"{TIME}, gear_speed: {{column: x, unit: rpm}}", f"conditions: {{{SPEED}}}"),
         "records[0].channels", "lacks pinion_torque"),
        (_gear(f"{TIME}, {SHAFT}", top="parameters: {equivalent_mass: {value: 1, unit: kg}}"),
         "parameters.equivalent_mass", "does not say how one shaft moves"),
        (_gear(ERROR, top="parameters: {equivalent_mass: {value: 1, unit: kg}, inertia_gear: {value: 1, unit: kg*m^2}, "
               "inertia_pinion: {value: 1, unit: kg*m^2}}"), "parameters.equivalent_mass", "inertias"),
        (_gear(f"{ERROR}, pinion_speed: {{column: n, unit: rpm, noise: {{value: 1, unit: rpm}}}}"),
         "pinion_speed.noise", "gives the angle and is no response"),
        (_gear(f"{TIME}, pinion_speed: {{column: x, unit: rpm, coupling: AC}}", f"conditions: {{{LOAD}}}"),
         "pinion_speed.coupling", "has lost it"),
        (_gear(ERROR, f"{SET}, role: reference"), "records[0].role", "no casing's acceleration"),
        (_gear(ERROR) + f"  - {{file: b.csv, channels: {{{ERROR}, {CASING}}}, {SET}, role: reference}}\n",
         "records[1].role", "a reference only with other casings"),
        (_gear(f"{ERROR}, gear_torque: held", f"conditions: {{gear_torque: {{value: 9, unit: N*m}}, {LOAD}, {SPEED}}}"),
         "conditions.gear_torque", "one of the two is a word"),
        (_gear(ERROR, f"{SET}, encoders: {{tacho: {{column: t, pulses_per_revolution: 1}}, pinion: {{column: p, "
               "counts_per_revolution: 9}}"), "encoders.tacho", "same shaft"),
        (_gear(ERROR, f"{SET}, slice: [0, 9], window: {{from: 0, to: 1, unit: s}}"), "window", "both given"),
        (_gear(f"{TIME}, acceleration: {{column: x, unit: gn, noise: {{value: 1, unit: gn}}}}"),
         "acceleration.noise", "the path from the mesh to a casing is unknown"),
        (_gear(f"{ERROR}, pinion_angle: {{column: a, unit: rad, datum: absolute}}"),
         "pinion_angle.datum", "mesh_index"),
        (_gear(f"{TIME}, transmission_error: {{column: x, unit: um, coupling: AC, datum: absolute}}"),
         "transmission_error.datum", "lost its mean"),
        (_gear(f"{TIME}, acceleration: {{column: x, unit: gn}}", "encoders: {tacho: {column: t, unit: mVV, "
               "pulses_per_revolution: 1}}"), "encoders.tacho.unit", "unknown unit"),
        (_gear(f"{TIME}, acceleration: {{column: x, unit: gn}}", "encoders: {pinion: {column: t, unit: deg, "
               "counts_per_revolution: 9}}"), "encoders.pinion.unit", "counts have no unit"),
        (_gear(ERROR, f"{SET}, mesh_index: true"), "records[0].mesh_index", "no zero that could be that of the mesh"),
        (_gear(f"{ERROR}, pinion_speed: {{column: n, unit: rpm}}", f"conditions: {{{LOAD}}}, mesh_index: true"),
         "records[0].mesh_index", "declare pinion_angle"),
        (_gear(f"{ERROR}, pinion_speed: {{column: n, unit: rpm, uncertainty: .1}}", f"conditions: {{{LOAD}}}"),
         "pinion_speed.uncertainty", "instead of this channel"),
        (_oscillator(f"{TIME}, {MOTION}, force: {{column: F, unit: N, noise: 1 N}}"), "force.noise", "leave it out"),
        (_oscillator(f"{TIME}, velocity: {{column: x, unit: m/s}}, {BASE[:-1]}, noise: 1 gn}}"),
         "base_acceleration.noise", "leave it out"),
        (_gear(f"{ERROR}, gear_torque: {{column: T, unit: Nm, noise: 1 Nm}}", SET),
         "gear_torque.noise", "leave it out"),
        (_oscillator(f"{TIME}, force: {{column: F, unit: N}}"), "records[0].channels", "lacks a displacement"),
        (_oscillator(DRIVEN, f"{TIME}, {MOTION}"), "records[1].channels", "lacks the force that records[0] has"),
        (_oscillator(f"{TIME}, {MOTION}", top="parameters: {force_gain: {value: 2}}"),
         "force_gain", "no record has a force"),
        (_oscillator(DRIVEN, top="parameters: {damping_ratio: 0.1, damping_coefficient: {value: 1, unit: 1/s}}"),
         "damping_ratio", "gives the damping too"),
        (_oscillator(DRIVEN, top="parameters: {damping_ratio: 0.1, stiffness: {value: 0, unit: 1/s^2}}"),
         "damping_ratio", "without a spring"),
        (_oscillator(DRIVEN, top="parameters: {stiffness: {value: 0, unit: 1/s^2, uncertainty: 0.1}}"),
         "stiffness.uncertainty", "nothing to relate it to"),
        (_oscillator(f"{TIME}, velocity: {{column: x, unit: m/s, frame: relative}}"),
         "velocity.frame", "base_acceleration"),
        (_oscillator(f"{TIME}, {BASE}, velocity: {{column: x, unit: m/s, frame: absolute}}"),
         "velocity.frame", "drifts away"),
        (_oscillator(f"{TIME}, {MOTION}, force: {{column: F, unit: N, lowpass: {{value: 9, unit: Hz}}}}"),
         "force.lowpass", "an input is what drives"),
        (_oscillator(f"{TIME}, {BASE}, velocity: {{column: x, unit: V}}"), "base_acceleration.unit", "kind of 'V/s'"),
        (_oscillator(f"{TIME}, {MOTION}", more=", mesh_index: true"), "mesh_index", "only a gear_pair meshes"),
        (_oscillator(f"{TIME}, {MOTION}", top="segments: {value: 0, unit: s}"), "segments", "must be positive"),
        (_oscillator(f"{TIME}, {MOTION}", top="segments: {value: 1, unit: s, uncertainty: 0.1}"),
         "segments.uncertainty", "only parameters, conditions of a gear_pair and the gain"),
    ],
)  # fmt: skip
def test_what_has_no_meaning_is_refused_with_the_reason(tmp_path, text, key, said):
    (problem,) = _problems(tmp_path, text)
    assert key in problem.split(":")[0]
    assert said in problem


def test_every_sensor_key_acts_or_has_a_reason():
    every = set(names(Response))
    for models in CHANNEL_MODELS.values():
        for name, model in models.items():
            assert issubclass(model, AnyChannel)
            assert not set(names(model)) & set(model.refused), name
            assert every <= set(names(model)) | set(model.refused), name


def test_shared_anchors_are_told_once_for_each_record_and_nothing_follows(tmp_path):
    text = f"system: oscillator\nrecords:\n  - {{file: a, channels: &c {{{TIME}, "
    text += "velocity: {column: v, unit: m/s, polarty: 1}}}\n  - {file: b, channels: *c}\n  - 3\n"
    problems = _problems(tmp_path, text)
    assert [problem.split(":")[0] for problem in problems] == [
        "records[0].channels.velocity.polarty", "records[1].channels.velocity.polarty", "records[2] = 3",
    ]  # fmt: skip


@pytest.mark.parametrize("system", ["oscillator", "gear_pair"])
def test_several_sensors_of_a_kind_are_told_once_with_what_to_do_with_the_others(system, tmp_path):
    sensors = "[{column: a1, unit: m/s^2}, {column: a2, unit: m/s^2}]"
    text = f"system: {system}\nrecords:\n  - {{file: a, channels: &c {{{TIME}, acceleration: {sensors}}}}}\n"
    text += "  - {file: b, channels: *c}\n  - {file: c, channels: *c, rolle: fit}\n"
    several, other = sorted(_problems(tmp_path, text))
    assert several.startswith("records[0].channels.acceleration = [")
    assert ": lists several sensors, and a record takes one acceleration; " in several
    assert "remedy: keep one, without the list; declare each of the others in a measurement.yaml of its own" in several
    assert other.startswith("records[2].rolle: unknown key")
    lone = text.replace(sensors, "[a1]")
    assert sum("must be a mapping with keys among" in one for one in _problems(tmp_path, lone)) == 3


def test_a_window_as_a_list_of_two_times_is_told_as_it_is_written(tmp_path):
    text = "system: oscillator\nrecords:\n  - {file: a, window: [0.1, 0.9], channels: {TIME, velocity: {column: v}}}\n"
    (said,) = _problems(tmp_path, text.replace("TIME", TIME))
    assert "remedy: write window: {from: 0.1, to: 0.9, unit: s}, or slice: [a, b] with the numbers of rows" in said


def test_a_yaml_that_holds_itself_is_one_problem(tmp_path):
    assert len(_problems(tmp_path, "system: oscillator\nrecords:\n  - &a [*a]\n")) == 1


CHECK = """
import sys
from gear_damping.measurement.load import check_declaration
try:
    check_declaration(sys.argv[1])
except ValueError as error:
    print(error)
print(sorted({"torch", "scipy", "pandas"} & {*sys.modules}))
"""


def test_a_mistake_is_told_before_anything_heavy_is_imported(tmp_path):
    (tmp_path / "m.yaml").write_text(_oscillator(f"{TIME}, dispacement: {{column: x, unit: m}}"))
    command = [sys.executable, "-c", CHECK, str(tmp_path / "m.yaml")]
    root = Path(__file__).resolve().parents[2]
    said = subprocess.run(command, capture_output=True, text=True, cwd=root, check=True).stdout
    assert "did you mean 'displacement'?" in said
    assert said.endswith("[]\n")


def test_a_hundred_records_are_checked_within_a_second(tmp_path):
    text = _oscillator(*[DRIVEN] * 100)
    _problems(tmp_path, _oscillator(DRIVEN))
    start = time.process_time()
    assert _problems(tmp_path, text) == []
    assert time.process_time() - start < 1.0


def _load(folder: Path, content: dict):
    path = folder / "m.yaml"
    path.write_text(yaml.safe_dump(content))
    return load_measurement(path)


def test_absent_keys_are_resolved(tmp_path):
    values = np.random.default_rng(0).standard_normal((50, 3))
    np.savetxt(tmp_path / "a.csv", values, delimiter=",", header="x,v,b", comments="")
    channels = {"sampling_rate": {"value": 100, "unit": "Hz"}, "displacement": {"column": "x", "unit": "mm"},
                "velocity": {"column": "v", "unit": "mm/s"}, "acceleration": {"column": "b", "unit": "mm/s^2"},
                "base_acceleration": {"column": "b", "unit": "m/s^2", "gain": -2.0}}  # fmt: skip
    content = {"system": "oscillator", "segments": {"value": 200, "unit": "ms"}}
    measurement = _load(tmp_path, content | {"records": [{"file": "a.csv", "channels": channels}]})
    found = measurement.records[0].channels
    assert measurement.segment_s == pytest.approx(0.2)
    assert {name: (c.datum, c.frame) for name, c in found.items()} == {
        "displacement": ("arbitrary", "relative"), "velocity": ("absolute", "relative"),
        "acceleration": ("arbitrary", "absolute"), "base_acceleration": ("absolute", None),
    }  # fmt: skip
    assert found["base_acceleration"].unit == "mm/s^2"
    np.testing.assert_allclose(found["base_acceleration"].values, -500 * values[:, 2], rtol=1e-12)
    channels["velocity"]["coupling"] = "AC"
    again = _load(tmp_path, content | {"records": [{"file": "a.csv", "channels": channels}]})
    assert again.records[0].channels["velocity"].datum == "arbitrary"


def test_an_ac_coupled_speed_gets_the_mean_that_is_stated(bench):
    bench.channels["pinion_speed"] = {"column": "dte", "unit": "rad/s", "coupling": "AC"}
    for name in ("pinion_angle", "transmission_error"):
        del bench.channels[name]
    bench.record["conditions"] = {"pinion_speed": {"value": 188.0, "unit": "rad/s", "uncertainty": 0.005}}
    record = bench.load().records[0]
    dte = bench.columns["dte"]
    np.testing.assert_allclose(record.channels["pinion_speed"].values, dte - dte.mean() + 188.0, rtol=1e-12)
    assert record.conditions["pinion_speed"] == Quantity(188.0, "rad/s", 0.005)


def test_rates_that_differ_by_rounding_are_one(bench):
    del bench.channels["time"]
    bench.channels["sampling_rate"] = {"value": 20000.0, "unit": "Hz"}
    for rate in (20000.0000000000036, 20001.0, 20001.00001, 30000.0):
        bench.add_record()["channels"]["sampling_rate"] = {"value": rate, "unit": "Hz"}
    assert [r.sampling_rate for r in bench.load().records] == [20000.0, 20000.0, 20001.0, 20001.0, 30000.0]


def test_index_pulses_that_are_no_turn_apart_are_refused(bench):
    turns = bench.columns["theta1"] / (2 * np.pi) * 10
    bench.columns |= {"count": turns * 64, "z": (np.mod(turns, 1) < 0.1) * 1.0}
    del bench.channels["pinion_angle"]
    encoder = {"column": "count", "counts_per_revolution": 64, "index": "z"}
    bench.record["encoders"] = {"pinion": encoder}
    assert bench.load().records[0].channels["pinion_angle"].datum == "arbitrary"
    encoder["counts_per_revolution"] = 128
    assert "turns of 128 counts apart" in bench.only_problem()
