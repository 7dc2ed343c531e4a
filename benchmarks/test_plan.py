"""What plans promise beside what 1000 simulated and fitted tests of each show: `make plan-check`.

Each test is the rig's own motion behind white noise of its own; each estimate is maximum likelihood, Gauss-Newton from
the truth until it rests. Writes the table of `docs/plan.md`.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path

import gear_damping as gd
from benchmarks.marked import put
from gear_damping.identification.test_plan.asked import Unknown
from gear_damping.identification.test_plan.plan import ToldTest
from gear_damping.identification.test_plan.repeated import Repeated, Shown

PAGE = Path(__file__).parents[1] / "docs" / "plan.md"
BEFORE, AFTER = "<!-- measured by `make plan-check` -->", "<!-- end of what was measured -->"
SEED = 31  # of the noise
RPM = pi / 30  # rad/s
WITHIN, COVERING = 0.10, (0.93, 0.97)  # what is asked of a promise: its deviation, its coverage
LOST = 0.005  # share of fits that may run off
WIDE = 50.0  # %, half of an interval beyond which nothing is promised (docs/plan.md)
STIFFNESS, TORQUE = "fourier_mesh_stiffness.maximum", Unknown("pinion_torque", percent=1.0, each=True)
COLUMNS = (
    "plan", "wanted", "promised ± % of it", "standard deviation, shown / promised", "bias / deviation", "coverage",
    "lost fits", "kept",
)  # fmt: skip


def gears(*more: object) -> gd.Model:
    return gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.PowerLawDamping(coefficient=131.8), *more])


def rig(law: object) -> gd.Model:
    return gd.Model(gd.Oscillator(stiffness=1e4, amplitude=0.01), [law])


@dataclass(frozen=True)
class Case:
    """A plan whose tests are all made together.

    Args:
        name: What the table calls it.
        model: The rig.
        settings: Speed in rpm and torque of each test, or the amplitude.
        duration: s.
        sensors: Name of the channel -> noise in SI, or a text such as `10 dB`.
        joint: Whether the exponent is unknown too.
        settle: Seconds before the record; None as usual.
        offset: Whether zeros are unknown.
    """

    name: str
    model: gd.Model
    settings: tuple
    duration: float
    sensors: dict
    joint: bool = False
    settle: float | None = None
    offset: bool = False


ENCODERS, LINEAR, POWER = "transmission_error", gd.ViscousDamping(damping_coefficient=1.0), gd.PowerLawDamping(
    coefficient=2.0, exponent=2.0
)  # fmt: skip
CASES = (
    Case("steady, 5500 rpm, 0.05 s, 30 dB", gears(), ((5500, 150),), 0.05, {ENCODERS: "30 dB"}),
    Case("steady, 5500 rpm, 0.05 s, 10 dB", gears(), ((5500, 150),), 0.05, {ENCODERS: "10 dB"}),
    Case("steady, 5500 rpm, 0.0125 s, 10 dB", gears(), ((5500, 150),), 0.0125, {ENCODERS: "10 dB"}),
    Case("steady, 4600 rpm, 0.25 s, 10 dB", gears(), ((4600, 300),), 0.25, {ENCODERS: "10 dB"}),
    Case("steady, 5500 rpm, 0.05 s, 40 dB", gears(), ((5500, 150),), 0.05, {ENCODERS: "40 dB"}, joint=True),
    Case("steady, 1500 and 5500 rpm, 0.05 s each, 20 dB", gears(), ((1500, 300), (5500, 150)), 0.05,
         {ENCODERS: "20 dB"}, joint=True),
    Case("run-up from rest, 3000 rpm, 0.05 s, 10 dB", gears(), ((3000, 150),), 0.05, {ENCODERS: "10 dB"}, settle=0.0),
    Case("run-up from rest, 3000 rpm, 0.05 s, 20 dB", gears(), ((3000, 150),), 0.05, {ENCODERS: "20 dB"}, joint=True,
         settle=0.0),
    Case("accelerometer, 4500 rpm, 0.05 s, 20 dB", gears(), ((4500, 300),), 0.05, {"pinion_acceleration": "20 dB"}),
    Case("impacts (backlash), 3500 rpm, 0.05 s, 0.5 µm, zero unknown", gears(gd.Backlash(gap=1e-4)), ((3500, 300),),
         0.05, {ENCODERS: 5e-7}, joint=True, offset=True),
    Case("impacts, 3500 and 5500 rpm, 0.05 s each, 10 dB", gears(gd.Backlash(gap=1e-4)), ((3500, 150), (5500, 300)),
         0.05, {ENCODERS: "10 dB"}),
    Case("oscillator's decay, 0.5 s, 10 dB", rig(LINEAR), (0.01,), 0.5, {"displacement": "10 dB"}),
    Case("oscillator's decay, 2 s, 30 dB", rig(LINEAR), (0.01,), 2.0, {"acceleration": "30 dB"}),
    Case("oscillator's decays from 0.5 and 2 cm, 2 s, 20 dB", rig(POWER), (0.005, 0.02), 2.0,
         {"displacement": "20 dB"}, joint=True),
    Case("steady, 3000 rpm, 0.05 s, 10 dB: too little", gears(), ((3000, 150),), 0.05, {ENCODERS: "10 dB"}),
    Case("steady, 3000 rpm, 0.02 s, 10 dB: too little", gears(), ((3000, 150),), 0.02, {ENCODERS: "10 dB"}),
    Case("steady, 3000 rpm, 0.0125 s, 10 dB: too little", gears(), ((3000, 150),), 0.0125, {ENCODERS: "10 dB"}),
)  # fmt: skip


def planned(case: Case) -> tuple[gd.Plan, ToldTest]:
    """The plan, and all its tests together."""
    turning = case.model.system.name == "gear_pair"
    axes = {"amplitudes": case.settings}
    if turning:
        axes = {"speeds": tuple(speed * RPM for speed, _ in case.settings),
                "torques": tuple(dict.fromkeys(torque for _, torque in case.settings))}  # fmt: skip
    tests = gd.PlannedTests((case.duration,), 40e3 if turning else 1e3, settle=case.settle, **axes)
    sensors = [sensor(name, noise, case.offset) for name, noise in case.sensors.items()]
    count = len(case.settings)
    goal = gd.PlanGoal(joint=case.joint, most_tests=count)
    found = gd.plan(case.model, tests, sensors, unknown=[STIFFNESS, TORQUE] if turning else ["stiffness"], goal=goal)
    wanted = [(one[0] * RPM, one[1]) if turning else (one,) for one in case.settings]
    places = [tuple(one.values()) for one in found.found.survey.settings]
    return found, found.found.told([(places.index(one), 0) for one in wanted])


def sensor(name: str, noise: float | str, offset: bool) -> gd.PlannedSensor:
    told = {"snr_db": float(noise.split()[0])} if isinstance(noise, str) else {"noise": noise}
    return gd.PlannedSensor(name, offset=offset, **told)


def rows(case: Case, count: int) -> list[tuple[str, ...]]:
    """One for the ratio, and one for the exponent where that is unknown."""
    began = time.perf_counter()
    plan, told = planned(case)
    found: Repeated = plan.simulated(told, count=count, joint=case.joint, seed=SEED)
    said = told.joint if case.joint else told.alone
    wanted = "ratio, n unknown" if case.joint else "ratio"
    lost, wide = found.lost / found.count, said.percent > WIDE
    lines = [row(case.name, wanted, said.percent, found.damping_ratio, (lost, wide))]
    if found.exponent is not None:
        exponent = float(plan.found.survey.rig.values[plan.found.survey.rig.exponent][0])
        lines.append(row("", "exponent", 100 * said.exponent / exponent, found.exponent, (lost, wide)))
    print(f"{case.name}: {lines}, {time.perf_counter() - began:.0f} s", flush=True)
    return lines


def row(name: str, wanted: str, percent: float, shown: Shown, fits: tuple[float, bool]) -> tuple[str, ...]:
    ratio = shown.deviation / shown.promised
    lost, wide = fits
    kept = abs(ratio - 1) <= WITHIN and COVERING[0] <= shown.covered <= COVERING[1] and lost <= LOST
    verdict = "yes" if kept else "no: too wide to promise" if wide else "no"
    return (name, wanted, f"{percent:.3g}", f"{ratio:.3f}", f"{shown.bias / shown.promised:+.2f}",
            f"{100 * shown.covered:.1f} %", f"{100 * lost:.1f} %", verdict)  # fmt: skip


def table(lines: Sequence[Sequence[str]]) -> str:
    head = ["| " + " | ".join(COLUMNS) + " |", "|---|---|" + "---:|" * 5 + "---|"]
    return "\n".join([*head, *("| " + " | ".join(line) + " |" for line in lines)])


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="simulated tests of each plan")
    parser.add_argument("--only", default="", help="plans whose name holds this; the page stays as it is")
    chosen = parser.parse_args(arguments)
    lines = [line for case in CASES if chosen.only in case.name for line in rows(case, chosen.count)]
    text = table(lines)
    print(text)
    if not chosen.only:
        put(text, PAGE, BEFORE, AFTER)


if __name__ == "__main__":
    main()
