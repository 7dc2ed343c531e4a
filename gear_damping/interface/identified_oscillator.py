"""Oscillators, fitted by the linear model, with what it lacks."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import floor, log10, pi
from typing import Any

from gear_damping.explanation.evidence.noise import NoiseLevel, noise_of, weighted
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.release import released_at
from gear_damping.explanation.model.contradicted import contradicted, noise_above
from gear_damping.explanation.model.homogeneity import FEWEST, homogeneity
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome
from gear_damping.explanation.trials.efficient import weighed
from gear_damping.identification.free_vibration import LEAST_FALL, grows
from gear_damping.identification.observation import fit_record, has_spring, known_of, require_alike, require_fitted
from gear_damping.identification.oscillator.each_alone import each_alone, said_of_each
from gear_damping.identification.oscillator.estimates import Estimate
from gear_damping.identification.oscillator.fit import OscillatorFit, fit_oscillator
from gear_damping.identification.oscillator.linear_model import DAMPING, LAWS
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import WHOLE, Segments
from gear_damping.interface.base_reading import base_reading
from gear_damping.interface.far_from_stated import far_from_stated
from gear_damping.interface.identified_page import MOST_PANELS, estimate_rows, panel, residual_rows
from gear_damping.interface.lack_of_fit import lack_of_fit, sentence
from gear_damping.measurement.record import Channel, Measurement
from gear_damping.reporting import figures, tables
from gear_damping.simulation.solver_settings import Progress, Solver

NEWTONS = ("N*s/m", "N/m")  # units of what is not per unit of mass
STATED = ("force_gain", "stiffness")  # by the file, and fitted all the same
FOLLOWED = 50.0  # % of a signal, root mean square, that is left: an input late by a twelfth of a turn leaves as much
MOST_SAMPLES = 200_000  # beyond which the test of what is random takes longer than the fit
BEGUN_ANEW = (
    "no damping is told: the motion runs out of step with any ring-down and was begun anew in every segment. "
    "Something drives it that no channel holds (declare the force, or a `window` in which it dies away; where that is "
    "a random load, model=ambient_spectrum tells the damping), or its frequency changes with the amplitude"
)


NOT_FREE = "no damping is told: the motion was begun anew in every segment, since no one start leads through all of it"


@dataclass(frozen=True)
class Fitted:
    """A fitted linear oscillator with the records by role, the channel that responded, and its noise."""

    found: OscillatorFit
    roles: Mapping[str, Sequence[FitRecord]]
    channel: Channel
    noise: NoiseLevel


def linear_fit(measurement: Measurement, progress: Progress | None, solver: Solver | None) -> Fitted:
    """The linear oscillator fitted to the records that are for that.

    Raises:
        InputError: a record has no response that can be fitted, or some have an input that others lack.
    """
    require_fitted(measurement)
    known = known_of(measurement)
    spring = has_spring(known, measurement.base)
    fit = [fit_record(r, measurement.base, spring) for r in measurement.records if r.role in ("fit", None)]
    holdout = [fit_record(r, measurement.base, spring) for r in measurement.with_role("holdout")]
    require_alike([*fit, *holdout], str(measurement.source))
    fit, holdout, noise = noise_of(fit, holdout, measurement)
    roles = {"fit": weighted(fit, noise), "holdout": weighted(holdout, noise)}
    channels = {name: c for record in measurement.records for name, c in record.channels.items()}
    channel = channels[roles["fit"][0].observed.name]
    stated = Segments(measurement.segment_s, exact=True) if measurement.segment_s else None
    found = fit_oscillator(roles["fit"], roles["holdout"], progress, solver, known, stated)
    return Fitted(_weighed(found, measurement, roles["fit"], channel), roles, channel, noise)


def _weighed(
    found: OscillatorFit, measurement: Measurement, fit: Sequence[FitRecord], channel: Channel
) -> OscillatorFit:
    """The figures weighed by what is random in the residual, where nothing else is: only then its interval holds."""
    if found.fitted.prediction.residual.numel() > MOST_SAMPLES:
        return found
    better = weighed(*_explained(found, measurement, fit, channel))
    if better.whitened is None:
        return found
    return found.weighed(replace(better.fitted, prediction=better.whitened))


def _explained(
    found: OscillatorFit, measurement: Measurement, fit: Sequence[FitRecord], channel: Channel
) -> tuple[Outcome, Evidence]:
    """The fit and its records as an explanation has them."""
    problem, model = found.problem, found.problem.model
    hypothesis = Hypothesis(model.system, tuple(model.effects), found.given, tuple(problem.free))
    values = {name: float(value) for name, value in problem.unknowns.parameters(found.fitted.shared).items()}
    outcome = Outcome(hypothesis, problem, found.fitted, values, [], [])
    system = {"system": measurement.system, "base": measurement.base, "known": known_of(measurement)}
    evidence = Evidence(fit=tuple(fit), holdout=(), channel=channel, one_record=False, noise=problem.noise, **system)
    return outcome, replace(evidence, segments=found.segments)


def content_of(measurement: Measurement, fitted: Fitted) -> dict[str, Any]:
    """What stands in identification.json."""
    found, roles, channel = fitted.found, fitted.roles, fitted.channel
    content = _identification(found, measurement, roles, channel)
    lacking = lack_of_fit(found.predictions, roles["fit"], roles["holdout"], channel, fitted.noise)
    not_yet_free = _not_yet_free(roles["fit"], measurement)
    undamped = _undamped(found, roles["fit"], lacking)
    if undamped == BEGUN_ANEW and not_yet_free:
        undamped = NOT_FREE
    is_lacking = bool(lacking and lacking["significant"])
    differs = (is_lacking and _apart(fitted, measurement)) or _differing(found, measurement, roles["fit"], channel)
    said = {
        "differing": differs,
        "undamped": undamped,
        "not_yet_free": not_yet_free,
        "contradicted": (base_reading(measurement) if is_lacking or undamped else None)
        or contradicted(found.problem.free, found.fitted.shared.tolist(), _words_of_the_file(found, measurement))
        or _far_off(found, measurement)
        or noise_above(fitted.noise, found.rmse["fit"], channel),
    }
    return content | said | {"lack_of_fit": lacking and lacking | {"source": str(measurement.source)}}


def _words_of_the_file(found: OscillatorFit, measurement: Measurement) -> dict[str, str]:
    """The key of the file that states each parameter, by flat name: a damping may stand there as a ratio."""
    said = {flat: name for name, flat in LAWS.items() if name in measurement.parameters}
    return {name: said.get(name, name.split(".")[-1]) for name in found.given}


def _apart(fitted: Fitted, measurement: Measurement) -> str | None:
    """The frequency and the damping of every record, where each alone is followed and all together are not."""
    found, records = fitted.found, fitted.roles["fit"]
    left = sum(float((one.weight * found.first_residual(one)).square().sum()) for one in records)
    alone = each_alone(records, left, known_of(measurement))
    if not alone:
        return None
    return (
        f"one model does not follow all records, and one of its own follows each: {said_of_each(alone)}. A mass, a "
        "tension, a temperature or the mounting changed between them, or the frequency goes with the amplitude: "
        "identify them one by one, or let task=explain look for its name"
    )


def _differing(
    found: OscillatorFit, measurement: Measurement, fit: Sequence[FitRecord], channel: Channel
) -> str | None:
    """The damping ratio of every record, where they are not one; None where they are, or too few tell."""
    ratio, is_free = found.damping_ratio_percent, any(p.name == DAMPING for p in found.problem.free)
    is_known = bool(found.fitted.prediction.sensitivity.isfinite().all())
    if ratio is None or not is_free or not is_known or len(fit) < FEWEST:
        return None
    outcome, evidence = _explained(found, measurement, fit, channel)
    test = homogeneity(outcome, DAMPING.partition(".")[0], evidence)
    if test.holds:
        return None
    said = [f"{ratio.value * one:.2g} % in {name}" for name, one in zip(test.names, test.estimates, strict=True)]
    return (
        f"the damping ratio is not one for all records, about {', '.join(said)}: task=explain looks for a law of the "
        "amplitude, or for a damping of each"
    )


def _far_off(found: OscillatorFit, measurement: Measurement) -> str | None:
    """A stated stiffness or gain of the force that the records put far away, whatever its uncertainty."""
    fitted = {name.split(".")[-1]: one.value for name, one in found.parameters.items()}
    stated = {name: measurement.parameters[name].value for name in STATED if name in measurement.parameters}
    pairs = {name: (fitted[name], value) for name, value in stated.items() if name in fitted}
    return far_from_stated(pairs, "sign, unit and gain of the force and of the motion, and the value itself")


def _not_yet_free(fit: Sequence[FitRecord], measurement: Measurement) -> str | None:
    """What to leave out of records without an input that begin before their motion is free; None of others.

    By the stamps of the file, which are those that a `window` counts in.
    """
    waits = {record.name: released_at(record) / record.sampling_rate for record in fit}
    first = {record.name: float(record.time[0]) for record in measurement.records}

    def until(record: FitRecord) -> str:
        wait = record.begins + waits[record.name]
        return f"{record.name} before {first[record.name] + wait:.{max(0, 3 - floor(log10(wait)))}f} s"

    said = [until(record) for record in fit if waits[record.name]]
    if not said or any(map(grows, fit)):
        return None
    return f"the motion is not free from the start: leave out {', '.join(said)} (`window` or `slice` in the file)"


def _undamped(found: OscillatorFit, fit: Sequence[FitRecord], lacking: Mapping[str, Any] | None) -> str | None:
    """What it means where the records do not tell the damping from none; None where they do."""
    ratio, frequency = found.damping_ratio_percent, found.natural_frequency_hz
    if ratio is None or ratio.interval95[0] > 0:
        return None
    is_free, was_lost = not any(record.inputs for record in fit), found.segments != WHOLE and not found.segments.exact
    if is_free and was_lost:
        return BEGUN_ANEW
    text = f"no damping: these records do not tell it from none; it is at most {ratio.interval95[1]:.3g} %"
    if lacking and lacking["percent_of_signal"] > FOLLOWED:
        return f"{text}, and it follows little of them: check that every column and unit is what it is declared as"
    if not is_free:
        late = "an input that is late does that, and its `delay` in the file then tells it"
        return f"{text}, if this model is right: {late}"
    if all(map(grows, fit)):
        return (
            "no damping: the motion grows, so that something feeds it; a negative damping is not fitted, and the "
            "figures tell nothing of it"
        )
    nepers = 2 * pi * frequency.value * ratio.value / 100 * max(record.duration for record in fit)
    if nepers > LEAST_FALL:
        return text
    return (
        f"{text}. A motion that does not die away may be driven by what no channel holds, and its frequency is then "
        "that of the drive: declare the force, or a window behind its end"
    )


def table_of(content: dict[str, Any]) -> str:
    """The parameters with their intervals, and what is missing."""
    text, lacking = _table(content), content["lack_of_fit"]
    said = [content[key] for key in ("undamped", "not_yet_free", "differing", "contradicted")]
    said += [sentence(lacking) if lacking else None]
    return "\n\n".join([text.rstrip(), *filter(None, said)]) + "\n"


def _identification(
    found: OscillatorFit, measurement: Measurement, roles: Mapping[str, Sequence[FitRecord]], channel: Channel
) -> dict[str, Any]:
    channels = {record.name: record.channels for record in measurement.records}

    def told(record: FitRecord) -> dict[str, Any]:
        own = channels[record.name][record.observed.name]
        left = float(found.first_residual(record).square().mean().sqrt())
        return {"rmse": left / own.declared_factor, "unit": own.declared_unit}

    def residual(value: float | None) -> dict[str, Any] | None:
        return None if value is None else {"rmse": value / channel.declared_factor, "unit": channel.declared_unit}

    def plain(estimate: Estimate | None) -> dict[str, Any] | None:
        return None if estimate is None else asdict(estimate)

    records = {record.name: {"role": role, **told(record)} for role, listed in roles.items() for record in listed}
    return {
        "system": measurement.system,
        "method": "output_error",
        "channel": channel.name,
        "parameters": {name.split(".")[-1]: asdict(value) for name, value in found.parameters.items()},
        "damping_ratio_percent": plain(found.damping_ratio_percent),
        "natural_frequency_hz": plain(found.natural_frequency_hz),
        "log_decrement": plain(found.log_decrement),
        "residual": {"fit": residual(found.rmse["fit"]), "holdout": residual(found.rmse["holdout"])},
        "segment_s": found.segments.seconds or None,
        "own": found.own,
        "records": records,
        "converged": found.converged,
    }


def _table(content: dict[str, Any]) -> str:
    """The figures; without those that are over a frequency of which nothing is known, as it may be none."""
    named = {key: content[key] for key in ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")}
    frequency = content["natural_frequency_hz"]
    if frequency is not None and not frequency["interval95"][0] > 0:
        named = {}
    rows = estimate_rows({**named, **content["parameters"]}) + residual_rows(content["records"])
    is_si = any(entry["unit"] in NEWTONS for entry in content["parameters"].values())
    title = "identified by output error" + ("" if is_si else ", per unit of mass")
    if content["segment_s"]:
        title += f", in segments of {content['segment_s']:.3g} s"
    return tables.parameter_table(title, rows)


def figure_of(fitted: Fitted, content: dict[str, Any]) -> figures.Figure:
    """Measured and simulated records, with what was found."""
    found, roles, channel = fitted.found, fitted.roles, fitted.channel
    shown = (*roles["fit"][:MOST_PANELS], *roles["holdout"][-MOST_PANELS:])
    known, factor = content["records"], channel.declared_factor
    first = {one.name: found.predictions[one.name].chunk(len(one.channels))[0].numpy() for one in shown}
    panels = [panel(one, known[one.name]["role"], first[one.name], factor) for one in shown]
    stated = content["parameters"].items()
    text = [f"{key.replace('_', ' ')} {entry['value']:.4g} {entry['unit']}" for key, entry in stated]
    if zeta := content["damping_ratio_percent"]:
        text = [f"damping ratio {zeta['value']:.4g} % ({zeta['interval95'][0]:.4g} … {zeta['interval95'][1]:.4g})"]
        text.append(f"natural frequency {content['natural_frequency_hz']['value']:.5g} Hz")
    return figures.identification_figure(panels, content["residual"]["fit"]["unit"], text, channel.name)
