"""Cases c01 to c16."""

from __future__ import annotations

from dataclasses import replace

from .case import Case, Stream
from .channels import AC, COLOURED, COUNTS, ERROR_MM, ERROR_OF_ENCODERS, ERROR_UM, ERROR_WITH_ZERO, PINK, WHITE
from .files import Encoders, Table, Wav
from .motion import Hidden, Run, Steps
from .pair import steel_rig
from .sensors import Noise, Sensor

SEED = 90417


def _at(words: int, half: int | None = None) -> Stream:
    return Stream(SEED, words, half)


def _c01() -> Case:
    steps = Steps(((40.0, 120.0, 0.05), (120.0, 60.0, 0.15)))
    return Case(
        steel_rig((27, 38), 2.5e-3, 0.022, (3e-3, 9e-3), 0.012),
        (
            Run(40e3, 0.25, 1500, 35.0, at_rest=True),
            Run(40e3, 0.25, 1500, steps),
            Run(40e3, 0.25, 3300, 90.0, at_rest=True),
            Run(40e3, 0.2, 2150, 120.0, at_rest=True),
        ),
        Sensor("pinion_speed", "rad/s", whole=True),
        Table("csv", "omega", "%.7g", time=True),
        Noise(WHITE, 40),
        _at(0),
        "the file holds the whole speed, mean and fluctuation",
        Hidden("coulomb_friction", {"force": 35.0, "width": 1.5e-3}),
    )


def _c02() -> Case:
    return Case(
        steel_rig((23, 41), 3e-3, 0.02, (2e-3, 1.2e-2), 0.022, law="fourier"),
        (
            Run(25e3, 0.3, 1100, 60.0, role="fit"),
            Run(25e3, 0.3, 2500, 110.0, role="fit"),
            Run(25e3, 0.2, 3900, 110.0, at_rest=True, role="holdout"),
        ),
        ERROR_UM,
        Table("csv", "TE"),
        Noise(WHITE, 30),
        _at(38841),
        "stiffness of eight harmonics",
    )


def _c03() -> Case:
    return Case(
        steel_rig((19, 57), 3e-3, 0.03, (1.5e-3, 4e-2), 0.025),
        (Run(20e3, 0.8, 1200, 90.0), Run(20e3, 0.8, 1900, 140.0), Run(20e3, 0.6, 1550, 140.0)),
        ERROR_OF_ENCODERS,
        Encoders("mat", (COUNTS, COUNTS)),
        Noise(COLOURED, 30),
        _at(59292, 3300204629),
        "one tooth of the gear; it stands elsewhere in each record, though the counters run on",
        Hidden("tooth_crack", {"depth": 0.22}),
    )


def _c04() -> Case:
    rig = steel_rig((31, 31), 2e-3, 0.018, (6e-4, 6e-4), 0.03)
    return Case(
        rig,
        (
            Run(100e3, 0.08, 5400, 30.0, at_rest=True),
            Run(100e3, 0.08, 2650, 30.0, at_rest=True),
            Run(100e3, 0.08, 3600, 18.0),
        ),
        Sensor("acceleration", "g", radius=rig.radii[0], radius_unit="m"),
        Wav(160.0),
        Noise(WHITE, 34),
        _at(104960),
        "1.5 % declared, 3 % true",
        Hidden("damping_ratio"),
        declared=replace(rig, damping_ratio=0.015),
    )


def _c05() -> Case:
    rig = steel_rig((28, 35), 2.5e-3, 0.02, (2.5e-3, 6e-3), 0.03)
    turning = Steps(((-20.0, 25.0, 0.03), (25.0, -20.0, 0.08)))
    return Case(
        rig,
        (
            Run(50e3, 0.1, 1830, 6.0, at_rest=True, begin=(-3e-5, 0.0)),
            Run(50e3, 0.15, rig.speed_at(0.93), 8.0),
            Run(50e3, 0.12, 1500, turning, at_rest=True, begin=(-6.2e-5, 0.0)),
            Run(50e3, 0.15, rig.speed_at(0.47), 8.0),
        ),
        ERROR_UM,
        Table("npz", "x"),
        Noise(WHITE, 40),
        _at(129520, 280536353),
        "viscous force in contact only; one record begins amid the gap, in one the torque crosses it twice",
        Hidden("backlash", {"gap": 6e-5}),
    )


def _c06() -> Case:
    zero = 0.71
    return Case(
        steel_rig((18, 63), 3e-3, 0.025, (1.5e-3, 5e-2), 0.035, gain=1.25),
        (
            Run(20e3, 1.2, 900, 70.0, speed_end=4500, mesh_zero=zero),
            Run(20e3, 0.3, 2000, 70.0, mesh_zero=zero),
            Run(20e3, 0.3, 3700, 110.0, mesh_zero=zero),
        ),
        Sensor("gear_speed", "rpm", shaft="gear", whole=True),
        Table("mat", "n2", angle=True, digits=None, name="B{}"),
        Noise(PINK, 26),
        _at(156121, 1479921809),
        "run-up from 900 to 4500 rpm; the torques that the inertias take are in the declared ones",
        gear_torque="stated",
    )


def _c07() -> Case:
    zero = 0.2
    return Case(
        steel_rig((29, 46), 3e-3, 0.03, (5e-3, 3e-2), 0.018),
        (
            Run(16e3, 0.4, 1500, 100.0, mesh_zero=zero),
            Run(16e3, 0.3, 2900, 100.0, mesh_zero=zero),
            Run(16e3, 0.4, 1500, 200.0, mesh_zero=zero),
        ),
        ERROR_MM,
        Table("csv", "s", "%.5f", time=True, angle=True),
        Noise(WHITE, 28),
        _at(192918),
        "the angle of the pinion has one zero in all records, not that of the mesh",
        Hidden("pinion_eccentricity", {"amplitude": 8e-6, "phase": 1.1}),
        step=1e-5,
    )


def _c08() -> Case:
    rig = steel_rig((22, 37), 3e-3, 0.025, (2.5e-3, 1.2e-2), 0.01)
    low = tuple(Run(50e3, 0.12, 1700, torque, at_rest=True) for torque in (30.0, 90.0, 240.0))
    return Case(
        rig,
        (*low, Run(50e3, 0.12, 3100, 150.0, at_rest=True)),
        Sensor("acceleration", "m/s^2", radius=rig.radii[0]),
        Table("csv", "a"),
        Noise(WHITE, 40),
        _at(210876, 1885699551),
        "c v + c2 |v| v",
        Hidden("power_law_damping", {"exponent": 2.0, "coefficient": 7000.0}),
    )


def _c09() -> Case:
    return Case(
        steel_rig((21, 52), 3e-3, 0.025, (2e-3, 3e-2), 0.02),
        (
            Run(20e3, 0.5, 1000, 150.0, role="fit"),
            Run(20e3, 0.4, 2200, 150.0, role="fit"),
            Run(20e3, 0.5, 1500, 70.0, role="fit"),
            Run(20e3, 0.3, 3000, 150.0, role="holdout"),
        ),
        ERROR_UM,
        Table("npz", "te_um"),
        Noise(WHITE, 30),
        _at(235451, 3156531514),
        "torque of the motor, once a turn; that of the gear does not follow",
        Hidden("torque_ripple", {"amplitude": 18.0, "phase": 0.4}),
        gear_torque="held",
    )


def _c10() -> Case:
    zero = 0.55
    return Case(
        steel_rig((23, 64), 2.5e-3, 0.02, (1.5e-3, 2e-2), 0.02),
        (
            Run(25e3, 0.4, 1300, 60.0, mesh_zero=zero),
            Run(25e3, 0.3, 2000, 60.0, mesh_zero=zero),
            Run(25e3, 0.3, 1650, 100.0, mesh_zero=zero),
        ),
        ERROR_UM,
        Table("csv", "DTE", angle=True),
        Noise(COLOURED, 28),
        _at(270243, 3415942344),
        "one tooth of the pinion, weighed by the stiffness of its pair over that of the mesh",
        Hidden("pitch_error", {"amplitude": 6e-6, "tooth": 7}),
    )


def _c11() -> Case:
    rig = steel_rig((34, 43), 2e-3, 0.02, (1.5e-3, 4e-3), 0.016)
    return Case(
        rig,
        (
            Run(48e3, 0.1, 2150, 40.0, at_rest=True, role="fit"),
            Run(48e3, 0.15, 1480, 60.0, role="fit"),
            Run(48e3, 0.1, 3900, 60.0, at_rest=True, role="holdout"),
        ),
        Sensor("acceleration", "m/s^2", shaft="gear", radius=2 * rig.radii[1]),
        Wav(5000.0),
        Noise(WHITE, 35),
        _at(296422),
        "16 bit",
    )


def _c12() -> Case:
    rig, modulated = steel_rig((25, 33), 3e-3, 0.02, (3e-3, 8e-3), 0.025, gain=1.7), 1.4  # times what is declared
    swing = (rig.two_pairs - rig.one_pair) / modulated
    one_pair = float(f"{rig.mean_stiffness - swing * (rig.contact_ratio - 1):.4g}")
    two_pairs = float(f"{one_pair + swing:.4g}")
    return Case(
        rig,
        (Run(25e3, 0.25, 1780, 80.0), Run(25e3, 0.25, 2600, 80.0), Run(25e3, 0.25, 1400, 120.0)),
        ERROR_WITH_ZERO,
        Table("csv", "te", time=True),
        Noise(WHITE, 30),
        _at(313649, 214842197),
        "the stiffness swings by 1.4 times what is declared about the same mean; absolute zero",
        Hidden("mesh_modulation", {"true_over_declared": modulated}),
        declared=replace(rig, one_pair=one_pair, two_pairs=two_pairs),
    )


def _c13() -> Case:
    low = tuple(Run(40e3, 0.15, 1300, torque, at_rest=True) for torque in (50.0, 150.0, 300.0))
    return Case(
        steel_rig((24, 50), 2.5e-3, 0.025, (2e-3, 1.5e-2), 0.01),
        (*low, Run(40e3, 0.15, 2750, 220.0, at_rest=True)),
        Sensor("pinion_speed", "rad/s", said=AC),
        Table("mat", "w1"),
        Noise(WHITE, 40),
        _at(332833),
        "c v + c3 v^3; coupled AC",
        Hidden("power_law_damping", {"exponent": 3.0, "coefficient": 2e5}),
    )


def _c14() -> Case:
    rig = steel_rig((26, 39), 3e-3, 0.02, (3e-3, 1e-2), 0.025)
    return Case(
        rig,
        (
            Run(50e3, 0.12, 2450, 70.0, at_rest=True),
            Run(50e3, 0.15, 1650, 70.0),
            Run(50e3, 0.12, 3400, 120.0, at_rest=True),
            Run(50e3, 0.12, 2100, 120.0),
        ),
        Sensor("acceleration", "g", radius=rig.radii[0], mount=(8200.0, 0.04)),
        Table("npz", "acc"),
        Noise(WHITE, 34),
        _at(357380),
        "the accelerometer's mount resonates; the catalogue has no such effect",
        Hidden("sensor_mount_resonance", {"frequency": 8200.0, "damping_ratio": 0.04}),
    )


def _c15() -> Case:
    slow = 0.12  # s in which so heavy discs settle
    return Case(
        steel_rig((19, 71), 5e-3, 0.05, (2.0, 12.0), 0.03),
        (
            Run(8e3, 2.0, 340, 400.0, settling=slow, role="fit"),
            Run(8e3, 2.0, 520, 400.0, settling=slow, role="fit"),
            Run(8e3, 1.5, 1100, 800.0, settling=slow, role="holdout"),
        ),
        ERROR_OF_ENCODERS,
        Encoders("csv", (COUNTS, 18_432_000)),
        Noise(WHITE, 30),
        _at(383501),
        "slow, heavy discs on both shafts",
        Hidden("gear_eccentricity", {"amplitude": 1.5e-5, "phase": 2.2}),
    )


def _c16() -> Case:
    from_rest = ((900, 60.0), (1700, 60.0), (1500, 120.0), (1700, 180.0))
    steady = ((1500, 60.0), (2500, 120.0), (3100, 120.0), (2750, 180.0))
    runs = []
    for (one, torque), (other, other_torque) in zip(from_rest, steady, strict=True):
        runs += [Run(20e3, 0.1, one, torque, at_rest=True), Run(20e3, 0.1, other, other_torque)]
    return Case(
        steel_rig((31, 47), 3e-3, 0.025, (6e-3, 3e-2), 0.014),
        tuple(runs),
        ERROR_UM,
        Table("csv", "te"),
        Noise(COLOURED, 30),
        _at(428440, 3914736045),
        "eight short records; the gain of the torque is declared as 1 and uncertain by 2 %, and is 1",
        gear_torque="held",
        said={"torque_gain": {"value": 1.0, "uncertainty": 0.02}},
    )


FIRST = (_c01, _c02, _c03, _c04, _c05, _c06, _c07, _c08, _c09, _c10, _c11, _c12, _c13, _c14, _c15, _c16)
