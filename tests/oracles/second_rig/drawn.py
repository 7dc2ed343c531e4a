"""Cases that are drawn by a number: teeth, loads, speeds, sensors, files, noise and what is hidden all vary.

What is hidden is drawn from its usual size and kept only if it shows: a case in which it moves no record by VISIBLE
standard deviations of the noise is drawn anew.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .case import Case, Stream
from .channels import AC, ARBITRARY, COLOURED, COUNTS, ERROR_OF_ENCODERS, PINK, WHITE
from .files import Encoders, Table, Writer
from .motion import Hidden, Run, simulate
from .pair import Rig, steel_rig
from .sensors import Noise, Sensor, shaken

VISIBLE = 0.5  # root mean square of what is hidden over that of the noise, in the record that shows it best
ATTEMPTS = 60  # to draw something that shows
RATES = (8e3, 12.8e3, 16e3, 20e3, 25e3, 25.6e3, 40e3, 48e3, 50e3, 51.2e3, 80e3, 100e3)  # samples per s
MOST_SAMPLES = 16000  # of a record
NOTHING = 3  # of so many draws as there are names below is nothing hidden
TURNS = 2.5  # of the gear in a record that has to show a single tooth or an eccentricity, at least
Rng = np.random.Generator


@dataclass(frozen=True)
class Setting:
    """The rig and what it carries: deflection / m, the mean one under the lower torque."""

    rig: Rig
    deflection: float

    @property
    def torque(self) -> float:
        """The lower one of the pinion / (N m)."""
        return self.rig.mean_stiffness * self.deflection * self.rig.radii[0]

    @property
    def rate(self) -> float:
        """Of a vibration at the natural frequency of the size of the deflection / (m/s)."""
        return 2 * math.pi * self.rig.natural_frequency * self.deflection


def drawn(number: int) -> Case:
    """The case of a number, which settles what is hidden: the first of its draws that shows it."""
    name = str(np.random.default_rng(number).choice(["nothing"] * NOTHING + list(SIZES)))
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([number, attempt])
        case = _case(name, rng, int(rng.integers(2**31)))
        if _shows(case):
            return case
    raise ValueError(f"no draw of {number} shows what it hides")


def _case(name: str, rng: Rng, seed: int) -> Case:
    setting = Setting(_rig(rng), rng.uniform(2e-6, 7e-6))
    hidden = SIZES[name](rng, setting) if name != "nothing" else None
    sensor, writer = _seen(rng, setting.rig)
    if name == "sensor_mount_resonance":
        sensor, writer = _mounted(rng, setting.rig, resonant=True), Table("csv", "acc")
    runs = _runs(rng, setting, name, bool(getattr(writer, "angle", False)))
    noise = Noise(str(rng.choice([WHITE, WHITE, PINK, COLOURED])), float(rng.integers(24, 43)))
    case = Case(setting.rig, runs, sensor, writer, noise, Stream(seed, 0), "drawn", hidden, assembled=True)
    if name == "torque_ripple":
        return _rippled(case)
    return replace(case, declared=_declared(rng, setting.rig, hidden))


def _rippled(case: Case) -> Case:
    """The gear's torque stands where nothing shows how the shafts then speed up, and follows where a sensor would."""
    if case.sensor.channel == "transmission_error" and not isinstance(case.writer, Encoders):
        return replace(case, gear_torque="held")
    return replace(case, hidden=replace(case.hidden, values={**case.hidden.values, "follows": True}))


def _rig(rng: Rng) -> Rig:
    teeth = (int(rng.integers(17, 41)), int(rng.integers(30, 80)))
    hubs = tuple(float(f"{10 ** rng.uniform(-3.2, -1.6):.2g}") for _ in range(2))
    module, width = float(rng.choice([1.5, 2.0, 2.5, 3.0, 4.0])) * 1e-3, float(rng.integers(12, 41)) * 1e-3
    damping, gain = round(rng.uniform(0.008, 0.045), 4), round(rng.uniform(1.25, 1.7), 2)
    return steel_rig(teeth, module, width, hubs, damping, gain, str(rng.choice(["trapezoid", "fourier"])))


def _runs(rng: Rng, setting: Setting, name: str, indexed: bool) -> tuple[Run, ...]:
    """Three to five records; those of a law of damping ring, those of a gap pass the resonance."""
    rig, count = setting.rig, int(rng.integers(3, 6))
    rate = min(RATES, key=lambda one: abs(math.log(one / (rig.natural_frequency * rng.uniform(4, 9)))))
    zero = float(round(rng.uniform(), 2)) if indexed else None
    higher, holdout = rng.uniform(1.4, 2.2), rng.uniform() < 0.3
    runs = []
    for place in range(count):
        resonant = name == "backlash" and place % 2 == 0
        tuning = rng.uniform(0.88, 1.08) if resonant else 10 ** rng.uniform(-0.9, 0.05)
        speed = float(round(min(rig.speed_at(tuning), 6000.0)))
        rings = rng.uniform() < (0.85 if name in LAWS else 0.3)
        torque = float(f"{setting.torque * (higher if place % 3 == 1 else 1.0):.3g}")
        shortest = TURNS * 60 / speed * rig.teeth[1] / rig.teeth[0] if name in ROTATING else 0.0
        seconds = min(max(rng.uniform(0.1, 0.4), shortest), MOST_SAMPLES / rate)
        role = None if not holdout else ("holdout" if place == count - 1 else "fit")
        runs.append(Run(rate, round(seconds, 2), speed, torque, at_rest=rings, role=role, mesh_zero=zero))
    return tuple(runs)


def _seen(rng: Rng, rig: Rig) -> tuple[Sensor, Writer]:
    """A sensor and the file that holds it."""
    kind = rng.choice(["error", "error", "encoders", "speed", "acceleration"])
    if kind == "encoders":
        return ERROR_OF_ENCODERS, Encoders(str(rng.choice(["csv", "mat"])), (COUNTS, COUNTS))
    table = Table(str(rng.choice(["csv", "mat", "npz"])), "y", "%.9g", bool(rng.integers(2)), bool(rng.integers(2)))
    shaft = str(rng.choice(["pinion", "gear"]))
    if kind == "error":
        said = ARBITRARY if rng.integers(2) else ()
        return Sensor("transmission_error", str(rng.choice(["um", "mm", "m"])), said=said), table
    if kind == "speed":
        whole = shaft == "pinion" and bool(rng.integers(2))  # the gear's tells no rotation of the pinion
        said = AC if shaft == "pinion" and not whole and rng.integers(2) else ()
        return Sensor(f"{shaft}_speed", str(rng.choice(["rad/s", "rpm"])), shaft, whole=whole, said=said), table
    return _mounted(rng, rig, shaft), table


def _mounted(rng: Rng, rig: Rig, shaft: str = "pinion", resonant: bool = False) -> Sensor:
    """An accelerometer at the rim, on a mount that resonates or not."""
    radius = rig.radii[shaft == "gear"]
    mount = (rig.natural_frequency * rng.uniform(1.3, 2.5), rng.uniform(0.02, 0.06)) if resonant else None
    return Sensor("acceleration", str(rng.choice(["m/s^2", "g"])), shaft, radius, mount=mount)


def _declared(rng: Rng, rig: Rig, hidden: Hidden | None) -> Rig | None:
    """The rig as the declaration has it, where a constant is hidden."""
    if hidden and hidden.name == "damping_ratio":
        return replace(rig, damping_ratio=round(rig.damping_ratio * 10 ** rng.uniform(-0.5, 0.5), 4))
    if hidden and hidden.name == "mesh_modulation":
        swing = (rig.two_pairs - rig.one_pair) / hidden.values["true_over_declared"]
        one_pair = float(f"{rig.mean_stiffness - swing * (rig.contact_ratio - 1):.4g}")
        return replace(rig, one_pair=one_pair, two_pairs=float(f"{one_pair + swing:.4g}"))
    return None


def _phase(rng: Rng) -> float:
    return round(rng.uniform(0, 2 * math.pi), 2)


def _power_law(rng: Rng, at: Setting) -> Hidden:
    exponent = float(rng.choice([1.5, 2.0, 2.5, 3.0]))
    share = rng.uniform(0.3, 1.5)  # of the viscous force at the size of the deflection
    coefficient = float(f"{share * at.rig.viscous * at.rate ** (1 - exponent):.3g}")
    return Hidden("power_law_damping", {"exponent": exponent, "coefficient": coefficient})


def _coulomb(rng: Rng, at: Setting) -> Hidden:
    force = float(f"{rng.uniform(0.01, 0.05) * at.torque / at.rig.radii[0]:.3g}")
    return Hidden("coulomb_friction", {"force": force, "width": float(f"{rng.uniform(0.01, 0.05) * at.rate:.2g}")})


def _eccentric(shaft: str) -> Callable[[Rng, Setting], Hidden]:
    def size(rng: Rng, at: Setting) -> Hidden:
        values = {"amplitude": round(10 ** rng.uniform(-5.5, -4.7), 7), "phase": _phase(rng)}
        return Hidden(f"{shaft}_eccentricity", values)

    return size


def _ripple(rng: Rng, at: Setting) -> Hidden:
    amplitude = float(f"{rng.uniform(0.05, 0.3) * at.torque:.3g}")
    return Hidden("torque_ripple", {"amplitude": amplitude, "phase": _phase(rng)})


def _pitch(rng: Rng, at: Setting) -> Hidden:
    tooth = int(rng.integers(at.rig.teeth[0]))
    return Hidden("pitch_error", {"amplitude": round(rng.uniform(2e-6, 8e-6), 7), "tooth": tooth})


SIZES: dict[str, Callable[[Rng, Setting], Hidden]] = {
    "damping_ratio": lambda rng, at: Hidden("damping_ratio"),
    "mesh_modulation": lambda rng, at: Hidden(
        "mesh_modulation", {"true_over_declared": round(rng.uniform(1.2, 1.8), 2)}
    ),
    "coulomb_friction": _coulomb,
    "power_law_damping": _power_law,
    "backlash": lambda rng, at: Hidden("backlash", {"gap": round(rng.uniform(3e-5, 1.2e-4), 6)}),
    "pinion_eccentricity": _eccentric("pinion"),
    "gear_eccentricity": _eccentric("gear"),
    "torque_ripple": _ripple,
    "tooth_crack": lambda rng, at: Hidden("tooth_crack", {"depth": round(rng.uniform(0.08, 0.35), 3)}),
    "pitch_error": _pitch,
    "sensor_mount_resonance": lambda rng, at: Hidden("sensor_mount_resonance"),
}
LAWS = ("coulomb_friction", "power_law_damping")  # that a record shows best which rings
ROTATING = ("pinion_eccentricity", "gear_eccentricity", "torque_ripple", "tooth_crack", "pitch_error")


def _shows(case: Case) -> bool:
    """Whether some record differs by what is hidden, which is not asked of a constant that is declared."""
    if case.hidden is None or case.declared is not None:
        return True
    runs = [replace(run, mesh_zero=run.mesh_zero or 0.0) for run in case.runs]
    without = [case.sensor.fluctuation(case.rig, simulate(case.rig, run)) for run in runs]
    if case.sensor.mount:
        seen = [shaken(case.sensor, case.rig, run) for run in runs]
    else:
        motions = [simulate(case.rig, run, case.hidden) for run in runs]
        if case.hidden.name == "backlash" and not any((motion.x < 0).any() for motion in motions):
            return False
        seen = [case.sensor.fluctuation(case.rig, motion) for motion in motions]
    noise = case.noise.std(seen)
    return max((one - other).std() for one, other in zip(seen, without, strict=True)) > VISIBLE * noise
