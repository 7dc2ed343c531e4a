"""What sensors on the shafts of a gear pair see of a run: speeds and angular accelerations."""

import torch
from torch import Tensor

from gear_damping.errors import with_article
from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Prepared
from gear_damping.physics.systems.gear_pair import true_torque
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, LoadFactor, LoadPath, MeshForceFactor
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
    Behind the torsion of the pinion's shaft T1 is the shaft's torque, before that of the gear's T2.
    Of errors of geometry only x is seen. That they, as a stiffness that turns, also change the arms of the mesh force
    N, which speeds both shafts up by the force N e' / (r_b1 omega_1), is left out: of an eccentricity of 20 um at
    150 N m and 4600 rpm .6 of what the pinion shows of it, 2.4 times what the gear shows, and more at lower speeds.
    Load effects (drag, a ripple, a torque that varies) are torques on the pinion. Where the gear's torque balances them
    they enter through x'' alone, where it is held, or does not follow a ripple, through a too; so does sliding friction
    off the pitch point, to first order in its coefficient. Drawn loads enter through x'' alone, as do torques on both
    shafts that balance.

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
    unbalanced = _unseen_force(runs)
    if _is_held(runs):
        inputs = _inputs(runs)
        drive, brake = (inputs.get(f"{s}_torque", runs.values[f"{s}_torque"].unsqueeze(1)) for s in ("pinion", "gear"))
        drive = true_torque(drive.T, runs.values).T
        unbalanced = unbalanced + drive / pinion_radius - brake / gear_radius
    pinion, gear = _compliances(runs)
    scale = runs.derived["equivalent_mass"].unsqueeze(1) * (pinion + gear)  # of both inertias against the drawing
    return unbalanced / (scale * (1 / pinion + 1 / gear))


def _inputs(runs: Runs) -> dict[str, Tensor]:
    """The inputs as they are up to each sample, which is what the acceleration there belongs to."""
    return {n: torch.cat([s[:, :1], s[:, :-1]], -1) if n in runs.held else s for n, s in runs.inputs.items()}


def _is_held(runs: Runs) -> bool:
    return runs.model.system.chosen["gear_torque_mode"] == "held"


def _unseen_force(runs: Runs) -> Tensor:
    """The force on both pitch circles as one body beyond that of the stated torques, N, (batch, time) or one 0."""
    acting = [effect for effect in runs.model.effects if isinstance(effect, LoadPath | MeshForceFactor)]
    loads = [effect for effect in runs.model.effects if isinstance(effect, Load | LoadFactor)]
    if not acting and not any(_is_held(runs) or getattr(load, "is_unbalanced", False) for load in loads):
        return torch.zeros((), dtype=torch.float64)
    prepared = runs.model.prepare(runs.values)
    equation, at = EquationOfMotion(runs.model), _kinematics(runs, prepared)
    at.active_branch = {name: _reached(value) for name, value in equation.switches(at, prepared.terms).items()}
    equation.fill_in_loads(at, prepared.base, prepared.terms)
    return _unbalanced_force(runs, prepared, at) + _sliding(runs, prepared, at)


def _unbalanced_force(runs: Runs, prepared: Prepared, at: Kinematics) -> Tensor:
    """Of what a shaft transmits beyond what drives or brakes it, and of loads that no torque on the gear balances, N.

    Loads are torques on the pinion. In the load of the mesh torques of both shafts have one sign, on the body opposite
    ones.
    """
    alone = at.drive_load - runs.model.system.load(at, prepared.base) if _is_held(runs) else at.unbalanced_load
    paths = [effect for effect in runs.model.effects if isinstance(effect, LoadPath)]
    found = [(alone, "pinion"), *((at.load - at.drive_load, path.turned_shaft) for path in paths)]
    pinion, gear = _compliances(runs)
    on_body = {"pinion": 1 + gear / pinion, "gear": -(1 + pinion / gear)}  # of a force in the load of the mesh
    return sum((force * prepared.scales.force + torch.zeros_like(at.displacement)).T * on_body[s] for force, s in found)


def _sliding(runs: Runs, prepared: Prepared, at: Kinematics) -> Tensor:
    """The force on both pitch circles of what acts between the flanks beside the normal force, N, or one 0.

    What it has on average under balanced torques the brake gives way to, since the speed stays.
    """
    effects = [effect for effect in runs.model.effects if isinstance(effect, MeshForceFactor)]
    shares = [effect.common_share(at, prepared.terms[effect.name]) for effect in effects]
    shares = [share for share in shares if share is not None]
    if not shares:
        return torch.zeros((), dtype=torch.float64)
    drive, load = (
        ((force + torch.zeros_like(at.displacement)) * prepared.scales.force).T for force in (at.drive_load, at.load)
    )
    if ACCELERATION in runs.states:
        moved = runs.states[ACCELERATION]
    else:
        moved = torch.gradient(runs.states["velocity"], dim=-1)[0] * runs.sampling_rate
    pressed = load - runs.derived["equivalent_mass"].unsqueeze(1) * moved
    return sum(pressed * share.T - (not _is_held(runs)) * drive * mean.unsqueeze(1) for share, mean in shares)


def _kinematics(runs: Runs, prepared: Prepared) -> Kinematics:
    """Every instant of every run in natural units, (time, batch)."""
    units = natural_units(runs.model, prepared)
    x, v, *extra = (runs.states[name].T / unit for name, unit in units.items())
    inputs = _inputs(runs)
    given = {n: inputs[n].T / unit for n, unit in input_units(runs.model, inputs, prepared).items()}
    interval = 1 / (runs.sampling_rate * prepared.scales.time)
    turning = given | ({ANGLE_RATE: _rate(given[ANGLE], interval)} if ANGLE in given else {})
    time = torch.arange(len(x), dtype=x.dtype).unsqueeze(1) * interval
    turns = runs.model.system.rotations(time, turning, prepared.base, x)
    names = list(units)[2:]
    return Kinematics(time, x, v, extra=dict(zip(names, extra, strict=True)), inputs=given, **turns)


def _reached(switch: Tensor) -> Tensor:
    """The branch of a switching function (time, batch): at the start what begins there, later what holds up to then."""
    return torch.cat([switch[:1] >= 0, switch[1:] > 0]).to(switch)


def _rate(angle: Tensor, interval: Tensor) -> Tensor:
    """Rate of an angle (time, rows) by differences, over intervals (batch,)."""
    if len(angle) == 1:
        return torch.zeros_like(angle) / interval
    return torch.gradient(angle, dim=0)[0] / interval


def _integral(rate: Tensor, sampling_rate: float) -> Tensor:
    """Cumulative integral by trapezoids from 0, (batch, time)."""
    steps = (rate[:, 1:] + rate[:, :-1]) / (2 * sampling_rate)
    return torch.nn.functional.pad(steps.cumsum(-1), (1, 0))
