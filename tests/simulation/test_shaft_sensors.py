"""What sensors on either shaft see of every effect, against two turning wheels integrated without the reduction.

The forces are written down from the published equations (docs/effects.md). What is compared is the difference that an
effect makes, in the transmission error, both speeds and both angular accelerations.
"""

from functools import cache

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.observed import shaft_motion
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

TORQUE, HELD = 150.0, 290.0  # N m, on the pinion and on a gear that is held: it does not balance
I1, I2 = 2.6e-4, 4.5e-3  # kg m^2
R1, R2 = 3e-3 / 2 * np.cos(np.pi / 9) * np.array([20, 40])  # m
MASS = 1 / (R1**2 / I1 + R2**2 / I2)  # kg, of both along the line of action
K, C, START = 3e8, 400.0, 2.5e-5  # N/m, N s/m, m
SAMPLES, SAMPLING, SPEED = 120, 4e4, 4600 * np.pi / 30
TIMES = np.arange(SAMPLES) / SAMPLING
LOADS = {"balanced": TORQUE / R1, "held": MASS * (R1 * TORQUE / I1 + R2 * HELD / I2)}  # N, mean on the mesh
MODES = pytest.mark.parametrize("mode", ["balanced", "held"])


def braked(mode, drive):
    """The torque on the gear where nothing else is said."""
    return (lambda t: drive(t) * R2 / R1) if mode == "balanced" else (lambda t: HELD)


class Pair:
    """Two wheels, and behind one of them a machine on a shaft where there is one.

    force: between the flanks / N, of time, delta and its rate. error: of the flanks and its rate. drive, brake: torques
    of time. machine: the shaft it is on, stiffness of the shaft, inertia and first twist. bearing: stiffness, mass,
    damping and a force of time on it; it gives way from where the mean load holds it. start: the transmission error.
    """

    def __init__(self, mode, drive=None, brake=None, **parts):
        self.mode, self.drive = mode, drive or (lambda t: TORQUE)
        self.brake = brake or braked(mode, self.drive)
        self.force = parts.get("force", lambda t, delta, rate: K * delta + C * rate)
        self.error = parts.get("error", lambda t: (0.0, 0.0))
        self.machine, self.bearing = parts.get("machine"), parts.get("bearing")
        self.inertias, self.start = parts.get("inertias", (I1, I2)), parts.get("start", START)

    def slope(self, t, s):
        (error, rate), (first, second) = self.error(t), (self.drive(t), self.brake(t))
        delta, rate = R1 * s[0] - R2 * s[2] - error, R1 * s[1] - R2 * s[3] - rate
        if self.bearing:
            delta, rate = delta - s[4], rate - s[5]
        force, more = self.force(t, delta, rate), []
        if self.bearing:
            stiffness, mass, damping, push = self.bearing
            more = [s[5], (force + push(t) - stiffness * s[4] - damping * s[5]) / mass]
        if self.machine and self.machine[0] == "pinion":
            shaft = self.machine[1] * (s[4] - s[0])
            first, more = shaft, [s[5], (first - shaft) / self.machine[2]]
        if self.machine and self.machine[0] == "gear":
            shaft = self.machine[1] * (s[2] - s[4])
            second, more = shaft, [s[5], (shaft - second) / self.machine[2]]
        i1, i2 = self.inertias
        return np.array([s[1], (first - R1 * force) / i1, s[3], (R2 * force - second) / i2, *more])

    def motion(self):
        start, more = [self.start / R1, 0.0, 0.0, 0.0], []
        if self.machine:
            more = [start[0] + self.machine[3] if self.machine[0] == "pinion" else -self.machine[3], 0.0]
        if self.bearing:
            more = [LOADS[self.mode] / self.bearing[0], 0.0]
        solver = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-16, "max_step": 1e-5}
        states = solve_ivp(self.slope, (0, TIMES[-1]), start + more, t_eval=TIMES, **solver).y
        slopes = np.array([self.slope(t, s) for t, s in zip(TIMES, states.T, strict=True)]).T
        return {
            "x": R1 * states[0] - R2 * states[2],
            "pinion_speed": states[1],
            "gear_speed": states[3],
            "pinion_acceleration": slopes[1],
            "gear_acceleration": slopes[3],
        }


def found(mode, effects=(), given=None, inputs=None, **options):
    """The same of the package; options: of an effect, by its name. The second is a first twist."""
    named = ("fourier_mesh_stiffness", "viscous_damping", *effects)
    model = Model(GearPair(gear_torque_mode=mode), [effect_class(n)(**options.get(n, {})) for n in named])
    known = {"fourier_mesh_stiffness.maximum": K, "fourier_mesh_stiffness.minimum": K}
    known |= {"viscous_damping.damping_coefficient": C, "initial_displacement": START}
    known |= {"gear_torque": HELD} if mode == "held" else {}
    settings = {"solver": Solver(accuracy=1e-8, acceleration=True), "inputs": inputs}
    values = model.values(2, **(known | (given or {})))
    runs = simulate(model, values, sampling_rate=SAMPLING, n_samples=SAMPLES, **settings)
    seen = shaft_motion(runs) | {"x": runs.states["displacement"]}
    twist = runs.states.get("shaft_torsion.twist")
    return {name: series[1].numpy() for name, series in seen.items()}, twist if twist is None else float(twist[1, 0])


@cache
def plain(mode, start=START):
    return found(mode, given={"initial_displacement": start})[0]


def agree(seen, pair, without, tolerance=1e-4, of_speed=1e-2):
    """Every sensor within a share of what the effect does to it; of_speed: speeds, which are summed by trapezoids."""
    for name, true in pair.motion().items():
        missed, effect = seen[name] - true, true - without[name]
        if name.endswith("speed"):  # they are told about their mean
            missed, effect = missed - missed.mean(), effect - effect.mean()
        share = of_speed if name.endswith("speed") else tolerance
        assert np.abs(missed).max() < share * np.abs(effect).max(), name


def ripple(t):
    return 20.0 * np.cos(3 * SPEED * t + 0.4)


RIPPLE = {"torque_ripple.amplitude": 20.0, "torque_ripple.order": 3.0, "torque_ripple.phase": 0.4}
STAYS = {"torque_ripple": {"gear_torque": "stays"}}
DRAG = 4e-5 * SPEED**2  # N m
STEP = 0.00101  # s, between samples
# name, effect, parameters, options, torque on the pinion, whether the gear's torque stays even where it is balanced
TORQUES = [
    ("gain", (), {"torque_gain": 1.1, "torque_offset": 4.0}, {}, lambda t: 1.1 * TORQUE + 4.0, False),
    ("drag", ("windage_drag",), {"windage_drag.coefficient": 4e-5}, {}, lambda t: TORQUE - DRAG, False),
    ("ripple", ("torque_ripple",), RIPPLE, {}, lambda t: TORQUE + ripple(t), False),
    ("ripple alone", ("torque_ripple",), RIPPLE, STAYS, lambda t: TORQUE + ripple(t), True),
    (
        "sine",
        ("torque_variation",),
        {"torque_variation.sine_frequency": 700.0},
        {"torque_variation": {"form": "sine"}},
        lambda t: TORQUE + 15.0 * np.sin(2 * np.pi * 700.0 * t),
        False,
    ),
]
NAMED = pytest.mark.parametrize(
    ("effects", "given", "options", "drive", "stays"), [pytest.param(*t[1:], id=t[0]) for t in TORQUES]
)


@MODES
@NAMED
def test_what_changes_the_torque_of_the_pinion_speeds_both_shafts_up_where_that_of_the_gear_is_held(
    mode, effects, given, options, drive, stays
):
    brake = (lambda t: TORQUE * R2 / R1) if stays and mode == "balanced" else None
    agree(found(mode, effects, given, **options)[0], Pair(mode, drive, brake), plain(mode))


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
@MODES
@NAMED
def test_what_changes_the_torque_of_the_pinion_acts_on_the_machine_of_a_shaft_that_twists(
    shaft, mode, effects, given, options, drive, stays
):
    stiffness, inertia = {"pinion": 2000.0, "gear": 8000.0}[shaft], 0.01
    torsion = {"shaft_torsion.stiffness": stiffness, "shaft_torsion.motor_inertia": inertia}
    torsion |= {"shaft_torsion.damping_ratio": 0.0}
    options = options | {"shaft_torsion": {"shaft": shaft}}
    brake = (lambda t: TORQUE * R2 / R1) if stays and mode == "balanced" else None
    seen, twist = found(mode, ("shaft_torsion", *effects), given | torsion, **options)
    without = found(mode, ("shaft_torsion",), torsion, shaft_torsion={"shaft": shaft})[0]
    pair = Pair(mode, drive, brake, machine=(shaft, stiffness, inertia, twist))
    agree(seen, pair, without)


def test_a_shaft_is_twisted_at_first_by_the_true_torque():
    given = {"torque_gain": 1.1, "torque_offset": 4.0, "shaft_torsion.stiffness": 2000.0}
    for mode in LOADS:
        assert found(mode, ("shaft_torsion",), given)[1] == pytest.approx((1.1 * TORQUE + 4.0) / 2000.0)


@MODES
def test_a_share_of_the_load_is_a_torque_of_the_pinion_where_that_of_the_gear_is_held(mode):
    size = {"balanced": TORQUE, "held": LOADS["held"] * I1 / (MASS * R1)}[mode]
    given = RIPPLE | {"torque_ripple.share": 0.1}
    seen, _ = found(mode, ("torque_ripple",), given, torque_ripple={"proportional": True})
    agree(seen, Pair(mode, lambda t: TORQUE + 0.1 * size * ripple(t) / 20.0), plain(mode))


@MODES
def test_a_torque_that_steps(mode):
    given = {"torque_variation.step_times": (STEP,), "torque_variation.step_changes": (30.0,)}
    seen, _ = found(mode, ("torque_variation",), given)
    agree(seen, Pair(mode, lambda t: TORQUE + 30.0 * (t > STEP)), plain(mode), 2e-3, 5e-2)


@MODES
def test_a_torque_that_a_controller_puts_out_in_steps(mode):
    series = TORQUE + 10.0 * np.cos(np.arange(SAMPLES) // 15)
    driven = Driven({"pinion_torque": torch.as_tensor(series).unsqueeze(0)}, held=("pinion_torque",))

    def drive(t):  # up to a sample that of the one before
        return series[max(int(np.ceil(t * SAMPLING - 1e-9)) - 1, 0)]

    agree(found(mode, inputs=driven)[0], Pair(mode, drive), plain(mode), 5e-3, 8e-2)


def shaken(amplitude, order, phase):
    """An error of the flanks of so many periods a turn of the pinion, and its rate."""
    rate = order * SPEED
    return lambda t: (amplitude * np.cos(rate * t + phase), -amplitude * rate * np.sin(rate * t + phase))


def turned_stiffness(share, order, phase):
    return {"force": lambda t, d, v: K * (1 + share * np.cos(order * SPEED * t + phase)) * d + C * v}


def dry(mode, width=0.05):
    """The sign of a rate, as smooth as the effects have it."""
    velocity = np.sqrt(K / MASS) * LOADS[mode] / K
    return lambda v: np.tanh(v / (width * velocity))


def damped(force):
    return {"force": lambda t, d, v: K * d + C * v + force(d, v)}


def asymmetric(mode):
    sign = dry(mode)
    return damped(lambda d, v: 15 * sign(v) + 5 * (0.3 + 0.7 * sign(v) ** 2) + v * (35 + 15 * sign(v)))


def unbalanced(order):
    damping, rate = 2 * 0.02 * np.sqrt(5e8 * 2.0), order * SPEED
    return {"bearing": (5e8, 2.0, damping, lambda t: 2e-2 * rate**2 * np.cos(rate * t + 0.3))}


ASYMMETRIC = {"rest_share": 0.3, "damping_forward": 50.0, "damping_backward": 20.0}
SHAPE = {"in_phase": (0.05,), "quadrature": (0.0,)}
# effect, its own parameters, options, what it does to the pair in a mode
EFFECTS = [
    ("coulomb_friction", {}, {}, lambda mode: damped(lambda d, v: 20 * dry(mode)(v))),
    ("asymmetric_friction", ASYMMETRIC, {}, asymmetric),
    ("power_law_damping", {"coefficient": 132.0}, {}, lambda mode: damped(lambda d, v: 132.0 * v * abs(v))),
    ("hunt_crossley_damping", {}, {}, lambda mode: damped(lambda d, v: 64.5 * abs(d) / 1.66e-5 * v)),
    ("damping_by_record", {"level": 3.0}, {}, lambda mode: damped(lambda d, v: 30.0 * v)),
    ("cubic_stiffness", {}, {}, lambda mode: damped(lambda d, v: 5.8e16 * d**3)),
    ("hertz_stiffness", {}, {}, lambda mode: damped(lambda d, v: K * d * ((abs(d) / 1.66e-5) ** 0.1 - 1))),
    ("pinion_eccentricity", {"phase": 0.7}, {}, lambda mode: {"error": shaken(2e-5, 1, 0.7)}),
    ("gear_eccentricity", {"phase": 0.7}, {}, lambda mode: {"error": shaken(2e-5, 0.5, 0.7)}),
    ("profile_error", {"amplitudes": (3e-6,), "phases": (0.2,)}, {}, lambda mode: {"error": shaken(3e-6, 20, 0.2)}),
    ("pinion_stiffness_modulation", {"phase": 0.7}, {}, lambda mode: turned_stiffness(0.01, 1, 0.7)),
    ("gear_stiffness_modulation", {"phase": 0.7}, {}, lambda mode: turned_stiffness(0.01, 0.5, 0.7)),
    ("mesh_stiffness_shape", SHAPE, {}, lambda mode: turned_stiffness(0.05, 20, 0.0)),
    ("inertia_error", {}, {}, lambda mode: {"inertias": (1.1 * I1, 1.1 * I2)}),
    ("unbalance", {"unbalance": 2e-2, "phase": 0.3}, {"shaft": "pinion"}, lambda mode: unbalanced(1)),
    ("unbalance", {"unbalance": 2e-2, "phase": 0.3}, {"shaft": "gear"}, lambda mode: unbalanced(0.5)),
]


@MODES
@pytest.mark.parametrize(
    ("effect", "own", "options", "parts"), EFFECTS, ids=lambda one: one if isinstance(one, str) else ""
)
def test_forces_between_the_flanks_turn_both_shafts_as_they_act_on_either(mode, effect, own, options, parts):
    given = {f"{effect}.{name}": value for name, value in own.items()}
    effects = ("bearing_flexibility", effect) if effect == "unbalance" else (effect,)
    agree(found(mode, effects, given, **{effect: options})[0], Pair(mode, **parts(mode)), plain(mode))


@MODES
@pytest.mark.parametrize("film", [0.0, 64.5])
def test_flanks_that_part_leave_each_wheel_to_its_own_torque(mode, film):
    gap, start, thick = 4e-5, 9e-5, 1e-5

    def force(t, d, v):
        touching = max(d, 0.0) + min(d + gap, 0.0)
        shares = [(thick / (thick + h)) ** 3 for h in (max(-d, 0.0), max(d + gap, 0.0))]
        return K * touching + (C * v if touching else 0.0) + film * sum(shares) * v

    effects = ("backlash", "squeeze_film_damping") if film else ("backlash",)
    given = {"backlash.gap": gap, "initial_displacement": start}
    seen, _ = found(mode, effects, given)
    agree(seen, Pair(mode, force=force, start=start), plain(mode, start), 1e-3)
    with_gap = seen["pinion_acceleration"][np.abs(seen["x"] + gap / 2) < gap / 2]
    assert film or np.allclose(with_gap, TORQUE / I1)
    assert len(with_gap) > 5
