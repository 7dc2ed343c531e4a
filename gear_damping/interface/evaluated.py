"""How good estimators are on simulated runs whose damping is known, beside what the runs hold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist
from time import perf_counter
from typing import Any

import torch
from matplotlib.figure import Figure
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.asked import estimates_of
from gear_damping.identification.bench import CLEAN
from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.identification.estimators.base import Recorded
from gear_damping.identification.evaluation import scores
from gear_damping.identification.free_vibration import Turning
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.seeding import seeded_generator
from gear_damping.interface.arguments import levels, refuse_no_flag
from gear_damping.interface.estimator import ClassicalEstimator, Estimator, NetworkEstimator
from gear_damping.interface.simulated import Simulation, refuse_other_runs, refuse_rest
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.reporting.evaluation import evaluation_figure, evaluation_table
from gear_damping.schema.values import Number, Problems
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.sampling import whole_number_problems

SEED = Number(0, whole=True)  # of what is drawn
NOTHING = (float("nan"),) * 3  # of a record that does not suit an estimator: ratio and ends of its interval
# Width of a Gaussian's 90 % interval over that of its 95 % one.
NARROWER = NormalDist().inv_cdf(0.95) / NormalDist().inv_cdf(0.975)


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What estimators said of the same noisy records.

    Args:
        content: `test_runs`, and `snr_db`: by level of noise `bound_percent`, the root mean square of the bounds, and
            `estimators`: by name `rmse_percent`, `median_relative_error`, `p90_relative_error`, `ratio_to_bound`,
            `typical_ratio`, `rmse_to_bound`, `skill`, `coverage90`, `answered` (records that suit it),
            `seconds_per_record`, and of a network that knows its training `strange`, the share of records unlike it.
    """

    content: Mapping[str, Any]

    def table(self) -> str:
        """A row for every level of noise and estimator, as Markdown."""
        return evaluation_table(self.content)

    def plot(self) -> Figure:
        """Error of every estimator against the noise, above the bound."""
        return evaluation_figure(self.content)

    def __repr__(self) -> str:
        return self.table()

    def _repr_markdown_(self) -> str:
        return self.table()


def evaluate(
    estimators: Mapping[str, Estimator],
    runs: Simulation,
    *,
    snr_db: float | Sequence[float] = (CLEAN,),
    bound: bool = True,
    seed: int = 0,
) -> Evaluation:
    """Ask estimators about the same noisy records of simulated runs.

    Args:
        estimators: By the name that the table gives them: of `load_estimator` or `estimator`.
        runs: As `simulate` gives them, with the damping ratios that are true: of all damping laws together, and for
            networks, as they learn it, of the laws that state one.
        snr_db: Levels of the response above white noise, about the response's mean, run by run.
        bound: Whether the Cramer-Rao bound of the runs is worked out, displacement and velocity at the start unknown.
        seed: Of the noise.

    Raises:
        InputError: no estimator is named, nothing moves, the runs have no damping ratio, or a network was trained on
            another kind of record.
    """
    if not isinstance(estimators, Mapping):
        rule, remedy = "must be named", "for example {'mine': gd.load_estimator(PATH)}"
        raise InputError(Problem("estimators", rule, repr(estimators), remedy))
    if not estimators:
        raise InputError(Problem("estimators", "none is named", {}, "for example {'mine': gd.load_estimator(PATH)}"))
    refuse_other_runs(runs)
    Problems(whole_number_problems("seed", seed, SEED)).raise_any()
    refuse_no_flag("bound", bound)
    seed = int(seed)
    _require_alike(estimators, runs)
    refuse_rest(runs.runs)
    _refuse_without_ratio(runs.runs)
    signals = runs.runs.response
    found = {}
    for snr in levels("snr_db", snr_db):
        noise = signals.std(-1, correction=0) * 10 ** (-snr / 20)
        drawn = torch.randn(signals.shape, generator=seeded_generator(seed, "noise", str(snr)), dtype=signals.dtype)
        limit = _limit(runs.runs, noise) if bound and snr < CLEAN else None
        found[f"{snr:g}"] = _level(estimators, runs.runs, signals + noise[:, None] * drawn, limit)
    return Evaluation({"test_runs": len(runs), "snr_db": found})


def _refuse_without_ratio(runs: Runs) -> None:
    """Refuse runs of which no damping ratio is true.

    Raises:
        InputError: it says which law has none, or that there is none.
    """
    by_law, nameless = runs.damping_ratio_by_law, runs.laws_without_ratio
    if by_law and not nameless:
        return
    lacking = f"{' and '.join(nameless)} has none that could be worked out" if by_law else "there is no damping law"
    rule = f"have no damping ratio that an answer could be held to: {lacking}"
    remedy = "give the model a damping law, a linear stiffness, and an amplitude that is that of the motion"
    raise InputError(Problem("runs", rule, remedy=remedy))


def _require_alike(estimators: Mapping[str, Estimator], runs: Simulation) -> None:
    """Refuse networks of other records.

    Raises:
        InputError: of each that another system, rate or longer records were trained on.
    """
    problems = []
    for name, one in estimators.items():
        if not isinstance(one, NetworkEstimator):
            continue
        trained, system = one.module.data, runs.model.system
        for problem in one.trained_on.problems(system.name, system.response, one.trained_on.unit):
            problems.append(replace(problem, key=f"{name}.{problem.key}"))
        if trained["sampling_rate"] != runs.sampling_rate:
            rule = f"was trained at {trained['sampling_rate']:g} Hz, and these runs have {runs.sampling_rate:g} Hz"
            problems.append(Problem(name, rule, remedy=f"sampling_rate={trained['sampling_rate']:g}"))
        if trained["window"] > len(runs.time):
            rule = f"sees {trained['window']} samples at once, and runs have {len(runs.time)}"
            problems.append(Problem(name, rule, remedy=f"n_samples={trained['window']}"))
    if problems:
        raise InputError(problems)


def _limit(runs: Runs, noise: Tensor) -> Tensor:
    """Standard deviations of the damping ratio that the bound leaves, %, (runs,)."""
    return cramer_rao(runs, [DAMPING_RATIO], noise).deviation(DAMPING_RATIO)


def _level(estimators: Mapping[str, Estimator], runs: Runs, records: Tensor, limit: Tensor | None) -> dict[str, Any]:
    """Every estimator, and the mean of what is true, on records (runs, time).

    A network is held to what it learns, the ratio of the laws that state one, and any other to that of all laws.
    """
    true, learned = runs.damping_ratio_percent.double(), runs.stated_ratio_percent.double()
    mean = float(true.mean())
    found = {}
    for name, one in estimators.items():
        begun = perf_counter()
        said = _said(one, runs, records)
        seconds = (perf_counter() - begun) / len(true)
        own = learned if isinstance(one, NetworkEstimator) else true
        found[name] = _scored(own, said, limit, mean) | {"seconds_per_record": seconds} | _strange(one, records)
    nothing = Estimates.without_interval(torch.full_like(true, mean))
    found["mean"] = _scored(true, nothing, limit, mean) | {"seconds_per_record": 0.0}
    shown = None if limit is None else float(limit.square().mean().sqrt())
    return {"bound_percent": shown, "estimators": found}


def _strange(one: Estimator, records: Tensor) -> dict[str, float]:
    """The share of records that a network calls unlike its training; nothing where it cannot tell."""
    like = one.module.components if isinstance(one, NetworkEstimator) else None
    if like is None or records.shape[1] < like.samples:
        return {}
    return {"strange": float(like.strange(records).double().mean())}


def _scored(true: Tensor, said: Estimates, limit: Tensor | None, mean: float) -> dict[str, Any]:
    """Figures over the records that suit the estimator; None each where there is none."""
    kept = said.ratio.isfinite()
    picked = Estimates(said.ratio[kept], said.low[kept], said.high[kept])
    if not bool(kept.any()):
        return dict.fromkeys(scores(true, Estimates.without_interval(true), limit, mean)) | {"answered": 0}
    own = None if limit is None else limit[kept]
    return dict(scores(true[kept], picked, own, mean)) | {"answered": int(kept.sum())}


def _said(one: Estimator, runs: Runs, records: Tensor) -> Estimates:
    if isinstance(one, NetworkEstimator):
        found = estimates_of(one.module, records)
        return Estimates(found.ratio.double(), found.low.double(), found.high.double())
    if not isinstance(one, ClassicalEstimator):
        raise InputError(Problem("estimators", "is no estimator of records", type(one).__name__, "gd.load_estimator"))
    each = [_of_record(one, recorded) for recorded in _as_recorded(runs, records)]
    return Estimates(*(torch.tensor(column, dtype=torch.float64) for column in zip(*each, strict=True)))


def _as_recorded(runs: Runs, records: Tensor) -> list[Recorded]:
    """Records as estimators of one record meet them: nothing of the rig is told but what turns in it."""
    turned = runs.angles.get("pinion_angle")
    system = type(runs.model.system)
    found = []
    for number, values in enumerate(records):
        turning = None
        if turned is not None:
            teeth = tuple(float(runs.values[name][number]) for name in ("n_teeth_pinion", "n_teeth_gear"))
            turning = Turning(teeth[0] * turned[number].numpy(), teeth)
        record = FitRecord(f"run {number + 1}", values.double(), runs.sampling_rate)
        found.append(Recorded(record, system, Known({}, {}), turning))
    return found


def _of_record(one: ClassicalEstimator, recorded: Recorded) -> tuple[float, float, float]:
    """Ratio and the ends of the 90 % interval, from the 95 % one as of a normal distribution."""
    said = one.tell(recorded)
    if said.damping_ratio_percent is None or said.interval95 is None:
        return NOTHING
    ratio = said.damping_ratio_percent
    low, high = (ratio + NARROWER * (end - ratio) for end in said.interval95)
    return ratio, low, high
