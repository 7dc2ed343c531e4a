"""Records that a linear oscillator follows one by one and not together: not of one rig, or not of one state of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.estimates import Estimate
from gear_damping.identification.oscillator.fit import OscillatorFit, fit_oscillator
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.simulation.solver_settings import Solver

LEAVES = 0.5  # of what is left together: more, and most of it is missed in each record too
MOST = 12  # records that are fitted alone: a fit takes up to a second, and twelve figures fill a sentence


@dataclass(frozen=True)
class Alone:
    """What a record says by itself."""

    record: str
    natural_frequency_hz: Estimate
    damping_ratio_percent: Estimate | None


def each_alone(
    records: Sequence[FitRecord], left: float, known: Known, solver: Solver | None = None, leaves: float = LEAVES
) -> tuple[Alone, ...]:
    """The natural frequency and the damping of every record by itself, where that is what one model for all misses.

    The records alone leave a share of what is left together at most, half of it, and the 95 % intervals of two
    frequencies, or of two damping ratios, lie apart.

    Args:
        records: Those that were fitted together.
        left: Sum of squares that they leave of their first channel together, each by its weight.
        known: What is stated of the rig.
        solver: Settings of the solver.
        leaves: That share.

    Returns:
        One for each record; none where they are of one rig, are fewer than two or more than `MOST`, or have no spring.
    """
    if not 2 <= len(records) <= MOST:
        return ()
    fits = [fit_oscillator([record], known=known, solver=solver) for record in records]
    if any(fit.natural_frequency_hz is None for fit in fits):
        return ()
    apart = sum(_left(fit, record) for fit, record in zip(fits, records, strict=True))
    differ = _lie_apart([fit.natural_frequency_hz for fit in fits]) or _lie_apart(
        [fit.damping_ratio_percent for fit in fits]
    )
    if apart > leaves * left or not differ:
        return ()
    return tuple(
        Alone(record.name, fit.natural_frequency_hz, fit.damping_ratio_percent)
        for record, fit in zip(records, fits, strict=True)
        if fit.natural_frequency_hz
    )


def _lie_apart(found: Sequence[Estimate | None]) -> bool:
    """Whether the intervals of two of them do."""
    intervals = [one.interval95 for one in found if one is not None]
    return any(one[1] < other[0] or other[1] < one[0] for one, other in combinations(intervals, 2))


def said_of_each(found: Sequence[Alone]) -> str:
    """The figures of every record, as a part of a sentence."""

    def text(one: Alone) -> str:
        ratio = f" and {one.damping_ratio_percent.value:.3g} %" if one.damping_ratio_percent else ""
        return f"{one.natural_frequency_hz.value:.4g} Hz{ratio} in {one.record}"

    return ", ".join(map(text, found))


def _left(fit: OscillatorFit, record: FitRecord) -> float:
    return float((record.weight * fit.first_residual(record)).square().sum())
