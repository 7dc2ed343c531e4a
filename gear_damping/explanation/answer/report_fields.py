"""What explanation.json holds, as plain values."""

from collections.abc import Sequence
from math import log10
from typing import Any

from torch import Tensor

from gear_damping.explanation.answer import gain
from gear_damping.explanation.answer.judged import share_of_held_out
from gear_damping.explanation.answer.levels import damping_by_record, levels_by_record
from gear_damping.explanation.answer.next_experiment import confusable_beforehand, next_experiment
from gear_damping.explanation.answer.unexplained import unexplained_residual
from gear_damping.explanation.evidence.data_faults import sentences
from gear_damping.explanation.evidence.declared_units import rig_unit, unit_of
from gear_damping.explanation.evidence.excess import WHOLE, Excess, ac_energy
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import has_records, moves_without_one, wider_of_both
from gear_damping.explanation.model.homogeneity import by_record
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.nominal_gear_pair import is_standing
from gear_damping.explanation.model.own_phases import own_levels
from gear_damping.explanation.model.ringing import told_covariance
from gear_damping.explanation.report_schema import KEYS, SCHEMA_VERSION
from gear_damping.explanation.steps.judge import CONSISTENT, DATA_PROBLEM, LARGEST_SET, Judged, is_visible, statuses
from gear_damping.explanation.trials.assess import Assessment
from gear_damping.explanation.trials.random_part import Random
from gear_damping.explanation.trials.score import Score, best_by_effect
from gear_damping.measurement.record import Finding, Measurement
from gear_damping.physics.systems.traits import Trait

WHITE = 1.1  # sum of squared autocorrelations: with less of it noise is called white
RAN_AWAY = "its prediction of conditions that are left out ran away"


def of_faults(measurement: Measurement, faults: Sequence[Finding]) -> dict[str, Any]:
    """The content where the data were refused: no cause, and what to cure."""
    nothing = dict.fromkeys(KEYS)
    said = sentences(faults)
    return nothing | {
        "schema_version": SCHEMA_VERSION,
        "system": measurement.system,
        "verdict": DATA_PROBLEM,
        "sentences": ["The data are damaged, so no physical cause is named.", *said],
        "causes": [],
        "candidates": [],
        "not_observable": [],
        "records": {record.name: {"role": record.role} for record in measurement.records},
        "findings": _findings([*faults, *(f for f in measurement.findings if f not in faults)]),
    }


def of_casing(measurement: Measurement, found: dict[str, Any]) -> dict[str, Any]:
    """The content where a casing was heard: `found` holds the verdict, its sentences and the findings."""
    return dict.fromkeys(KEYS) | {
        "schema_version": SCHEMA_VERSION,
        "system": measurement.system,
        "causes": [],
        "candidates": [],
        "not_observable": [],
        "records": {record.name: {"role": record.role} for record in measurement.records},
        "findings": _findings(measurement.findings),
        **found,
    }


def of_search(measurement: Measurement, evidence: Evidence, noise: NoiseLevel, judged: Judged) -> dict[str, Any]:
    """The content of a finished search."""
    found, before, after = judged.found, judged.before, judged.after
    unit, factor = evidence.channel.declared_unit, evidence.channel.declared_factor
    first, last = found.nominal, found.outcome
    causes = _causes(judged, evidence)
    names = [name for cause in causes for name in (cause["name"], *cause["confusable_with"])]
    return {
        "schema_version": SCHEMA_VERSION,
        "system": measurement.system,
        "verdict": judged.verdict.word,
        "sentences": list(judged.verdict.sentences),
        "causes": causes,
        "misfit": {
            "before": before.misfit,
            "after": after.misfit,
            "floor": 1.0,
            "excess_percent": {
                "before": before.percent,
                "after": after.percent,
                "threshold": min(after.threshold, WHOLE),
            },
            "records": {
                name: {"before": before.per_record[name], "after": after.per_record[name]} for name in before.per_record
            },
        },
        "visible": _visible(found.seen, found.left),
        "random": _random(found.left, evidence),
        "residual": {
            "fit": _residual(first.fit_residuals, last.fit_residuals, unit, factor),
            "holdout": _residual(first.holdout, last.holdout, unit, factor),
            "segment_s": evidence.segments.seconds or None,
        },
        "parameters": gain.final_parameters(last, _known(judged, evidence), evidence),
        "gain": _gain(judged, evidence, noise),
        "noise": {
            "channel": evidence.channel.name,
            "value": noise.value / factor,
            "unit": unit,
            "by_record": {name: value / factor for name, value in noise.by_record.items()},
            "method": noise.method,
            "estimates_agree": noise.agree,
        },
        "candidates": _candidates(judged, evidence),
        "not_tried": list(judged.not_tried),
        "not_observable": _not_observable(found.first_scores, names, evidence),
        "next_experiment": next_experiment(names, evidence),
        "unexplained": None if judged.verdict.word == CONSISTENT else unexplained_residual(last, evidence),
        "records": _records(evidence, first, last, factor, unit),
        "calibration": {
            "converged": first.fitted.converged,
            "parameters": dict(first.values),
            "steps": _steps(judged, evidence),
        },
        "findings": _findings(measurement.findings),
        "casing": None,
    }


def _visible(seen: Assessment | None, left: Assessment | None) -> dict[str, Any] | None:
    """What the test of everything at once says of the nominal model, and of the one at the end."""
    if seen is None or left is None:
        return None
    laws = seen.random.laws
    return {
        "p": {"before": seen.visible.p, "after": left.visible.p},
        "statistic": {"before": seen.visible.statistic, "after": left.visible.statistic},
        "limit": seen.visible.limit,
        "level": seen.visible.level,
        "largest": {"before": seen.visible.largest, "after": left.visible.largest},
        "not_random": {"before": seen.taken, "after": left.taken},
        "draws": seen.visible.draws,
        "effective_blocks": seen.visible.effective_blocks,
        "whitening": [{"order": law.order, "coefficients": law.coefficients.tolist()} for law in laws],
        "by_name": seen.visible.by_name,
    }


def _random(left: Assessment | None, evidence: Evidence) -> dict[str, Any] | None:
    """The random part of the residuals, of the fitted records' AC variance, and what it looks like."""
    if left is None:
        return None
    records = evidence.fitted
    own = [r.response - r.response.mean() for r in records]
    variance = sum(float(r.square().sum()) for r in own) / sum(len(r) for r in own)
    share = left.random.variance / max(variance, 1e-300)
    return {
        "percent": 100 * share,
        "looks_like": _looks_like(left.random),
        "snr_db": -10 * log10(max(share, 1e-300)),
        "correlation": left.random.correlation,
    }


def _looks_like(random: Random) -> str:
    if random.loads:
        return "the motion that a random load makes, and the noise of the sensor"
    order = max((law.order for law in random.laws), default=0)
    return "white noise" if random.correlation < WHITE else f"coloured noise (autoregression of order {order})"


def _findings(findings: Sequence[Finding]) -> list[dict[str, Any]]:
    return [
        {"kind": f.kind, "message": f.message, "record": f.record, "channel": f.channel, "sample": f.sample}
        | {"severity": f.severity}
        for f in findings
    ]


def _steps(judged: Judged, evidence: Evidence) -> list[str]:
    before = judged.before
    ended = "converged" if judged.found.nominal.fitted.converged else "did not converge: take it with care"
    segments = (
        f"These records cannot be predicted from their start alone: they were fitted and scored in segments of "
        f"{evidence.segments.seconds:.3g} s, each from an initial state of its own."
    )
    beyond = f"{before.percent:.3g} % of the signal's variance beyond the noise"
    left = "less than the noise" if before.percent < 0 else beyond
    return [
        f"The nominal simulation was fitted first, so that no wrong parameter passes for physics; the fit {ended}.",
        f"On held-out records it leaves {left}; {_significant(before)}.",
        *([segments] if evidence.segments else []),
        *_of_standing_shafts(evidence),
    ]


def _significant(before: Excess) -> str:
    """From where on it tells something; a calibration may be too uncertain for that."""
    if before.threshold >= WHOLE:
        return "the calibration is too uncertain for them to tell that something is missing"
    return f"more than {before.threshold:.2g} % counts as significant"


def _of_standing_shafts(evidence: Evidence) -> list[str]:
    """What is stated of the change of the stiffness, which shafts that stand do not see."""
    unused = [name for name in ("contact_ratio", "mesh_stiffness_min") if name in evidence.parameters]
    if not unused or not (evidence.has(Trait.TEETH) and is_standing(evidence)):
        return []
    said = f"{' and '.join(unused)} of the file {'are' if len(unused) > 1 else 'is'} not used"
    return [f"The shafts stand, so that one stiffness is fitted: {said}."]


def _causes(judged: Judged, evidence: Evidence) -> list[dict[str, Any]]:
    """Accepted causes; where none was, the best of what was tried as a suggestion."""
    found, last = judged.found, judged.found.outcome
    covariances = _known(judged, evidence)
    resting = {end for score in found.first_scores for end in score.candidate.resting}
    listed = [
        {
            "name": cause.name,
            "parameters": gain.parameters_of(last, covariances, cause.name, evidence, resting),
            "excess_explained": cause.share,
            "confusable_with": [*cause.confusable, *cause.looks_like][: LARGEST_SET - 1],
            "status": statuses(judged.verdict.word),
            "fixed": _fixed(last, cause.name),
            "options": dict(cause.candidate.tried),
            **_by_record(last, cause.name, evidence),
        }
        for cause in found.accepted
    ]
    if not listed and judged.verdict.word != CONSISTENT:
        helping = (r for r in found.rejected if r.gain > 0 and r.is_seen_in_fit)
        for refit in [r for r in helping if _share(r.outcome, found.nominal) > 0][:1]:
            covariances = told_covariance(refit.outcome, evidence)
            own = gain.parameters_of(refit.outcome, covariances, refit.name, evidence, resting)
            alike = confusable_beforehand(found.first_scores, refit.name)[: LARGEST_SET - 1]
            share = _share(refit.outcome, found.nominal)
            listed.append(
                {"name": refit.name, "parameters": own, "excess_explained": share, "confusable_with": alike}
                | {"status": "suggested", "options": dict(refit.score.candidate.tried)}
                | _by_record(refit.outcome, refit.name, evidence)
            )
    return sorted(listed, key=lambda cause: -cause["excess_explained"])


def _known(judged: Judged, evidence: Evidence) -> Tensor:
    """How well the last model's coordinates are known, the scatter between records counted where noise is not all.

    It is not beside several causes, nor where something is left that has no name.
    """
    last = judged.found.outcome
    covariances = told_covariance(last, evidence)
    scatters = (_are_several(judged) or _is_conditional(judged)) and _may_scatter(judged)
    return wider_of_both(covariances, last) if scatters else covariances


def _is_conditional(judged: Judged) -> bool:
    """Whether something is left that has no name or is not random, or a fit has not converged."""
    is_more = bool(judged.found.accepted) and is_visible(judged.found.left)
    return judged.verdict.leaves_unnamed or is_more or not judged.found.outcome.fitted.converged


def _are_several(judged: Judged) -> bool:
    """Whether there are causes whose forms trade against each other, and records enough to show it."""
    return len(judged.found.accepted) > 1 and has_records(judged.found.outcome)


def _may_scatter(judged: Judged) -> bool:
    """Whether records are expected to agree: where a cause says that they differ, their scatter is no error."""
    return not own_levels(judged.found.outcome)


def _by_record(outcome: Outcome, cause: str, evidence: Evidence) -> dict[str, Any]:
    """The strength of a cause record by record; of one that has a level in each, by how much that is off the mean."""
    found = by_record(outcome, cause, evidence)
    differs = cause in own_levels(outcome)
    return found | {"per_record": levels_by_record(outcome, cause, evidence)} if differs else found


def _fixed(outcome: Outcome, cause: str) -> dict[str, float]:
    """Parameters of a cause that were tried and not fitted, as the order of a ripple, by own name."""
    free = {parameter.name.partition("[")[0] for parameter in outcome.hypothesis.free}
    own = {name: value for name, value in outcome.hypothesis.given.items() if name.startswith(cause + ".")}
    return {n.partition(".")[2]: v for n, v in own.items() if n not in free and not isinstance(v, tuple)}


def _share(outcome: Outcome, nominal: Outcome) -> float:
    """Share of the squared residual of left-out records that an outcome takes."""
    return 1 - outcome.left_out_cost / max(nominal.left_out_cost, 1e-300)


def _residual(before: Sequence, after: Sequence, unit: str, factor: float) -> dict[str, Any]:
    return {"before": gain.rmse(before) / factor, "after": gain.rmse(after) / factor, "unit": unit}


def _gain(judged: Judged, evidence: Evidence, noise: NoiseLevel) -> dict[str, Any]:
    first, last = judged.found.nominal, judged.found.outcome
    energy = sum(ac_energy(record) for record in evidence.held)
    floor = sum(len(r.stacked) * noise.by_record[r.name] ** 2 for r in evidence.held)
    conditional = _is_conditional(judged)
    missed = {
        "before": judged.verdict.leaves_unnamed or bool(judged.found.accepted),
        "after": judged.verdict.leaves_unnamed or (_may_scatter(judged) and (conditional or _are_several(judged))),
    }
    damping = {
        key: gain.damping_ratio(
            outcome,
            told_covariance(outcome, evidence),
            moves_without_one(outcome) if missed[key] else None,
        )
        for key, outcome in (("before", first), ("after", last))
    }
    whole = all(damping.values())
    if whole:
        damping = {key: found | {"velocity_unit": rig_unit("m/s", evidence)} for key, found in damping.items()}
        damping["by_record"] = damping_by_record(last, evidence)
        damping["conditional"] = conditional
        damping["bias_of_the_nominal"] = damping["before"]["value"] - damping["after"]["value"]
    return {
        "nrmse": {
            "before": gain.nrmse(first.holdout, evidence.held),
            "after": gain.nrmse(last.holdout, evidence.held),
            "floor": (floor / max(energy, 1e-300)) ** 0.5,
        },
        "damping_ratio_percent": damping if whole else None,
        "confirmed": _confirmed(judged) if judged.found.accepted else None,
    }


def _confirmed(judged: Judged) -> dict[str, Any]:
    """What the causes together add to the prediction of held-out records, and the share of these that they take."""
    share = share_of_held_out(judged.found)
    interval = [100 * end for end in share.interval95]
    return {"t": judged.confirmed_t, "percent": 100 * share.value, "interval95": interval}


def _candidates(judged: Judged, evidence: Evidence) -> list[dict[str, Any]]:
    """Every effect that was tried: its predicted gain on fitted records, and what a full fit took of left-out ones."""
    found = judged.found
    best_last = reversed(found.first_fits)  # of several forms of an effect the best one counts
    taken = {refit.name: _share(refit.outcome, found.nominal) for refit in best_last}
    accepted = {cause.name: cause.share for cause in found.accepted}
    alike = {name for cause in found.accepted for name in cause.confusable}
    best = best_by_effect(found.first_scores)

    def status(name: str) -> str:
        if name in accepted:
            return statuses(judged.verdict.word)
        if name in alike:
            return "confusable"
        return "not_tried" if name in judged.not_tried and name not in taken else "rejected"

    bounded = {refit.name for refit in found.first_fits if refit.is_at_bound}
    wild = {name: RAN_AWAY for name, share in taken.items() if share < -1 and name not in accepted}
    shares = {name: share for name, share in taken.items() if name not in wild} | accepted
    failed = wild | found.failed
    return [
        {"name": name, "promised": score.gain, "share": shares.get(name), "status": status(name)}
        | {"at_bound": name in bounded, "failed": failed.get(name) or score.failed or None}
        for name, score in best.items()
    ]


def _not_observable(scores: Sequence[Score], named: Sequence[str], evidence: Evidence) -> list[dict[str, Any]]:
    """Effects that were not found, with the smallest size that these data would have shown."""
    best: dict[str, Score] = {}
    for score in scores:
        name = score.candidate.name
        if name not in best or score.smallest < best[name].smallest:
            best[name] = score
    listed = []
    for name, score in best.items():
        if name in named:
            continue
        place = score.candidate.strengths[0]
        flat = score.candidate.hypothesis.common[place].name
        unit = unit_of(flat.partition("[")[0], score.candidate.hypothesis.model, evidence)
        listed.append({"name": name, "parameter": flat, "smallest": score.smallest, "unit": unit})
    return listed


def _records(evidence: Evidence, first: Outcome, last: Outcome, factor: float, unit: str) -> dict[str, Any]:
    found = {}
    for role, records, before, after in (
        ("fit", evidence.fit, first.fit_residuals, last.fit_residuals),
        ("holdout", evidence.holdout, first.holdout, last.holdout),
    ):
        for record, old, new in zip(records, before, after, strict=True):
            found[record.name] = {
                "role": role,
                "samples": len(record.response),
                "rmse": {"before": gain.rmse([old]) / factor, "after": gain.rmse([new]) / factor, "unit": unit},
            }
    return found
