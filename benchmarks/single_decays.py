"""What `explain` says of one free decay alone, whose roles nobody states: `python -m benchmarks.single_decays`.

Drawn are frequency, damping, size, length, rate, noise (white, of the first order, or rounded), zero and unit; two
thirds are linear, the others have one law more. Integrated by scipy, and handed over as files.
"""

import argparse
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from gear_damping.interface.explained import explain
from gear_damping.measurement.load import load_measurement

LAWS = {  # what is added to the acceleration over the square of the frequency, by displacement, rate and strength
    "cubic_stiffness": lambda x, v, s: s * x**3,
    "power_law_damping": lambda x, v, s: 0.3 * s * abs(v) * v,
    "coulomb_friction": lambda x, v, s: 0.02 * s * np.tanh(v / 1e-3),
    "quadratic_stiffness": lambda x, v, s: s * x * x,
}
DRAWN = ("",) * 24 + (*LAWS,) * 4  # laws by seed, in turn
UNITS = ("m", "mm", "um")
MOST = 6000  # samples of a decay
DAMPING = "viscous_damping.damping_coefficient"


def drawn(seed: int) -> tuple[str, float, NDArray[np.float64], NDArray[np.float64], str]:
    """The law that is hidden, the damping in 1/s, stamps (n,) in s, displacement (n,), and the unit that it states."""
    rng, law = np.random.default_rng(seed), DRAWN[seed % len(DRAWN)]
    omega, ratio, size = (
        2 * np.pi * 10 ** rng.uniform(-0.3, 2.5),
        10 ** rng.uniform(-2.5, -0.9),
        10 ** rng.uniform(-4, 1),
    )
    cycles, per_cycle = rng.uniform(15, 60), 10 ** rng.uniform(1.1, 2)
    time = np.arange(min(int(cycles * per_cycle), MOST)) * 2 * np.pi / omega / per_cycle
    strength, phase = 10 ** rng.uniform(-1.5, -0.5), rng.uniform(0, 2 * np.pi)

    def rates(_: float, state: NDArray[np.float64]) -> list[float]:
        place, rate = state
        more = LAWS[law](place, rate / omega, strength) if law else 0.0
        return [rate, -2 * ratio * omega * rate - omega**2 * (place + more)]

    begin = [np.cos(phase), -omega * np.sin(phase)]
    swing = solve_ivp(rates, (0, time[-1]), begin, "DOP853", time, rtol=1e-9, atol=1e-11).y[0]
    level, noise, kind = 10 ** rng.uniform(-3.5, -1.7), rng.standard_normal(time.size), rng.integers(3)
    if kind == 1:
        noise = lfilter([1], [1, -0.7], noise)
        noise /= noise.std()
    values = size * (swing + level * noise)
    values = np.round(values / (2 * size * level)) * 2 * size * level if kind == 2 else values
    values = values + size * rng.uniform(-3, 3) if rng.random() < 0.4 else values
    return law, 2 * ratio * omega, time, values, UNITS[rng.integers(3)]


def judged(seed: int) -> dict[str, Any]:
    """What is hidden and what was said of it."""
    law, damping, time, values, unit = drawn(seed)
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": unit}}
    declared = {"system": "oscillator", "records": [{"file": "decay.npz", "channels": channels}]}
    with TemporaryDirectory() as name:
        folder = Path(name)
        np.savez(folder / "decay.npz", t=time, x=values)
        (folder / "measurement.yaml").write_text(yaml.safe_dump(declared))
        answer = explain(load_measurement(folder / "measurement.yaml"), minutes=1.5)
    found = [cause["name"] for cause in answer.content["causes"] if cause["status"] == "established"]
    low, high = answer.content["parameters"][DAMPING]["interval95"]
    return {"law": law, "verdict": answer.verdict, "named": found, "is_inside": low <= damping <= high}


def main() -> None:
    """Explain so many decays and count what was said."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1000, help="of the first decay")
    parser.add_argument("--cases", type=int, default=80)
    asked, counts = parser.parse_args(), Counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        said = judged(seed)
        hidden, named = said["law"] or "linear", said["named"]
        right = named == [said["law"]] if said["law"] else said["verdict"] == "consistent"
        counts.update(
            {f"{hidden}: drawn": 1, f"{hidden}: right": right, f"{hidden}: damping inside": said["is_inside"]}
        )
        counts[f"{hidden}: wrong name"] += any(name != said["law"] for name in named)
        print(f"{seed} {hidden}: {said['verdict']} {', '.join(named)}", flush=True)
    print("\n".join(f"{name} {count}" for name, count in sorted(counts.items())))


if __name__ == "__main__":
    main()
