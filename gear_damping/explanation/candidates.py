"""Step 5a: what could be missing. Every effect of the catalogue as something that can be switched on gradually."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, log, pi

from gear_damping.explanation.hypothesis import Given, Hypothesis
from gear_damping.identification.output_error.problem import FreeParameter
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Effect
from gear_damping.units import parse_unit


@dataclass(frozen=True)
class Recipe:
    """How an effect is switched on, where its declaration does not say so.

    Args:
        strengths: Parameters that are zero without the effect, with a size in natural units (of an
            oscillator) or None for the declared default.
        phases: Phase parameter of each strength that turns with a shaft.
        scanned: Other parameters with the values that are tried, natural units; freed in the full fit.
        timed: The same for times and frequencies, in durations of the longest record and cycles of it.
        beside: Parameters of other effects that are fitted with it; with the value at which the full fit begins,
            where they have no size yet.
        fixed: Parameters that stay, natural units.
        presence: The effect has no zero (a stiffness that was rigid): it is tried as a whole, at the size
            of its strength, with everything that is scanned free from the start.
        options: Options of the effect.
        length: Elements of its lists; as declared where absent.
    """

    strengths: Mapping[str, float | None]
    phases: Mapping[str, str] = field(default_factory=dict)
    scanned: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    timed: Mapping[str, float] = field(default_factory=dict)
    beside: Mapping[str, float | None] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    presence: bool = False
    options: Mapping[str, object] = field(default_factory=dict)
    length: int | None = None


def _wave(size: float | None = None) -> Recipe:
    return Recipe({"amplitude": size}, {"amplitude": "phase"})


RECIPES: dict[str, tuple[Recipe, ...]] = {
    "power_law_damping": tuple(Recipe({"coefficient": 0.01}, scanned={"exponent": (n,)}) for n in (2.0, 0.5, 3.0)),
    "coulomb_friction": (Recipe({"force": 0.005}, scanned={"width": (0.05,)}),),
    "asymmetric_friction": (
        Recipe({"force_forward": 0.005, "force_backward": 0.005}, scanned={"width": (0.05,)}),
        Recipe(
            {"force_forward": 0.005, "force_backward": 0.005, "damping_forward": 0.01, "damping_backward": 0.01},
            scanned={"width": (0.05,)},
        ),
    ),
    "hysteretic_damping": (Recipe({"share": 0.02}, fixed={"yield_deflection": 0.2, "exponent": 1.0}),),
    "hunt_crossley_damping": (
        Recipe({"damping_coefficient": 0.01}, fixed={"exponent": 1.0, "reference_deflection": 1.0}),
    ),
    "squeeze_film_damping": (Recipe({"damping_coefficient": 0.01}),),
    "cubic_stiffness": (Recipe({"coefficient": 0.02}),),
    "quadratic_stiffness": (Recipe({"coefficient": 0.02}),),
    "hertz_stiffness": (Recipe({"exponent": 0.05}, fixed={"reference_deflection": 1.0}),),
    "tooth_friction": (Recipe({"friction_coefficient": None}),),
    "backlash": tuple(Recipe({"gap": gap}, presence=True) for gap in (3e-5, 6e-5, 1.2e-4, 2.4e-4)),
    "pinion_eccentricity": (_wave(),),
    "gear_eccentricity": (_wave(),),
    "pinion_stiffness_modulation": (_wave(),),
    "gear_stiffness_modulation": (_wave(),),
    "shaft_angle_error": (_wave(),),
    "profile_error": (Recipe({"amplitudes": None}, {"amplitudes": "phases"}, length=4),),
    "pitch_error": (Recipe({"values": 3e-6}),),
    "torque_ripple": tuple(
        Recipe(
            {strength: None},
            {strength: "phase"},
            fixed={"order": order, other: 0.0},
            options={"proportional": strength == "share"},
        )
        for strength, other in (("amplitude", "share"), ("share", "amplitude"))
        for order in (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    ),
    "torque_variation": (
        *(
            Recipe(
                {"sine_amplitude": None},
                {"sine_amplitude": "sine_phase"},
                timed={"sine_frequency": cycles},
                options={"form": "sine"},
            )
            for cycles in (0.7, 1.0, 1.4, 1.8, 2.2, 2.6, 3.0)
        ),
        *(
            Recipe(
                {"ramp_change": None}, timed={"ramp_start": at, "ramp_end": at + length}, options={"form": "ramp"}
            )
            for at in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
            for length in (0.02, 0.25)
        ),
    ),
    "bearing_flexibility": tuple(
        Recipe({"stiffness": k}, presence=True, scanned={"mass": (m,), "damping_ratio": (0.02,)})
        for k in (5e8, 2e9, 1e10, 4e10)
        for m in (1.5, 4.0)
    ),
    "unbalance": (Recipe({"unbalance": None}, {"unbalance": "phase"}),),
    "shaft_torsion": tuple(
        Recipe({"stiffness": k}, presence=True, scanned={"motor_inertia": (j,), "damping_ratio": (0.02,)})
        for k in (3e3, 1e4, 3e4, 1e5)
        for j in (4e-3, 1.5e-2)
    ),
    "load_dependent_contact": (  # what it changes are the edges, which the free shape of the stiffness hid so far
        Recipe(
            {"growth": None},
            beside={
                "mesh_phase": None,
                "fourier_mesh_stiffness.contact_ratio": None,
                "fourier_mesh_stiffness.minimum": None,
                "fourier_mesh_stiffness.edge": 0.1,
            },
        ),
    ),
    "windage_drag": (Recipe({"coefficient": None}),),
    "tooth_crack": tuple(
        Recipe({"depth": None}, scanned={"phase": (2 * pi * i / 20,), "edge": (0.1,)}) for i in range(20)
    ),
    "sensor_offset": (Recipe({"offset": None}),),
    "sensor_drift": (Recipe({"rate": 0.001}),),
    "sensor_delay": (Recipe({"delay": 0.05}),),
    "sensor_lowpass": tuple(
        Recipe({"cutoff": size}, presence=True, options={"order": order})
        for order in (1, 2)
        for size in (0.5, 1.5, 4.0)
    ),
    "sensor_gain": (Recipe({"gain": None}),),
    "sensor_saturation": (Recipe({"limit": None}, presence=True),),
}
SAME_RECORD = {  # what no record of this channel can tell apart, and is never tried by itself
    "pinion_eccentricity": ("encoder_error",),
    "gear_eccentricity": ("encoder_error",),
    "sensor_gain": ("inertia_error",),
}
SIMPLER = {"asymmetric_friction": "coulomb_friction"}  # what an effect contains, with fewer parameters
NEUTRAL = {"sensor_gain": 1.0}
UNSEEN = 50.0  # times smaller than where it begins, a parameter that has no size yet does nothing
ANGLE_SCALE = 0.1  # rad, a step of order one of an angle that is freed
WITHIN = {"width": (0.02, 0.5), "edge": (0.02, 0.3)}  # what is sharper costs steps and shows no more
OWN_UNITS = {"bearing_flexibility", "shaft_torsion", "torque_ripple", "torque_variation", "tooth_crack", "backlash"}
SHOWN = ("exponent", "order", "phase", "sine_frequency", "ramp_start")  # of a variant, in its label
COVERED_BY_NUISANCE = {"oscillator": {"sensor_offset", "sensor_gain"}, "gear_pair": set()}


@dataclass(frozen=True)
class Candidate:
    """One way in which one effect may be missing.

    Args:
        name: The effect.
        label: The name with what distinguishes the variant.
        hypothesis: The calibrated model with the effect added and switched off (or present).
        strengths: Places of its strengths among the free parameters.
        phases: Place of the phase by place of its strength.
        begun: Coordinates at which other parameters begin in the full fit, by their place.
        later: Free parameters that join in the full fit only.
        presence: Whether it is tried as a whole.
    """

    name: str
    label: str
    hypothesis: Hypothesis
    strengths: tuple[int, ...]
    phases: Mapping[int, int]
    begun: Mapping[int, float]
    later: tuple[FreeParameter, ...]
    presence: bool


def candidates_for(base: Hypothesis, duration: float) -> list[Candidate]:
    """Every variant of every effect that goes with the system and is not there yet.

    Args:
        base: The calibrated model.
        duration: Length of the longest record in s.
    """
    kinds = builtin_effects()
    there = {effect.name for effect in base.effects}
    refused = there | COVERED_BY_NUISANCE[base.system.name]
    found = []
    for name, recipes in RECIPES.items():
        kind = kinds[name]
        if base.system.name in kind.systems and name not in refused and set(kind.requires) <= there:
            found += [_candidate(base, kind, recipe, duration) for recipe in recipes]
    return found


def _candidate(base: Hypothesis, kind: type[Effect], recipe: Recipe, duration: float) -> Candidate:
    effect = kind(**recipe.options)
    sizes = _Sizes(base, duration)
    given: Given = {}
    for parameter in kind.parameters:
        given[f"{kind.name}.{parameter.name}"] = sizes.default(kind, parameter, recipe)
    free, strengths, phases = [], [], {}
    first = len(base.free)
    for name, size in recipe.strengths.items():
        for parameter in _elements(kind, name, sizes.size(kind, name, size, recipe), given, recipe):
            place = first + len(free)
            free.append(parameter)
            strengths.append(place)
            if name in recipe.phases:
                index = parameter.name.partition("[")[2]
                phase = f"{kind.name}.{recipe.phases[name]}" + (f"[{index}" if index else "")
                free.append(FreeParameter(phase, 0.0))
                phases[place] = place + 1
    later = [_freed(declared, f"{kind.name}.{name}", given) for name, declared in _declared(kind, recipe)]
    if recipe.presence:
        free, later = [*free, *later], []
    begun = {}
    for name, start in recipe.beside.items():
        if start is not None:
            given[name] = start / UNSEEN
            begun[first + len(free)] = log(UNSEEN)
        if name in given or name in base.given:
            free.append(_freed(base.model.parameters()[name], name, base.given | given))
    return Candidate(
        kind.name,
        _label(kind, recipe),
        base.with_effect([effect], given, free, kind.name),
        tuple(strengths),
        phases,
        begun,
        tuple(later),
        recipe.presence,
    )


def _declared(kind: type[Effect], recipe: Recipe) -> list[tuple[str, Parameter]]:
    """The scanned and timed parameters of a recipe with their declarations."""
    declared = {p.name: p for p in kind.parameters}
    return [(name, declared[name]) for name in (*recipe.scanned, *recipe.timed)]


def _freed(declared: Parameter, flat: str, given: Given) -> FreeParameter:
    """A parameter that joins in the full fit, from its value there; an angle on its own scale."""
    value, (low, high) = float(given[flat]), WITHIN.get(declared.name, (-inf, inf))
    if declared.lower < 0:
        return FreeParameter(flat, value, ANGLE_SCALE)
    lower, upper = max(declared.lower, low), min(declared.upper, high)
    return FreeParameter(flat, value, logarithmic=True, lower=lower, upper=upper)


def _label(kind: type[Effect], recipe: Recipe) -> str:
    values = {**recipe.fixed, **{k: v[0] for k, v in recipe.scanned.items()}, **recipe.timed}
    label = kind.name + "".join(f" {k}={v:.3g}" for k, v in values.items() if k in SHOWN)
    return label + "".join(f" {k}={v}" for k, v in recipe.options.items())


class _Sizes:
    """Sizes of an effect's parameters for this rig."""

    def __init__(self, base: Hypothesis, duration: float) -> None:
        self.duration = duration
        self.is_gear = base.system.name == "gear_pair"
        self.scales = base.model.prepare(base.model.values(1, **base.given)).scales

    def natural(self, kind: type[Effect], parameter: Parameter, value: float, exponent: float = 1.0) -> float:
        """A value in natural units, in the rig's own; the unit of a power law hangs on its exponent."""
        if kind.name == "power_law_damping" and parameter.name == "coefficient":
            return value * float(self.scales.force[0] / self.scales.velocity[0] ** exponent)
        return value * float(self.scales.unit_of(parse_unit(parameter.unit).dimension)[0])

    def size(self, kind: type[Effect], name: str, size: float | None, recipe: Recipe) -> float:
        """The size of a strength that is tried."""
        parameter = next(p for p in kind.parameters if p.name == name)
        if size is None or kind.name in OWN_UNITS or (self.is_gear and kind.name == "pitch_error"):
            default = size or parameter.default
            return default[0] if isinstance(default, tuple) else float(default)
        return self.natural(kind, parameter, size, recipe.scanned.get("exponent", (1.0,))[0])

    def default(self, kind: type[Effect], parameter: Parameter, recipe: Recipe) -> float | tuple[float, ...]:
        """The value that a parameter has before it is fitted."""
        if parameter.name in recipe.strengths:
            neutral = NEUTRAL.get(kind.name, 0.0)
            if recipe.presence:
                return self.size(kind, parameter.name, recipe.strengths[parameter.name], recipe)
            return (neutral,) * (recipe.length or len(parameter.default)) if parameter.vector else neutral
        if parameter.name in recipe.timed:
            share = recipe.timed[parameter.name]
            return share / self.duration if parameter.unit == "Hz" else share * self.duration
        chosen = recipe.fixed.get(parameter.name, recipe.scanned.get(parameter.name, (None,)))
        value = chosen[0] if isinstance(chosen, tuple) else chosen
        if value is None:
            return (0.0,) * (recipe.length or len(parameter.default)) if parameter.vector else parameter.default
        if kind.name in OWN_UNITS or parameter.unit in ("1", "rad"):
            return value
        return self.natural(kind, parameter, value)


def _elements(kind: type[Effect], name: str, size: float, given: Given, recipe: Recipe) -> list[FreeParameter]:
    """A free parameter for a strength, or for each element of a list of them."""
    declared = next(p for p in kind.parameters if p.name == name)
    flat, value = f"{kind.name}.{name}", given[f"{kind.name}.{name}"]
    if recipe.presence:
        return [FreeParameter(flat, float(value), logarithmic=True, lower=declared.lower, upper=declared.upper)]
    if isinstance(value, tuple):
        return [FreeParameter(f"{flat}[{i}]", v, abs(size)) for i, v in enumerate(value)]
    lower, upper = (-float("inf"), float("inf")) if name in recipe.phases else (declared.lower, declared.upper)
    if name in recipe.phases:
        return [FreeParameter(flat, value, abs(size))]
    return [FreeParameter(flat, value, abs(size), lower=lower, upper=upper)]
