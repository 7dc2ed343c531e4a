"""Whether the interval of the damping holds the truth once `explain` has named what was hidden: `make coverage`.

Each case is a test of the paper's gear pair with one thing hidden in it, written as files. Before: output error that
takes the equation for known, as it takes it. After: `explain`, and `identify` on the simulation that it wrote. Goes on
where it stopped; a case a line in `docs/coverage_cases.jsonl`, the table in `docs/coverage.md`.
"""

import argparse
import json
import math
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist
from time import monotonic, process_time
from typing import Any

import numpy as np
import torch
from matplotlib.figure import Figure
from scipy.stats import binomtest

import gear_damping as gd
from benchmarks.marked import put
from gear_damping.identification.seeding import seeded_generator
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.write import write_measurement
from gear_damping.physics.damping_ratio import equivalent_damping_ratio, power_law_coefficient
from gear_damping.reporting.figures import save
from gear_damping.reporting.style import BLUE, INK, RED, new_figure, styled

DOCS = Path(__file__).parents[1] / "docs"
PAGE, CASES, PICTURE = DOCS / "coverage.md", DOCS / "coverage_cases.jsonl", DOCS / "figures" / "coverage.png"
BEGIN, END = "<!-- measured by `make coverage` -->", "<!-- end -->"
KINDS = {
    "modulation": "the pinion's shaft modulates the stiffness by 1 %",
    "exponent": "damping of the power 1.8 instead of 2",
    "speed": "every speed wrong by 0.5 %, up or down",
}
SEED = 90000  # of the first case; the tests draw others
SPEEDS = {"fit": (2120.0, 3580.0, 4440.0), "holdout": (2850.0,)}  # rpm, where a damping of 0.1 % leaves it stable
RATE, SAMPLES, SNR_DB = 40e3, 1200, 30.0  # Hz; of a record; of the transmission error
TORQUE, HALF_RANGE = 150.0, 0.2  # N m of family bench, and how far it varies
RATIOS = (0.1, 0.6)  # % of critical, of family bench
PERTURBATION = 0.1  # of the start, of static deflection and reference velocity, of family bench
MODULATION, POWER, TAKEN, SPEED_ERROR = 0.01, 1.8, 2.0, 0.005
MESH = {"mesh_stiffness_max": "maximum", "mesh_stiffness_min": "minimum", "contact_ratio": "contact_ratio"}  # stated
SHOWN = 5.0  # % of the truth, up and down: a few intervals are wider
NARROWER = NormalDist().inv_cdf(0.95) / NormalDist().inv_cdf(0.975)  # a 90 % interval over a 95 % one
Case = dict[str, Any]


@dataclass(frozen=True)
class Truth:
    """A drawn test: its simulation, values of every record, and what the damping of it is."""

    kind: str
    seed: int
    model: gd.Model
    coefficient: float
    exponent: float
    values: Mapping[str, np.ndarray]

    def ratio_percent(self, velocity: float) -> float:
        """The damping ratio at a velocity amplitude in m/s, % of critical."""
        mass, stiffness = _rig()
        own = (torch.tensor(x, dtype=torch.float64) for x in (self.coefficient, self.exponent, velocity))
        return 100 * float(equivalent_damping_ratio(*own, mass, stiffness))


def _rig() -> tuple[torch.Tensor, torch.Tensor]:
    """Mass along the line of action, and mean stiffness."""
    model = gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.ViscousDamping()])
    derived = model.prepare(model.values(1)).derived
    return derived["equivalent_mass"][0], derived["mean_stiffness"][0]


def drawn(kind: str, seed: int) -> Truth:
    """A test with something hidden in it."""
    random = np.random.default_rng([SEED + seed, list(KINDS).index(kind)])
    speeds = np.array([speed for role in SPEEDS.values() for speed in role]) * math.pi / 30
    torque = TORQUE * random.uniform(1 - HALF_RANGE, 1 + HALF_RANGE, speeds.size)
    mass, stiffness = _rig()
    pair = gd.GearPair()
    force = TORQUE / float(pair_radius(pair))
    velocity = force / math.sqrt(float(mass * stiffness))
    exponent = POWER if kind == "exponent" else 1.0
    wanted = (torch.tensor(x, dtype=torch.float64) for x in (random.uniform(*RATIOS) / 100, exponent, velocity))
    coefficient = float(power_law_coefficient(*wanted, mass, stiffness))
    law = (
        gd.PowerLawDamping(coefficient=coefficient, exponent=exponent)
        if kind == "exponent"
        else gd.ViscousDamping(damping_coefficient=coefficient)
    )
    effects = [gd.FourierMeshStiffness(), law]
    if kind == "modulation":
        effects.append(gd.PinionStiffnessModulation(amplitude=MODULATION, phase=random.uniform(-math.pi, math.pi)))
    start = PERTURBATION * random.normal(size=(2, speeds.size))
    values = {
        "pinion_speed": speeds,
        "pinion_torque": torque,
        "initial_displacement": torque / TORQUE * force / float(stiffness) * (1 + start[0]),
        "initial_velocity": velocity * start[1],
    }
    return Truth(kind, seed, gd.Model(pair, effects), coefficient, exponent, values)


def pair_radius(pair: gd.GearPair) -> torch.Tensor:
    """Base radius of the pinion, m."""
    model = gd.Model(pair, [gd.FourierMeshStiffness(), gd.ViscousDamping()])
    return 1 / model.prepare(model.values(1)).derived["load_per_pinion_torque"][0]


def measured(truth: Truth, folder: Path, uncertainty: float | None) -> gd.Measurement:
    """The test as files, read back. uncertainty: of the speeds, where these and no angle are known."""
    runs = gd.simulate(truth.model, sampling_rate=RATE, n_samples=SAMPLES, batch=4, **truth.values)
    clean = torch.as_tensor(runs.transmission_error)
    sigma = float(clean.var(-1, correction=0).mean().sqrt()) * 10 ** (-SNR_DB / 20)
    generator = seeded_generator(SEED + truth.seed, "coverage", truth.kind)
    noisy = clean + sigma * torch.randn(clean.shape, generator=generator, dtype=clean.dtype)
    random = np.random.default_rng([SEED + truth.seed, 99])
    errors = SPEED_ERROR * random.choice([-1.0, 1.0], clean.shape[0]) if truth.kind == "speed" else np.zeros(4)
    roles = [role for role, speeds in SPEEDS.items() for _ in speeds]
    records = []
    for i, role in enumerate(roles):
        speed = float(truth.values["pinion_speed"][i]) * (1 + errors[i])
        channels = {"transmission_error": Channel("transmission_error", noisy[i].numpy().copy(), "m")}
        conditions = {"pinion_torque": Quantity(float(truth.values["pinion_torque"][i]), "N*m")}
        if truth.kind == "speed":
            conditions["pinion_speed"] = Quantity(speed, "rad/s", uncertainty or 0.0)
        else:
            channels["pinion_angle"] = Channel("pinion_angle", runs.pinion_angle[i].copy(), "rad")
        records.append(Record(f"run_{i + 1}", Path(), "", role, RATE, runs.time, channels, conditions, "balanced"))
    defaults = {p.name: (float(p.default), p.unit) for p in gd.FourierMeshStiffness.parameters}
    stated = {said: Quantity(*defaults[name]) for said, name in MESH.items()}
    return gd.load(write_measurement(folder, "gear_pair", records, stated))


def nominal(truth: Truth) -> gd.Model:
    """The simulation that an engineer takes for right, with the damping that it begins at."""
    ratio, velocity = (torch.tensor(x, dtype=torch.float64) for x in (0.0035, 0.6))
    mass, stiffness = _rig()
    power = torch.tensor(TAKEN if truth.kind == "exponent" else 1.0, dtype=torch.float64)
    begun = float(power_law_coefficient(ratio, power, velocity, mass, stiffness))
    law = (
        gd.PowerLawDamping(coefficient=begun, exponent=TAKEN)
        if truth.kind == "exponent"
        else gd.ViscousDamping(damping_coefficient=begun)
    )
    return gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), law])


def answered(kind: str, seed: int) -> Case:
    """What was hidden, and the damping before and after."""
    begun, truth = process_time(), drawn(kind, seed)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        trusted = measured(truth, Path(folder) / "trusted", None)
        before = gd.identify(trusted, nominal(truth), ["damping_ratio"]).damping_ratio_percent
        declared = measured(truth, Path(folder) / "declared", SPEED_ERROR) if kind == "speed" else trusted
        answer = gd.explain(declared)
        calibrated, after = answer.content["gain"]["damping_ratio_percent"]["before"], None
        if answer.model is not None:
            after = gd.identify(declared, answer.model).damping_ratio_percent
    found = {"before": before, "calibrated": calibrated, "after": after}
    return {
        "kind": kind,
        "seed": seed,
        "verdict": answer.verdict,
        "causes": {cause["name"]: cause["status"] for cause in answer.causes},
        **{name: one and _held(one, truth) for name, one in found.items()},
        "seconds": round(process_time() - begun, 1),
    }


def _held(one: Mapping[str, Any], truth: Truth) -> dict[str, Any]:
    """Value and half 90 % interval in % of the truth, and whether the interval holds it."""
    true = truth.ratio_percent(one["reference_velocity"])
    value, (low, high) = one["value"], one["interval95"]
    ends = [value + NARROWER * (end - value) for end in (low, high)]
    return {
        "true": true,
        "value": value,
        "interval90": ends,
        "error_percent": 100 * (value / true - 1),
        "half_percent": 50 * (ends[1] - ends[0]) / true,
        "holds": bool(ends[0] <= true <= ends[1]),
    }


def main() -> None:
    """Do what is not noted yet, kinds in turns; then write the table."""
    parser = argparse.ArgumentParser(prog="make coverage ARGS=...", description=__doc__)
    parser.add_argument("--cases", type=int, default=100, help="of each kind")
    parser.add_argument("--kinds", nargs="+", choices=tuple(KINDS), default=tuple(KINDS))
    parser.add_argument("--first", type=int, default=0, help="number of the first case: for a second process")
    parser.add_argument("--minutes", type=float, default=85.0, help="begin no case after so many")
    parser.add_argument("--no-page", dest="page", action="store_false", help=f"leave {PAGE.name} as it is")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    begun, done = monotonic(), {(case["kind"], case["seed"]) for case in noted()}
    waiting = [(kind, asked.first + i) for i in range(asked.cases) for kind in asked.kinds]
    for kind, seed in waiting:
        if (kind, seed) in done or monotonic() - begun > 60 * asked.minutes:
            continue
        case = answered(kind, seed)
        with CASES.open("a", encoding="utf-8") as notes:
            notes.write(json.dumps(case) + "\n")
        print(json.dumps(case), flush=True)
    cases = noted()
    text = table(cases)
    print(text)
    if asked.page:
        put(text, PAGE, BEGIN, END)
        save(figure(cases), PICTURE)


def figure(cases: Sequence[Case]) -> Figure:
    """Every interval after `explain` about the truth, in the order of the errors; a panel for each thing hidden."""
    with styled():
        shown = new_figure(3.4)
        for axes, kind in zip(shown.subplots(1, len(KINDS), sharey=True), KINDS, strict=True):
            own = [case["after"] for case in cases if case["kind"] == kind and case["after"]]
            own.sort(key=lambda one: one["error_percent"])
            for number, one in enumerate(own):
                look = {"color": BLUE, "linewidth": 1.0} if one["holds"] else {"color": RED, "linewidth": 2.5}
                ends = [100 * (end / one["true"] - 1) for end in one["interval90"]]
                axes.plot([number, number], ends, **look)
            axes.axhline(0, color=INK, linewidth=0.8)
            held = sum(one["holds"] for one in own)
            axes.set(title=f"{kind}: {held} of {len(own)} hold it", xlabel="test, by its error", ylim=(-SHOWN, SHOWN))
        shown.axes[0].set_ylabel("interval about the truth / %")
    return shown


def noted() -> list[Case]:
    """The cases so far."""
    return [json.loads(line) for line in CASES.read_text().splitlines()] if CASES.exists() else []


def table(cases: Sequence[Case]) -> str:
    """How often the intervals hold the truth, before and after, by what was hidden."""
    named = {"before": "known equation", "calibrated": "calibrated nominal", "after": "after `explain`"}
    columns = ("hidden", "cases", *(f"{name}: holds | error / half" for name in named.values()), "named")
    rows = [f"| {' | '.join(columns)} |", "|---" * 9 + "|"]
    for kind, sentence in KINDS.items():
        own = [case for case in cases if case["kind"] == kind]
        cells = [part for key in named for part in _of([case[key] for case in own])]
        explained = sum(bool(case["causes"]) for case in own)
        rows.append(f"| {sentence} | {len(own)} | {' | '.join(cells)} | {explained} |")
    return "\n".join(rows)


def _of(found: Sequence[Mapping[str, Any] | None]) -> tuple[str, str]:
    """How many of the intervals hold the truth, and the median error beside half an interval, % of the truth."""
    held, of = sum(bool(one and one["holds"]) for one in found), len(found)
    if not of:
        return "–", "–"
    low, high = binomtest(held, of).proportion_ci()  # of Clopper and Pearson
    told = [one for one in found if one]
    error, half = (float(np.median([abs(one[key]) for one in told])) for key in ("error_percent", "half_percent"))
    return f"{held} of {of} ({100 * low:.0f} to {100 * high:.0f} %)", f"{error:.2g} / {half:.2g} %"


if __name__ == "__main__":
    main()
