"""Another value of every key of measurement.yaml changes the answer of task=explain, or is refused with a reason.

A key that is read, checked and then used nowhere fails here. The nominal model alone is fitted, for few iterations and
from few starts: every figure of the answer counts, so that whatever a key does is seen.
"""

import copy
import json
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from declared_keys import another, declared_keys, holder

from gear_damping.errors import InputError
from gear_damping.explanation.explain import explain
from gear_damping.explanation.state import State
from gear_damping.identification.output_error.descent import Descent
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.vocabulary import CHANNEL_MODELS
from gear_damping.schema.mappings import names
from gear_damping.schema.values import Value

ITERATIONS = 1
SAME = 1e-6  # relative difference of figures that are one
RATE, SPEED, TEETH = 40000.0, 1200.0, 20  # Hz, rad/s
ROWS, HEARD_ROWS = 400, 2400
FREQUENCY = 2 * np.pi * 3000.0  # of the oscillator, rad/s
# Values by the last keys, where the next one of the kind would not be seen.
VALUES = {
    ("range", "value"): [1e-9],
    ("threshold", "value"): [0.3],
    ("records", "role"): ["holdout"],
    ("mesh_stiffness_max", "unit"): ["N/um"],
    ("mesh_stiffness_min", "unit"): ["N/um"],
    ("pressure_angle", "unit"): ["rad"],
    ("stiffness", "uncertainty"): [1e-3],
    ("channels", "time", "unit"): ["ms"],  # in minutes a mesh would turn hundreds of times from sample to sample
}
REFUSED = {
    ("gear_pair", "system"): "unknown key",
    ("oscillator", "system"): "no meaning for an oscillator|unknown key|is missing|lacks",
    ("gear_pair", "records", "channels", "pinion_speed", "datum"): "always arbitrary",
    ("gear_pair", "records", "channels", "gear_speed", "datum"): "always arbitrary",
    ("oscillator", "records", "channels", "displacement", "frame"): "drifts away",
    ("oscillator", "records", "channels", "velocity", "frame"): "drifts away",
    ("gear_pair", "records", "channels", "acceleration", "mounting"): "no meaning on a casing",
    ("gear_pair", "records", "channels", "acceleration", "coupling"): "has lost its mean",
    ("gear_pair", "records", "channels", "gear_speed", "coupling"): "whatever its coupling",
    ("oscillator", "records", "channels", "displacement", "coupling"): "has lost its mean",
    ("oscillator", "records", "channels", "acceleration", "coupling"): "has lost its mean",
    ("gear_pair", "records", "encoders", "pinion", "index"): "turns of|holds no pulse",
    ("gear_pair", "records", "encoders", "gear", "index"): "turns of|holds no pulse",
    ("oscillator", "parameters", "stiffness", "unit"): "show nothing beyond",
    **{
        ("gear_pair", "parameters", name, "unit"): "lies outside|must be a whole number|finite"
        for name in (
            "n_teeth_pinion",
            "n_teeth_gear",
            "module",
            "pressure_angle",
            "inertia_pinion",
            "inertia_gear",
            "mesh_stiffness_max",
            "mesh_stiffness_min",
            "contact_ratio",
        )
    },
    **{(system, "records", "window", "unit"): "the record goes from" for system in ("gear_pair", "oscillator")},
    **{(system, "segments", "unit"): "longer than every record" for system in ("gear_pair", "oscillator")},
    ("oscillator", "records", "role"): "is held out, and all rows of it are fitted",
    **{(system, "records", "resample", "unit"): "samples; a record needs" for system in ("gear_pair", "oscillator")},
}
SI = {"transmission_error": "m", "pinion_torque": "N*m", "gear_torque": "N*m", "pinion_angle": "rad",
      "pinion_speed": "rad/s", "gear_speed": "rad/s", "acceleration": "m/s^2", "displacement": "m",
      "velocity": "m/s", "force": "N", "base_acceleration": "m/s^2"}  # fmt: skip
COLUMN = {"transmission_error": "x", "pinion_torque": "T", "gear_torque": "T2", "pinion_angle": "angle",
          "pinion_speed": "w1", "gear_speed": "w2", "displacement": "y", "velocity": "v", "force": "F",
          "base_acceleration": "base"}  # fmt: skip
UNITS = {"mm": "mm", "deg": "deg"}
NOISE = {"transmission_error": 2e-8, "acceleration": 20.0, "displacement": 1e-5}
FULL_SCALE = {"transmission_error": 1e-3, "pinion_torque": 1e3, "gear_torque": 1e3, "pinion_speed": 1e4,
              "gear_speed": 1e4, "displacement": 0.1, "velocity": 1e3, "force": 100.0,
              "base_acceleration": 1e6}  # fmt: skip


def table(rows: int) -> dict[str, np.ndarray]:
    """Columns of a turning gear pair and of a driven oscillator, near what a simulation gives."""
    rng = np.random.default_rng(7)
    t = np.arange(rows) / RATE
    angle = SPEED * t + 1e-3 * np.sin(160 * np.pi * t)
    turns, mesh, speed = angle / (2 * np.pi), TEETH * angle + 0.4, np.gradient(angle, t)
    noise = rng.standard_normal((8, rows))
    x = 9e-6 + 2e-6 * np.cos(mesh) + 8e-7 * np.cos(2 * mesh + 1) + 2e-8 * noise[0]
    radius = 0.0015 * np.cos(np.pi / 9) * TEETH
    back = (radius * angle - x) / (2 * radius)
    waves = [(1.0, 0.4, 0.3), (0.6, 0.9, 1.0), (0.8, 1.1, 2.0), (0.5, 1.6, 4.0)]  # force, over omega_n, phase
    w = FREQUENCY * np.array([wave[1] for wave in waves])[:, None]
    force = np.array([a * np.exp(1j * (w[i] * t + p)) for i, (a, _, p) in enumerate(waves)])
    motion = force / (FREQUENCY**2 - w**2 + 0.06j * FREQUENCY * w)
    size = 1e3 * float(np.real(motion.sum(0)).std())
    rates = [np.real((1j * w) ** n * motion).sum(0) / size for n in range(3)]
    y, v, acceleration = (rate + 1e-5 * FREQUENCY**n * noise[n] for n, rate in enumerate(rates))
    column = {
        "t": t, "ts": 1.001 * t, "x": x, "f": x[::-1].copy(), "T": 150 + 3 * np.sin(300 * t),
        "T2": 300 + 6 * np.sin(300 * t + 0.1), "angle": angle, "w1": speed + 0.3 * np.sin(mesh) + 0.05 * noise[3],
        "w2": speed / 2 + 0.2 * np.sin(mesh) + 0.05 * noise[4], "a": 900 * np.cos(mesh) + 20 * noise[5],
        "p": 4096 * turns, "g": 4096 * back / (2 * np.pi), "z": (np.mod(turns - 0.2, 1) < 0.03) * 1.0,
        "z2": (np.mod(back / (2 * np.pi) - 0.3, 1) < 0.03) * 1.0, "y": y, "v": v, "acc": acceleration,
        "wave": 1.9 + 2.0 * np.tanh(3 * np.sin(32 * np.pi * turns)),
        "let_go": 1e-3 * np.exp(-0.03 * FREQUENCY * t) * np.cos(FREQUENCY * t) + 1e-5 * noise[6],
        "F": np.real(force.sum(0)) + 0.2, "base": -np.real(force.sum(0)) / size,
    }  # fmt: skip
    pulses = np.interp(np.linspace(0, turns[-1], rows), turns, t)
    back_pulses = np.interp(np.linspace(0, back[-1] - back[0], rows), np.maximum.accumulate(back - back[0]), t)
    more = {"tide": np.roll(column["wave"], 9), "pulses": pulses, "back_pulses": back_pulses}
    return column | more | {"marks": pulses + 1e-6 * np.sin(0.1 * np.arange(rows)) ** 2}


def channel(system: str, name: str, **more: object) -> dict:
    """A channel with every key that its model has, but for those that exclude others."""
    unit = SI[name]
    column = "acc" if system == "oscillator" and name == "acceleration" else COLUMN.get(name, "a")
    full = {
        "column": column, "unit": unit, "polarity": 1, "gain": 1.05, "hold": False, "uncertainty": 0.01,
        "range": {"value": 1e7 if column == "acc" else FULL_SCALE.get(name, 1e4), "unit": unit},
        "timing_error": {"value": 1e-7, "unit": "s"},
        "delay": {"value": 1e-5, "unit": "s"}, "lowpass": {"value": 15e3, "unit": "Hz", "order": 2},
        "highpass": {"value": 20.0, "unit": "Hz", "order": 1}, "coupling": "DC",
        "noise": {"value": NOISE.get(name, 0.05), "unit": unit},
    }  # fmt: skip
    known = names(CHANNEL_MODELS[system][name])
    return {key: value for key, value in full.items() if key in known} | more


def record(channels: dict, timed: bool = True, **more: object) -> dict:
    """A record of the file of every test."""
    base = {"name": "one", "file": "data.npz", "role": "fit"}
    return base | {"channels": ({"time": {"column": "t", "unit": "s"}} if timed else {}) | channels} | more


def gear(*records: dict, **more: object) -> dict:
    return {"system": "gear_pair", "records": [*records]} | more


def oscillator(*records: dict, **more: object) -> dict:
    return {"system": "oscillator", "records": [*records]} | more


def only(system: str, *chosen: str, **more: object) -> dict:
    """Channels with all of their keys."""
    return {name: channel(system, name, **more) for name in chosen}


def plain(system: str, *chosen: str) -> dict:
    """Channels with what they must have."""
    return {name: {"column": COLUMN.get(name, "a"), "unit": SI[name]} for name in chosen}


def stated(system: str, *left_out: str) -> dict:
    """Every parameter of the rig with its uncertainty, near its default."""
    gears = {"n_teeth_pinion": (20, "1"), "n_teeth_gear": (40, "1"), "module": (3, "mm"), "pressure_angle": (20, "deg"),
             "inertia_pinion": (2.6e-4, "kg*m^2"), "inertia_gear": (4.5e-3, "kg*m^2"),
             "mesh_stiffness_max": (4.1e8, "N/m"), "mesh_stiffness_min": (2.2e8, "N/m"), "contact_ratio": (1.5, "1"),
             "damping_ratio": (0.04, "1"), "equivalent_mass": (0.23, "kg"), "backlash_gap": (4e-5, "m"),
             "torque_gain": (1.02, "1"), "torque_offset": (0.5, "N*m")}  # fmt: skip
    motion = {"stiffness": (FREQUENCY**2, "1/s^2"), "damping_coefficient": (1e3, "1/s"), "damping_ratio": (0.03, "1"),
              "force_gain": (1e5, "m/s^2/N")}  # fmt: skip
    known = gears if system == "gear_pair" else motion
    found = {name: {"value": value, "unit": UNITS.get(unit, unit)} for name, (value, unit) in known.items()}
    for name in found.keys() - {"n_teeth_pinion", "n_teeth_gear"}:
        found[name]["uncertainty"] = 0.02
    return {name: value for name, value in found.items() if name not in left_out}


def bases() -> list[dict]:
    """Files that hold every key between them."""
    one, two = "gear_pair", "oscillator"
    error, response = plain(one, "transmission_error"), plain(two, "displacement", "force")
    balanced = plain(one, "pinion_torque") | {"gear_torque": "balanced"}
    turning = plain(one, "pinion_angle") | balanced
    tangential = only(one, "acceleration", mounting="tangential", shaft="pinion", radius={"value": 0.03, "unit": "m"})
    load = {"pinion_torque": {"value": 150.0, "unit": "N*m", "uncertainty": 0.01}}
    still = load | {"pinion_speed": {"value": 1200.0, "unit": "rad/s", "uncertainty": 0.001},
                    "gear_torque": {"value": 300.0, "unit": "N*m", "uncertainty": 0.01}}  # fmt: skip
    speed = {"pinion_speed": {"value": 1200.0, "unit": "rad/s"}}
    around = {"unit": "mm/s", "radius": {"value": 30.0, "unit": "mm"}, "range": {"value": 1e9, "unit": "mm/s"},
              "noise": {"value": 2.0, "unit": "mm/s"}}  # fmt: skip
    rate = {"sampling_rate": {"value": RATE, "unit": "Hz"}}
    cut = {"window": {"from": 1e-3, "to": 9e-3, "unit": "s"}, "resample": {"value": 3e4, "unit": "Hz"}}
    segments = {"segments": {"value": 2e-3, "unit": "s"}}
    every, torque_channels = plain(one, "pinion_angle", "gear_speed"), plain(one, "pinion_torque", "gear_torque")
    inertias = {"parameters": stated(one, "equivalent_mass")}
    counts = {"pinion": {"column": "p", "counts_per_revolution": 4096, "direction": 1},
              "gear": {"column": "g", "counts_per_revolution": 4096, "direction": 1}}  # fmt: skip
    turns = SPEED * (ROWS - 1) / RATE / (2 * np.pi)
    stamped = {"timestamps": "pulses", "unit": "s", "counts_per_revolution": (ROWS - 1) / turns, "direction": 1}
    stamps = {"pinion": stamped, "gear": stamped | {"timestamps": "back_pulses",
                                                   "counts_per_revolution": 2 * (ROWS - 1) / turns}}  # fmt: skip
    indexed = {"pinion": counts["pinion"] | {"index": "z"}, "gear": counts["gear"] | {"index": "z2"}}
    tacho = {"column": "wave", "unit": "V", "pulses_per_revolution": 16, "direction": 1,
             "threshold": {"value": 2.0, "unit": "V"}}  # fmt: skip
    pulses = {"timestamps": "pulses", "unit": "s", "pulses_per_revolution": (ROWS - 1) / turns, "direction": 1}
    heard = {"acceleration": {"column": "a", "unit": "m/s^2", "gain": 1.05, "mounting": "casing",
                              "range": {"value": 1e9, "unit": "m/s^2"}}}  # fmt: skip
    heard |= {"pinion_angle": channel(one, "pinion_angle")}
    later = {"name": "two"}
    torques = only(one, "pinion_torque", "gear_torque", "pinion_angle")
    motions, inputs = only(two, "displacement", "velocity"), only(two, "base_acceleration")
    inputs |= {"force": {key: value for key, value in channel(two, "force").items() if key != "uncertainty"}}
    based = only(two, "acceleration") | plain(two, "base_acceleration")
    own = [{"time": {"column": "ts", "unit": "s"}}, {"sampling_rate": {"value": 0.999 * RATE, "unit": "Hz"}}]

    def apart(channels: dict, base: dict) -> dict:
        return {name: value | copy.deepcopy(base) for name, value in channels.items()}

    def encoded(encoders: dict, **more: object) -> dict:
        channels = {} if "gear" in encoders else error
        return gear(record(channels, encoders=encoders, conditions=load, **more), **inertias)

    def several(system: str, channels: dict, **more: object) -> list[dict]:
        """The same record twice."""
        return [record(channels, **more), record(channels, **(more | later))]

    arbitrary = {"datum": "arbitrary"}
    angular = {"column": "x", "unit": "arcsec", "gain": 0.0282 / 206265, "shaft": "pinion"}  # m in an arc second of it
    return [
        gear(*several(one, turning | error)),
        oscillator(*several(two, response)),
        gear(record(error | torques)),
        gear(record(only(one, "transmission_error") | turning)),
        gear(record(only(one, "transmission_error", **arbitrary) | turning, mesh_index=False), **segments),
        gear(record({"transmission_error": angular} | turning), **inertias),
        gear(record(tangential | turning)),
        gear(record(apart(tangential, {"datum": "absolute"}) | turning)),
        gear(record(apart(tangential, arbitrary) | turning)),
        gear(record(only(one, "gear_speed") | turning)),
        gear(record(only(one, "pinion_speed", **around) | balanced, conditions=speed)),
        gear(record(only(one, "gear_speed", **around) | balanced, conditions=speed)),
        gear(record(only(one, "pinion_speed") | balanced, conditions=speed)),
        gear(record(apart(only(one, "pinion_speed", "gear_speed"), arbitrary) | balanced, conditions=speed)),
        oscillator(record(only(two, "displacement") | inputs), **segments),
        *(oscillator(record(only(two, name) | plain(two, "force"))) for name in motions),
        oscillator(record(only(two, "acceleration", datum="absolute") | plain(two, "force"))),
        oscillator(record(only(two, "acceleration", frame="relative") | plain(two, "base_acceleration"))),
        oscillator(record(apart(motions, {"frame": "relative"}) | plain(two, "base_acceleration"))),
        oscillator(record(based)),
        oscillator(record(only(two, "displacement", datum="absolute") | plain(two, "force"))),
        *(oscillator(record(only(two, name, **arbitrary) | plain(two, "force")))
          for name in ("displacement", "velocity", "acceleration")),
        *(gear(record(apart(error | tangential | every | torque_channels, base))) for base in own),
        *(gear(record(apart(plain(one, "pinion_speed") | torque_channels, base))) for base in own),
        *(oscillator(record(apart(plain(two, "displacement", "velocity", "acceleration", "force", "base_acceleration"),
                                  base))) for base in own),
        gear(record(error, conditions=still)),
        gear(record(error, conditions=load | {"pinion_speed": still["pinion_speed"], "gear_torque": "balanced"})),
        gear(record(rate | error | turning, timed=False)), gear(record(error | turning, timed=False, **rate)),
        oscillator(record(rate | response, timed=False)), oscillator(record(response, timed=False, **rate)),
        gear(record(heard, file="heard.npz")),
        gear(record(error | turning, slice=[0, 380])), oscillator(record(response, slice=[0, 380])),
        gear(record(error | turning, **cut)), oscillator(record(response, **cut)),
        oscillator(record({"displacement": {"column": "let_go", "unit": "m"}}, conditions={"force": {"value": 0.3,
                                                                                                 "unit": "N"}}),
                   record(response, **later)),
        gear(record({"pinion_speed": plain(one, "pinion_speed")["pinion_speed"] | {"coupling": "DC"}} | balanced,
                    conditions={"pinion_speed": {"value": 1202.0, "unit": "rad/s"}})),
        gear(record(error | turning), **inertias),
        gear(record(error | turning), parameters=stated(one, "inertia_pinion", "inertia_gear")),
        oscillator(record(only(two, "force") | plain(two, "displacement")), parameters=stated(two, "damping_ratio")),
        oscillator(record(response), parameters=stated(two, "damping_coefficient")),
        *(encoded(found) for found in (counts, stamps, indexed, {"tacho": tacho}, {"tacho": pulses})),
    ]  # fmt: skip


BASES = bases()
KEYS = list(declared_keys())
QUICK = ("sampling_rate", "transmission_error")  # of a gear pair; its time is read as an oscillator's is


def is_slow(path: tuple[str, ...]) -> bool:
    """Whether a key is one of many that lie alike, each a second of fitting: a unit is read with every value.

    So are channels and uncertainties of a gear pair. That another unit changes what is loaded is seen in tests of the
    measurement.
    """
    is_unit = path[-1] == "unit" and path not in REFUSED
    is_uncertainty = path[0] == "gear_pair" and path[-1] == "uncertainty"
    return is_unit or is_uncertainty or (path[:3] == ("gear_pair", "records", "channels") and path[3] not in QUICK)


WALKED = [
    pytest.param(path, kind, part, id=".".join(path), marks=[pytest.mark.slow] if is_slow(path) else [])
    for path, kind, part in KEYS
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("every_key_in_the_answer")
    for name, rows in (("data", ROWS), ("heard", HEARD_ROWS)):
        np.savez(place / f"{name}.npz", **table(rows))
    np.savez(place / "other.npz", **{k: c if k in ("t", "ts") else 1.1 * c for k, c in table(ROWS).items()})
    return place


def answer(content: dict, folder: Path) -> object:
    """What task=explain answers, or why it refuses."""
    return _answer(json.dumps(content), folder)


@cache
def _answer(content: str, folder: Path) -> object:
    whole = Descent.run

    def short(descent, iterations, *others):
        return whole(descent, min(iterations, ITERATIONS), *others)

    reading = patch("gear_damping.measurement.load.read_yaml", lambda _: json.loads(content))
    calibration_alone = patch(
        "gear_damping.explanation.explain.search", lambda nominal, bench, *_: State(bench, nominal, nominal)
    )
    few_scans = patch.multiple("gear_damping.explanation.steps.calibrate", EDGES=(0.0,), STIFFNESSES=(1.0, 0.92))
    with reading, calibration_alone, few_scans, patch.object(Descent, "run", short):
        try:
            return explain(load_measurement(folder / "measurement.yaml"), library={}).content
        except InputError as error:
            return str(error)


def differ(one: object, other: object) -> bool:
    """Whether two answers say something else anywhere."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() != other.keys() or any(differ(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) != len(other) or any(differ(a, b) for a, b in zip(one, other, strict=True))
    if isinstance(one, float) and isinstance(other, float):
        return not np.isclose(one, other, rtol=SAME, atol=0.0, equal_nan=True)
    return one != other


@pytest.mark.parametrize("number", range(len(BASES)))
def test_the_files_that_are_varied_are_answered(number, folder):
    found = answer(BASES[number], folder)
    assert isinstance(found, dict), found
    assert found["verdict"] != "data_problem", found["sentences"]


@pytest.mark.parametrize(("path", "kind", "part"), WALKED)
def test_another_value_of_a_key_changes_the_answer_or_is_refused(path, kind, part, folder):
    files = [base for base in BASES if base["system"] == path[0] and holder(base, path[1:])]
    assert files, f"no file of this test holds {'.'.join(path)}: write one that does"
    outcomes = []
    for base in files:
        for value in values_of(base, path, kind, part):
            outcomes.append(_outcome(base, path, value, folder))
            if _is_right(outcomes[-1], path):
                return
    pytest.fail(f"another value of {'.'.join(path)} changes nothing: {outcomes}")


def values_of(base: dict, path: tuple[str, ...], kind: Value, part: str) -> list:
    """Other values of a key."""
    return VALUES.get(path[-3:]) or VALUES.get(path[-2:]) or [another(holder(base, path[1:])[path[-1]], kind, part)]


def _is_right(outcome: bool | str, path: tuple[str, ...]) -> bool:
    if path in REFUSED:
        return isinstance(outcome, str) and any(word in outcome for word in REFUSED[path].split("|"))
    return outcome is True


def _outcome(base: dict, path: tuple[str, ...], value: object, folder: Path) -> bool | str:
    """Whether the value changes the answer, or why it is refused."""
    changed = copy.deepcopy(base)
    holder(changed, path[1:])[path[-1]] = value
    found = answer(changed, folder)
    return found if isinstance(found, str) else differ(answer(base, folder), found)
