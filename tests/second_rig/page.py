"""The page that lays each answer beside the truth."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

from second_rig import CASES

from ..blind.judge import damping_held
from ..blind.rates import clopper_pearson
from .work import Case, names_right, names_wrongly

HEAD = """# A second rig

A second generator of measurements (`tests/oracles/second_rig`), by another hand than the generator of the
[blind cases](blind.md), which imports nothing of that or of the package. Its stiffness is another law (the sum of
single pairs of teeth with edges of their own, or eight harmonics), the gear stands anywhere by whole turns of the
pinion, and sensors, noise, rates and files vary: encoders of both shafts, accelerometers, speeds, csv, mat, npz and
wav. There are two sets of fixed cases. Each is a folder as a user would hand it over; nothing but that folder reaches
the explanation, and its answer is judged afterwards. *Right* means: where nothing is hidden, consistent, with the
true damping ratio in its 95 % interval; an effect, established and named first; a constant that is declared wrong,
consistent once it is calibrated; an effect that the catalogue lacks, unexplained or partly explained with no name
established. The cases are few and were chosen, not drawn: they say whether another rig is a difficulty, and no rate.
They are fixed, too: a package that is changed after its answers about them were read is not blind to them any more.
In c03 and d10 the cracked tooth stands elsewhere in each record although the counters of both shafts run on, which no
gear does; they are kept as they were made. The gear's torque of d09 follows the ripple: of one that stands a sensor on
a shaft would show how both shafts speed up, which this generator does not tell.
"""
DRAWN_HEAD = """# Drawn cases of the second rig

The [second rig](second_rig.md) with everything drawn by a number: tooth counts, modules, widths, inertias, damping,
stiffness law, speeds, torques, three to five records with or without a held-out one, sensors and their units, files,
noise and its colour, and what is hidden (`tests/oracles/second_rig/drawn.py`). What is hidden has a size drawn from
its usual range, and moves at least one record by half a standard deviation of the noise: some of it is small. The
numbers below were drawn once and were not looked at before the version of the package that answered them was frozen;
other numbers, by which it was mended, are not counted here. A name is *right* as on that page; the intervals of the
damping ratio are counted apart, where no damping law is hidden. Where the pinion's angle is recorded, it holds the
vibration too, while the mesh follows the even rotation: some 2 mrad of the mesh apart, which shows 40 dB below the
motion (r604).
"""
LAWS = ("coulomb_friction", "power_law_damping")  # whose part a damping ratio holds too
COLUMNS = ("case", "teeth", "sensor", "noise", "hidden", "verdict", "first cause: found beside the truth",
           "damping ratio / %", "s", "")  # fmt: skip
SHOWN = ("depth", "gap", "force", "exponent", "coefficient", "amplitude")  # parameters that mean the same on both sides


def page(cases: Sequence[Case], command: str) -> str:
    """The markdown page of these cases."""
    return "\n".join([HEAD, _basis(cases, command), _table(cases), ""])


def drawn_page(cases: Sequence[Case], command: str) -> str:
    """The same of drawn cases, with what they add up to."""
    engines = ", ".join(sorted({case["engine"] for case in cases}))
    right, wrong = (sum(map(count, cases)) for count in (names_right, names_wrongly))
    seconds = sorted(case["seconds"] for case in cases)
    said = (
        f"Written by `{command}` from {len(cases)} cases, explained by the version {engines} of the package: "
        f"**{right} right ({_share(right, len(cases))}), {wrong} with a name that is not there "
        f"({_share(wrong, len(cases))})**; {_covered(cases)}; {seconds[len(seconds) // 2]:.3g} s of one core (median; "
        f"the longest {seconds[-1]:.3g}). Shares have their 95 % intervals (Clopper and Pearson).\n"
    )
    return "\n".join([DRAWN_HEAD, said, _by_hidden(cases), "", _table(cases), ""])


def _share(count: int, total: int) -> str:
    low, high = clopper_pearson(count, total)
    return f"{100 * count / total:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def _covered(cases: Sequence[Case]) -> str:
    told = [held for case in cases if case["truth"]["hidden"] not in LAWS
            if (held := damping_held(case, case["answer"])) is not None]  # fmt: skip
    return f"{sum(told)} of {len(told)} intervals of the damping ratio hold it"


def _by_hidden(cases: Sequence[Case]) -> str:
    """A row for each thing that is hidden."""
    rows = ["| hidden | cases | right | a wrong name |", "|---|---|---|---|"]
    for name in sorted({_hidden(case["truth"]) for case in cases}):
        these = [case for case in cases if _hidden(case["truth"]) == name]
        right, wrong = (sum(map(count, these)) for count in (names_right, names_wrongly))
        rows.append(f"| {name} | {len(these)} | {right} | {wrong} |")
    return "\n".join(rows)


def _basis(cases: Sequence[Case], command: str) -> str:
    engines = sorted({case["engine"] for case in cases})
    seconds = [case["seconds"] for case in cases]
    versions = "one version" if len(engines) == 1 else f"{len(engines)} versions"
    right = sum(case["right"] for case in cases)
    return (
        f"Written by `{command}` from {len(cases)} of the {len(CASES)} cases: {right} right. Explained by {versions} "
        f"of the package ({', '.join(engines)}) in {statistics.median(seconds):.3g} s of one core (median; the longest "
        f"{max(seconds):.3g}). A name with a question mark is suggested, not established. Found values have their 95 % "
        f"intervals in square brackets, and the truth in round ones behind them.\n"
    )


def _table(cases: Sequence[Case]) -> str:
    rows = [f"| {' | '.join(COLUMNS)} |", "|" + "---|" * len(COLUMNS)]
    rows += [f"| {' | '.join(_row(case))} |" for case in sorted(cases, key=lambda case: case["case"])]
    return "\n".join(rows)


def _row(case: Case) -> list[str]:
    truth, said = case["truth"], case["answer"]
    noise = f"{truth['noise']['kind']}, {truth['noise']['snr_db']} dB"
    return [
        case["case"], "/".join(map(str, truth["teeth"])), truth["sensor"].replace("_", " "), noise, _hidden(truth),
        said["verdict"].replace("_", " "), _first_cause(case), _damping(case), f"{case['seconds']:.0f}",
        "right" if case["right"] else "**wrong**",
    ]  # fmt: skip


def _hidden(truth: dict[str, Any]) -> str:
    if truth["hidden"] is None:
        return "nothing"
    return f"`{truth['hidden']}`" if truth["to_find"] == "effect" else truth["hidden"].replace("_", " ")


def _first_cause(case: Case) -> str:
    """The first cause, and what it says of its parameters beside the truth where that means the same."""
    causes, truth = case["answer"]["causes"], case["truth"]
    if not causes:
        return "–"
    cause = causes[0]
    name = f"`{cause['name']}`" + ("" if cause["status"] == "established" else "?")
    if cause["name"] != truth["hidden"]:
        return name
    found, true = cause["parameters"], truth["parameters"]
    shown = [f"{key} {_found(found[key], true[key])}" for key in SHOWN if key in found and key in true]
    if cause["name"] == "pitch_error":
        shown = [_largest(found, true["amplitude"], truth["teeth"][0])]
    return "; ".join([name, *shown])


def _largest(found: dict[str, Any], amplitude: float, z: int) -> str:
    """The largest error of a tooth / m. Only differences act: of one tooth alone the mean, 1 / z, is lost."""
    errors = [one["value"] for key, one in found.items() if key.startswith("values")]
    return f"largest tooth {max(errors, key=abs):.3g} m ({amplitude * (1 - 1 / z):.3g})"


def _found(parameter: dict[str, Any], true: float) -> str:
    """A value with its interval and its unit, and the truth."""
    unit = "" if parameter["unit"] == "1" else f" {parameter['unit']}"
    return f"{parameter['value']:.3g}{_interval(parameter)}{unit} ({true:.3g})"


def _damping(case: Case) -> str:
    found = case["answer"].get("damping_ratio_percent")
    part = "viscous part " if case["truth"]["hidden"] in LAWS else ""  # the ratio found is that of all laws together
    true = f"({part}{case['truth']['damping_ratio_percent']:.3g})"
    return f"{found['value']:.3g}{_interval(found)} {true}" if found else f"– {true}"


def _interval(parameter: dict[str, Any]) -> str:
    interval = parameter.get("interval95")
    return "" if interval is None else " [{:.3g}, {:.3g}]".format(*interval)
