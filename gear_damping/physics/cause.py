"""What an effect says of itself as a possible cause of what a simulation misses."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Experiment = Literal["torque", "speed", "torque_channel", "bearing", "remount", "ring_down", "amplitude", "reversal"]


@dataclass(frozen=True)
class Recipe:
    """One way in which an effect is switched on gradually.

    Sizes are in natural units, unless `in_si`; None stands for the declared default.

    Args:
        strengths: Parameters that are neutral without the effect, with the size of a first step.
        phases: Phase parameter of each strength that turns with a shaft.
        scanned: Other parameters with the value that is tried; freed in the full fit.
        within: Narrower bounds by flat name: beyond them it costs steps and shows no more.
        timed: As `scanned` for times and frequencies, in durations of the longest record and cycles of it.
        beside: Parameters of other effects that are fitted with it; with the value at which the full fit begins,
            where they have no size yet.
        stood_in: Parameters, by flat name, that bend far off where the effect is missing, with the factor by which
            they are moved for further starts of the full fit.
        fixed: Parameters that stay.
        neutral: Value of the strengths without the effect.
        presence: The effect has no neutral value (a stiffness that was rigid): it is tried as a whole, at the
            size of its strength, with everything that is scanned free from the start.
        in_si: Whether the sizes are in SI.
        options: Options of the effect.
        length: Elements of its lists; as declared where absent.
    """

    strengths: Mapping[str, float | None]
    phases: Mapping[str, str] = field(default_factory=dict)
    scanned: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    timed: Mapping[str, float] = field(default_factory=dict)
    beside: Mapping[str, float | None] = field(default_factory=dict)
    stood_in: Mapping[str, float] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    neutral: float = 0.0
    presence: bool = False
    in_si: bool = False
    options: Mapping[str, object] = field(default_factory=dict)
    length: int | None = None


@dataclass(frozen=True)
class Cause:
    """An effect as a cause.

    Args:
        sentence: What it is called in a sentence: 'the simulation misses …'.
        recipes: Its variants, each tried; none for an effect that is never tried by itself.
        separated_by: The experiment that separates it from what it resembles.
        looks_like: Effects that no record of this channel can tell from it and that are never tried by themselves.
        simpler: An effect that it contains, with fewer parameters.
    """

    sentence: str
    recipes: tuple[Recipe, ...] = ()
    separated_by: Experiment = "torque"
    looks_like: tuple[str, ...] = ()
    simpler: str | None = None
