"""What sensors on the shafts of a gear pair see of a run: speeds and angular accelerations."""

import torch
from torch import Tensor

from gear_damping.errors import with_article
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Prepared
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, LoadPath, MeshForceFactor
from gear_damping.simulation.integrate import input_units
from gear_damping.simulation.runs import ACCELERATION, Runs
from gear_damping.simulation.series import ANGLE, ANGLE_RATE
from gear_damping.simulation.simulate import natural_units

PINION_SPEED, GEAR_SPEED = "pinion_speed", "gear_speed"
PINION_ACCELERATION, GEAR_ACCELERATION = "pinion_acceleration", "gear_acceleration"


def shaft_motion(runs: Runs) -> dict[str, Tensor]:
    """Fluctuation of the speed (rad/s) and angular acceleration (rad/s^2) of both shafts, each (batch, time).

    From I1 theta1'' = T1 - r_b1 N and I2 theta2'' = -T2 + r_b2 N follows with x = r_b1 theta1 - r_b2 theta2

        theta1'' = a / r_b1 + r_b1 m_e x'' / I1,   theta2'' = a / r_b2 - r_b2 m_e x'' / I2,
        a = (T1 / r_b1 - T2 / r_b2) / (I1 / r_b1^2 + I2 / r_b2^2),

    where a is the acceleration of both pitch circles as one body: 0 where the torques balance. Speeds are those
    about the mean speed of the shafts: the integral of a about its mean, and the share of x'.
    Errors of geometry move x, so that nothing changes here. Behind the torsion of the pinion's shaft T1 is the shaft's
    torque, before that of the gear's T2.
    Load effects (drag, drawn loads, a ripple that the gear's torque follows) enter through x'' alone, as they do where
    that torque balances them, and a ripple that it does not follow enters through a too; so does sliding friction off
    the pitch point, to first order in its coefficient.

    Returns:
        `pinion_speed` and `gear_speed`; where the run has the acceleration (`Solver(acceleration=True)`) also
        `pinion_acceleration` and `gear_acceleration`.

    Raises:
        ValueError: the model is not a gear pair.
    """
    if not runs.model.system.has(Trait.SHAFTS):
        raise ValueError(
            f"shaft_motion needs a gear_pair, this is {with_article(runs.model.system.name)}: it has no shafts"
        )
    moves = ACCELERATION in runs.states
    names = [PINION_SPEED, GEAR_SPEED, *([PINION_ACCELERATION, GEAR_ACCELERATION] if moves else [])]
    return {name: motion_of_shaft(runs, name) for name in names}


def motion_of_shaft(runs: Runs, name: str) -> Tensor:
    """One of the series of `shaft_motion`, (batch, time)."""
    shaft, _, quantity = name.partition("_")
    radius = runs.derived[f"base_radius_{shaft}"].unsqueeze(1)
    sign, share = (1, _participation(runs)[0]) if shaft == "pinion" else (-1, _participation(runs)[1])
    common = _common_acceleration(runs)
    if quantity == "acceleration":
        return torch.addcmul(common / radius, share, runs.states[ACCELERATION], value=sign)
    own = runs.states["velocity"] * (sign * share)
    if common.shape[1] == 1 and not bool(common.any()):
        return own
    drift = _integral(common.expand_as(own), runs.sampling_rate)
    return own + (drift - drift.mean(-1, keepdim=True)) / radius


def _compliances(runs: Runs) -> tuple[Tensor, Tensor]:
    """r_b^2 / I of pinion and gear as they are on the drawing, 1/kg, (batch, 1)."""
    shafts = ("pinion", "gear")
    pinion, gear = (runs.derived[f"base_radius_{s}"] ** 2 / runs.values[f"inertia_{s}"] for s in shafts)
    return pinion.unsqueeze(1), gear.unsqueeze(1)


def _participation(runs: Runs) -> tuple[Tensor, Tensor]:
    """r_b m_e / I of pinion and gear, 1/m, (batch, 1); an error of both inertias does not change it."""
    pinion, gear = _compliances(runs)
    radii = (runs.derived[f"base_radius_{shaft}"].unsqueeze(1) for shaft in ("pinion", "gear"))
    return tuple(part / (pinion + gear) / radius for part, radius in zip((pinion, gear), radii, strict=True))


def _common_acceleration(runs: Runs) -> Tensor:
    """The acceleration of both pitch circles as one body, m/s^2, (batch, time), or (batch, 1) where it is steady."""
    pinion_radius, gear_radius = (runs.derived[f"base_radius_{s}"].unsqueeze(1) for s in ("pinion", "gear"))
    unbalanced = _unbalanced_force(runs) + _sliding(runs)
    if runs.model.system.chosen["gear_torque_mode"] == "held":
        torques = (runs.inputs.get(f"{s}_torque", runs.values[f"{s}_torque"].unsqueeze(1)) for s in ("pinion", "gear"))
        drive, brake = torques
        unbalanced = unbalanced + drive / pinion_radius - brake / gear_radius
    pinion, gear = _compliances(runs)
    scale = runs.derived["equivalent_mass"].unsqueeze(1) * (pinion + gear)  # of both inertias against the drawing
    return unbalanced / (scale * (1 / pinion + 1 / gear))


def _unbalanced_force(runs: Runs) -> Tensor:
    """The force on both pitch circles as one body beyond that of the stated torques, N, (batch, time) or one 0.

    It is what a shaft transmits beyond what drives or brakes it, and what loads on the pinion have that no torque on
    the gear balances. In the load of the mesh torques of both shafts have one sign, on the body opposite ones.
    """
    paths = [effect for effect in runs.model.effects if isinstance(effect, LoadPath)]
    loads = [effect for effect in runs.model.effects if isinstance(effect, Load) and effect.is_unbalanced]
    if not paths and not loads:
        return torch.zeros((), dtype=torch.float64)
    prepared = runs.model.prepare(runs.values)
    at = _kinematics(runs, prepared)
    at.drive_load = _drive_load(runs, prepared, at)
    found = [
        (path.transmitted_load(at, prepared.terms[path.name]) - at.drive_load, path.turned_shaft) for path in paths
    ]
    found += [(load.load_force(at, prepared.terms[load.name]), "pinion") for load in loads]
    pinion, gear = _compliances(runs)
    on_body = {"pinion": 1 + gear / pinion, "gear": -(1 + pinion / gear)}  # of a force in the load of the mesh
    return sum((force * prepared.scales.force).T * on_body[shaft] for force, shaft in found)


def _sliding(runs: Runs) -> Tensor:
    """The force on both pitch circles of what acts between the flanks beside the normal force, N, or one 0.

    What it has on average under balanced torques the brake gives way to, since the speed stays.
    """
    effects = [effect for effect in runs.model.effects if isinstance(effect, MeshForceFactor)]
    if not effects:
        return torch.zeros((), dtype=torch.float64)
    prepared = runs.model.prepare(runs.values)
    at = _kinematics(runs, prepared)
    shares = [effect.common_share(at, prepared.terms[effect.name]) for effect in effects]
    shares = [share for share in shares if share is not None]
    if not shares:
        return torch.zeros((), dtype=torch.float64)
    load = (_drive_load(runs, prepared, at) * prepared.scales.force).T
    if ACCELERATION in runs.states:
        moved = runs.states[ACCELERATION]
    else:
        moved = torch.gradient(runs.states["velocity"], dim=-1)[0] * runs.sampling_rate
    pressed = load - runs.derived["equivalent_mass"].unsqueeze(1) * moved
    is_balanced = runs.model.system.chosen["gear_torque_mode"] == "balanced"
    return sum(pressed * share.T - is_balanced * load * mean.unsqueeze(1) for share, mean in shares)


def _drive_load(runs: Runs, prepared: Prepared, at: Kinematics) -> Tensor:
    """The load of the system alone at every instant, in natural units, (time, batch)."""
    return runs.model.system.load(at, prepared.base) + torch.zeros_like(at.displacement)


def _kinematics(runs: Runs, prepared: Prepared) -> Kinematics:
    """Every instant of every run in natural units, (time, batch)."""
    units = natural_units(runs.model, prepared)
    x, v, *extra = (runs.states[name].T / unit for name, unit in units.items())
    given = {n: runs.inputs[n].T / unit for n, unit in input_units(runs.model, runs.inputs, prepared).items()}
    turning = given | ({ANGLE_RATE: 0 * given[ANGLE]} if ANGLE in given else {})
    time = runs.time.unsqueeze(1) / prepared.scales.time
    turns = runs.model.system.rotations(time, turning, prepared.base, x)
    names = list(units)[2:]
    return Kinematics(time, x, v, extra=dict(zip(names, extra, strict=True)), inputs=given, **turns)


def _integral(rate: Tensor, sampling_rate: float) -> Tensor:
    """Cumulative integral by trapezoids from 0, (batch, time)."""
    steps = (rate[:, 1:] + rate[:, :-1]) / (2 * sampling_rate)
    return torch.nn.functional.pad(steps.cumsum(-1), (1, 0))
