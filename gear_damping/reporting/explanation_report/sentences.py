"""The findings as sentences."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from gear_damping.reporting.explanation_report.vocabulary import description, form_of, listed
from gear_damping.reporting.figures.visible import UNNAMED
from gear_damping.reporting.numbers import estimate, number, percent, quantity
from gear_damping.reporting.page.render import words

HEADLINES = {
    "consistent": "Consistent: these data give no evidence that the simulation misses anything.",
    "explained": "Explained: what the simulation misses has a name.",
    "ambiguous": "Ambiguous: what the simulation misses goes by several names that these data do not tell apart.",
    "partly_explained": "Partly explained: a part of what the simulation misses has a name.",
    "unexplained": "Unexplained: the simulation misses something that no effect that was tried explains.",
    "data_problem": "Data problem: the data have a fault that must be cured before a cause can be named.",
}
CASING_HEADLINES = {
    "consistent": "Consistent: the casing shows nothing that a sound gear pair does not show.",
    "unexplained": "Unexplained: the casing shows something that a sound gear pair does not show.",
}
CONDITIONAL = (
    " Something is left that has no name or is not all random, or a fit has not converged: the interval is that of the "
    "noise, or of how the figure moves without each of the records where that is wider; the damping may lie outside."
)
VISCOUS = "viscous_damping.damping_coefficient"
ONLY_NOISE = 1.5  # noise variances that may be left for saying so
MOST_PLACES = 4  # of a list, as errors of every tooth, that are told one by one
MOST_SIZES = 6  # parameters in a line
ALL_THE_SAME = "An effect smaller than those listed under “What could not have been seen” may be there all the same."


def verdict_sentences(explanation: Mapping[str, Any]) -> list[str]:
    """The verdict and what was found, the most important first."""
    headlines = CASING_HEADLINES if explanation.get("casing") else HEADLINES
    told = [headlines[explanation["verdict"]], *(explanation.get("sentences") or ())]
    if explanation["verdict"] == "explained":
        told.append(unexplained_residual_sentence(explanation.get("misfit"), explanation.get("visible")))
    told += [ALL_THE_SAME] if explanation["verdict"] == "consistent" and explanation.get("not_observable") else []
    gain = explanation.get("gain")
    told += [misfit_sentence(explanation.get("misfit")), confirmed_sentence(gain), damping_sentence(gain)]
    told.append(rate_sentence(explanation))
    return [sentence for sentence in told if sentence]


def in_short(explanation: Mapping[str, Any]) -> list[str]:
    """What was found, how large it is, and what the damping is with it."""
    sizes = map(size_sentence, explanation["causes"])
    told = (*explanation["sentences"], *sizes, damping_sentence(explanation.get("gain")), rate_sentence(explanation))
    return [sentence for sentence in told if sentence]


def cause_sentences(cause: Mapping[str, Any], own: Mapping[str, str]) -> list[str]:
    """What a cause is, how much it explains and what it could be mistaken for."""
    told = [description(cause["name"], own)]
    share = cause.get("excess_explained")
    if _known(share):
        told.append(f"It takes {percent(share)} of the excess, every condition left out of the fit in turn.")
    if cause.get("confusable_with"):
        told.append(f"These data do not tell it from {listed(cause['confusable_with'], 'or')}.")
    if cause.get("status") == "suggested":
        told.append("It is a suggestion only: held-out records do not validate it.")
    return [sentence for sentence in told if sentence]


def size_sentence(cause: Mapping[str, Any]) -> str:
    """The size of a cause in a line: its form, its parameters with their intervals, and those that were not fitted."""
    form = [f"{words(name)} {value}" for name, value in form_of(cause).items()]
    fitted = [f"{words(name)} {estimate(entry)}" for name, entry in _largest(cause.get("parameters") or {}).items()]
    more = [f"and {len(fitted) - MOST_SIZES} more in the report"] if len(fitted) > MOST_SIZES else []
    return f"{cause['name']} ({cause['status']}): {'; '.join([*form, *fitted[:MOST_SIZES], *more])}."


def _largest(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters, of a long list the largest place only, with how many there are."""
    lists: dict[str, list[str]] = {}
    for name in parameters:
        lists.setdefault(name.partition("[")[0], []).append(name)
    found = {}
    for names in lists.values():
        if len(names) <= MOST_PLACES:
            found |= {name: parameters[name] for name in names}
            continue
        largest = max(names, key=lambda name: abs(parameters[name]["value"]))
        found[f"{largest}, the largest of {len(names)},"] = parameters[largest]
    return found


def one_size_sentence(homogeneous: Mapping[str, Any] | None) -> str:
    """Whether a cause has one size over all records."""
    if not homogeneous or not homogeneous.get("testable") or not _known(homogeneous.get("p")):
        return "Too few records tell of it to see whether it has one size in all of them." if homogeneous else ""
    p = number(homogeneous["p"], 2)
    if homogeneous["p"] < homogeneous["level"]:
        return f"Its size differs between records by more than chance and a tolerance would have it (p = {p})."
    return f"Its size is the same in all records, within a tolerance of {percent(homogeneous['tolerance'])} (p = {p})."


def random_sentences(random: Mapping[str, Any] | None, visible: Mapping[str, Any] | None) -> list[str]:
    """What of the residuals is random, and whether anything else stands out."""
    if not random or not visible:
        return []
    told = [
        f"{number(random['percent'], 3)} % of the variance of the fitted records is random. It looks like "
        f"{random['looks_like']}, {number(random['snr_db'], 3)} dB below the signal."
    ]
    p, largest = visible["p"], visible["largest"]
    told.append(f"Beside the nominal simulation, {_stands_out(p['before'], largest['before'], visible['level'])}.")
    if p["after"] != p["before"] or largest["after"] != largest["before"]:
        told.append(f"Beside the extended one, {_stands_out(p['after'], largest['after'], visible['level'])}.")
    return told


def _stands_out(p: float, largest: str | None, level: float) -> str:
    if largest is None:
        return "nothing could be tested"
    name = listed([largest.removeprefix(UNNAMED)])
    if p < level:
        return f"something stands out of it that chance does not give (p = {number(p, 2)}), {name} first"
    return f"nothing stands out of it that chance would not give (p = {number(p, 2)}; {name} comes first)"


def unexplained_residual_sentence(misfit: Mapping[str, Any] | None, visible: Mapping[str, Any] | None = None) -> str:
    """Whether only noise is left of what was explained."""
    excess = (misfit or {}).get("excess_percent") or {}
    if not _known(excess.get("after")) or not _known(excess.get("threshold")):
        return ""
    small = misfit["after"] <= ONLY_NOISE
    if visible and visible["p"]["after"] < visible["level"]:
        return "What is left is small beside what was explained, but it is not all random."
    if small and excess["after"] <= excess["threshold"]:
        return "With it only noise is left."
    return "What is left is small beside what was explained, but it is more than noise."


def misfit_sentence(misfit: Mapping[str, Any] | None) -> str:
    """Misfit before, after, floor."""
    if not misfit or not _known(misfit.get("before")):
        return ""
    floor = number(misfit.get("floor", 1.0), 3)
    said = f"On held-out records the mean squared residual is {number(misfit['before'], 3)} times the noise variance"
    if _known(misfit.get("after")) and misfit["after"] != misfit["before"]:
        said += f" with the calibrated nominal simulation and {number(misfit['after'], 3)} times with the extended one"
    return f"{said}; noise alone would leave {floor}."


def confirmed_sentence(gain: Mapping[str, Any] | None) -> str:
    """What the causes are worth on held-out records, and how sure that is."""
    confirmed = (gain or {}).get("confirmed") or {}
    if not _known(confirmed.get("percent")) or not _known(confirmed.get("t")):
        return ""
    low, high = (number(end) for end in confirmed["interval95"])
    share, t = number(confirmed["percent"]), number(confirmed["t"], 3)
    return f"There the causes take {share} % ({low} to {high} %) of the squared residuals; t of what they add is {t}."


def damping_sentence(gain: Mapping[str, Any] | None) -> str:
    """What the missing effect did to the damping figure."""
    damping = (gain or {}).get("damping_ratio_percent") or {}
    before, after = damping.get("before") or {}, damping.get("after") or {}
    if not _known(before.get("value")):
        return ""
    at = quantity(before.get("reference_velocity"), before.get("velocity_unit", "m/s"))
    at = f" at a velocity amplitude of {at}" if before.get("reference_velocity") else ""
    return f"{_damping(before, after, at)}{CONDITIONAL if damping.get('conditional') else ''}"


def rate_sentence(explanation: Mapping[str, Any]) -> str:
    """The viscous damping where no ratio is told: without a spring nothing is critical."""
    viscous = (explanation.get("parameters") or {}).get(VISCOUS) or {}
    ratio = ((explanation.get("gain") or {}).get("damping_ratio_percent") or {}).get("before") or {}
    if not _known(viscous.get("value")) or _known(ratio.get("value")):
        return ""
    return f"The viscous damping is {estimate(viscous)}."


def _damping(before: Mapping[str, Any], after: Mapping[str, Any], at: str) -> str:
    was, now = (f"{estimate({**found, 'unit': '%'})}{_parts(found)}" for found in (before, after))
    if not _known(after.get("value")) or after["value"] == before["value"]:
        return f"The damping ratio is {was} of critical{at}."
    said = f"The damping ratio came out at {was} of critical{at} with the nominal simulation"
    said += f", at {now} with the extended one"
    change = before["value"] / after["value"] - 1 if after["value"] else float("nan")
    if _inside(before, after) or _inside(after, before) or not isfinite(change):
        return f"{said}: a difference within its uncertainty."
    way = "high" if change > 0 else "low"
    return f"{said}: what the simulation missed had made damping look {number(abs(100 * change), 2)} % too {way}."


def _parts(ratio: Mapping[str, Any]) -> str:
    """What each law of damping adds to a ratio, in brackets; nothing where one makes all of it."""
    parts = ratio.get("by_law") or {}
    return f" ({', '.join(f'{name} {number(value, 3)} %' for name, value in parts.items())})" if parts else ""


def next_experiment_sentences(experiment: Mapping[str, Any] | None) -> list[str]:
    """What to measure next, and why."""
    if not experiment or not experiment.get("what"):
        return []
    told = [_sentence(experiment["what"])]
    names = experiment.get("separates") or ()
    if len(names) > 1:
        told.append(f"That would separate {listed(names)}.")
    elif names:
        told.append(f"That would confirm or refute {listed(names)}.")
    separation = experiment.get("predicted_separation")
    if _known(separation):
        told.append(f"The predicted separation is {number(separation, 3)} standard deviations of the noise.")
    return told


def noise_sentences(noise: Mapping[str, Any] | None) -> list[str]:
    """How large the noise is, and how that is known."""
    if not noise:
        return []
    level = quantity(noise.get("value"), noise.get("unit"))
    told = [f"The noise of the {listed([noise.get('channel', 'channel')])} is {level} (standard deviation)."]
    told += [f"It was found from this: {noise['method']}."] if noise.get("method") else []
    if noise.get("estimates_agree") is False:
        told.append("Two estimates of it differ by more than 20 %, so thresholds were widened.")
    return told


def calibration_sentences(calibration: Mapping[str, Any] | None) -> list[str]:
    """How the nominal simulation was calibrated, and whether that converged."""
    if not calibration:
        return []
    told = [_sentence(step) for step in calibration.get("steps") or ()]
    if calibration.get("converged") is False:
        return [*told, "The calibration did not converge: take every figure here with care."]
    return [*told, "The calibration converged."] if "converged" in calibration else told


def _sentence(text: str) -> str:
    text = str(text).strip()
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")


def _inside(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether the value of one lies in the interval of the other."""
    low, high = other.get("interval95") or (None, None)
    return low is not None and low <= one["value"] <= high


def _known(value: float | None) -> bool:
    return value is not None and isfinite(value)
