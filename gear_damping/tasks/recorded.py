"""What a rig would have recorded of simulated runs: channels, and records that can be fed back."""

from pathlib import Path

import torch
from torch import Tensor

from gear_damping.config.settings import Settings
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.vocabulary import INPUTS, OSCILLATOR_CHANNELS, PARAMETERS
from gear_damping.physics.effects.torque_variation import TorqueVariation
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Model
from gear_damping.physics.systems.swinging import MOTION
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import MeshStiffness
from gear_damping.simulation.inspect import forces_of
from gear_damping.simulation.runs import Runs, effect_state_units

UNITS = {"transmission_error": "m", "pinion_torque": "N*m", "gear_torque": "N*m", "pinion_angle": "rad"}
OWN_UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2", "force": "N",
             "base_acceleration": "m/s^2"}  # fmt: skip
FROM_THE_MESH = {"mesh_stiffness_max": "maximum", "mesh_stiffness_min": "minimum", "contact_ratio": "contact_ratio"}
Channels = dict[str, Tensor]


def recorded_channels(runs: Runs, seed: int) -> Channels:
    """Every channel of a measurement file that the system has, (runs, time), SI.

    The response and the pinion angle are those behind the sensors that act on them.

    Args:
        runs: Simulated runs.
        seed: Of the sensors' noise.
    """
    generator = torch.Generator().manual_seed(seed)
    channels = {runs.model.system.response: runs.record(generator)}
    if not runs.model.system.has(Trait.SHAFTS):
        forces = [forces_of(runs, member) for member in range(len(runs.status))]
        free = torch.stack([one["load"] - one["mesh_force"] for one in forces])
        channels["velocity"] = runs.states["velocity"]
        channels["acceleration"] = free / runs.derived["equivalent_mass"].unsqueeze(1)
        return channels | {name: series for name, series in runs.inputs.items() if name in OSCILLATOR_CHANNELS}
    channels["pinion_angle"] = runs.measured("pinion_angle", generator)
    return channels | _torques(runs)


def units_of(model: Model) -> dict[str, str]:
    """The unit of every channel: SI, or the rig's own; "" where nobody knows it."""
    if model.system.has(Trait.SHAFTS):
        return UNITS | effect_state_units(model)
    return {name: model.system.unit_of(unit) for name, unit in (OWN_UNITS | effect_state_units(model)).items()}


def _torques(runs: Runs) -> Channels:
    """The torques that a torque meter shows: a ripple is none of them, a torque that is varied is."""
    shape = runs.response.shape
    held = runs.model.system.chosen["gear_torque_mode"] == "held"
    found = {}
    for name in ("pinion_torque", "gear_torque") if held else ("pinion_torque",):
        found[name] = runs.inputs.get(name, runs.values[name].unsqueeze(1)).expand(shape)
    found["pinion_torque"] = found["pinion_torque"] + _varied_torque(runs)
    if not held:
        ratio = runs.values["n_teeth_gear"] / runs.values["n_teeth_pinion"]
        found["gear_torque"] = found["pinion_torque"] * ratio.unsqueeze(1)
    return found


def _varied_torque(runs: Runs) -> Tensor:
    """What `torque_variation` adds to the pinion torque, (runs, time)."""
    effect = next((effect for effect in runs.model.effects if isinstance(effect, TorqueVariation)), None)
    if effect is None:
        return torch.zeros_like(runs.response)
    prepared = runs.model.prepare(runs.values)
    time = runs.time.unsqueeze(1) / prepared.scales.time  # (time, runs): parameters have one value a run
    at, terms = Kinematics(time, time * 0, time * 0), prepared.terms[effect.name]
    at.active_branch = {name: (value >= 0).to(value) for name, value in effect.switches(at, terms).items()}
    force = (effect.load_force(at, terms) * prepared.scales.force).expand(time.shape)
    return (force / runs.derived["load_per_pinion_torque"]).T


def as_records(runs: Runs, channels: Channels) -> list[Record]:
    """The runs as records of a rig, one a run.

    An oscillator is recorded in its displacement (and force): the other channels follow from it. A gear torque
    that balances follows from the pinion's.
    """
    system = runs.model.system
    names = [system.response, *(name for name in channels if name in (*INPUTS, "pinion_angle"))]
    mode = system.chosen["gear_torque_mode"] if system.has(Trait.TORQUE) else None
    if mode == "balanced":
        names.remove("gear_torque")
    units = units_of(runs.model)
    speed = runs.values.get("pinion_speed")
    records = []
    for i in range(len(runs.status)):
        signals = {name: Channel(name, channels[name][i].numpy().copy(), units[name] or "1") for name in names}
        record = Record(
            name=f"run_{i + 1}",
            file=Path(f"run_{i + 1}.csv"),
            sha256="",
            role=None,
            sampling_rate=runs.sampling_rate,
            time=runs.time.numpy(),
            channels=signals,
            conditions={} if speed is None else {"pinion_speed": Quantity(float(speed[i]), "rad/s")},
            gear_torque_mode=mode if mode == "balanced" else None,
        )
        records.append(record)
    return records


def rig_parameters(settings: Settings) -> dict[str, Quantity]:
    """What is known of the rig beforehand and differs from the defaults: its gears, inertias and mesh.

    Damping and the effects are what a measurement is taken for: they are not among them.
    """
    simulator = settings.simulator
    system = simulator.model.system
    if system.has(Trait.MASS, Trait.REST):
        unknown = {system.spring, *system.gains.values(), *(parameter.name for parameter in MOTION)}
        known = [p for p in system.parameters if p.name not in unknown and p.name in simulator.given]
        return {p.name: Quantity(float(simulator.given[p.name]), p.unit) for p in known}
    if not system.has(Trait.TEETH):
        return {}
    mesh = next(effect.name for effect in simulator.model.effects if isinstance(effect, MeshStiffness))
    found = {}
    for name, unit in PARAMETERS[system.name].items():
        flat = f"{mesh}.{FROM_THE_MESH[name]}" if name in FROM_THE_MESH else name
        declared, value = simulator.model.parameters().get(flat), simulator.given.get(flat)
        if declared is not None and value is not None and value != declared.default:
            found[name] = Quantity(float(value), unit)
    return found
