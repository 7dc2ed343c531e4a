"""What is tried follows the rig of the records: tooth counts, shafts, orders, and the unit of the response."""

from dataclasses import replace
from itertools import product
from math import degrees, pi

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import candidates_for, restored
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.model.rig import rig_of, strongest_orders
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.measurement.record import Channel
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.effect_files import cause_faults
from gear_damping.physics.effects.coulomb_friction import CoulombFriction
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator

RIGS = [(17, 43), (25, 50), (37, 53)]
CLOCKED = {"torque_variation"}  # the hum of a grid wants longer records
RATE, SPEED = 40_000.0, 300.0  # Hz, rad/s
DAMPING = "viscous_damping.damping_coefficient"


def gear_pair(teeth, speeds=(SPEED, 1.5 * SPEED), rate=RATE):
    time = torch.arange(2400, dtype=torch.float64) / rate
    records = tuple(
        FitRecord(f"r{i}", torch.sin(time * speed), rate, {"pinion_angle": 0.7 + speed * time}, {"pinion_speed": speed})
        for i, speed in enumerate(speeds)
    )
    given = {"n_teeth_pinion": teeth[0], "n_teeth_gear": teeth[1], DAMPING: 100.0}
    base = Hypothesis(GearPair(), (FourierMeshStiffness(), ViscousDamping()), given, (FreeParameter(DAMPING, 100.0),))
    channel = Channel("transmission_error", np.zeros(1), "m")
    return base, Evidence("gear_pair", records, (), {}, channel, False)


def oscillator(unit="rad", stiffness=50.0, forced=False):
    time = torch.arange(400, dtype=torch.float64) / 100
    response = torch.cos(7 * time)
    record = FitRecord("r", response, 100.0, {"force": torch.sin(3 * time)} if forced else {})
    given = {"amplitude": 0.5, "stiffness": stiffness, DAMPING: 0.2}
    free = (FreeParameter("stiffness", stiffness, logarithmic=True), FreeParameter(DAMPING, 0.2, logarithmic=True))
    base = Hypothesis(Oscillator(), (ViscousDamping(),), given, free)
    return base, Evidence("oscillator", (record,), (), {}, Channel("displacement", np.zeros(1), unit), False)


def of(name, base, evidence, residuals=None):
    return [found for found in candidates_for(base, evidence, residuals) if found.name == name]


@pytest.mark.parametrize("teeth", RIGS)
def test_a_crack_is_sought_at_every_tooth_of_either_shaft(teeth):
    base, evidence = gear_pair(teeth)
    turned = replace(base, given=base.given | {"mesh_phase": 0.9})
    found = [c for c in of("tooth_crack", turned, evidence) if not c.own_tooth]
    for (shaft, count), halved in product(zip(("pinion", "gear"), teeth, strict=True), (False, True)):
        own = [c for c in found if {("shaft", shaft), ("halved", halved)} <= set(c.options)]
        phases = sorted(c.hypothesis.given["tooth_crack.phase"] for c in own)
        assert phases == pytest.approx([(2 * pi * i + 0.9) / count for i in range(count)])
        edge = next(p for p in own[0].later if p.name == "tooth_crack.edge")
        assert edge.lower < edge.start < edge.upper < 2 * 2 * pi / count, "an edge is short beside a tooth"


def test_turns_of_the_gear_are_each_records_own_beside_one_mark_of_the_pinion_but_within_one_record():
    base, evidence = gear_pair((17, 43))
    turning = {"gear_eccentricity", "gear_stiffness_modulation", "tooth_crack", "pitch_error", "torque_ripple"}
    found = candidates_for(base, evidence)
    assert {c.name for c in found if c.own_phases or c.own_tooth} == turning | CLOCKED
    assert all(("shaft", "pinion") not in c.options for c in found if c.own_tooth)
    one = candidates_for(base, replace(evidence, one_record=True))
    assert {c.name for c in one if c.own_phases or c.own_tooth} == CLOCKED, "its clock begins anew"


def test_a_swinging_torque_is_no_level_of_each_record():
    base, evidence = gear_pair((17, 43))
    found = [c for c in of("torque_variation", base, evidence) if ("form", "sine") in c.options]
    frequencies = [p for c in found for p in c.later if p.name == "torque_variation.sine_frequency"]
    assert len(frequencies) == len(found) > 1
    assert {p.lower for p in frequencies} == {0.5 / evidence.duration}
    assert min(p.start for p in frequencies) > 0.5 / evidence.duration


@pytest.mark.parametrize("teeth", RIGS)
def test_pitch_errors_have_one_value_a_tooth(teeth):
    base, evidence = gear_pair(teeth)
    for candidate in of("pitch_error", base, evidence):
        count = dict(zip(("pinion", "gear"), teeth, strict=True))[dict(candidate.options)["shaft"]]
        assert len(candidate.strengths) == count
        problem = OutputErrorProblem(
            candidate.hypothesis.model, candidate.hypothesis.given, candidate.hypothesis.free, evidence.fit
        )
        found = problem.predict(torch.zeros(1, problem.n_shared, dtype=torch.float64), problem.first_states()[None], 40)
        assert bool(found.isfinite().all())


@pytest.mark.parametrize("teeth", RIGS)
def test_every_candidate_of_a_rig_can_be_simulated(teeth):
    base, evidence = gear_pair(teeth)
    for candidate in {(c.name, c.options): c for c in candidates_for(base, evidence)}.values():
        given = candidate.hypothesis.given
        candidate.hypothesis.model.prepare(candidate.hypothesis.model.values(1, **given))


@pytest.mark.parametrize("teeth", RIGS)
def test_low_orders_of_either_shaft_are_tried_as_a_ripple(teeth):
    found = of("torque_ripple", *gear_pair(teeth))
    orders = {c.hypothesis.given["torque_ripple.order"] for c in found}
    gear = {i * teeth[0] / teeth[1] for i in (1, 2, 3)}
    assert orders == {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, teeth[0] - 1.0, teeth[0] + 1.0} | gear
    turns = [order for order in orders if order != round(order)]
    assert len(found) == 2 * (len(orders) + len(turns)), "each as a torque and as a share; the gear may stand anywhere"


@pytest.mark.parametrize("order", [12, 36])
@pytest.mark.parametrize("teeth", RIGS)
def test_what_stands_out_of_the_residual_is_tried_as_a_ripple(teeth, order):
    base, evidence = gear_pair(teeth)
    residuals = [(r, _line(r, order, 1.0) + _line(r, 2 * teeth[0], 3.0) + _noise(r)) for r in evidence.fit]
    found = of("torque_ripple", base, evidence, residuals)
    assert float(order) in {c.hypothesis.given["torque_ripple.order"] for c in found}
    assert len(found) <= 2 * (11 + 8 + 3)


def _line(record, order, size):
    return size * torch.cos(order * record.inputs["pinion_angle"] + 1.0)


def _noise(record):
    return 0.2 * torch.randn(len(record.response), generator=torch.Generator().manual_seed(1), dtype=torch.float64)


def test_the_strongest_orders_come_first_and_the_mesh_and_the_gear_are_left_out():
    _, evidence = gear_pair((37, 53))
    sizes = {12: 2.0, 40: 1.5, 5: 1.0, 74: 9.0, 37 / 53: 4.0}
    residuals = [(r, sum(_line(r, q, s) for q, s in sizes.items()) + _noise(r)) for r in evidence.fit]
    found = strongest_orders(residuals, 37, 53, SPEED)
    assert found[:3] == (12.0, 40.0, 5.0)
    assert len(found) == 8
    assert 74.0 not in found


def test_orders_follow_the_speed_where_no_angle_was_measured():
    _, evidence = gear_pair((25, 50))
    residuals = [(replace(r, inputs={}), _line(r, 12, 1.0)) for r in evidence.fit]
    assert strongest_orders(residuals, 25, 50, 1.0)[0] == 12.0


def test_a_shaft_that_hardly_turns_shows_no_orders():
    _, evidence = gear_pair((25, 50), speeds=(20.0,))
    assert strongest_orders([(r, _line(r, 12, 1.0)) for r in evidence.fit], 25, 50, SPEED) == ()


@pytest.mark.parametrize(("rate", "length"), [(40_000.0, 4), (4800.0, 2), (2400.0, 1)])
def test_a_profile_error_has_the_harmonics_that_the_sampling_shows(rate, length):
    base, evidence = gear_pair((20, 40), speeds=(300.0,), rate=rate)
    (candidate,) = of("profile_error", base, evidence)
    assert len(candidate.strengths) == length


def test_what_has_a_shaft_is_tried_on_both():
    base, evidence = gear_pair((25, 50))
    found = candidates_for(base, evidence)
    names = {c.name for c in found}
    for effect in ("eccentricity", "stiffness_modulation"):
        assert {f"pinion_{effect}", f"gear_{effect}"} <= names
    for effect in ("tooth_crack", "pitch_error", "shaft_torsion"):
        assert {dict(c.options)["shaft"] for c in found if c.name == effect} == {"pinion", "gear"}


@pytest.mark.parametrize("teeth", RIGS)
def test_what_no_machine_has_is_not_tried(teeth):
    """A shaft that any load twists by a radian, with hardly a hub on it, or damped as no rubber coupling; a pinion of a
    hundred masses of the mesh, or of half of one.
    """
    base, evidence = gear_pair(teeth)
    stated = base.model.values(1, **base.given)
    values = base.model.prepare(stated)
    stiffness, mass = float(values.derived["mean_stiffness"][0]), float(values.derived["equivalent_mass"][0])
    for candidate in of("shaft_torsion", base, evidence):
        own = next(p for p in candidate.hypothesis.free if p.name == "shaft_torsion.stiffness")
        radius = float(values.derived[f"base_radius_{dict(candidate.options)['shaft']}"][0])
        assert own.lower == pytest.approx(1e-4 * stiffness * radius**2)
        assert own.lower < own.start / 100
        bounds = {p.name: (p.lower, p.upper) for p in candidate.hypothesis.free}
        inertias = (float(stated[f"inertia_{shaft}"][0]) for shaft in ("pinion", "gear"))
        radii = (float(values.derived[f"base_radius_{shaft}"][0]) for shaft in ("pinion", "gear"))
        both = sum(i * (radius / r) ** 2 for i, r in zip(inertias, radii, strict=True))
        assert bounds["shaft_torsion.motor_inertia"][0] == pytest.approx(0.1 * both)
        assert bounds["shaft_torsion.damping_ratio"] == (0.0, 0.3)
    for candidate in of("bearing_flexibility", base, evidence):
        own = next(p for p in candidate.hypothesis.free if p.name == "bearing_flexibility.mass")
        assert (own.lower, own.upper) == (pytest.approx(0.5 * mass), pytest.approx(100 * mass))
        assert own.start < own.upper / 6


def test_sizes_follow_the_rig():
    """What is tried of a shaft, a bearing or a gap is a share of this rig's own stiffness, inertia and teeth."""

    def sizes(scale):
        base, evidence = gear_pair((25, 50))
        larger = {"inertia_pinion": 2.6e-4 * scale**5, "inertia_gear": 4.5e-3 * scale**5, "module": 3e-3 * scale}
        found = candidates_for(replace(base, given=base.given | larger), evidence)
        wanted = ("shaft_torsion.stiffness", "shaft_torsion.motor_inertia", "bearing_flexibility.mass", "backlash.gap")
        return [[c.hypothesis.given[name] for c in found if name in c.hypothesis.given] for name in wanted]

    for usual, larger, power in zip(sizes(1.0), sizes(2.0), (2, 5, 3, 1), strict=True):
        assert larger == pytest.approx([value * 2.0**power for value in usual])


def test_a_gap_is_none_of_an_oscillators():
    assert not of("backlash", *oscillator())


def test_the_width_of_a_friction_may_rest_at_its_lower_bound():
    for base, evidence in (oscillator(), gear_pair((20, 40))):
        for name in ("coulomb_friction", "asymmetric_friction"):
            for candidate in of(name, base, evidence):
                (width,) = [p for p in candidate.later if (p.name, -1) in candidate.resting]
                assert width.name == f"{name}.width"
                assert width.lower == (0.001 if base.system.name == "oscillator" else 0.02)
                assert width.start == 0.05


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_sizes_of_an_oscillators_candidates_follow_its_unit(scale):
    base, evidence = oscillator("V")
    in_unit = replace(base, given=base.given | {"amplitude": 0.5 * scale})
    for candidate in candidates_for(in_unit, evidence):
        declared = candidate.hypothesis.model.parameters()
        for parameter in candidate.hypothesis.free:
            if declared[parameter.name.partition("[")[0]].unit != "1":
                reach = parameter.start if parameter.logarithmic else parameter.start + 1e3 * parameter.scale
                assert parameter.lower < reach < parameter.upper, f"{parameter.name} of {candidate.label}"


def test_a_pendulum_takes_the_place_of_the_spring():
    base, evidence = oscillator()
    found = of("sine_restoring", base, evidence)
    assert [c.hypothesis.given["sine_restoring.stiffness"] for c in found] == pytest.approx([50.0, 65.0, 100.0])
    for candidate in found:
        names = [p.name for p in candidate.hypothesis.free]
        assert candidate.non_nested
        assert candidate.hypothesis.given["stiffness"] == 0
        assert names == [DAMPING, "sine_restoring.stiffness"]
        assert candidate.strengths == (1,)
        assert candidate.hypothesis.free[1].logarithmic
        assert candidate.replaced == (base.free[0],)
        frequency = candidate.hypothesis.model.prepare(
            candidate.hypothesis.model.values(1, **candidate.hypothesis.given)
        ).derived["natural_frequency"]
        assert float(frequency[0]) == pytest.approx(candidate.hypothesis.given["sine_restoring.stiffness"] ** 0.5)


def test_without_the_pendulum_the_spring_is_back():
    base, evidence = oscillator()
    candidate = of("sine_restoring", base, evidence)[0]
    taken = replace(
        candidate.hypothesis,
        effects=base.effects,
        given={k: v for k, v in candidate.hypothesis.given.items() if not k.startswith("sine_restoring.")},
        free=tuple(p for p in candidate.hypothesis.free if not p.name.startswith("sine_restoring.")),
        causes=(),
    )
    back = restored(taken, "sine_restoring")
    assert back.given == base.given
    assert set(back.free) == set(base.free)


@pytest.mark.parametrize(
    ("unit", "radian"),
    [("rad", 1.0), ("deg", degrees(1.0)), ("mrad", 1000.0), ("rad/s", 1.0), ("deg/s^2", degrees(1.0))],
)
def test_the_length_of_a_pendulum_is_a_radian_where_the_response_is_an_angle(unit, radian):
    for candidate in of("sine_restoring", *oscillator(unit)):
        assert candidate.hypothesis.given["sine_restoring.length"] == pytest.approx(radian)
        assert "sine_restoring.length" not in {p.name for p in candidate.hypothesis.free}


@pytest.mark.parametrize("unit", ["mm", "V", "m", "m/s^2"])
def test_the_length_is_free_where_the_response_is_no_angle(unit):
    for candidate in of("sine_restoring", *oscillator(unit)):
        assert candidate.hypothesis.given["sine_restoring.length"] == pytest.approx(1.5), "three amplitudes"
        assert "sine_restoring.length" in {p.name for p in candidate.hypothesis.free}


def test_without_a_spring_nothing_takes_its_place():
    base, evidence = oscillator()
    free = base.free[1:]
    without = replace(base, free=free, given=base.given | {"stiffness": 0.0})
    for name in ("sine_restoring", "hunt_crossley_damping", "sensor_drift"):
        assert of(name, base, evidence)
        assert not of(name, without, evidence), name


def test_recipes_may_be_a_tuple_or_a_function_of_the_rig():
    seen = []

    def by_input(rig):
        seen.append(rig)
        return tuple(Recipe({"force": 0.01 * i}, scanned={"width": 0.05}) for i in range(1, 1 + len(rig.inputs)))

    def kind(recipes):
        own = {"name": "my_friction", "cause": Cause("a friction of my own", recipes), "__doc__": "One's own."}
        return type("MyFriction", (CoulombFriction,), own)

    base, evidence = oscillator(forced=True)
    for recipes in ((Recipe({"force": 0.01}, scanned={"width": 0.05}),), by_input):
        mine = kind(recipes)
        assert list(cause_faults(mine)) == []
        evidence = replace(evidence, library=builtin_effects() | {"my_friction": mine})
        (found,) = of("my_friction", base, evidence)
        assert found.hypothesis.free[found.strengths[0]].name == "my_friction.force"
    assert seen[-1].inputs == ("force",)
    assert seen[-1].values["natural_frequency"] == pytest.approx(50**0.5)


@pytest.mark.parametrize(
    ("recipes", "said"),
    [
        (lambda rig: rig.nothing, "has recipes that fail on a rig: AttributeError"),
        (lambda rig: ("a",), "has recipes that give something else than a tuple of Recipe"),
        (lambda rig: (Recipe({"size": 1.0}),), "has a recipe with 'size', which is none of its parameters"),
    ],
)
def test_what_is_wrong_with_a_function_of_the_rig_is_said(recipes, said):
    wrong = type("Wrong", (CoulombFriction,), {"cause": Cause("a friction of my own", recipes)})
    (fault,) = cause_faults(wrong)
    assert fault.startswith(said)


def test_the_rig_of_a_gear_pair_is_that_of_the_records():
    rig = rig_of(*gear_pair((37, 53)))
    assert (rig.n_teeth_pinion, rig.n_teeth_gear, rig.radian) == (37, 53, None)
    assert (rig.teeth("pinion"), rig.teeth("gear")) == (37, 53)
    assert rig.values["contact_ratio"] == pytest.approx(1.6)
    assert rig.inputs == ("pinion_angle",)
    assert rig.mesh_harmonics == int(RATE / 2 / (37 * SPEED / (2 * pi)))


def test_a_strength_tried_as_a_whole_keeps_the_bounds_of_its_recipe():
    base, evidence = oscillator()
    time = torch.arange(400, dtype=torch.float64) / 100
    left = torch.cos(2 * pi * 9.0 * time)
    tried = of("second_mode", base, evidence, [(evidence.fit[0], left)])
    own = {p.name: (p.lower, p.upper) for found in tried for p in found.hypothesis.free}
    assert own["second_mode.mass_ratio"] == (1e-4, 1.0)


@pytest.mark.parametrize(("name", "shapes"), [("hunt_crossley_damping", {"exponent"}),
                                              ("hysteretic_damping", {"yield_deflection", "exponent"})])  # fmt: skip
def test_the_shape_of_a_law_joins_the_full_fit(name, shapes):
    for base, evidence in (oscillator(forced=True), gear_pair((17, 43))):
        for found in of(name, base, evidence):
            assert {p.name.partition(".")[2] for p in found.later} == shapes


def test_a_torque_that_swings_begins_anywhere_in_every_record():
    found = of("torque_variation", *gear_pair(RIGS[0]))
    sines = [one for one in found if one.tried["form"] == "sine"]
    assert sines
    assert all(one.own_phases and not one.phases for one in sines)
    assert not any(one.own_phases for one in found if one.tried["form"] == "ramp")
