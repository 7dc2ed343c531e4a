"""What the stated figures of a rig foretell: how fast it swings, and of a gear pair how its teeth mesh and give way."""

from collections.abc import Mapping
from math import pi

import numpy as np

from gear_damping.measurement.angular_error import base_radius
from gear_damping.measurement.record import Channel, Measurement, Quantity, Record
from gear_damping.units import parse_unit

Stated = Mapping[str, Quantity]

WAVE = ("mesh_stiffness_max", "mesh_stiffness_min", "contact_ratio")
INERTIAS = ("inertia_pinion", "inertia_gear")
RESPONSE = "transmission_error"
FAR = 3.0  # times what the stated stiffness says: that of a pair is known to a fifth, and half of it stands for a pitch


def natural_frequency(measurement: Measurement) -> float | None:
    """Hz, of small motion; None where the file does not state enough."""
    stated = measurement.parameters
    if spring := stated.get("stiffness"):  # over the mass
        return spring.value**0.5 / (2 * pi) or None
    stiffness, mass = _stated_stiffness(stated), equivalent_mass(stated)
    return (stiffness / mass) ** 0.5 / (2 * pi) if stiffness and mass else None


def mean_stiffness(values: Mapping[str, float]) -> float | None:
    """N/m, over a period of the mesh, of values in SI by the file's names; None where one of them is missing."""
    if not all(name in values for name in WAVE):
        return None
    most, least, ratio = (values[name] for name in WAVE)
    return least + (ratio - 1) * (most - least)


def _stated_stiffness(stated: Stated) -> float | None:
    return mean_stiffness({name: quantity.value for name, quantity in stated.items()})


def equivalent_mass(stated: Stated) -> float | None:
    """Kg, along the line of action."""
    if whole := stated.get("equivalent_mass"):
        return whole.value
    radii, inertias = _radii(stated), [stated.get(name) for name in INERTIAS]
    if not radii or not all(inertias):
        return None
    return 1 / sum(radius**2 / inertia.value for radius, inertia in zip(radii, inertias, strict=True))


def of_record(measurement: Measurement, record: Record) -> str:
    """How often teeth mesh in a record, and how far its mean torque presses them; empty where that is not known."""
    stated = measurement.parameters
    speed, teeth = _mean(record, "pinion_speed"), stated.get("n_teeth_pinion")
    said = []
    if speed and teeth:
        said.append(f"teeth mesh at {abs(speed) * teeth.value / (2 * pi):.4g} Hz on average")
    torque, stiffness, radii = _mean(record, "pinion_torque"), _stated_stiffness(stated), _radii(stated)
    if torque and stiffness and radii:
        channel = record.channels.get(RESPONSE)
        unit = channel.declared_unit if channel else "um"
        pressed = abs(torque) / radii[0] / stiffness / parse_unit(unit).factor
        said.append(f"the mean torque presses them by {pressed:.3g} {unit}{_otherwise(channel, pressed, unit)}")
    return ", ".join(said)


def _otherwise(channel: Channel | None, pressed: float, unit: str) -> str:
    """What is said where a transmission error that counts from the unloaded contact lies far from what it should be."""
    if channel is None or channel.datum != "absolute":
        return ""
    mean = abs(float(channel.values.mean())) / parse_unit(unit).factor
    if pressed / FAR < mean < FAR * pressed:
        return ""
    return (
        f", and its mean, counted from the unloaded contact, is {mean:.3g} {unit}: check the torque, the stiffness and "
        "their units, or leave out datum: absolute"
    )


def _radii(stated: Stated) -> tuple[float, ...]:
    """m, of the base circles of pinion and gear."""
    known = [stated.get(name) for name in ("n_teeth_pinion", "n_teeth_gear", "module", "pressure_angle")]
    if not all(known):
        return ()
    pinion, gear, module, angle = (one.value for one in known)
    return base_radius(pinion, module, angle), base_radius(gear, module, angle)


def _mean(record: Record, name: str) -> float | None:
    """In SI: of a speed that of the angle, else the stated one, beside which a channel may be about its mean."""
    if name == "pinion_speed" and "pinion_angle" in record.channels:
        angle = record.channels["pinion_angle"].values
        return float(angle[-1] - angle[0]) * record.sampling_rate / max(angle.size - 1, 1)
    if name in record.conditions:
        return record.conditions[name].value
    return float(np.mean(record.channels[name].values)) if name in record.channels else None
