"""How often a network's alarm sounds where it should, and where it should not: `make alarm`.

The components are those of `training=record` on family `bench` with backlash; the records are of unseen runs of the
family, of runs with a hidden effect, and of other rigs. The misfit of a record is what output error with the equation
of the family leaves of it, over the noise. Writes its part of docs/limit.md; each effect is kept, and it goes on.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import torch
from scipy.stats import binomtest

from benchmarks.marked import put
from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.familiarity import Components, components_for
from gear_damping.identification.known_model.known_runs import KnownRuns, range_of, start_of
from gear_damping.identification.known_model.output_error import misfit
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.seeding import seeded_generator
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of

PAGE = Path(__file__).parents[1] / "docs" / "limit.md"
BEFORE, AFTER = "<!-- measured by `make alarm` -->", "<!-- end of the alarm -->"
SNRS = (30, 20, 10)  # dB
TRAINED, CALIBRATED, UNSEEN = 1000, 1000, 2000  # runs
SEED, CLEAR = 70000, 2.0  # of unseen runs; noise levels of a misfit that must be seen
HIDDEN = {
    "stiffness modulation of the pinion, 0.3 %": ["+simulator.pinion_stiffness_modulation={amplitude: 0.003}"],
    "stiffness modulation of the pinion, 1 %": ["+simulator.pinion_stiffness_modulation={amplitude: 0.01}"],
    "stiffness modulation of the gear, 1 %": ["+simulator.gear_stiffness_modulation={amplitude: 0.01}"],
    "exponent of the damping 1.8": ["simulator.power_law_damping.exponent=1.8"],
    "exponent of the damping 1.5": ["simulator.power_law_damping.exponent=1.5"],
    "speed 0.1 % higher": ["simulator.pinion_speed_rpm=4604.6"],
    "speed 0.5 % higher": ["simulator.pinion_speed_rpm=4623"],
    "no backlash": ["simulator.backlash=null"],
    "eccentricity of the pinion, 5 um": ["+simulator.pinion_eccentricity={amplitude: 5.0e-6}"],
    "profile error, 3 and 1 um": ["+simulator.profile_error={}"],
    "tooth crack": ["+simulator.tooth_crack={}"],
    "dry friction of the mesh": ["+simulator.coulomb_friction={}"],
    "torque ripple": ["+simulator.torque_ripple={}"],
    "other rig: 21 teeth": ["simulator.n_teeth_pinion=21"],
    "other rig: gear of 1.1 times the inertia": ["simulator.inertia_gear=4.95e-3"],
    "other rig: mesh 1 % stiffer": ["+simulator.fourier_mesh_stiffness.maximum=4.04e8",
                                    "+simulator.fourier_mesh_stiffness.minimum=2.02e8"],
}  # fmt: skip


def main() -> None:
    """Do what is not kept yet, then write the tables."""
    parser = argparse.ArgumentParser(prog="make alarm ARGS=...", description=__doc__)
    parser.add_argument("--runs", type=int, default=60, help="of each hidden effect")
    parser.add_argument("--minutes", type=float, default=85.0, help="begin no effect after so many")
    parser.add_argument("--out", type=Path, default=Path("outputs/alarm"))
    parser.add_argument("--no-page", dest="page", action="store_false", help="leave docs/limit.md as it is")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    asked.out.mkdir(parents=True, exist_ok=True)
    begun, plan, kept = monotonic(), plan_of(_settings([])), asked.out / f"alarm_{asked.runs}.json"
    found: dict[str, Any] = json.loads(kept.read_text()) if kept.exists() else {}
    components = _components(plan)
    for name, overrides in {"unseen runs of the family": [], **HIDDEN}.items():
        if name in found or monotonic() - begun > 60 * asked.minutes:
            continue
        found[name] = _unseen(plan, components) if not overrides else _hidden(plan, components, overrides, asked.runs)
        kept.write_text(json.dumps(found) + "\n")
        print(name, {snr: _row(levels) for snr, levels in found[name].items()}, flush=True)
    text = table(found, float(components.threshold))
    print(text)
    if asked.page:
        put(text, PAGE, BEFORE, AFTER)


def _settings(overrides: list[str]) -> Settings:
    return read_settings(*composed(["experiment=limit", "progress=false", *overrides]))


def _components(plan: SimulationPlan) -> Components:
    """As `training=record` makes them, from as many runs as they are made from."""
    settings = _settings([])
    signals = run_plan(replace(plan, n_runs=TRAINED + CALIBRATED)).response.float()
    made = Components(signals.shape[1], components_for(TRAINED, CALIBRATED))
    made.fit(signals[:TRAINED], signals[TRAINED:], SensorNoise(settings.training["noise_snr_db"]), settings.seed)
    return made


def _noisy(signals: torch.Tensor, snr: float) -> tuple[torch.Tensor, torch.Tensor]:
    """Records, and the standard deviation of their noise."""
    noise = signals.std(-1, correction=0) * 10 ** (-snr / 20)
    drawn = torch.randn(signals.shape, generator=seeded_generator(SEED, "noise", str(snr)), dtype=signals.dtype)
    return signals + noise[:, None] * drawn, noise


def _unseen(plan: SimulationPlan, components: Components) -> dict[str, list[list[float]]]:
    """Of every record whether it is called strange, by level of noise; its misfit is that of noise."""
    signals = run_plan(replace(plan, n_runs=UNSEEN, seed=SEED)).response
    return {str(snr): [[1.0, float(one)] for one in components.strange(_noisy(signals, snr)[0])] for snr in (*SNRS, 1)}


def _hidden(plan: SimulationPlan, components: Components, overrides: list[str], runs: int) -> dict[str, Any]:
    """Of every record its misfit under the equation of the family, and whether it is called strange."""
    other = plan_of(_settings(overrides))
    shown = run_plan(replace(other, n_runs=runs, seed=SEED + 1)).response
    nominal = run_plan(replace(plan, n_runs=runs, seed=SEED + 1))
    kept = min(len(shown), len(nominal.response))
    nominal = nominal.keep(torch.arange(len(nominal.response)) < kept)
    found = {}
    for snr in SNRS:
        records, noise = _noisy(shown[:kept], snr)
        start = start_of(nominal, plan.prior)
        known = KnownRuns(nominal, plan.damping_law, range_of(plan.prior), *start, records, noise, solver=plan.solver)
        pairs = zip(misfit(known).tolist(), components.strange(records).tolist(), strict=True)
        found[str(snr)] = [[size, float(strange)] for size, strange in pairs]
    return found


def _row(pairs: list[list[float]]) -> dict[str, float]:
    size, strange = torch.tensor(pairs).T
    clear = size >= CLEAR
    return {
        "records": len(size),
        "misfit": float(size.median()),
        "clear": int(clear.sum()),
        "seen": int(strange[clear].sum()),
        "strange": int(strange.sum()),
    }


def _share(count: int, of: int) -> str:
    """A share with its 95 % interval (Clopper and Pearson)."""
    if not of:
        return "–"
    low, high = binomtest(count, of).proportion_ci()
    return f"{100 * count / of:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def table(found: dict[str, Any], threshold: float) -> str:
    """False alarms by level of noise, and of each effect what is seen."""
    unseen = {snr: _row(pairs) for snr, pairs in found["unseen runs of the family"].items()}
    alarms = ", ".join(f"{_share(one['strange'], one['records'])} at {snr} dB" for snr, one in unseen.items())
    hidden = {name: levels for name, levels in found.items() if name in HIDDEN}
    rows = [f"| hidden | {' | '.join(f'misfit at {snr} dB | seen' for snr in SNRS)} |", "|---" * 7 + "|"]
    for name, levels in hidden.items():
        cells = []
        for snr in SNRS:
            one = _row(levels[str(snr)])
            cells += [f"{one['misfit']:.1f}", f"{one['strange']} of {one['records']}"]
        rows.append(f"| {name} | {' | '.join(cells)} |")
    every = [_row(levels[str(snr)]) for levels in hidden.values() for snr in SNRS]
    seen, clear = sum(one["seen"] for one in every), sum(one["clear"] for one in every)
    said = (
        f"Threshold {threshold:.3f}. False alarms on {UNSEEN} unseen runs: {alarms}. Of {clear} records"
        f" whose misfit is {CLEAR:g} or more, {_share(seen, clear)} were called unlike the training."
    )
    return "\n".join([said, "", *rows])


if __name__ == "__main__":
    main()
