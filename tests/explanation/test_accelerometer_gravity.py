"""What an accelerometer on a turning shaft feels of its own weight is told as that."""

from pathlib import Path

import numpy as np
import pytest
import torch
import yaml
from scipy.integrate import solve_ivp

from gear_damping.explanation.explain import explain
from gear_damping.identification.output_error.observe import recorded
from gear_damping.identification.output_error.records import Observed
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.accelerometer_gravity import AccelerometerGravity
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

PINION, GEAR = 19, 45  # teeth
MODULE, ANGLE = 3e-3, np.radians(20)  # m, rad
INERTIAS = (6e-4, 9e-3)  # kg m^2, pinion and gear
STIFFNESS, SWING, RATIO = 2.4e7, 0.12, 0.03  # N/m on average, of it over a pitch, of critical
RADIUS = 0.06  # m, where the sensor sits on the gear
GRAVITY = 9.80665  # m/s^2
RATE, DURATION, NOISE = 7e3, 0.4, 0.2  # Hz, s, m/s^2
CONDITIONS = [("fit", 31.0, 20.0), ("fit", 47.0, 32.0), ("fit", 71.0, 24.0), ("holdout", 58.0, 28.0)]  # rad/s, N m
BASE = tuple(MODULE * teeth * np.cos(ANGLE) / 2 for teeth in (PINION, GEAR))
MASS = 1 / sum(radius**2 / inertia for radius, inertia in zip(BASE, INERTIAS, strict=True))


def acceleration(speed, torque):
    """Tangential acceleration of the gear at the sensor, m/s^2, and the angle of the pinion: torques balance."""
    force, damping = torque / BASE[0], 2 * RATIO * np.sqrt(STIFFNESS * MASS)

    def rates(time, state):
        pull = STIFFNESS * (1 + SWING * np.cos(PINION * speed * time)) * state[0] + damping * state[1]
        return [state[1], (force - pull) / MASS]

    time = np.arange(0, DURATION, 1 / RATE)
    moved = solve_ivp(rates, (0, DURATION), [force / STIFFNESS, 0], t_eval=time, rtol=1e-8, atol=1e-14).y
    pushed = np.array([rates(t, state)[1] for t, state in zip(time, moved.T, strict=True)])
    return -RADIUS * BASE[1] * MASS / INERTIAS[1] * pushed, speed * time


def measured(folder: Path, weight: float) -> Path:
    random, records = np.random.default_rng(7), []
    for i, (role, speed, torque) in enumerate(CONDITIONS):
        moved, angle = acceleration(speed, torque)
        felt = weight * np.cos(angle * PINION / GEAR + random.uniform(-np.pi, np.pi))
        seen = moved + felt + random.normal(0, NOISE, angle.size)
        np.savetxt(folder / f"{i}.csv", np.column_stack([angle, seen]), delimiter=",", header="angle,a", comments="")
        mounted = {"mounting": "tangential", "shaft": "gear", "radius": f"{RADIUS} m"}
        channels = {
            "pinion_angle": {"column": "angle", "unit": "rad"},
            "acceleration": {"column": "a", "unit": "m/s^2", **mounted},
        }
        conditions = {"pinion_torque": f"{torque} N*m", "gear_torque": "balanced"}
        declared = {"file": f"{i}.csv", "role": role, "sampling_rate": f"{RATE} Hz"}
        records.append(declared | {"channels": channels, "conditions": conditions})
    parameters = {"n_teeth_pinion": PINION, "n_teeth_gear": GEAR, "module": f"{MODULE} m", "pressure_angle": "20 deg"}
    parameters |= {
        f"inertia_{shaft}": f"{inertia} kg*m^2" for shaft, inertia in zip(("pinion", "gear"), INERTIAS, strict=True)
    }
    parameters |= {f"mesh_stiffness_{end}": f"{STIFFNESS * by} N/m" for end, by in (("max", 1.12), ("min", 0.88))}
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "gear_pair", "parameters": parameters, "records": records}))
    return path


@pytest.mark.slow
def test_its_weight_is_named(tmp_path):
    content = explain(load_measurement(measured(tmp_path, GRAVITY))).content
    first = content["causes"][0]
    assert (first["name"], first["status"]) == ("accelerometer_gravity", "established"), content["sentences"]
    low, high = first["parameters"]["amplitude"]["interval95"]
    assert low < GRAVITY < high < 1.01 * GRAVITY


@pytest.mark.parametrize("carries", [(), ("gear",), ("pinion", "gear")])
def test_it_is_tried_on_shafts_that_carry_an_accelerometer(carries):
    recipes = AccelerometerGravity.cause.recipes_for(Rig("gear_pair", PINION, GEAR, accelerometers=carries))
    assert tuple(recipe.options["shaft"] for recipe in recipes) == carries


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("seen", ["pinion_acceleration", "gear_acceleration", "pinion_speed", "transmission_error"])
def test_it_is_in_the_acceleration_of_its_shaft_alone_whichever_channel_that_is(first, seen):
    effects = [FourierMeshStiffness(), ViscousDamping(damping_coefficient=400.0)]
    shaft, _, quantity = seen.partition("_")
    of_a_shaft = {"shaft": shaft, "radius": RADIUS} if quantity == "acceleration" else {}
    channel = Observed(quantity if of_a_shaft else seen, **of_a_shaft)
    plain, weighed = (
        run(Model(GearPair(), [*effects, *more])) for more in ([], [AccelerometerGravity(shaft="gear", phase=0.3)])
    )
    added = recorded(weighed, channel, first) - recorded(plain, channel, first)
    expected = GRAVITY * torch.cos(weighed.angles["gear_angle"] + 0.3) if seen == "gear_acceleration" else 0 * added
    torch.testing.assert_close(added, expected)


def run(model):
    values, kept = model.values(1, pinion_speed=40.0), Solver(acceleration=True)
    return simulate(model, values, sampling_rate=5000.0, n_samples=50, solver=kept)
