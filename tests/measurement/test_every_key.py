"""Every key that the declarations hold changes what is loaded; a key that is parsed and dropped fails here."""

import copy
import json
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from declared_keys import another, declared_keys, holder

from gear_damping.errors import InputError
from gear_damping.measurement import layout
from gear_damping.measurement.load import check_declaration, load_measurement
from gear_damping.measurement.vocabulary import CHANNEL_MODELS
from gear_damping.schema.mappings import inner_model, kind_of, names
from gear_damping.schema.values import Value

N = 128
RATE = 1000.0
COLUMNS = ("t", "a", "b", "c", "d", "e", "f", "p", "g", "z", "wave", "tide", "ts", "pulses", "marks")
# What cannot be another value in a file that is right: said why, and what the answer must hold.
REFUSED = {
    ("gear_pair", "system"): "unknown key",
    ("oscillator", "system"): "no meaning for an oscillator|unknown key|is missing|lacks",
    ("gear_pair", "records", "channels", "pinion_speed", "datum"): "always arbitrary",
    ("gear_pair", "records", "channels", "gear_speed", "datum"): "always arbitrary",
    ("gear_pair", "records", "channels", "gear_speed", "coupling"): "whatever its coupling",
    ("oscillator", "records", "channels", "displacement", "frame"): "drifts away",
    ("oscillator", "records", "channels", "velocity", "frame"): "drifts away",
    ("gear_pair", "records", "channels", "acceleration", "mounting"): "no meaning on a casing",
    ("gear_pair", "records", "encoders", "pinion", "index"): "turns of",
    ("gear_pair", "records", "encoders", "gear", "index"): "turns of",
    **{(system, "segments", "unit"): "longer than every|to the next sample" for system in ("gear_pair", "oscillator")},
    **{
        ("gear_pair", "parameters", name, "unit"): "lies outside|must be a whole number"
        for name in ("module", "pressure_angle", "n_teeth_pinion", "n_teeth_gear", "contact_ratio")
    },
}
# Where the next value of the kind would be refused beside the others.
CHOSEN = {
    ("records", "role"): "holdout",
    ("parameters", "mesh_stiffness_max", "unit"): "kN/m",
    ("parameters", "mesh_stiffness_min", "unit"): "mN/m",
}
# Cut out of the values by the reader, which its own tests follow; here they must reach its plan.
PLANNED = {("records", "window", "from"), ("records", "window", "to"), ("records", "window", "unit"),
           ("records", "resample", "value"), ("records", "resample", "unit")}  # fmt: skip


def _table() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(4)
    time = np.arange(N) / RATE
    columns = {name: np.cumsum(rng.standard_normal(N)) for name in COLUMNS}
    turns = 40.0 * time + 0.01 * np.sin(60 * time)
    columns |= {
        "t": time, "p": 64 * turns, "g": 48 * turns / 2, "z": (np.mod(turns, 1) < 0.03) * 1.0,
        "wave": 1.9 + 2.0 * np.tanh(3 * np.sin(8 * np.pi * turns)), "ts": time * 1.001 - 1e-4,
        "pulses": np.interp(np.linspace(0, turns[-1], N), turns, time),
    }  # fmt: skip
    return columns | {"tide": columns["wave"][::-1], "marks": columns["pulses"] + 1e-4 * np.sin(99 * columns["pulses"])}


SI = {"transmission_error": "m", "pinion_torque": "N*m", "gear_torque": "N*m", "pinion_angle": "rad",
      "pinion_speed": "rad/s", "gear_speed": "rad/s", "acceleration": "m/s^2", "displacement": "m",
      "velocity": "m/s", "force": "N", "base_acceleration": "m/s^2"}  # fmt: skip


def _channel(system: str, name: str, column: str, **more: object) -> dict:
    """A channel with every key that its model has, but for those that exclude others."""
    unit = SI[name]
    full = {
        "column": column, "unit": unit, "polarity": 1, "gain": 2.0, "hold": False, "uncertainty": 0.01,
        "range": {"value": 900.0, "unit": unit}, "delay": {"value": 2e-4, "unit": "s"},
        "lowpass": {"value": 300.0, "unit": "Hz", "order": 2}, "highpass": {"value": 2.0, "unit": "Hz", "order": 1},
        "coupling": "DC", "noise": {"value": 0.01, "unit": unit},
    }  # fmt: skip
    known = names(CHANNEL_MODELS[system][name])
    full |= {"uncertainty": 0.0} if name == "force" else {}  # without a stated force_gain it has no meaning
    return {key: value for key, value in full.items() if key in known} | more


def _gear(channels: dict, **record: object) -> dict:
    torque = {name: _channel("gear_pair", name, "b") for name in ("pinion_torque", "gear_torque")}
    angle = {"pinion_angle": _channel("gear_pair", "pinion_angle", "a", polarity=1)}
    angle["pinion_angle"]["timing_error"] = {"value": 3e-6, "unit": "s"}
    base = {"name": "one", "file": "data.npz", "role": "fit", "mesh_index": False}
    timed = {"time": {"column": "t", "unit": "s"}}
    return {"system": "gear_pair", "segments": {"value": 0.065, "unit": "s"},
            "records": [base | record | {"channels": timed | torque | angle | channels}]}  # fmt: skip


def _oscillator(channels: dict, **record: object) -> dict:
    timed = {"time": {"column": "t", "unit": "s"}}
    base = {"name": "one", "file": "data.npz", "role": "fit"}
    return {"system": "oscillator", "segments": {"value": 0.065, "unit": "s"},
            "records": [base | record | {"channels": timed | channels}]}  # fmt: skip


IN_RANGE = {"stiffness": 2.0, "module": 0.01, "pressure_angle": 0.3, "contact_ratio": 1.5, "backlash_gap": 1e-3}


def _without(mapping: dict, *keys: str) -> dict:
    return {key: value for key, value in mapping.items() if key not in keys}


def _parameters(system: str, *left_out: str) -> dict:
    model = names(inner_model(names(layout.FILES[system])["parameters"]))
    found = {}
    for name, info in model.items():
        kind, unit = kind_of(info), {"own": "m/s^2/N"}.get(kind_of(info).unit, kind_of(info).unit)
        value = {"value": IN_RANGE.get(name, 20.0), "unit": unit} | ({"uncertainty": 0.05} if kind.uncertain else {})
        found[name] = value
    found |= {"mesh_stiffness_min": {"value": 9.0, "unit": "N/m", "uncertainty": 0.05}} if system == "gear_pair" else {}
    return _without(found, *left_out)


def _own_time(content: dict, base: dict) -> dict:
    """The same with a time base in every channel."""
    content = copy.deepcopy(content)
    for name, channel in content["records"][0]["channels"].items():
        if name != "time":
            channel.update(copy.deepcopy(base))
    return content


def _bases() -> list[dict]:
    gear = lambda name, column="c", **more: {name: _channel("gear_pair", name, column, **more)}  # noqa: E731
    motion = lambda name, column, **more: {name: _channel("oscillator", name, column, **more)}  # noqa: E731
    error = gear("transmission_error", range={"value": 9e3, "unit": "m"})
    tangential = gear("acceleration", mounting="tangential", shaft="pinion", radius={"value": 0.03, "unit": "m"})
    speeds = gear("pinion_speed", "d") | gear("gear_speed", "e")
    around = {"unit": "mm/s", "radius": {"value": 0.03, "unit": "m"}, "range": {"value": 9e9, "unit": "mm/s"},
              "noise": {"value": 0.5, "unit": "mm/s"}}  # fmt: skip
    vibrometers = _gear(gear("pinion_speed", "d", **around) | gear("gear_speed", "e", **around))
    all_gear = _gear(error | tangential | gear("gear_speed", "e"))
    motions = motion("displacement", "a") | motion("velocity", "b") | motion("acceleration", "c")
    all_motions = _oscillator(motions | motion("force", "d") | motion("base_acceleration", "e"))
    framed = copy.deepcopy(all_motions)
    for name, frame in (("displacement", "relative"), ("velocity", "relative"), ("acceleration", "absolute")):
        framed["records"][0]["channels"][name]["frame"] = frame
    dated = copy.deepcopy(all_motions)
    for name in ("displacement", "velocity", "acceleration"):
        dated["records"][0]["channels"][name]["datum"] = "arbitrary"
    counts = {"pinion": {"column": "p", "counts_per_revolution": 64, "direction": 1},
              "gear": {"column": "g", "counts_per_revolution": 48, "direction": 1}}  # fmt: skip
    stamped = {"pinion": {"timestamps": "pulses", "unit": "s", "counts_per_revolution": 64, "direction": 1},
               "gear": {"timestamps": "pulses", "unit": "s", "counts_per_revolution": 48, "direction": 1}}  # fmt: skip
    with_index = copy.deepcopy(counts)
    with_index["pinion"] |= {"index": "z"}
    with_index["gear"] |= {"column": "p", "counts_per_revolution": 64, "index": "z"}
    tacho = {"column": "wave", "unit": "V", "pulses_per_revolution": 4, "direction": 1,
             "threshold": {"value": 2.0, "unit": "V"}}  # fmt: skip
    tacho_at = {"timestamps": "pulses", "unit": "s", "pulses_per_revolution": 4, "direction": 1}
    load = {"pinion_torque": {"value": 150.0, "unit": "N*m", "uncertainty": 0.01}}
    condition = load | {"pinion_speed": {"value": 100.0, "unit": "rad/s", "uncertainty": 0.01},
                        "gear_torque": {"value": 300.0, "unit": "N*m", "uncertainty": 0.01}}  # fmt: skip
    rig = {"parameters": _parameters("gear_pair", "equivalent_mass")}

    def turning(encoders: dict, **more: object) -> dict:
        content = _gear(error if "gear" not in encoders else {}, encoders=encoders, conditions=load) | rig
        content["records"][0]["channels"] = _without(content["records"][0]["channels"], "pinion_angle", "pinion_torque")
        content["records"][0] |= more
        return content

    plain = _gear(error, conditions=condition)
    plain["records"][0]["channels"] = {"time": {"column": "t", "unit": "s"}} | error
    worded = copy.deepcopy(plain)
    worded["records"][0]["conditions"]["gear_torque"] = "balanced"
    rate_inside = copy.deepcopy(plain)
    rate_inside["records"][0]["channels"].pop("time")
    rate_outside = copy.deepcopy(rate_inside)
    rate_inside["records"][0]["channels"]["sampling_rate"] = {"value": 1000.0, "unit": "Hz"}
    rate_outside["records"][0]["sampling_rate"] = {"value": 1000.0, "unit": "Hz"}
    reference = _gear(gear("acceleration", mounting="casing"))
    casing = reference["records"][0]["channels"]["acceleration"]
    casing = {key: casing[key] for key in ("column", "unit", "gain", "range", "mounting")}
    reference["records"][0]["channels"]["acceleration"] = casing
    windowed = {"window": {"from": 0.01, "to": 0.1, "unit": "s"}, "resample": {"value": 400.0, "unit": "Hz"}}
    force = _oscillator(motion("displacement", "a"), conditions={"force": {"value": 3.0, "unit": "N"}})
    force["records"].append(force["records"][0] | {"name": "two", "conditions": {"force": {"value": 0, "unit": "N"}}})
    two = _gear(error)
    two["records"].append(two["records"][0] | {"name": "two"})
    gained = motions | motion("force", "d", uncertainty=0.01)
    own = {"time": {"column": "ts", "unit": "s"}}, {"sampling_rate": {"value": 999.0, "unit": "Hz"}}
    sensor = _gear(error | tangential)
    for name in ("transmission_error", "acceleration"):
        sensor["records"][0]["channels"][name]["datum"] = "arbitrary"
    angular = _gear(gear("transmission_error", unit="arcsec", shaft="pinion", range={"value": 9e3, "unit": "arcmin"},
                         noise={"value": 0.01, "unit": "urad"})) | copy.deepcopy(rig)  # fmt: skip
    angular["parameters"]["n_teeth_gear"]["value"] = 41.0
    speedy = _gear(_dated(speeds))
    oscillator_rate = _oscillator(motions | motion("force", "d"))
    oscillator_rate["records"][0]["channels"]["sampling_rate"] = {"value": 1000.0, "unit": "Hz"}
    del oscillator_rate["records"][0]["channels"]["time"]
    oscillator_outside = _oscillator(motion("displacement", "a"), sampling_rate={"value": 1000.0, "unit": "Hz"})
    del oscillator_outside["records"][0]["channels"]["time"]
    return [
        all_gear, sensor, angular, speedy, _gear(speeds), vibrometers, all_motions, framed, dated,
        *(_own_time(all_gear, base) for base in own),
        *(_own_time(_gear(speeds), base) for base in own), *(_own_time(all_motions, base) for base in own),
        plain, worded, rate_inside, rate_outside, reference, oscillator_rate, oscillator_outside,
        _gear(error, slice=[0, 100]), _oscillator(motions, slice=[0, 100]),
        _gear(error, **windowed), _oscillator(motions, **windowed),
        force, two,
        _gear(error) | {"parameters": _parameters("gear_pair", "equivalent_mass")},
        _gear(error) | {"parameters": _parameters("gear_pair", "inertia_pinion", "inertia_gear")},
        _oscillator(gained) | {"parameters": _parameters("oscillator", "damping_ratio")},
        _oscillator(gained) | {"parameters": _parameters("oscillator", "damping_coefficient")},
        turning(counts), turning(stamped), turning(with_index), turning({"tacho": tacho}), turning({"tacho": tacho_at}),
    ]  # fmt: skip


def _dated(speeds: dict) -> dict:
    return {name: speed | {"datum": "arbitrary"} for name, speed in speeds.items()}


def _told(content: dict, folder: Path, planned: bool = False) -> str:
    """Everything that a measurement (or its plan) says, as a text."""
    return _told_of(json.dumps(content), folder, planned)


@cache
def _told_of(content: str, folder: Path, planned: bool) -> str:
    path = folder / "measurement.yaml"
    with patch("gear_damping.measurement.load.read_yaml", lambda _: json.loads(content)):
        if planned:
            return repr(check_declaration(path))
        measurement = load_measurement(path)
    values = [channel.values.tobytes() for record in measurement.records for channel in record.channels.values()]
    values += [record.time.tobytes() for record in measurement.records]
    with np.printoptions(threshold=1, edgeitems=1):
        return repr(measurement) + repr([hash(part) for part in values])


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("every_key")
    table = _table()
    np.savez(place / "data.npz", **table)
    np.savez(place / "other.npz", **{name: 1.5 * column for name, column in table.items()})
    return place


BASES = _bases()


@pytest.mark.parametrize("number", range(len(BASES)))
def test_the_files_that_are_varied_are_right(number, folder):
    assert _told(BASES[number], folder)


KEYS = list(declared_keys())


@pytest.mark.parametrize(("path", "kind", "part"), KEYS, ids=[".".join(path) for path, _, _ in KEYS])
def test_another_value_of_a_key_changes_what_is_loaded_or_is_refused(path, kind, part, folder):
    bases = [base for base in BASES if base["system"] == path[0] and holder(base, path[1:])]
    assert bases, f"no file of this test holds {'.'.join(path)}: write one that does"
    outcomes = [_outcome(base, path, _another_at(base, path, kind, part), folder) for base in bases[:1]]
    for base in bases[1:]:
        if True not in outcomes:
            outcomes.append(_outcome(base, path, _another_at(base, path, kind, part), folder))
    if path in REFUSED:
        assert any(isinstance(found, str) and any(w in found for w in REFUSED[path].split("|")) for found in outcomes)
    else:
        assert True in outcomes, outcomes


def _another_at(base: dict, path: tuple[str, ...], kind: Value, part: str) -> object:
    return CHOSEN.get(path[1:]) or another(holder(base, path[1:])[path[-1]], kind, part)


def _outcome(base: dict, path: tuple[str, ...], value: object, folder: Path) -> bool | str:
    """Whether the value changes what is loaded, or why it is refused."""
    changed, planned = copy.deepcopy(base), path[1:] in PLANNED
    holder(changed, path[1:])[path[-1]] = value
    try:
        return _told(changed, folder, planned) != _told(base, folder, planned)
    except InputError as error:
        return str(error)
