"""Turns the oracle's cases into models of the package."""

import numpy as np
import pytest
import torch
from gear_case import GearCase

from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.native import build
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

RATE = 40e3


def effect(name, **options):
    return effect_class(name)(**options)


class Assembly:
    """Effects and values that a case asks for, added one after another."""

    def __init__(self, case):
        self.case, self.effects, self.given = case, [], {}
        self._mesh()
        self._damping()
        self._shafts()
        self._torque()
        self.given |= {
            "pinion_torque": case.torque,
            "pinion_speed": case.pinion_speed,
            "pinion_angle": case.pinion_angle_0,
            "mesh_phase": case.mesh_phase,
            "gear_phase": case.gear_angle_0,
            "initial_displacement": case.x0,
            "initial_velocity": case.v0,
        }

    def add(self, name, options=None, **values):
        self.effects.append(effect(name, **(options or {})))
        self.given |= {f"{name}.{key}": value for key, value in values.items()}

    def _mesh(self):
        case = self.case
        shape = {"maximum": case.k_max, "minimum": case.k_min, "contact_ratio": case.contact_ratio}
        if case.stiffness_form == "rectangular":
            self.add("rectangular_mesh_stiffness", **shape)
        else:
            options = {"n_harmonics": case.n_harmonics, "weighting": case.weighting}
            self.add("fourier_mesh_stiffness", options, **shape)
        if case.gap is not None:
            self.add("backlash", gap=case.gap)

    def _damping(self):
        case = self.case
        if case.viscous:
            self.add("viscous_damping", damping_coefficient=case.viscous)
        if case.power_alpha:
            self.add("power_law_damping", coefficient=case.power_alpha, exponent=case.power_n)
        if case.coulomb_force:
            frequency = (case.mean_stiffness / case.mass) ** 0.5
            velocity = frequency * abs(case.load_of(case.torque)) / case.mean_stiffness
            self.add("coulomb_friction", force=case.coulomb_force, width=case.coulomb_smoothing / velocity)

    def _shafts(self):
        case = self.case
        for shaft in ("pinion", "gear"):
            for name in (f"{shaft}_eccentricity", f"{shaft}_stiffness_modulation"):
                amplitude, phase = getattr(case, name)
                if amplitude:
                    self.add(name, amplitude=amplitude, phase=phase)
        if case.profile_error:
            highest = max(h for h, _, _ in case.profile_error)
            amplitudes, phases = np.zeros(highest), np.zeros(highest)
            for h, amplitude, phase in case.profile_error:
                amplitudes[h - 1], phases[h - 1] = amplitude, phase
            self.add("profile_error", amplitudes=list(amplitudes), phases=list(phases))

    def _torque(self):
        case = self.case
        if case.torque_steps:
            times, changes = zip(*case.torque_steps, strict=True)
            self.add("torque_variation", {"form": "steps"}, step_times=times, step_changes=changes)
        if case.torque_sine:
            names = ("sine_amplitude", "sine_frequency", "sine_phase")
            values = dict(zip(names, case.torque_sine, strict=True))
            self.add("torque_variation", {"form": "sine"}, **values)
        if case.gear_torque is not None:
            self.given["gear_torque"] = case.gear_torque

    def model(self):
        mode = "balanced" if self.case.gear_torque is None else "held"
        return Model(GearPair(gear_torque_mode=mode), self.effects), self.given


@pytest.fixture(scope="session")
def assemble():
    """(model, given values) of an oracle case."""
    return lambda case: Assembly(case).model()


@pytest.fixture(scope="session")
def run_case(assemble):
    """The displacement of an oracle case, (time,), on the fastest engine there is."""

    def run(case, times, substeps, batch=1, engine="auto"):
        model, given = assemble(case)
        values = model.values(batch, **given)
        solver = Solver(substeps=substeps, engine=engine)
        runs = simulate(model, values, sampling_rate=RATE, n_samples=len(times), solver=solver)
        return runs.response[0].numpy()

    return run


@pytest.fixture(scope="session")
def free_oscillator():
    """A damped oscillator without force: model and values for (damping ratio, frequency in rad/s)."""

    def make(ratio, rate, batch=1):
        model = Model(Oscillator(), [effect("viscous_damping")])
        values = model.values(
            batch,
            stiffness=rate**2,
            amplitude=1e-3,
            initial_displacement=1e-3,
            initial_velocity=0.2e-3 * rate,
            **{"viscous_damping.damping_coefficient": 2 * ratio * rate},
        )
        return model, values

    return make


@pytest.fixture(scope="session")
def bench_model():
    """The default gear pair with power-law damping and backlash, and values for a batch of varied members."""
    model = Model(GearPair(), [effect("fourier_mesh_stiffness"), effect("power_law_damping"), effect("backlash")])

    def values(batch, seed=0):
        generator = torch.Generator().manual_seed(seed)
        share = torch.rand(batch, generator=generator, dtype=torch.float64)
        return model.values(
            batch, pinion_torque=120 + 60 * share, initial_displacement=1.66e-5 * (0.6 + 1.2 * share.flip(0))
        )

    return model, values


@pytest.fixture
def compiler():
    """Skips where there is no C++ compiler."""
    if build.compiler() is None:
        pytest.skip("no C++ compiler on this machine: native kernels cannot be built")


@pytest.fixture(scope="session")
def base_case():
    return GearCase()
