"""Step 5a: what could be missing. Every effect of the catalogue as something that can be switched on gradually."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, log

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Given, Hypothesis
from gear_damping.explanation.model.rig import Residuals, rig_of
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.cause import Recipe, Rig
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingForce, Effect, ElasticForce
from gear_damping.units import parse_unit

UNSEEN = 50.0  # times smaller than where it begins, a parameter that has no size yet does nothing
LEAST_CYCLES = 0.5  # of a wave in the longest record: with a phase in each record, less is a level of each
ANGLE_SCALE = 0.1  # rad, a step of order one of an angle that is freed
EXPONENT = "exponent"  # the name of a parameter that is the power of a law
SHOWN = (EXPONENT, "order", "phase", "sine_frequency", "ramp_start")  # of a variant, in its label


@dataclass(frozen=True)
class Candidate:
    """One way in which one effect may be missing.

    Args:
        name: The effect.
        label: The name with what distinguishes the variant.
        hypothesis: The calibrated model with the effect added and switched off (or present).
        strengths: Places of its strengths among the free parameters.
        phases: Place of the phase by place of its strength.
        initial_values: Coordinates at which other parameters begin in the full fit, by their place.
        moved: How far other parameters are moved for further starts, in coordinates by place.
        later: Free parameters that join in the full fit only.
        settled: Names of free parameters that stay where a first fit has put them.
        non_nested: Whether it is tried as a whole.
        replaced: Free parameters that it took the place of.
        resting: Names of parameters that may rest at a bound without having run into it, with -1 for the lower one, 1
            for the upper one.
        own_phases: Name of the phase by place of its strength, where every record has one of its own.
        own_levels: Whether these are no phases but levels, in standard deviations between records.
        own_tooth: Name of the phase that says which tooth is in mesh at the start of a record, where nothing else does.
        teeth: How many there are, where that is so.
        tried: The options that its recipe sets, as whose tooth is cracked.
    """

    name: str
    label: str
    hypothesis: Hypothesis
    strengths: tuple[int, ...]
    phases: Mapping[int, int]
    initial_values: Mapping[int, float]
    moved: Mapping[int, float]
    later: tuple[FreeParameter, ...]
    non_nested: bool
    replaced: tuple[FreeParameter, ...] = ()
    resting: frozenset[tuple[str, int]] = frozenset()
    own_phases: Mapping[int, str] = field(default_factory=dict)
    own_levels: bool = False
    own_tooth: str = ""
    teeth: int = 0
    tried: Mapping[str, object] = field(default_factory=dict)
    settled: tuple[str, ...] = ()

    @property
    def options(self) -> tuple[tuple[str, object], ...]:
        """The form of the effect, as (option, choice)."""
        return tuple(sorted(self.hypothesis.effects[-1].chosen.items()))

    @property
    def form(self) -> tuple[object, ...]:
        """What parts its full fit from others of the effect: the options, and whether records have their own phases."""
        return (*self.options, bool(self.own_phases or self.own_tooth))

    @property
    def tells_teeth_apart(self) -> bool:
        """Whether it is of single teeth, as an error of each."""
        return self.hypothesis.effects[-1].cause.turns_with == "tooth"

    @property
    def names_of_phases(self) -> set[str]:
        """Names of its angles, which count from anywhere and are no sizes."""
        common = {self.hypothesis.common[place].name for place in self.phases.values()}
        own = set() if self.own_levels else set(self.own_phases.values())
        return (common | own | {self.own_tooth}) - {""}

    @property
    def is_law(self) -> bool:
        """Whether it is a law of the restoring or of the damping force."""
        return isinstance(self.hypothesis.effects[-1], ElasticForce | DampingForce)


def candidates_for(base: Hypothesis, evidence: Evidence, residuals: Residuals | None = None) -> list[Candidate]:
    """Every variant of every effect of the library that goes with the system and is not there yet.

    Args:
        base: The calibrated model.
        evidence: The records.
        residuals: What it leaves of them, in whose orders a ripple is sought beyond the low ones.
    """
    there = {effect.name for effect in base.effects}
    refused = there | base.system.covered_by_nuisance
    rig = rig_of(base, evidence, residuals)
    rigs = [rig, replace(rig, indexed=False)] if rig.indexed and not evidence.tells_turns else [rig]
    each_rig = [_Sizes(base, evidence.duration, one) for one in rigs]
    return [
        _candidate(base, kind, recipe, sizes)
        for name, kind in evidence.library.items()
        if kind.cause and base.system.has(*kind.needs) and name not in refused and set(kind.requires) <= there
        for sizes in (each_rig if kind.cause.turns_with in ("shaft", "tooth") else each_rig[:1])
        for recipe in kind.cause.recipes_for(sizes.rig)
        if sizes.rig is rig or recipe.turns == "gear"  # where only the pinion has a mark, turns of the gear have none
        if all(_value(base, parameter) > 0 for parameter in recipe.replaces)
    ]


def first_sizes(base: Hypothesis, evidence: Evidence, effects: Sequence[Effect]) -> tuple[Given, Given]:
    """Where the parameters of effects begin that nobody knows, as they are tried on this rig.

    Returns:
        Strengths, without which an effect is not there, and everything else, by flat name.
    """
    rig = rig_of(base, evidence)
    sizes, strengths, others = _Sizes(base, evidence.duration, rig), {}, {}
    for effect in effects:
        recipe = next(iter(effect.cause.recipes_for(rig) if effect.cause else ()), None)
        for parameter in effect.parameters if recipe else ():
            name, flat = parameter.name, f"{effect.name}.{parameter.name}"
            if name in recipe.strengths and not parameter.vector:
                own = replace(recipe, scanned={**recipe.scanned, **effect.given})
                strengths[flat] = sizes.size(type(effect), name, recipe.strengths[name], own)
            else:
                others[flat] = sizes.default(type(effect), parameter, recipe)
    return strengths, others


def going_with(name: str, effects: Sequence[Effect]) -> frozenset[str]:
    """An effect and all that need it, without which they are nothing: a force on a bearing goes with the bearing."""
    gone, before = {name}, 0
    while len(gone) > before:
        before = len(gone)
        gone |= {effect.name for effect in effects if gone & set(effect.requires)}
    return frozenset(gone)


def restored(hypothesis: Hypothesis, cause: str) -> Hypothesis:
    """A model from which a cause was taken, with what the cause had replaced free again."""
    replaced = hypothesis.replaced.get(cause, ())
    given = hypothesis.given | {parameter.name: parameter.start for parameter in replaced}
    others = {name: parameters for name, parameters in hypothesis.replaced.items() if name != cause}
    return replace(hypothesis, given=given, free=(*replaced, *hypothesis.free), replaced=others)


def _value(base: Hypothesis, name: str) -> float:
    """Where a free parameter begins; 0 for one that is known."""
    return next((p.start for p in base.free if p.name == name), 0.0)


def _candidate(base: Hypothesis, kind: type[Effect], recipe: Recipe, sizes: "_Sizes") -> Candidate:
    """One recipe of an effect on the calibrated model."""
    replaced = tuple(p for p in base.free if p.name in recipe.replaces)
    kept = tuple(p for p in base.free if p not in replaced)
    base = replace(base, free=kept, given=base.given | {p.name: 0.0 for p in replaced})
    effect = kind(**recipe.options)
    given: Given = {f"{kind.name}.{p.name}": sizes.default(kind, p, recipe) for p in kind.parameters}
    first = len(base.common)
    laid = _strengths(kind, recipe, sizes, given, first)
    own_tooth = f"{kind.name}.phase" if not sizes.rig.indexed and kind.cause.turns_with == "tooth" else ""
    teeth = sizes.rig.teeth(effect.chosen["shaft"]) if own_tooth else 0
    free, later = laid.free, _joining(kind, recipe, sizes, given, own_tooth)
    if recipe.non_nested:
        free, later = [*free, *later], []
    initial_values = {}
    for name, start in recipe.jointly_fitted.items():
        if start is not None:
            given[name] = start / UNSEEN
            initial_values[first + len(free)] = log(UNSEEN)
        if name in given or name in base.given:
            free.append(_freed(base.model.parameters()[name], name, base.given | given, recipe.within))
    templates = _templates(kind, laid.own_phases, own_tooth, teeth)
    extended = base.with_effect([effect], given, [*free, *templates], kind.name)
    scaling = recipe.restart_scaling
    return Candidate(
        kind.name,
        _label(kind, recipe),
        replace(extended, replaced=base.replaced | {kind.name: replaced}),
        tuple(laid.places),
        laid.phases,
        initial_values,
        moved={place: log(scaling[p.name]) for place, p in enumerate(base.common) if p.name in scaling},
        later=tuple(later),
        non_nested=recipe.non_nested,
        replaced=replaced,
        resting=frozenset((f"{kind.name}.{name}", end) for name, end in recipe.resting),
        own_phases=laid.own_phases,
        own_levels=_has_levels(kind),
        own_tooth=own_tooth,
        teeth=teeth,
        tried=recipe.options,
        settled=tuple(f"{kind.name}.{name}" for name in recipe.settled),
    )


@dataclass
class _Strengths:
    """The strengths of a recipe as free parameters, with the phases that belong to them.

    Args:
        free: Strengths, each before its phase.
        places: Of the strengths among all free parameters.
        phases: Place of the phase by place of its strength.
        own_phases: Name of the phase by place of its strength, where every record has one of its own.
    """

    free: list[FreeParameter] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    phases: dict[int, int] = field(default_factory=dict)
    own_phases: dict[int, str] = field(default_factory=dict)


def _strengths(kind: type[Effect], recipe: Recipe, sizes: "_Sizes", given: Given, first: int) -> _Strengths:
    """The strengths from place `first` on."""
    laid, own = _Strengths(), _has_own_phases(kind, sizes)
    for name, size in recipe.strengths.items():
        for parameter in _elements(kind, name, sizes.size(kind, name, size, recipe), given, recipe):
            place = first + len(laid.free)
            laid.free.append(parameter)
            laid.places.append(place)
            if name not in recipe.phases:
                continue
            phase = f"{kind.name}.{recipe.phases[name]}" + "".join(parameter.name.partition("[")[1:])
            if own:
                laid.own_phases[place] = phase
            else:
                laid.free.append(FreeParameter(phase, 0.0))
                laid.phases[place] = place + 1
    return laid


def _joining(kind: type[Effect], recipe: Recipe, sizes: "_Sizes", given: Given, own_tooth: str) -> list[FreeParameter]:
    """The scanned and timed parameters, which join in the full fit."""
    within = sizes.within(kind, recipe)
    joining = [(declared, f"{kind.name}.{declared.name}") for declared in _declared(kind, recipe)]
    return [_freed(declared, flat, given, within) for declared, flat in joining if flat != own_tooth]


def _templates(kind: type[Effect], own_phases: Mapping[int, str], own_tooth: str, teeth: int) -> list[FreeParameter]:
    """What every record has of its own: phases, levels, or which tooth is in mesh at its start."""
    if own_tooth:
        return [FreeParameter(own_tooth, 0.0, ANGLE_SCALE, per_record=True, places=teeth)]
    expected = 1.0 if _has_levels(kind) else inf  # a level counts in standard deviations
    return [FreeParameter(phase, 0.0, per_record=True, deviation=expected) for phase in own_phases.values()]


def _has_own_phases(kind: type[Effect], sizes: "_Sizes") -> bool:
    """Whether every record has phases of its own: no index says how the shafts stand, or when what swings began."""
    if kind.cause.turns_with in ("clock", "record"):
        return True
    return not sizes.rig.indexed and kind.cause.turns_with == "shaft"


def _has_levels(kind: type[Effect]) -> bool:
    """Whether these are levels: what differs between records is a size."""
    return kind.cause.turns_with == "record"


def _declared(kind: type[Effect], recipe: Recipe) -> list[Parameter]:
    """The scanned and timed parameters of a recipe."""
    declared = {p.name: p for p in kind.parameters}
    return [declared[name] for name in (*recipe.scanned, *recipe.timed)]


def _freed(declared: Parameter, flat: str, given: Given, within: Mapping[str, tuple[float, float]]) -> FreeParameter:
    """A parameter that joins in the full fit, from its value there; an angle on its own scale.

    The logarithm of a power is linear in its exponent.
    """
    value = float(given[flat])
    if declared.lower < 0:
        return FreeParameter(flat, value, ANGLE_SCALE)
    lower, upper = _narrowed(declared, flat, within)
    return FreeParameter(flat, value, logarithmic=declared.name != EXPONENT, lower=lower, upper=upper)


def _narrowed(declared: Parameter, flat: str, within: Mapping[str, tuple[float, float]]) -> tuple[float, float]:
    """The declared bounds of a parameter, or the narrower ones of a recipe."""
    low, high = within.get(flat, (-inf, inf))
    return max(declared.lower, low), min(declared.upper, high)


def _label(kind: type[Effect], recipe: Recipe) -> str:
    values = {**recipe.fixed, **recipe.scanned, **recipe.timed}
    label = kind.name + "".join(f" {k}={v:.3g}" for k, v in values.items() if k in SHOWN)
    return label + "".join(f" {k}={v}" for k, v in recipe.options.items())


class _Sizes:
    """Sizes of an effect's parameters for this rig."""

    def __init__(self, base: Hypothesis, duration: float, rig: Rig) -> None:
        self.base, self.duration, self.rig = base, duration, rig
        self.scales = base.model.prepare(base.model.values(1, **base.given)).scales

    def natural(self, kind: type[Effect], parameter: Parameter, value: float, exponent: float = 1.0) -> float:
        """A value in natural units, in the rig's own; the unit of a power law depends on its exponent."""
        if kind.name == "power_law_damping" and parameter.name == "coefficient":
            return value * float(self.scales.force[0] / self.scales.velocity[0] ** exponent)
        return value * float(self.scales.unit_of(parse_unit(parameter.unit).dimension)[0])

    def within(self, kind: type[Effect], recipe: Recipe) -> dict[str, tuple[float, float]]:
        """The narrower bounds of a recipe by flat name, those of what has a largest value, and of slow waves."""
        declared = {p.name: p for p in kind.parameters}
        most = {name: (-inf, self.natural(kind, declared[name], value)) for name, value in recipe.most.items()}
        waves = [name for name in recipe.timed if declared[name].unit == "Hz"]
        slowest = dict.fromkeys(waves, (LEAST_CYCLES / self.duration, inf))
        return {**recipe.within, **{f"{kind.name}.{name}": ends for name, ends in {**most, **slowest}.items()}}

    def size(self, kind: type[Effect], name: str, size: float | None, recipe: Recipe) -> float:
        """The size of a strength that is tried."""
        replaced = next((theirs for theirs, own in recipe.replaces.items() if own == name), None)
        if replaced is not None:
            return (size or 1.0) * _value(self.base, replaced)
        parameter = next(p for p in kind.parameters if p.name == name)
        if size is None or recipe.in_si:
            default = size or parameter.default
            return default[0] if isinstance(default, tuple) else float(default)
        return self.natural(kind, parameter, size, recipe.scanned.get("exponent", 1.0))

    def default(self, kind: type[Effect], parameter: Parameter, recipe: Recipe) -> float | tuple[float, ...]:
        """The value that a parameter has before it is fitted."""
        if parameter.name in recipe.strengths:
            neutral = recipe.neutral
            if recipe.non_nested:
                return self.size(kind, parameter.name, recipe.strengths[parameter.name], recipe)
            return (neutral,) * (recipe.length or len(parameter.default)) if parameter.vector else neutral
        if parameter.name in recipe.timed:
            share = recipe.timed[parameter.name]
            return share / self.duration if parameter.unit == "Hz" else share * self.duration
        value = recipe.fixed.get(parameter.name, recipe.scanned.get(parameter.name))
        if value is None:
            return (0.0,) * (recipe.length or len(parameter.default)) if parameter.vector else parameter.default
        if recipe.in_si or parameter.unit in ("1", "rad"):
            return value
        return self.natural(kind, parameter, value)


def _elements(kind: type[Effect], name: str, size: float, given: Given, recipe: Recipe) -> list[FreeParameter]:
    """A free parameter for a strength, or for each element of a list of them."""
    declared = next(p for p in kind.parameters if p.name == name)
    flat, value = f"{kind.name}.{name}", given[f"{kind.name}.{name}"]
    if recipe.non_nested:
        return [_freed(declared, flat, given, recipe.within)]
    if isinstance(value, tuple):
        return [FreeParameter(f"{flat}[{i}]", v, abs(size)) for i, v in enumerate(value)]
    if name in recipe.phases and not _has_levels(kind):
        return [FreeParameter(flat, value, abs(size))]
    expected = abs(size) if _has_levels(kind) else inf  # only its product with the levels acts
    lower, upper = _narrowed(declared, flat, recipe.within)
    return [FreeParameter(flat, value, abs(size), lower=lower, upper=upper, deviation=expected)]
