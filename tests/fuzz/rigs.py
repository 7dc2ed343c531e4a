"""Oscillators as people might hand them over: any channels, units, roles, clocks, loads and lengths, in any mixture."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.integrate import solve_ivp

UNITS = {"displacement": {"m": 1.0, "mm": 1e3, "V": 1.0, "rad": 1.0, "deg": 57.3},
         "velocity": {"m/s": 1.0, "mm/s": 1e3, "rad/s": 1.0, "rpm": 9.55},
         "acceleration": {"m/s^2": 1.0, "g": 0.102}}  # fmt: skip
KINDS = ({"m", "mm", "m/s", "mm/s", "m/s^2", "g"}, {"rad", "deg", "rad/s", "rpm"})  # that go together
ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}


def drawn(source: random.Random, folder: Path) -> Path:
    """Write a rig's files and its measurement.yaml, which it returns."""
    numbers = np.random.default_rng(source.getrandbits(32))
    rig = _rig(source)
    shown = _channels(source)
    records = [_record(f"r{k}", source, numbers, rig, shown, folder) for k in range(source.choice((1, 1, 2, 3, 4)))]
    content: dict[str, Any] = {"system": "oscillator", "records": records}
    if not rig["spring"] and source.random() < 0.8:
        content["parameters"] = {"stiffness": {"value": 0, "unit": "1/s^2"}}
    elif source.random() < 0.3:
        content["parameters"] = _stated(source, rig)
    if source.random() < 0.2:
        content["segments"] = {
            "value": source.choice((0.05, 0.3, 2.0)) * source.choice((1, 5)) / rig["hz"],
            "unit": "s",
        }
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


def _rig(source: random.Random) -> dict[str, Any]:
    hz = 10 ** source.uniform(-1, 2.5)
    return {
        "hz": hz,
        "ratio": 10 ** source.uniform(-3, 0.3),
        "spring": source.random() < 0.8,
        "sign": -1.0 if source.random() < 0.05 else 1.0,  # of the spring: an inverted pendulum, a magnet
        "cubic": source.choice((0.0, 0.0, 0.3, -0.1)),
        "friction": source.choice((0.0, 0.0, 0.02, 0.3)),
        "driven": source.random() < 0.6,
        "load": source.choice(("N", "V", "N*m", "A")),
    }


def _channels(source: random.Random) -> dict[str, str]:
    """Of the rig: channel and unit; each record shows some of them."""
    kind = source.choice(KINDS)
    return {name: source.choice(sorted(set(units) & kind)) for name, units in UNITS.items() if set(units) & kind}


def _stated(source: random.Random, rig: dict[str, Any]) -> dict[str, Any]:
    stiffness = (2 * np.pi * rig["hz"]) ** 2 * source.choice((1.0, 1.0, 0.5, 1e3))
    found: dict[str, Any] = {"stiffness": {"value": float(stiffness), "unit": "1/s^2"}}
    if source.random() < 0.5:
        found["stiffness"]["uncertainty"] = source.choice((0.01, 0.3))
    if source.random() < 0.5:
        found["damping_ratio"] = {"value": min(rig["ratio"], 1.0)}
    return found


def _record(
    name: str, source: random.Random, numbers: np.random.Generator, rig: dict, shown: dict[str, str], folder: Path
) -> dict[str, Any]:
    samples = source.choice((8, 40, 200, 600, 1500))
    rate = rig["hz"] * source.choice((1.5, 3, 12, 40, 200))
    time = np.arange(samples) / rate
    load = _load(source, numbers, time, rig) if rig["driven"] else np.zeros(samples)
    motion = _motion(source, time, load, rig)
    names = [one for one in shown if source.random() < 0.5] or [source.choice(list(shown))]
    table, channels = {}, {}
    for one in names:
        values = motion[ORDER[one]] * UNITS[one][shown[one]]
        noise = 10 ** source.uniform(-4, 0) * float(np.std(values)) if source.random() < 0.9 else 0.0
        values = values + noise * numbers.standard_normal(samples)
        step = source.choice((0.0, 0.0, 0.003, 0.03)) * float(np.std(values))
        table[one] = np.round(values / step) * step if step else values
        channels[one] = {"column": one, "unit": shown[one]} | _sensor(source, rate, one)
    if rig["driven"]:
        table["force"] = load + source.choice((0.0, 0.05)) * np.std(load) * numbers.standard_normal(samples)
        channels["force"] = {"column": "force", "unit": rig["load"]} | source.choice(({}, {"hold": True}))
    stamps, clock = _clock(source, numbers, time)
    kept = np.ones(samples, bool)
    if source.random() < 0.1 and "time" in clock and samples > 30:
        kept[numbers.integers(3, samples - 3, source.choice((1, 3)))] = False
    columns = {"t": stamps, **table}
    rows = np.column_stack([column[kept] for column in columns.values()])
    np.savetxt(folder / f"{name}.csv", rows, "%.9g", ",", header=",".join(columns), comments="")
    record: dict[str, Any] = {"name": name, "file": f"{name}.csv", "channels": clock | channels}
    role = source.choice((None, "fit", "fit", "holdout"))
    return record | ({"role": role} if role else {})


def _sensor(source: random.Random, rate: float, name: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if source.random() < 0.15:
        found["datum"] = source.choice(("arbitrary", "absolute"))
    if source.random() < 0.1:
        found["lowpass"] = {"value": float(rate * source.choice((0.2, 0.45, 3))), "unit": "Hz"}
    if source.random() < 0.1:
        found["delay"] = {"value": float(source.choice((0.3, 2, -1)) / rate), "unit": "s"}
    if source.random() < 0.1:
        found["polarity"] = -1
    return found


def _load(source: random.Random, numbers: np.random.Generator, time: np.ndarray, rig: dict) -> np.ndarray:
    beat = 2 * np.pi * rig["hz"] * source.choice((0.3, 1.0, 2.7))
    shapes = (
        lambda: np.sin(beat * time),
        lambda: np.sign(np.sin(beat / 3 * time + 0.1)),
        lambda: numbers.standard_normal(time.size),
        lambda: np.ones(time.size),
        lambda: np.where(time > time[-1] / 3, 1.0, 0.0),
        lambda: np.zeros(time.size),
    )
    return source.choice(shapes)() * 10 ** source.uniform(-2, 3)


def _motion(source: random.Random, time: np.ndarray, load: np.ndarray, rig: dict) -> np.ndarray:
    """Displacement, velocity and acceleration, (3, time)."""
    rate = 2 * np.pi * rig["hz"]
    gain = rate**2 / max(float(np.abs(load).max()), 1e-9)

    def slopes(t: float, y: np.ndarray) -> tuple[float, float]:
        force = gain * np.interp(t, time, load)
        spring = rig["sign"] * rate**2 * (y[0] + rig["cubic"] * y[0] ** 3) if rig["spring"] else 0.0
        friction = rig["friction"] * rate**2 * np.tanh(50 * y[1] / rate)
        return y[1], force - 2 * rig["ratio"] * rate * y[1] - spring - friction

    start = (source.choice((0.0, 1.0, 0.3)), source.choice((0.0, 0.5)) * rate)
    ends_early = lambda t, y: 1e3 - abs(y[0])  # noqa: E731 - what runs away is recorded as far as it went
    ends_early.terminal = True
    path = solve_ivp(slopes, (time[0], time[-1]), start, "LSODA", t_eval=time, rtol=1e-5, events=ends_early).y
    path = np.pad(path, ((0, 0), (0, time.size - path.shape[1])), mode="edge")
    return np.stack([path[0], path[1], np.gradient(path[1], time)])


def _clock(source: random.Random, numbers: np.random.Generator, time: np.ndarray) -> tuple[np.ndarray, dict[str, Any]]:
    rate = float(1 / (time[1] - time[0]))
    kind = source.choice(("rate", "even", "even", "late", "digits", "offset"))
    stamps = {
        "late": time + 0.05 / rate * numbers.uniform(-1, 1, time.size),
        "digits": np.round(time, max(0, int(np.ceil(np.log10(rate))) + 2)),
        "offset": time + 1e4,
    }.get(kind, time)
    if kind == "rate":
        return stamps, {"sampling_rate": {"value": rate, "unit": "Hz"}}
    return stamps, {"time": {"column": "t", "unit": "s"}}
