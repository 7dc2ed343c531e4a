"""What a model refuses, what effects know of each other, and effects from the user's own file."""

import math
from pathlib import Path

import numpy as np
import pytest
import torch
from effect_bench import EFFECTS, Bench
from gear_case import GearCase
from gear_terms import sampled

from gear_damping.errors import InputError
from gear_damping.physics.catalogue import catalogue, effect_class
from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import LoadPath


def model(*names: str) -> Model:
    return Model(GearPair(), [EFFECTS[n]() for n in ("fourier_mesh_stiffness", *names)])


@pytest.mark.parametrize(
    ("name", "needed"), [("unbalance", "bearing_flexibility"), ("squeeze_film_damping", "backlash")]
)
def test_an_effect_that_needs_another_says_so(name, needed):
    with pytest.raises(InputError, match=f"simulator.{name}: needs the effect '{needed}'.*simulator.{needed}"):
        model(name)
    model(name, needed)


def test_a_model_lists_every_problem_of_its_composition():
    with pytest.raises(InputError) as raised:
        Model(Oscillator(), [EFFECTS[n]() for n in ("backlash", "tooth_friction", "fourier_mesh_stiffness")])
    keys = [problem.key for problem in raised.value.problems]
    assert keys == ["simulator.tooth_friction", "simulator.fourier_mesh_stiffness", "simulator.mesh_stiffness"]


def test_a_model_refuses_two_of_a_kind():
    with pytest.raises(InputError, match="viscous_damping: is there twice"):
        model("viscous_damping", "viscous_damping")
    with pytest.raises(InputError, match="1 mesh stiffness, here there are 2"):
        model("rectangular_mesh_stiffness")
    with pytest.raises(InputError, match="1 mesh stiffness, here there are 0"):
        Model(GearPair(), [])


class Clutch(LoadPath):
    """A part between torques and mesh of one's own."""

    name = "clutch"
    needs = (Trait.TORQUE,)
    parameters = ()

    def transmitted_load(self, at, p):
        return at.drive_load / 2


def test_two_effects_that_would_undo_each_other_are_refused():
    effects = [EFFECTS["fourier_mesh_stiffness"](), EFFECTS["shaft_torsion"](), Clutch()]
    with pytest.raises(InputError, match="shaft_torsion and clutch each stand between the torques and the mesh"):
        Model(GearPair(), effects)


def test_an_unknown_effect_or_option_or_parameter_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'backlash'"):
        effect_class("backlsh")
    with pytest.raises(InputError, match="did you mean 'lanczos'"):
        EFFECTS["fourier_mesh_stiffness"](weighting="lanczo")
    with pytest.raises(InputError, match=r"did you mean 'backlash\.gap'"):
        model("backlash").values(1, **{"backlash.gapp": 1.0})


def test_lists_that_go_together_have_one_length():
    with pytest.raises(InputError, match=r"profile_error\.phases: has 1 values, amplitudes has 3"):
        Bench("profile_error", {}, {"profile_error.amplitudes": [1e-6] * 3, "profile_error.phases": [0.0]})
    with pytest.raises(InputError, match=r"torque_variation\.step_changes: has 3 values, step_times has 1"):
        Bench("torque_variation", {}, {"torque_variation.step_times": [0.01]})
    with pytest.raises(InputError, match=r"pitch_error\.values: has 20 values, the gear has 40 teeth"):
        Bench("pitch_error", {"shaft": "gear"})


def test_the_inertia_error_changes_mass_and_frequency_but_not_the_load():
    for options in ({}, {"gear_torque_mode": "held"}):
        plain = Bench("viscous_damping", {}, {"gear_torque": 280.0}, system_options=options).prepared.derived
        bench = Bench("inertia_error", {}, {"inertia_error.share": 0.21, "gear_torque": 280.0}, system_options=options)
        found = bench.prepared.derived
        ratio = {k: (found[k] / plain[k])[0].item() for k in ("equivalent_mass", "natural_frequency", "mean_load")}
        assert ratio == pytest.approx({"equivalent_mass": 1.21, "natural_frequency": 1 / 1.1, "mean_load": 1.0})


@pytest.mark.parametrize("mesh", ["fourier_mesh_stiffness", "rectangular_mesh_stiffness"])
def test_the_contact_grows_with_the_load_on_both_sides(mesh):
    given = {"load_dependent_contact.growth": 0.06, "pinion_torque": 75.0}
    given |= {"load_dependent_contact.reference_load": GearCase().mean_load}
    effects = [EFFECTS[n]() for n in (mesh, "load_dependent_contact")]
    grown = Model(GearPair(), effects)
    prepared = grown.prepare(grown.values(50, **given))
    case = GearCase(contact_ratio=1.63, mesh_phase=0.03 * math.pi, stiffness_form=mesh.split("_")[0])
    assert prepared.derived["mean_stiffness"][0].item() == pytest.approx(case.mean_stiffness, rel=1e-12)
    time = torch.linspace(1e-6, 2.9 * case.mesh_period, 50, dtype=torch.float64)
    zero = torch.zeros_like(time)
    equation = EquationOfMotion(grown)
    at = equation.kinematics(time / prepared.scales.time, (zero, zero), {}, prepared.base)
    at.active_branch = {k: (v >= 0).to(v) for k, v in equation.switches(at, prepared.terms).items()}
    equation.rates(at, prepared.base, prepared.terms)
    found = at.stiffness * prepared.scales.force / prepared.scales.length
    np.testing.assert_allclose(found.numpy(), sampled(case, "stiffness", time.numpy()), rtol=1e-10)


def test_the_contact_ratio_ends_at_two():
    bench = Bench("load_dependent_contact", {}, {"load_dependent_contact.growth": 1.0})
    assert bench.prepared.base["contact_ratio"].max().item() == 2.0
    assert bench.prepared.base["contact_lead"].max().item() == pytest.approx(0.4 * math.pi, rel=1e-12)


PLUGIN = '''
"""Damping of my own."""

from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import DampingForce


class MyDamping(DampingForce):
    """A cubic law."""

    name = "my_damping"
    equation = "F_d = a delta'^3"
    reference = "own measurement, 2026"
    parameters = (Parameter("coefficient", "N*s^3/m^3", 2.0, "a", 0, 1e12),)
    dissipative = True

    def damping_force(self, at, p):
        """The force at this instant."""
        return p["coefficient"] * at.delta_rate**3
'''


@pytest.fixture
def plugin(tmp_path: Path) -> Path:
    path = tmp_path / "my_damping.py"
    path.write_text(PLUGIN)
    return path


def test_a_plugin_adds_an_effect_that_works_like_any_other(plugin):
    cls = effect_class("my_damping", [plugin])
    own = Model(Oscillator(), [cls()])
    values = own.values(2, **{"my_damping.coefficient": 0.3, "stiffness": 4.0})
    prepared = own.prepare(values)
    equation = EquationOfMotion(own)
    v = torch.tensor([0.5, -2.0], dtype=torch.float64)
    at = equation.kinematics(torch.zeros(2), (0 * v, v / prepared.scales.velocity), {}, prepared.base)
    rates = equation.rates(at, prepared.base, prepared.terms)
    found = rates[1] * prepared.scales.length / prepared.scales.time**2
    assert torch.allclose(found, -0.3 * v**3, rtol=1e-12)
    assert "my_damping" not in catalogue()


def test_a_plugin_that_cannot_be_used_is_refused(plugin, tmp_path):
    with pytest.raises(InputError, match="no such file"):
        catalogue([tmp_path / "absent.py"])
    empty = tmp_path / "empty.py"
    empty.write_text("x = 1\n")
    with pytest.raises(InputError, match="declares no effect"):
        catalogue([empty])
    plugin.write_text(PLUGIN.replace('"my_damping"', '"backlash"'))
    with pytest.raises(InputError, match=r"repeats the name \['backlash'\]"):
        catalogue([plugin])


def test_a_gear_s_torque_that_stays_beside_a_ripple_of_the_load_is_refused():
    with pytest.raises(InputError, match=r"torque_ripple\.gear_torque: stays beside a ripple of the torque alone"):
        Bench("torque_ripple", {"gear_torque": "stays", "proportional": True})
