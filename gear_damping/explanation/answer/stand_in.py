"""Step 9c: does a cause keep its size beside something that has no name, or does it stand in for that?

The parameter-encompassing test (Mizon & Richard 1986, Econometrica 54): beside a family of forces or lines that by
itself takes more of what the model without the cause leaves, what really is there keeps its size. Where the family
can do most of what the cause does, a law in another form may lose its size too, and the test says nothing. One-sided:
what grows beside the family is no less there. And what takes less with more numbers explains nothing. A family that
takes less than a cause must to be one, of what is left beyond noise, is not what is missing either.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import hypot

import torch
from scipy.stats import norm
from torch import Tensor

from gear_damping.explanation.evidence.excess import ac_energy
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.gives_back import gives_back
from gear_damping.explanation.model.homogeneity import block_of, error_of
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.model.rig import strongest_frequencies
from gear_damping.explanation.model.two_modes import decay_time
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.statistics.bursts import BURST_KURTOSIS, kurtosis, pooled_kurtosis
from gear_damping.explanation.statistics.projector import Projector
from gear_damping.explanation.trials.assess import LINE_FAMILY, UNNAMED, orthonormal
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.explanation.trials.score import projected
from gear_damping.explanation.trials.unnamed import unnamed_columns
from gear_damping.physics.terms import ExtraStates

MOST_OF_IT = 0.5  # of a residual: a line that takes more is what is left
SWINGS_ON = "but `{}` does not die away within the records: a line looks the same."
NORMAL_KURTOSIS, OF_KURTOSIS = 3.0, 24.0  # of normal samples, and over their number its variance (Fisher 1930)
STRETCHES = 8  # of a record, most of which hold bursts where it is these; a decay is far from normal as a whole
GOES_ON = 3.0  # times the longest record: what swings for so long has lost a quarter of its size at its end


@dataclass(frozen=True)
class Alternative:
    """Forces or lines without a name.

    Args:
        name: What they are called.
        numbers: How many they take.
        project_out: What they leave of a signal out of which the model's parameters are projected already.
    """

    name: str
    numbers: int
    project_out: Callable[[Tensor], Tensor]


@dataclass(frozen=True)
class StandIn:
    """A cause in the place of something that has no name.

    Args:
        cause: The cause.
        alternative: What takes more than it.
        takes: Share that this takes of what the model without the cause leaves.
        cause_takes: Share that the cause takes of it.
        why: What gives it away.
    """

    cause: str
    alternative: str
    takes: float
    cause_takes: float
    why: str

    @property
    def sentence(self) -> str:
        """What is said of it."""
        more = "more" if self.takes > self.cause_takes else "about as much"  # with fewer numbers that is more
        return (
            f"but {self.alternative} takes {more} ({100 * self.takes:.3g} % of the residuals, `{self.cause}` "
            f"{100 * self.cause_takes:.3g} %), {self.why}: it stands in for something that has no name here."
        )


def stand_ins(state: State) -> Iterator[StandIn]:
    """The causes that stand in for something else, one by one, since each takes a fit to tell.

    None where nothing is visible beside all of them.
    """
    if state.left is None or not state.left.visible or not state.outcome.is_finite:
        return
    found = (_stand_in(cause, state) for cause in state.accepted)
    yield from (one for one in found if one is not None)


def swinging_on(state: State) -> Iterator[str]:
    """The names of causes that swing by themselves and do not die away.

    A motion that goes on all through the records with a start of its own in each is as well a line that somebody
    else drives, and no mode is without damping. What gives back within them what it took from the first mode is none:
    a line takes nothing.
    """
    evidence = state.bench.evidence
    longest = sum(one.duration for one in evidence.records) if evidence.one_record else evidence.duration
    for cause in state.accepted:
        effect = cause.effect
        if isinstance(effect, ExtraStates):
            goes_on = decay_time(state.outcome, effect) > GOES_ON * longest
            if goes_on and not gives_back(effect, state.outcome, evidence):
                yield effect.name


def is_untold(state: State) -> bool:
    """Whether there was no time to ask of some cause what it stands in for."""
    return any(_asked_of(cause) in state.bench.budget.not_tried for cause in state.accepted)


def _asked_of(cause: Accepted) -> str:
    return f"whether {cause.name} stands in for something else"


def shape_without_name(state: State) -> str:
    """The family without a name that is most visible beside the nominal model, in words; a line before all others.

    A line takes few numbers, and others may follow it. Empty where none is visible, or where it is too small a part of
    the signal to matter. Bursts all along the records are none of them: an autoregression takes them for noise.
    """
    if _comes_in_bursts(state):
        return "bursts, after each of which the motion rings"
    if state.seen is None or not state.seen.visible:
        return ""
    seen = state.seen.visible
    shown = {name: value for name, value in seen.by_name.items() if name.startswith(UNNAMED) and seen.shows(name)}
    if not shown:
        return ""
    largest = LINE_FAMILY if LINE_FAMILY in shown else max(shown, key=shown.get)
    evidence, nominal = state.bench.evidence, state.nominal
    line = strongest_line(nominal, evidence) if largest == LINE_FAMILY else None
    left = sum(float(residual.square().sum()) for residual in nominal.fit_residuals)
    percent = 100 * (line.share if line else state.seen.taken) * left / sum(map(ac_energy, evidence.fitted))
    if percent < state.bench.settings.least_excess:
        return ""
    if largest == LINE_FAMILY:
        return line.name if line else _line_in_segments(nominal, evidence)
    return f"some {largest.removeprefix(UNNAMED)}"


def _comes_in_bursts(state: State) -> bool:
    """Whether what the nominal model leaves is more than the noise of the sensor and comes in bursts all along.

    Most stretches of the records hold them, as far as so few independent samples can show it.
    """
    settings = state.bench.settings
    if pooled_kurtosis((left - left.mean()).numpy() for left in state.nominal.fit_residuals) <= BURST_KURTOSIS:
        return False
    parts = [part for residual in state.nominal.fit_residuals for part in residual.chunk(STRETCHES)]
    errors = [(OF_KURTOSIS * state.noise.correlation / len(part)) ** 0.5 for part in parts]
    heavy = [
        kurtosis((part - part.mean()).numpy()) > NORMAL_KURTOSIS + settings.standard_errors * error
        for part, error in zip(parts, errors, strict=True)
    ]
    if 2 * sum(heavy) <= len(parts):
        return False
    beyond = state.beyond_sensor(state.nominal)
    return beyond.misfit > settings.small_misfit and beyond.percent > settings.least_excess


def line_left(state: State) -> str:
    """What is said of a line that is most of what is left beside the causes; empty where there is none."""
    if not state.accepted or state.left is None or not state.left.visible.shows(LINE_FAMILY):
        return ""
    line = strongest_line(state.outcome, state.bench.evidence)
    if line is None or line.share < MOST_OF_IT:
        return ""
    return f"Of what is left, {100 * line.share:.0f} % is {line.name}."


def _line_in_segments(nominal: Outcome, evidence: Evidence) -> str:
    """A line where records are cut, none of whose segments holds one of its own: by the peak of what is left."""
    natural = natural_frequency_hz(nominal.hypothesis.model, nominal.flat_given()) if evidence.has_spring else 0.0
    found = strongest_frequencies(list(zip(evidence.fitted, nominal.fit_residuals, strict=True)), natural)
    return f"a line near {found[0]:.3g} Hz" if found else LINE_FAMILY.removeprefix(UNNAMED)


def _stand_in(cause: Accepted, state: State) -> StandIn | None:
    """What a cause stands in for; of several families the one that takes most."""
    bench, without = state.bench, _without(cause, state)
    if without is None or not without.is_finite:
        return None
    project, left = projected(without)
    added = (without.fitted.prediction.residual - state.outcome.fitted.prediction.residual)[0].reshape(-1, 1)
    residual, change = project(left), project(torch.nn.functional.pad(added, (0, 0, 0, len(project.expected))))
    energy, total = float(change.square().sum()), float(residual.square().sum())
    if energy <= 0:
        return None
    cause_takes = float((change * residual).sum()) ** 2 / energy / total
    free = sum(parameter.name.startswith(cause.name + ".") for parameter in state.outcome.problem.free)
    block, found = block_of(without, bench.evidence), []
    beyond_noise = 1 - min(bench.noise_cost(without) / total, 1.0)
    by_itself = beyond_chance(cause_takes, free, len(added) / block)
    least = max(by_itself, bench.settings.taken_by_one * beyond_noise)
    for alternative in _alternatives(without, project, state):
        left, other = alternative.project_out(residual), alternative.project_out(change)
        takes = 1 - float(left.square().sum()) / total
        if beyond_chance(takes, alternative.numbers, len(added) / block) <= least:
            continue
        share = float(other.square().sum()) / energy
        why = f"with {alternative.numbers} numbers in the place of {free}" if alternative.numbers < free else ""
        size = _size_within(other, left, len(added), share, block, bench.settings)
        if size is not None:
            why = f"and beside it `{cause.name}` has {size:.2g} times the size"
        if why:
            found.append(StandIn(cause.name, alternative.name, takes, cause_takes, why))
    return max(found, key=lambda one: one.takes, default=None)


def _without(cause: Accepted, state: State) -> Outcome | None:
    """The model without a cause; where there is no time to fit it, as the search had it on its way, if it had."""
    if len(state.accepted) == 1:
        return state.nominal
    budget, known = state.bench.budget, state.passed_without(cause.name)
    if known is not None and budget.all_spent:
        return known
    return None if budget.refuses(_asked_of(cause), is_last=True) else state.bench.without(state.outcome, cause.name)


def beyond_chance(takes: float, numbers: int, blocks: float) -> float:
    """The share of residuals that so many numbers take, less what they take of any (Ezekiel 1930).

    Args:
        takes: The share.
        numbers: How many are fitted.
        blocks: Of residuals that are independent of each other; as few as there are numbers tell nothing.
    """
    free = blocks - 1 - numbers
    return 1 - (1 - takes) * (blocks - 1) / free if free > 0 else 0.0


def _size_within(
    change: Tensor, residual: Tensor, samples: int, share: float, block: int, settings: SearchSettings
) -> float | None:
    """The size of a cause beside a family, relative to that which was found; None where it may well be the same.

    Args:
        change: What the cause adds, the alternative projected out, (samples + n, 1).
        residual: What the alternative leaves, (samples + n, 1).
        samples: Those of the records.
        share: Of what the cause adds, that the alternative leaves.
        block: Samples over which residuals may be correlated.
        settings: Thresholds.
    """
    tolerance = settings.homogeneity_tolerance / max(share, 1e-300) ** 0.5
    if tolerance >= 1:  # so little is the cause's own that its absence, too, is as near as its form is known
        return None
    size = float((change * residual).sum() / change.square().sum())
    column, left_over = (signal[:samples, 0] for signal in (change, residual - size * change))
    chance = norm.sf((1 - size) / hypot(float(error_of(column, left_over, block)), tolerance))
    return size if chance < settings.homogeneity_level else None


def _alternatives(without: Outcome, project: Projector, state: State) -> Iterator[Alternative]:
    """All of them beside a model."""
    evidence = state.bench.evidence
    for name, columns in unnamed_columns(without, evidence).items():
        basis = orthonormal(project(torch.nn.functional.pad(columns, (0, 0, 0, len(project.expected)))))
        yield Alternative(
            f"some {name}", basis.shape[1], lambda signal, basis=basis: signal - basis @ (basis.T @ signal)
        )
    line = strongest_line(without, evidence)
    if line is not None:
        yield Alternative(line.name, line.degrees, project.with_nuisance(line.columns))
