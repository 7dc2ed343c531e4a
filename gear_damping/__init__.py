"""gear_damping: how much damping a gear pair has, and why a simulation does not match a measurement.

    import gear_damping as gd

    model = gd.Model(gd.GearPair(), [gd.FourierMeshStiffness(), gd.ViscousDamping(), gd.Backlash(gap=80e-6)])
    runs = gd.simulate(model, sampling_rate=40e3, n_samples=2000)
    record = gd.load("measurement.yaml")
    fit = gd.identify(record, model, free=["backlash.gap", "damping_ratio"])
    answer = gd.explain(record)
    gd.damping(record).plot()

Every effect of docs/effects.md is there by its name without underscores (`power_law_damping`: `PowerLawDamping`).
Nothing heavy is imported before it is used.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gear_damping.threads import settle_threads

__version__ = "0.1.0"

if TYPE_CHECKING:
    from gear_damping.errors import InputError
    from gear_damping.explanation.explain import Listener
    from gear_damping.identification.test_plan.asked import PlanCosts, PlanGoal, PlannedSensor, PlannedTests, Unknown
    from gear_damping.interface.bound import bound
    from gear_damping.interface.damping import Damping, damping
    from gear_damping.interface.estimator import Estimator, estimator, load_estimator
    from gear_damping.interface.evaluated import Evaluation, evaluate
    from gear_damping.interface.explained import Answer, explain
    from gear_damping.interface.identified import Identification, identify
    from gear_damping.interface.model import Model
    from gear_damping.interface.planned import Plan, plan
    from gear_damping.interface.simulated import Simulation, simulate
    from gear_damping.measurement.load import load_measurement as load
    from gear_damping.measurement.record import Measurement
    from gear_damping.physics.systems.gear_pair import GearPair
    from gear_damping.physics.systems.oscillator import Oscillator
    from gear_damping.simulation.driven import Driven
    from gear_damping.simulation.solver_settings import Solver

settle_threads()

# what is offered -> where it is, and what it is called there
_PLACES = {
    "Answer": ("interface.explained", "Answer"),
    "Damping": ("interface.damping", "Damping"),
    "Driven": ("simulation.driven", "Driven"),
    "Estimator": ("interface.estimator", "Estimator"),
    "Evaluation": ("interface.evaluated", "Evaluation"),
    "GearPair": ("physics.systems.gear_pair", "GearPair"),
    "Identification": ("interface.identified", "Identification"),
    "InputError": ("errors", "InputError"),
    "Listener": ("explanation.explain", "Listener"),
    "Measurement": ("measurement.record", "Measurement"),
    "Model": ("interface.model", "Model"),
    "Oscillator": ("physics.systems.oscillator", "Oscillator"),
    "Plan": ("interface.planned", "Plan"),
    "PlanCosts": ("identification.test_plan.asked", "PlanCosts"),
    "PlanGoal": ("identification.test_plan.asked", "PlanGoal"),
    "PlannedSensor": ("identification.test_plan.asked", "PlannedSensor"),
    "PlannedTests": ("identification.test_plan.asked", "PlannedTests"),
    "Simulation": ("interface.simulated", "Simulation"),
    "Solver": ("simulation.solver_settings", "Solver"),
    "Unknown": ("identification.test_plan.asked", "Unknown"),
    "bound": ("interface.bound", "bound"),
    "damping": ("interface.damping", "damping"),
    "estimator": ("interface.estimator", "estimator"),
    "evaluate": ("interface.evaluated", "evaluate"),
    "explain": ("interface.explained", "explain"),
    "identify": ("interface.identified", "identify"),
    "load": ("measurement.load", "load_measurement"),
    "load_estimator": ("interface.estimator", "load_estimator"),
    "plan": ("interface.planned", "plan"),
    "simulate": ("interface.simulated", "simulate"),
}
_EFFECTS = {
    "".join(word.capitalize() for word in path.stem.split("_")): path.stem
    for path in (Path(__file__).parent / "physics" / "effects").glob("[!_]*.py")
}

__all__ = [
    "Answer", "Damping", "Driven", "Estimator", "Evaluation", "GearPair", "Identification", "InputError", "Listener",
    "Measurement", "Model", "Oscillator", "Plan", "PlanCosts", "PlanGoal", "PlannedSensor", "PlannedTests",
    "Simulation", "Solver", "Unknown", "__version__", "bound", "damping", "estimator", "evaluate", "explain",
    "identify", "load", "load_estimator", "plan", "simulate",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        place, own = _PLACES[name]
        found = getattr(import_module(f"{__name__}.{place}"), own)
    elif name in _EFFECTS:
        from gear_damping.physics.catalogue import builtin_effects

        found = builtin_effects()[_EFFECTS[name]]
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'{_nearest(name)}")
    globals()[name] = found
    return found


def _nearest(name: str) -> str:
    from difflib import get_close_matches

    found = get_close_matches(name, __dir__(), n=1)
    return f"; did you mean '{found[0]}'?" if found else ""


def __dir__() -> list[str]:
    return sorted({*__all__, *_EFFECTS})
