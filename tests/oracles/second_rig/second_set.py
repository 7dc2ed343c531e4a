"""Cases d01 to d14, made later than the first set."""

from __future__ import annotations

from dataclasses import replace

from .case import Case, Stream
from .channels import AC, COLOURED, COUNTS, ERROR_MM, ERROR_OF_ENCODERS, ERROR_UM, ERROR_WITH_ZERO, PINK, WHITE
from .files import Encoders, Table
from .motion import Hidden, Run
from .pair import steel_rig
from .sensors import Noise, Sensor

SEED = 51123


def _at(words: int, half: int | None = None) -> Stream:
    return Stream(SEED, words, half)


def _d01() -> Case:
    return Case(
        steel_rig((17, 43), 3e-3, 0.022, (2e-3, 1.5e-2), 0.02),
        (Run(25e3, 0.3, 1250, 70.0), Run(25e3, 0.2, 2300, 70.0), Run(25e3, 0.2, 3300, 130.0)),
        Sensor("gear_speed", "rpm", shaft="gear"),
        Table("csv", "n2"),
        Noise(COLOURED, 30),
        _at(0),
        "the file holds the fluctuation of the speed",
    )


def _d02() -> Case:
    rig = steel_rig((29, 53), 2e-3, 0.02, (1e-3, 6e-3), 0.025)
    return Case(
        rig,
        (
            Run(51200, 0.15, 1900, 40.0),
            Run(51200, 0.15, 2900, 40.0, at_rest=True),
            Run(51200, 0.1, 4100, 60.0),
            Run(51200, 0.1, 1400, 60.0),
        ),
        Sensor("acceleration", "m/s^2", radius=rig.radii[0]),
        Table("mat", "a", time=True, angle=True),
        Noise(PINK, 28),
        _at(18507, 3829049281),
        "pink noise",
    )


def _d03() -> Case:
    rig, zero = steel_rig((22, 59), 2.5e-3, 0.025, (2e-3, 2.5e-2), 0.02), 0.33
    return Case(
        rig,
        (
            Run(40e3, 0.5, 1500, 90.0, mesh_zero=zero),
            Run(40e3, 0.4, 2200, 90.0, mesh_zero=zero),
            Run(40e3, 0.4, 1800, 150.0, mesh_zero=zero),
        ),
        Sensor("acceleration", "m/s^2", radius=rig.radii[0]),
        Table("npz", "a", angle=True),
        Noise(WHITE, 30),
        _at(44708, 4150161494),
        "a tooth of the gear, and only the angle of the pinion is known",
        Hidden("tooth_crack", {"depth": 0.25}),
    )


def _d04() -> Case:
    zero = 0.12
    return Case(
        steel_rig((27, 64), 2e-3, 0.025, (1e-3, 1.5e-2), 0.022),
        (
            Run(12800, 0.8, 1100, 60.0, mesh_zero=zero),
            Run(12800, 0.6, 1900, 60.0, mesh_zero=zero),
            Run(12800, 0.6, 1500, 110.0, mesh_zero=zero),
            Run(12800, 0.5, 2500, 110.0, mesh_zero=zero),
        ),
        ERROR_UM,
        Table("csv", "te", angle=True),
        Noise(COLOURED, 30),
        _at(97899),
        "the gear, and only the angle of the pinion is known",
        Hidden("gear_eccentricity", {"amplitude": 1e-5, "phase": 0.7}),
    )


def _d05() -> Case:
    return Case(
        steel_rig((33, 45), 3e-3, 0.02, (6e-3, 2e-2), 0.016),
        (
            Run(20e3, 0.4, 1300, 120.0, role="fit"),
            Run(20e3, 0.3, 2100, 120.0, role="fit"),
            Run(20e3, 0.3, 1700, 200.0, role="holdout"),
        ),
        ERROR_MM,
        Table("csv", "te", "%.9f"),
        Noise(WHITE, 30),
        _at(131463),
        "no angle is known",
        Hidden("pinion_eccentricity", {"amplitude": 5e-6, "phase": 2.9}),
    )


def _d06() -> Case:
    return Case(
        steel_rig((19, 45), 3e-3, 0.025, (1.5e-3, 2e-2), 0.025),
        (Run(25e3, 0.5, 1200, 80.0), Run(25e3, 0.4, 2000, 80.0), Run(25e3, 0.4, 1600, 140.0)),
        ERROR_UM,
        Table("csv", "DTE"),
        Noise(WHITE, 30),
        _at(151932, 1120042208),
        "one tooth of the pinion; no angle is known",
        Hidden("pitch_error", {"amplitude": 5e-6, "tooth": 4}),
    )


def _d07() -> Case:
    return Case(
        steel_rig((26, 33), 2.5e-3, 0.02, (2.5e-3, 6e-3), 0.012),
        (
            Run(40e3, 0.15, 1400, 50.0, at_rest=True),
            Run(40e3, 0.15, 2500, 90.0, at_rest=True),
            Run(40e3, 0.15, 3300, 90.0, at_rest=True),
            Run(40e3, 0.12, 1900, 150.0, at_rest=True),
        ),
        ERROR_UM,
        Table("npz", "te"),
        Noise(WHITE, 40),
        _at(185224),
        "dry friction",
        Hidden("coulomb_friction", {"force": 30.0, "width": 2e-3}),
    )


def _d08() -> Case:
    rig = steel_rig((24, 56), 3e-3, 0.03, (3e-3, 4e-2), 0.01)
    low = tuple(Run(50e3, 0.1, 1500, torque, at_rest=True) for torque in (60.0, 150.0, 300.0))
    return Case(
        rig,
        (*low, Run(50e3, 0.1, 2900, 220.0, at_rest=True)),
        Sensor("acceleration", "g", shaft="gear", radius=rig.radii[1]),
        Table("csv", "a"),
        Noise(WHITE, 40),
        _at(208564),
        "c v + c2 |v| v",
        Hidden("power_law_damping", {"exponent": 2.0, "coefficient": 9000.0}),
    )


def _d09() -> Case:
    return Case(
        steel_rig((31, 49), 2.5e-3, 0.025, (4e-3, 2e-2), 0.02),
        (
            Run(20e3, 0.5, 1100, 100.0),
            Run(20e3, 0.4, 2100, 100.0),
            Run(20e3, 0.4, 1600, 160.0),
            Run(20e3, 0.3, 2700, 160.0),
        ),
        Sensor("pinion_speed", "rpm", said=AC),
        Table("mat", "w1"),
        Noise(WHITE, 36),
        _at(229021),
        "torque of the motor, once a turn; that of the gear follows",
        Hidden("torque_ripple", {"amplitude": 25.0, "phase": 1.4, "follows": True}),
    )


def _d10() -> Case:
    return Case(
        steel_rig((23, 61), 3e-3, 0.03, (2.5e-3, 4e-2), 0.02),
        (
            Run(20e3, 0.8, 1300, 120.0),
            Run(20e3, 0.8, 1900, 120.0),
            Run(20e3, 0.6, 1600, 180.0),
            Run(20e3, 0.6, 2300, 180.0),
        ),
        ERROR_OF_ENCODERS,
        Encoders("csv", (COUNTS, COUNTS)),
        Noise(WHITE, 32),
        _at(261732),
        "one tooth of the gear; it stands elsewhere in each record, though the counters run on",
        Hidden("tooth_crack", {"depth": 0.15}),
    )


def _d11() -> Case:
    low = tuple(Run(50e3, 0.1, 1700, torque, at_rest=True) for torque in (25.0, 70.0, 140.0))
    return Case(
        steel_rig((30, 37), 2e-3, 0.02, (8e-4, 2e-3), 0.01),
        (*low, Run(50e3, 0.1, 3100, 110.0, at_rest=True)),
        ERROR_WITH_ZERO,
        Table("csv", "te", time=True),
        Noise(WHITE, 40),
        _at(318907),
        "c v + c3 v^3; absolute zero",
        Hidden("power_law_damping", {"exponent": 3.0, "coefficient": 1.5e5}),
    )


def _d12() -> Case:
    rig, zero = steel_rig((28, 43), 2.5e-3, 0.02, (2.5e-3, 1e-2), 0.025), 0.4
    tuned = ((0.97, 12.0), (0.6, 60.0), (1.04, 20.0), (0.5, 14.0))
    return Case(
        rig,
        tuple(Run(50e3, 0.12, rig.speed_at(tuning), torque, mesh_zero=zero) for tuning, torque in tuned),
        ERROR_WITH_ZERO,
        Table("npz", "x", angle=True),
        Noise(WHITE, 40),
        _at(339368),
        "teeth part near resonance; absolute zero",
        Hidden("backlash", {"gap": 8e-5}),
    )


def _d13() -> Case:
    rig = steel_rig((37, 41), 2e-3, 0.02, (1.5e-3, 2.5e-3), 0.04)
    return Case(
        rig,
        (
            Run(25e3, 0.15, 1500, 40.0, at_rest=True),
            Run(25e3, 0.15, 2400, 40.0, at_rest=True),
            Run(25e3, 0.15, 3500, 70.0, at_rest=True),
        ),
        Sensor("gear_speed", "rad/s", shaft="gear"),
        Table("csv", "w2"),
        Noise(PINK, 34),
        _at(363896),
        "1 % declared, 4 % true; the file holds the fluctuation of the speed",
        Hidden("damping_ratio"),
        declared=replace(rig, damping_ratio=0.01),
    )


def _d14() -> Case:
    zero = 0.6
    return Case(
        steel_rig((21, 44), 3e-3, 0.025, (2e-3, 1.5e-2), 0.018, gain=1.6),
        (
            Run(16e3, 1.0, 350, 90.0, mesh_zero=zero),
            Run(16e3, 0.8, 600, 90.0, mesh_zero=zero),
            Run(16e3, 0.6, 950, 160.0, mesh_zero=zero),
        ),
        ERROR_UM,
        Table("csv", "te", angle=True),
        Noise(WHITE, 26),
        _at(375397, 716638401),
        "slow",
    )


SECOND = (_d01, _d02, _d03, _d04, _d05, _d06, _d07, _d08, _d09, _d10, _d11, _d12, _d13, _d14)
