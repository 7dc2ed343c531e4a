"""Every effect's declaration is complete and consistent: it feeds configuration, docs and causes."""

import re

import pytest
from effect_bench import EFFECTS

from gear_damping.errors import InputError
from gear_damping.physics.cause import Rig
from gear_damping.physics.effect_files import cause_faults, some_rigs
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.known import SYSTEMS, systems_of
from gear_damping.units import parse_unit

CATALOGUE = """
viscous_damping power_law_damping coulomb_friction asymmetric_friction tooth_friction squeeze_film_damping
hunt_crossley_damping hysteretic_damping backlash cubic_stiffness hertz_stiffness encoder_error pinion_eccentricity
gear_eccentricity pinion_stiffness_modulation gear_stiffness_modulation profile_error pitch_error tooth_crack
torque_ripple torque_variation bearing_flexibility shaft_torsion load_dependent_contact inertia_error unbalance
windage_drag shaft_angle_error load_noise sensor_noise sensor_gain sensor_offset sensor_drift sensor_delay
sensor_lowpass sensor_saturation sensor_quantisation fourier_mesh_stiffness rectangular_mesh_stiffness
quadratic_stiffness offset_force sine_restoring mesh_stiffness_shape second_mode tip_relief damping_by_record
stiffness_by_record dead_zone accelerometer_gravity noncollocated_mode mains_hum
"""


def test_the_catalogue_holds_every_canonical_name():
    assert sorted(EFFECTS) == sorted(CATALOGUE.split())


@pytest.mark.parametrize("name", EFFECTS)
def test_name_is_the_file_name_and_the_class_name_in_snake_case(name):
    cls = EFFECTS[name]
    assert cls.__module__.rsplit(".", 1)[1] == name
    assert re.sub(r"(?<=[a-z])(?=[A-Z])", "_", cls.__name__).lower() == name


@pytest.mark.parametrize("name", EFFECTS)
def test_it_says_what_it_is(name):
    cls = EFFECTS[name]
    assert len(cls.equation) > 2
    assert re.search(r"\(\d{4}\)|:\d{4}|\d{4}", cls.reference), "a reference has a year"
    assert cls.__doc__
    assert cls.__doc__.strip().endswith(".")
    assert systems_of(cls), "an effect of the catalogue goes with one of the systems"
    assert set(cls.requires) <= set(EFFECTS)


@pytest.mark.parametrize("name", EFFECTS)
def test_parameters_have_units_bounds_and_defaults_within(name):
    parameters = EFFECTS[name].parameters
    assert len({p.name for p in parameters}) == len(parameters)
    for p in parameters:
        parse_unit(p.unit)
        assert p.meaning
        assert p.lower < p.upper
        values = p.default if p.vector else (p.default,)
        assert values
        assert all(p.problem(v, p.name) is None for v in values)
        assert p.source in ("paper", "assumed")


@pytest.mark.parametrize("name", EFFECTS)
def test_options_have_their_default_among_the_choices(name):
    for option in EFFECTS[name].options:
        assert option.problem(option.default, option.name) is None
        assert option.meaning
        assert option.name not in {p.name for p in EFFECTS[name].parameters}


@pytest.mark.parametrize("name", [name for name, kind in EFFECTS.items() if kind.cause])
def test_as_a_cause_it_names_its_own_parameters_and_known_effects(name):
    cause = EFFECTS[name].cause
    assert list(cause_faults(EFFECTS[name])) == []
    assert set(cause.alike({})) <= set(EFFECTS)
    assert cause.simpler is None or cause.simpler in EFFECTS
    rigs = [rig for system in systems_of(EFFECTS[name]) for rig in some_rigs(SYSTEMS[system])]
    for recipe in (recipe for rig in rigs for recipe in cause.recipes_for(rig)):
        EFFECTS[name](**recipe.options)
        assert all("." in flat for flat in recipe.within)


@pytest.mark.parametrize("name", [name for name, kind in EFFECTS.items() if kind.cause])
def test_a_cause_with_a_shaft_is_tried_on_both(name):
    if "shaft" not in {option.name for option in EFFECTS[name].options}:
        return
    for rig in some_rigs(SYSTEMS["gear_pair"]):
        tried = {recipe.options.get("shaft") for recipe in EFFECTS[name].cause.recipes_for(rig)}
        assert tried == {"pinion", "gear"}


@pytest.mark.parametrize("on_shafts", [True, False])
def test_a_ripple_that_speeds_both_shafts_up_is_sought_where_a_sensor_on_a_shaft_sees_it(on_shafts):
    rig = Rig("gear_pair", n_teeth_pinion=20, n_teeth_gear=40, on_shafts=on_shafts)
    tried = {recipe.options["gear_torque"] for recipe in EFFECTS["torque_ripple"].cause.recipes_for(rig)}
    assert tried == ({"follows", "stays"} if on_shafts else {"follows"})


def test_a_length_in_mm_and_an_angle_in_degrees_are_told_in_si():
    for values, meant in (({"module": 2.5}, r"2\.5 mm are 0\.0025"), ({"pressure_angle": 20}, r"20 deg are 0\.3491")):
        with pytest.raises(InputError, match=meant):
            GearPair(**values)
    with pytest.raises(InputError, match=r"700 um are 0\.0007"):
        GearPair(module=700)
    with pytest.raises(InputError, match=r"nearest valid value 0\.1"):
        GearPair(module=7e5)
