"""The findings as sentences."""

from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from typing import Any

from gear_damping.reporting.explanation_report.vocabulary import description, kind, listed, words
from gear_damping.reporting.numbers import estimate, number, percent

Explanation = Mapping[str, Any]

HEADLINES = {
    "consistent": "Consistent",
    "explained": "Explained",
    "ambiguous": "Ambiguous",
    "partly_explained": "Partly explained",
    "unexplained": "Unexplained",
    "data_problem": "Data problem",
}
ALONE = "an effect smaller than those listed under “What could not have been seen” may be there all the same"


def verdict_sentences(explanation: Explanation, own: Mapping[str, str] | None = None) -> list[str]:
    """The verdict: the first sentence says what the simulation misses, the others what that is and how sure.

    Args:
        explanation: The content of `explanation.json`.
        own: Effect -> sentence about it, for effects that are not in the catalogue.
    """
    makers: dict[str, Callable[[Explanation], list[str]]] = {
        "consistent": _consistent,
        "explained": _explained,
        "ambiguous": _ambiguous,
        "partly_explained": _partly,
        "unexplained": _unexplained,
        "data_problem": _data_problem,
    }
    first, *others = makers[explanation["verdict"]](explanation)
    about = [description(name, own or {}) for name in names_of(explanation, "established")]
    return [first, *filter(None, about), *others]


def names_of(explanation: Explanation, status: str) -> list[str]:
    """Names of the causes with a status, strongest first."""
    return [cause["name"] for cause in explanation.get("causes") or () if cause.get("status") == status]


def cause_sentences(cause: Mapping[str, Any], own: Mapping[str, str]) -> list[str]:
    """What a cause is, how much it explains and what it could be mistaken for."""
    told = [description(cause["name"], own)]
    share = cause.get("excess_explained")
    if _known(share):
        told.append(f"It takes {percent(share)} of the excess on held-out records.")
    if cause.get("confusable_with"):
        told.append(f"These data cannot tell it from {listed(cause['confusable_with'], 'or')}.")
    if cause.get("status") == "suggested":
        told.append("It is a suggestion: held-out records do not bear it out.")
    return [sentence for sentence in told if sentence]


def damping_sentence(gain: Mapping[str, Any] | None) -> str:
    """What the missing effect did to the damping figure."""
    damping = (gain or {}).get("damping_ratio_percent") or {}
    before, after = damping.get("before"), damping.get("after")
    if not before or not _known(before.get("value")):
        return ""
    was = estimate({**before, "unit": "%"})
    if not after or not _known(after.get("value")):
        return f"The damping ratio is {was} of critical."
    now = estimate({**after, "unit": "%"})
    said = f"The damping ratio came out at {was} of critical before, and at {now} after the extension"
    change = before["value"] / after["value"] - 1 if after["value"] else float("nan")
    if _inside(before, after) or _inside(after, before) or not isfinite(change):
        return f"{said}: a difference within its uncertainty."
    way = "high" if change > 0 else "low"
    return f"{said}: what the simulation missed had made damping look {number(abs(100 * change), 2)} % too {way}."


def misfit_sentence(misfit: Mapping[str, Any] | None) -> str:
    """Misfit before, after, floor."""
    if not misfit or not _known(misfit.get("before")):
        return ""
    floor = number(misfit.get("floor", 1.0), 3)
    said = f"The mean squared residual on held-out records is {number(misfit['before'], 3)} times the noise variance"
    if _known(misfit.get("after")):
        said += f" with the calibrated nominal simulation and {number(misfit['after'], 3)} times with the extended one"
    return f"{said}; noise alone would leave {floor}."


def next_experiment_sentences(experiment: Mapping[str, Any] | str | None) -> list[str]:
    """What to measure next, and why."""
    if not experiment:
        return []
    if isinstance(experiment, str):
        return [experiment]
    told = [str(experiment.get("description", ""))]
    if experiment.get("separates"):
        told.append(f"That would separate {listed(experiment['separates'])}.")
    separation = experiment.get("predicted_separation")
    if isinstance(separation, (int, float)) and _known(separation):
        told.append(f"The predicted separation is {number(separation, 3)} standard deviations of the noise.")
    elif separation:
        told.append(f"Predicted separation: {separation}.")
    return [sentence for sentence in told if sentence]


def _missing(names: Sequence[str]) -> str:
    """`a damping force (coulomb friction)` for each."""
    phrases = [f"{kind(name)} ({words(name)})" for name in names] or ["something"]
    return phrases[0] if len(phrases) == 1 else f"{', '.join(phrases[:-1])} and {phrases[-1]}"


def _consistent(explanation: Explanation) -> list[str]:
    first = "These data give no evidence that the simulation misses anything."
    return [first, f"What it leaves on held-out records is noise; {ALONE}."]


def _explained(explanation: Explanation) -> list[str]:
    names = names_of(explanation, "established")
    with_them = "With them in the model" if len(names) > 1 else "With it in the model"
    return [f"The simulation misses {_missing(names)}.", f"{with_them}, what is left on held-out records is noise."]


def _ambiguous(explanation: Explanation) -> list[str]:
    first = "The simulation misses something that goes by more than one name here."
    causes = explanation.get("causes") or ()
    sets = [[cause["name"], *(cause.get("confusable_with") or ())] for cause in causes]
    told = [f"It may be {listed(names, 'or')}: these data cannot tell them apart." for names in sets if len(names) > 1]
    return [first, *told, "Each of them would leave only noise on held-out records."]


def _partly(explanation: Explanation) -> list[str]:
    first = f"The simulation misses {_missing(names_of(explanation, 'established'))}, and something else."
    return [first, "What is left on held-out records is more than noise, and no effect that was tried explains it."]


def _unexplained(explanation: Explanation) -> list[str]:
    told = ["The simulation misses something that no effect that was tried explains."]
    suggested = names_of(explanation, "suggested")
    if suggested:
        told.append(f"Nearest comes {listed(suggested, 'or')}, which held-out records do not bear out.")
    return told


def _data_problem(explanation: Explanation) -> list[str]:
    return ["The data have a fault that must be cured before any cause can be named."]


def _inside(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether the value of one lies in the interval of the other."""
    low, high = other.get("interval95") or (None, None)
    return low is not None and low <= one["value"] <= high


def _known(value: float | None) -> bool:
    return value is not None and isfinite(value)
