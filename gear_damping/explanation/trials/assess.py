"""Step 4: what is random in the residuals, and is anything in them that is not?"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import log

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, natural_frequency_hz
from gear_damping.explanation.statistics.family_wise import (
    Effect,
    Lines,
    Residual,
    Visible,
    block_numbers,
    cube_root,
    family_wise,
)
from gear_damping.explanation.statistics.projector import Projector
from gear_damping.explanation.statistics.tall import directions
from gear_damping.explanation.trials.innovations import load_errors, random_loads
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.explanation.trials.random_part import Random, Whitener, random_part
from gear_damping.explanation.trials.score import Score, projected
from gear_damping.explanation.trials.unnamed import unnamed_columns

COLUMNS_PER_SAMPLE = 0.2  # at most so many columns are taken out of white noise, whose variance then stays known,
SHOWN_PER_SAMPLE = 0.05  # and so many before the colour of the noise is fitted, which they take with them
STANDS_OUT = 3.0  # standard deviations of a normal variable: noise alone reaches them once in 700 times
INDEPENDENT = 1e-6  # of the largest: a direction of an effect, less the nuisance, that counts
ALIKE = 1e-6  # of the largest eigenvalue: below it a direction repeats others
COLUMNS_AT_ONCE = 64  # are made white together
MOST_COLUMNS = 400  # are taken out at once: those that take most, as the time goes with their square
LONGEST_BLOCK = 2.0  # natural periods, over which a residual is taken to be correlated at most
MOST_BLOCKS = 2000  # of all records: more only take time, where that makes none of them longer than that
CORRELATION_TIMES = 3.0  # of the whitened residual in a block
LARGEST_LAG = 50  # samples over which the correlation of the whitened residual is summed
LINES_OVER = 4.0  # natural frequencies up to which lines are looked for
UNNAMED = "unnamed: "  # before the names of families
LINE_FAMILY = UNNAMED + "a line at some frequency"


@dataclass(frozen=True)
class Assessment:
    """What residuals hold.

    Args:
        visible: The test of what is not random.
        random: What is; where nothing is visible, all that is left less the nuisance.
        taken: Share of the residual's energy, whitened or as it is, that effects and families take beyond chance.
    """

    visible: Visible
    random: Random
    taken: float


def assessed(outcome: Outcome, scores: Sequence[Score], evidence: Evidence, families: bool = True) -> Assessment | None:
    """What the residuals of the fitted records hold; None beside a model that runs away.

    The random part is what is left with the nuisance and what would take a large part of it projected out, and where
    something is visible in that, with all that is; and with the strongest line where that tells more
    (Schwarz 1978), which a narrow colour would swallow. Taking out every effect that could be there would
    take the colour of the noise with them, and noise alone would then look like something in short records.

    Args:
        outcome: The fitted model.
        scores: Of every effect beside it.
        evidence: The records.
        families: Whether families without a name stand in the same test.
    """
    problem, sensitivity = outcome.problem, outcome.fitted.prediction.sensitivity[0]
    if not bool(sensitivity.isfinite().all()):
        return None
    project, residual = projected(outcome)
    shapes = unnamed_columns(outcome, evidence) if families else {}
    unnamed = {UNNAMED + name: _padded(columns, project) for name, columns in shapes.items()}
    named = {score.candidate.name: score.columns for score in reversed(scores) if score.columns.shape[1]}
    orthogonal, count = project(residual), problem.response.weights.numel()
    nameless = cache(lambda: {name: orthonormal(project(columns)) for name, columns in unnamed.items()})
    known, line = cache(lambda: random_loads(outcome)), cache(lambda: strongest_line(outcome, evidence))

    errors = cache(lambda: load_errors(outcome, evidence.records))

    def looked_at(random: Random) -> Assessment:
        white = Whitener(random, outcome)
        if random.is_white:  # out of all the nuisance is projected as they are
            effects = _effects(scores, nameless())
            return _tested(white.padded(orthogonal)[:, 0], effects, project, white, outcome, evidence.settings.level)
        slopes = white(sensitivity.flatten(0, 1)).reshape(sensitivity.shape)
        whitened = Projector(slopes, project.expected, project.slope)
        seen = whitened(white.padded(residual))[:, 0]
        effects = _effects(scores, unnamed, lambda columns: whitened(white.padded(columns)))
        return _tested(seen, effects, whitened, white, outcome, evidence.settings.level)

    def random_in(left: Tensor, taken: float) -> Random:
        found = replace(random_part(left[:count, 0], taken, outcome, known), errors=errors())
        if not found.is_coloured or (strongest := line()) is None:
            return found
        apart = random_part(strongest.taken_out_of(left[:count, 0]), taken + strongest.degrees, outcome, known)
        is_better = apart.deviance + strongest.degrees * log(count) < found.deviance
        return replace(apart, errors=errors()) if is_better else found

    large = {s.candidate.name for s in scores if s.gain > evidence.settings.random_share}
    taken_out = [columns for name, columns in named.items() if name in large]
    found = looked_at(random_in(*_without(orthogonal, taken_out, SHOWN_PER_SAMPLE)))
    if not found.visible:
        return replace(found, random=random_in(orthogonal, 0.0)) if taken_out else found
    if found.taken > evidence.settings.random_share:  # beside so much the random part is no noise yet
        return found
    shown = [columns for name, columns in named.items() if found.visible.shows(name)]
    shown += [columns for name, columns in nameless().items() if found.visible.shows(name)]
    left, taken = _without(orthogonal, shown, SHOWN_PER_SAMPLE)
    again = looked_at(random_in(left, taken))
    if not again.visible:
        return replace(again, random=random_in(orthogonal, 0.0))
    share = 1 - float(left.square().sum()) / max(float(orthogonal.square().sum()), 1e-300) - taken / count
    return replace(again, taken=max(again.taken, share))  # a colour that is fitted to an effect hides its part


def _effects(
    scores: Sequence[Score], unnamed: Mapping[str, Tensor], form: Callable[[Tensor], Tensor] | None = None
) -> list[Effect]:
    """Every candidate that does something, and the families without a name; columns brought to a form span the same."""
    shown = [score for score in scores if score.columns.shape[1]]
    columns = [*(score.columns for score in shown), *unnamed.values()]
    columns = columns if form is None else [orthonormal(one) for one in _formed(columns, form)]
    named, nameless = columns[: len(shown)], columns[len(shown) :]
    found = [Effect(s.candidate.name, own, bool(s.candidate.non_nested)) for s, own in zip(shown, named, strict=True)]
    return found + [Effect(name, own) for name, own in zip(unnamed, nameless, strict=True)]


def _formed(columns: Sequence[Tensor], form: Callable[[Tensor], Tensor]) -> Iterator[Tensor]:
    """All columns brought to a form, many at once, as that costs hardly more of many than of one; never all of them."""
    chunks: list[list[Tensor]] = [[]]
    for one in columns:
        if sum(other.shape[1] for other in chunks[-1]) >= COLUMNS_AT_ONCE:
            chunks.append([])
        chunks[-1].append(one)
    for chunk in filter(None, chunks):
        yield from form(torch.cat(chunk, 1)).split([one.shape[1] for one in chunk], 1)


def _tested(
    seen: Tensor, effects: list[Effect], project: Projector, white: Whitener, outcome: Outcome, level: float
) -> Assessment:
    """The test on whitened signals, (samples + n,)."""
    problem, count = outcome.problem, outcome.problem.response.weights.numel()
    rows = problem.response.weights.reshape(-1, problem.response.length)
    samples = float(white.used.sum())
    nuisance = project.nuisance
    free = samples - nuisance.shape[1]
    left, taken = _without_what_shows(seen.unsqueeze(1), [effect.columns for effect in effects], free)
    variance = float(left.square().sum()) / max(free - taken, 1.0)
    length = _block_length(seen[:count].reshape(rows.shape), outcome)
    blocks = block_numbers([problem.response.length] * len(rows), length)
    blocks = torch.cat([blocks, torch.full((len(seen) - count,), int(blocks.max()) + 1)])
    lines = _lines(seen[:count].reshape(rows.shape), white.used, variance, outcome)
    visible = family_wise(Residual(seen, blocks, variance, nuisance), effects, lines, level=level)
    total = float(seen.square().sum())
    share = (total - float(left.square().sum()) - taken * variance) / max(total, 1e-300)
    return Assessment(visible, white.random, max(share, 0.0))


def _block_length(rows: Tensor, outcome: Outcome) -> list[int]:
    """Samples of a block by row (record and channel): correlation times of the whitened residual, within periods."""
    problem = outcome.problem
    spectrum = torch.fft.rfft(rows, n=2 * rows.shape[1]).abs().square().sum(0)
    covariance = torch.fft.irfft(spectrum)[: min(LARGEST_LAG, rows.shape[1])]
    shares = covariance / covariance[0].clamp(min=1e-300)
    negative = (shares <= 0).nonzero().flatten()
    stop = int(negative[0]) if len(negative) else len(shares)
    correlated = 1 + 2 * float(shares[1:stop].sum())
    least = max(CORRELATION_TIMES * correlated, rows.numel() / MOST_BLOCKS)
    frequency, found = natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given()), []
    for record in problem.records:
        longest = LONGEST_BLOCK * record.sampling_rate / max(frequency, 1e-9)
        found += [max(1, round(min(least, longest)))] * len(problem.response.channels)
    return found


def _lines(rows: Tensor, used: Tensor, variance: float, outcome: Outcome) -> list[Lines]:
    """Power of the whitened residual at every frequency, summed over records of one length and rate."""
    problem = outcome.problem
    rates = {record.sampling_rate for record in problem.records}
    if len(rates) > 1:
        return []
    power = torch.fft.rfft(rows).abs().square() / used.sum(1, keepdim=True).clamp(min=1) * 2
    kept = power[used.sum(1) > 0.5 * used.shape[1]].sum(0) / variance
    frequency = torch.fft.rfftfreq(rows.shape[1], 1 / rates.pop())
    limit = LINES_OVER * natural_frequency_hz(outcome.hypothesis.model, outcome.flat_given())
    inside = (frequency > 0) & (frequency < limit)
    degrees = 2.0 * int((used.sum(1) > 0.5 * used.shape[1]).sum())
    return [Lines(LINE_FAMILY, kept[inside], degrees)] if bool(inside.any()) and degrees else []


def _padded(columns: Tensor, project: Projector) -> Tensor:
    return torch.nn.functional.pad(columns, (0, 0, 0, len(project.expected)))


def orthonormal(columns: Tensor) -> Tensor:
    """Columns that span the same; the sign of a single one is kept."""
    if columns.shape[1] == 1:
        size = columns.norm()
        return columns / size if float(size) > 0 else columns[:, :0]
    basis, sizes = directions(columns, INDEPENDENT)
    return basis[:, sizes > INDEPENDENT * sizes[:1]]


def _without_what_shows(signal: Tensor, bases: Sequence[Tensor], free: float) -> tuple[Tensor, float]:
    """`signal` (samples, 1) without the bases that take more of it than chance would, and how many columns these are.

    Of bases chosen by what they take, those of noise take more than their number, and the variance of the rest would
    be too small.

    Args:
        signal: White but for what is in it.
        bases: Orthonormal columns of each.
        free: Degrees of freedom of the signal.
    """
    left, count, out = signal, 0.0, []
    waiting = [basis for basis in bases if basis.shape[1]]
    while waiting:
        variance = float(left.square().sum()) / max(free - count, 1.0)
        shown = [_stands_out(basis, left, variance) for basis in waiting]
        if not any(shown):
            break
        out += [basis for basis, one in zip(waiting, shown, strict=True) if one]
        waiting = [basis for basis, one in zip(waiting, shown, strict=True) if not one]
        left, count = _without(signal, out)
    return left, count


def _stands_out(basis: Tensor, signal: Tensor, variance: float) -> bool:
    """Whether a signal has more on orthonormal columns than noise of a variance has."""
    width, energy = basis.shape[1], float((basis.T @ signal).square().sum())
    return float(cube_root(torch.tensor(energy), width * max(variance, 1e-300), width)) > STANDS_OUT


def _without(signal: Tensor, bases: Sequence[Tensor], share: float = COLUMNS_PER_SAMPLE) -> tuple[Tensor, float]:
    """`signal` (samples, 1) with all bases projected out, or those that take most if they are too many; and how many.

    At most a `share` of as many columns as there are samples is taken out.
    """
    most = min(int(share * len(signal)), MOST_COLUMNS)
    gains = sorted(bases, key=lambda b: -float((b.T @ signal).square().sum()) / max(b.shape[1], 1))
    chosen, count = [], 0
    for basis in gains:
        if count + basis.shape[1] <= most:
            chosen, count = [*chosen, basis], count + basis.shape[1]
    if not count:
        return signal, 0.0
    joined = torch.cat(chosen, 1)
    sizes, turned = torch.linalg.eigh(joined.T @ joined)
    kept = sizes > ALIKE * sizes[-1]
    sizes, turned = sizes[kept], turned[:, kept]
    pull = turned.T @ (joined.T @ signal)
    return signal - joined @ (turned @ (pull / sizes.unsqueeze(1))), float(len(sizes))
