"""Made-up fits, scores and benches: a decision of the search sees its numbers and nothing else."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import torch

from gear_damping.explanation.evidence.excess import Excess
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials.bench import Bench
from gear_damping.physics.catalogue import builtin_effects, effect_class
from gear_damping.physics.systems.gear_pair import GearPair

NAMES = (
    "coulomb_friction", "power_law_damping", "hysteretic_damping", "hunt_crossley_damping", "sensor_drift",
    "asymmetric_friction", "pinion_eccentricity", "windage_drag", "encoder_error", "sensor_gain", "backlash",
    "profile_error",
)  # fmt: skip


def left(percent: float, misfit: float = 1.0, threshold: float = 0.01, chance: float = 0.0) -> Excess:
    """What residuals of conditions left out hold."""
    return Excess(percent, threshold, chance, misfit, {})


def outcome(cost: float = 1.0, squares: float = 1.0, **more: object) -> SimpleNamespace:
    """A fitted model by its sums of squares."""
    return SimpleNamespace(
        fitted=SimpleNamespace(cost=cost, converged=True), left_out_cost=squares, error_amplification=1.0, **more
    )


def fit(
    name: str = NAMES[0], cost: float = 0.5, squares: float = 0.5, t: float = 50.0, **more: object
) -> SimpleNamespace:
    """A full fit that conditions left out validate, unless said otherwise."""
    known = {"gain": 1.0, "fit_gain": 1e4, "is_seen_in_fit": True, "is_at_bound": False, "differs": False} | more
    return SimpleNamespace(name=name, outcome=outcome(cost, squares), t=t, **known)


@dataclass(frozen=True)
class Scored:
    """A score."""

    candidate: SimpleNamespace
    gain: float
    direction: torch.Tensor
    columns: torch.Tensor


def scored(place: int, gain: float, direction: int | None = None) -> Scored:
    """The score of the effect in this place of `NAMES`, along an axis of its own or along another."""
    axis = torch.eye(len(NAMES), dtype=torch.float64)[place if direction is None else direction]
    hypothesis = SimpleNamespace(effects=[effect_class(NAMES[place])()], common=())
    known = {"options": (), "form": (), "non_nested": False, "replaced": (), "is_law": False, "own_levels": False}
    known |= {"tells_teeth_apart": False, "strengths": (0,)}
    known |= {"hypothesis": hypothesis}
    return Scored(SimpleNamespace(name=NAMES[place], **known), gain, axis, axis[:, None])


@dataclass(frozen=True)
class MadeUpBench(Bench):
    """A bench where nothing is fitted: what models leave is said."""

    leaves: dict[int, Excess] = field(default_factory=dict)

    def noise_cost(self, outcome: SimpleNamespace) -> float:
        """Nothing."""
        return 0.0

    def excess(self, outcome: SimpleNamespace) -> Excess:
        """As said of this model, by its identity."""
        return self.leaves[id(outcome)]


def bench(settings: SearchSettings, leaves: list[tuple[SimpleNamespace, Excess]] = (), **evidence: object) -> Bench:
    """A bench with these thresholds."""
    noise = SimpleNamespace(value=1.0, correlation=1.0)
    known = SimpleNamespace(
        settings=settings, **{"segments": None, "has": GearPair.has, "library": builtin_effects()} | evidence
    )
    said = {id(model): what for model, what in leaves}
    return MadeUpBench(known, noise, lambda text: None, None, noise, leaves=said)
