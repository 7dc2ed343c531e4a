"""What an effect says of itself as a possible cause of what a simulation misses."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, Literal

from gear_damping.physics.systems.traits import Trait

Experiment = Literal["torque", "speed", "torque_channel", "bearing", "remount", "ring_down", "amplitude", "reversal"]


SHAFTS = ("pinion", "gear")


@dataclass(frozen=True)
class Mode:
    """A mass on a spring behind another one.

    Args:
        frequency: Its own on that spring, in Hz.
        mass_ratio: Its mass over the other.
        damping_ratio: Of that spring.
        drag_rate: What brakes it against the ground, per unit of its mass, in 1/s.
    """

    frequency: float
    mass_ratio: float
    damping_ratio: float
    drag_rate: float = 0.0


@dataclass(frozen=True)
class Rig:
    """What a recipe may depend on: the rig and the records of it.

    Args:
        system: The name of the system.
        n_teeth_pinion: Teeth of the pinion; 0 without a mesh.
        n_teeth_gear: Teeth of the gear; 0 without a mesh.
        inputs: Names of the input series that were measured.
        radian: One radian in the unit of the response; None where the response is no angle.
        mesh_harmonics: Harmonics of the mesh that the sampling of at least one record shows.
        lines: Orders of the pinion shaft at which most is left unexplained, the strongest first.
        frequencies: In Hz, at which most is left unexplained away from its own, the strongest first; of a rig with
            shafts the one below that of its mesh, away from their orders.
        values: Parameters and derived quantities of the system by name, SI; of a mesh the `contact_ratio` too.
        indexed: Whether the angle of all records counts from one mark, so that a tooth has one number.
        traits: Those of the system.
        spring: The parameter of the system that is its constant stiffness; None where it has a mesh.
        standing: Whether its shafts stand in all records.
        on_shafts: Whether a speed or an acceleration of one shaft was measured.
        accelerometers: Shafts that carry one, across the radius.
        band: Half the lowest sampling rate of the records, in Hz: what is faster is seen as something else.
        longest: Seconds of the longest record.
        records: How many were fitted.
        swells: Whether a free motion of them grows again after it fell: energy comes back from where it went.
        mode: A mass on a spring with which loads and motions agree best, where nothing holds the driven one.
        opposed: The same of a second mode of a residue of the other sign; its `mass_ratio` is that of the residues.
        one_way: Whether nothing brings it back and it moves in one direction in each record, so that what differs
            between directions, or yields before it slides, does not show.
    """

    system: str
    n_teeth_pinion: int = 0
    n_teeth_gear: int = 0
    inputs: tuple[str, ...] = ()
    radian: float | None = None
    mesh_harmonics: int = 0
    lines: tuple[float, ...] = ()
    frequencies: tuple[float, ...] = ()
    values: Mapping[str, float] = field(default_factory=dict)
    indexed: bool = True
    traits: frozenset[Trait] = frozenset()
    spring: str | None = None
    standing: bool = False
    on_shafts: bool = False
    one_way: bool = False
    mode: Mode | None = None
    opposed: Mode | None = None
    records: int = 1
    swells: bool = False
    accelerometers: tuple[str, ...] = ()
    band: float = inf
    longest: float = inf

    def has(self, trait: Trait) -> bool:
        """Whether its system has a trait."""
        return trait in self.traits

    @property
    def coasts(self) -> bool:
        """Whether no spring gives its motion a frequency."""
        return self.values.get("natural_frequency", 1.0) == 0

    @property
    def swings_freely(self) -> bool:
        """Whether nothing that was measured moves it: it dies away about its place of rest."""
        return self.has(Trait.REST) and not self.inputs

    def teeth(self, shaft: str) -> int:
        """Teeth of the gear on a shaft."""
        return {"pinion": self.n_teeth_pinion, "gear": self.n_teeth_gear}[shaft]


@dataclass(frozen=True)
class Recipe:
    """One way in which an effect is switched on gradually.

    Sizes are in natural units, unless `in_si`; None stands for the declared default.

    Args:
        strengths: Parameters that are neutral without the effect, with the size of a first step.
        phases: Phase parameter of each strength that turns with a shaft.
        scanned: Other parameters with the value that is tried; freed in the full fit.
        within: Narrower bounds by flat name: beyond them it costs steps and shows no more.
        most: Largest values of scanned parameters, by own name: one that ends there is no law of this motion any more.
        timed: As `scanned` for times and frequencies, in durations of the longest record and cycles of it.
        jointly_fitted: Parameters of other effects that are fitted with it; with the value at which the full fit
            begins, where they have no size yet.
        restart_scaling: Parameters, by flat name, that bend far off where the effect is missing, with the factor by
            which they are moved for further starts of the full fit.
        sharpest: Parameters, by own name, whose lower bound is where finer steps would cost more and show no more: one
            that converges there has run into nothing.
        whole: Parameters, by own name, whose upper bound is the end of what there is, as of a share of a pitch: one
            that converges there has run into nothing either.
        fixed: Parameters that stay.
        settled: Parameters, by own name, that a first fit only finds a motion with: others and the initial states make
            the same one with any of them. They stay where `Cause.settles` puts them.
        neutral: Value of the strengths without the effect.
        non_nested: The effect has no neutral value (a stiffness that was rigid): it is tried as a whole, at the
            size of its strength, with everything that is scanned free from the start.
        in_si: Whether the sizes are in SI.
        options: Options of the effect.
        length: Elements of its lists; as declared where absent.
        replaces: Parameters of the system that strengths take over, by own name: the parameter becomes 0 and is no
            longer free, and the size of the strength counts in what it was. Goes with `non_nested`.
        shaft: The shaft whose turns its phases count, where no option `shaft` says it.
    """

    strengths: Mapping[str, float | None]
    phases: Mapping[str, str] = field(default_factory=dict)
    scanned: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    most: Mapping[str, float] = field(default_factory=dict)
    timed: Mapping[str, float] = field(default_factory=dict)
    jointly_fitted: Mapping[str, float | None] = field(default_factory=dict)
    restart_scaling: Mapping[str, float] = field(default_factory=dict)
    sharpest: tuple[str, ...] = ()
    whole: tuple[str, ...] = ()
    fixed: Mapping[str, float] = field(default_factory=dict)
    settled: tuple[str, ...] = ()
    neutral: float = 0.0
    non_nested: bool = False
    in_si: bool = False
    options: Mapping[str, object] = field(default_factory=dict)
    length: int | None = None
    replaces: Mapping[str, str] = field(default_factory=dict)
    shaft: str = "pinion"

    @property
    def turns(self) -> str:
        """The shaft whose turns its phases count."""
        return str(self.options.get("shaft", self.shaft))

    @property
    def resting(self) -> tuple[tuple[str, int], ...]:
        """Parameters by own name with a bound, -1 or 1, at which they have run into nothing."""
        return (*((name, -1) for name in self.sharpest), *((name, 1) for name in self.whole))


FEWEST_RECORDS = 3  # that may differ: of two, one law that depends on their conditions tells as much


def of_several_records(rig: Rig) -> tuple[Recipe, ...]:
    """The recipe of what differs between records, by a `spread` and a `level` of each, where enough were fitted."""
    by_level = Recipe({"spread": 0.01}, {"spread": "level"}, fixed={"level": 0.0})
    return (by_level,) if rig.records >= FEWEST_RECORDS else ()


def where_there_is_a_spring(*recipes: Recipe) -> Callable[[Rig], tuple[Recipe, ...]]:
    """Recipes of a law about a place of rest: where nothing pulls the rig back there is none to count from."""

    def of_rig(rig: Rig) -> tuple[Recipe, ...]:
        return recipes if rig.values.get(rig.spring, 1.0) > 0 else ()

    return of_rig


Recipes = tuple[Recipe, ...] | Callable[[Rig], tuple[Recipe, ...]]


@dataclass(frozen=True)
class Cause:
    """An effect as a cause.

    Args:
        sentence: What it is called in a sentence: 'the simulation misses …'.
        recipes: Its variants, each tried; none for an effect that is never tried by itself. A function of the rig
            where they depend on it.
        separated_by: The experiment that separates it from what it resembles.
        looks_like: Effects that no record of this channel can tell from it and that are never tried by themselves; a
            function of its values by own name where they decide.
        simpler: An effect that it contains, with fewer parameters.
        turns_with: Whether its phases turn with a shaft (`shaft`) and not with the mesh, or even tell single teeth
            apart (`tooth`), or go with the time (`clock`), which begins anew in every record; or whether what stands
            in the place of a phase is a level of the record's own (`record`). Where no index says how
            the shaft stands, every record has phases of its own, and the `phase` of what tells teeth apart is sought
            tooth by tooth in each of them.
        one_class: What else no record of this channel parts from it, as words for a sentence: then several names are
            one answer.
        acts_as: What it comes to at the motion that was recorded, as words for a sentence with a size in N or in what
            that is per unit of mass: of its values by own name, the mean stiffness and the amplitude of the motion.
        also: What else would do the same to what was recorded, as a sentence, or nothing: of its options, its values by
            own name and the base values of the model, each a number.
        modes: The poles of the two modes that it makes of one, in 1/s: of its values by own name, the stiffness and the
            damping of the first one alone, both per unit of mass.
        settles: Of the same, its values and the stiffness and damping that make the same free motion.
    """

    sentence: str
    recipes: Recipes = ()
    separated_by: Experiment = "torque"
    looks_like: tuple[str, ...] | Callable[[Mapping[str, Any]], tuple[str, ...]] = ()
    simpler: str | None = None
    turns_with: Literal["", "shaft", "tooth", "clock", "record"] = ""
    one_class: tuple[str, ...] = ()
    acts_as: Callable[[Mapping[str, float], float, float], tuple[str, float] | None] | None = None
    also: Callable[[Mapping[str, Any], Mapping[str, float], Mapping[str, float]], str] | None = None
    modes: Callable[[Mapping[str, float], float, float], Sequence[complex]] | None = None
    settles: Callable[[Mapping[str, float], float, float], tuple[dict[str, float], float, float]] | None = None

    def alike(self, own: Mapping[str, Any]) -> tuple[str, ...]:
        """What it looks like with these values by own name."""
        return self.looks_like(own) if callable(self.looks_like) else self.looks_like

    def recipes_for(self, rig: Rig) -> tuple[Recipe, ...]:
        """Its variants on this rig."""
        return tuple(self.recipes(rig)) if callable(self.recipes) else self.recipes
