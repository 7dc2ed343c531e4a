"""A wrong tooth count is told from what else stands out beside a weak mesh."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.data_faults import mesh_order_faults
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Channel

RATE, N = 20000.0, 3000


def _record(
    orders: dict[float, float], speed: float, lines: dict[float, float], seed: int, is_stated: bool = False
) -> FitRecord:
    """Waves by shaft order and by frequency in Hz, with a little noise."""
    time = np.arange(N) / RATE
    angle = 0.3 + speed * time
    values = 0.02 * np.random.default_rng(seed).standard_normal(N)
    values += sum(size * np.cos(order * angle + order) for order, size in orders.items())
    values += sum(size * np.cos(2 * np.pi * f * time) for f, size in lines.items())
    series = {"response": torch.as_tensor(1e-6 * values), "angle": torch.as_tensor(angle)}
    stated = ({}, {"pinion_speed": speed}) if is_stated else ({"pinion_angle": series["angle"]}, {})
    return FitRecord(f"run_{seed}", series["response"], RATE, *stated)


def _found(
    teeth: int | None,
    orders: dict[float, float],
    lines=None,
    speeds=(150.0, 190.0),
    gear=None,
    is_stated=False,
    name="transmission_error",
) -> list[str]:
    records = tuple(_record(orders, speed, lines or {}, k, is_stated) for k, speed in enumerate(speeds))
    parameters = {} if teeth is None else {"n_teeth_pinion": float(teeth)}
    parameters |= {} if gear is None else {"n_teeth_gear": float(gear)}
    channel = Channel(name, np.zeros(2), "m")
    evidence = Evidence("gear_pair", records[:1], records[1:], Known(parameters, {}), channel, one_record=False)
    return [finding.message for finding in mesh_order_faults(evidence)]


MESH = {25: 1.0, 50: 0.4, 75: 0.1}


@pytest.mark.parametrize("declared", [17, 23, 24, 27])
def test_a_wrong_tooth_count_is_found_and_the_right_one_named(declared):
    (message,) = _found(declared, MESH)
    assert f"mesh order {declared} is absent, while order 25 stands out" in message


@pytest.mark.parametrize("teeth", [17, 25, 33])
@pytest.mark.parametrize("speed", [1.0, 1.5, 2.0])
def test_a_slow_roll_that_tells_no_orders_apart_blames_no_count(teeth, speed):
    """A fortieth to a twentieth of a turn: about one tooth, where every order fits as well as the next."""
    mesh = {teeth: 1.0, 2 * teeth: 0.6, 3 * teeth: 0.3, 4 * teeth: 0.3, 5 * teeth: 0.2, 6 * teeth: 0.1}
    assert _found(teeth, mesh, speeds=(speed, 1.3 * speed)) == []


def test_where_no_count_is_declared_the_rig_of_the_project_is_meant():
    assert _found(None, {20: 1.0, 40: 0.3}) == []
    assert len(_found(None, MESH)) == 1


@pytest.mark.parametrize(
    "orders",
    [
        MESH,
        MESH | {17: 9.0},  # a load that ripples at order 17
        MESH | {26: 4.0, 24: 4.0},  # sidebands above the mesh
        {25: 0.2} | {1 / 2: 3.0, 1: 5.0, 2: 4.0, 26.5: 1.0},  # eccentric shafts
        {17.3: 1.0},  # nothing that belongs to the shaft
    ],
)
def test_orders_beside_the_mesh_raise_no_alarm(orders):
    assert _found(25, orders) == []


def test_a_line_of_the_structure_is_no_mesh():
    speed = 150.0
    at_order_19 = 19 * speed / (2 * np.pi)
    assert _found(25, {}, {at_order_19: 3.0}, speeds=(speed, speed)) == []
    assert _found(25, {}, {at_order_19: 3.0}) == []


def test_one_speed_is_enough_where_the_comb_has_harmonics():
    assert len(_found(23, MESH, speeds=(150.0, 150.0))) == 1


@pytest.mark.parametrize(("teeth", "speed"), [(33, 2.0), (20, 3.0)])
def test_less_than_a_turn_tells_no_order(teeth, speed):
    assert _found(teeth, {0.5: 5.0, 1: 1.0}, speeds=(speed, speed)) == []


@pytest.mark.parametrize("factor", [0.25, 0.5, 2, 4])
def test_turns_that_were_counted_by_another_number_of_counts_are_found(factor):
    (message,) = _found(24, {factor * order: size for order, size in {24: 1.0, 48: 0.25, 72: 0.1, 96: 0.1}.items()})
    assert f"the teeth mesh {24 * factor:g} times a turn" in message
    assert "counts_per_revolution" in message


def test_where_a_speed_is_stated_nothing_was_counted():
    """A sampling rate of half of what it was."""
    (message,) = _found(24, {12: 1.0, 24: 0.25, 36: 0.1, 48: 0.1}, is_stated=True)
    assert "the teeth mesh 12 times a turn of the speed that is given" in message
    assert "check sampling_rate, and pinion_speed" in message
    assert "counts_per_revolution" not in message


@pytest.mark.parametrize(
    "orders",
    [
        {24: 1.0, 48: 0.4, 12: 1.5, 6: 0.5},  # a motor of twelve poles beside the mesh
        {24: 0.12, 48: 1.0, 72: 0.1},  # the second harmonic near the resonance
        {24: 0.12, 96: 1.0},
        {12: 1.0, 24: 0.4, 36: 0.1},
    ],
    ids=["a ripple at half of it", "mostly the second harmonic", "mostly the fourth", "either the mesh or its half"],
)
def test_a_mesh_that_is_there_is_not_miscounted(orders):
    assert _found(24, orders) == []


@pytest.mark.parametrize(
    ("counts", "factor", "is_said"),
    [
        ((23, 41), 0.5, True),
        ((23, 41), 0.25, True),
        ((23, 40), 0.5, False),
        ((24, 41), 0.5, False),
        ((22, 41), 0.25, True),
    ],
)
def test_lines_between_those_of_the_mesh_that_no_shaft_can_make_are_the_mesh(counts, factor, is_said):
    """The true mesh excites the resonance by its second or fourth harmonic, where the declared one has its first."""
    orders = {factor * counts[0]: 0.3, counts[0]: 1.0, 2 * counts[0]: 0.2}
    found = _found(counts[0], orders, gear=counts[1])
    assert len(found) == is_said
    assert all(f"mesh {counts[0] * factor:g} times a turn" in one for one in found)


@pytest.mark.parametrize("speeds", [(40.0, 60.0), (150.0, 190.0)])
def test_what_drifts_over_a_turn_is_no_mesh_between_the_lines(speeds):
    assert _found(23, {23: 1.0, 1: 30.0, 0.2: 60.0, 1.7: 9.0}, speeds=speeds, gear=41) == []


def test_a_mesh_counted_too_finely_is_found_by_its_high_harmonics():
    (message,) = _found(23, {46: 0.3, 92: 0.2, 184: 1.0}, gear=41)
    assert "mesh 46 times a turn" in message


@pytest.mark.parametrize(("name", "power"), [("gear_speed", 1), ("acceleration", 2)])
@pytest.mark.parametrize("factor", [0.5, 1, 2])
def test_of_a_rate_the_turns_are_counted_too(name, power, factor):
    """An accelerometer weighs the fourth harmonic by sixteen; no other count is blamed where the mesh is there."""
    mesh = {1: 1.0, 2: 0.35, 3: 0.15, 4: 0.2}
    orders = {23 * factor * k: size * k**power / 3 for k, size in mesh.items()}
    found = _found(23, orders, gear=41, name=name)
    assert len(found) == (factor != 1)
    assert all(f"the teeth mesh {23 * factor:g} times a turn" in one for one in found)


@pytest.mark.parametrize(("name", "power"), [("gear_speed", 1), ("acceleration", 2)])
def test_a_rate_that_rings_at_even_harmonics_blames_no_count(name, power):
    mesh = {1: 1.0, 2: 3.0, 3: 0.3, 4: 3.0}
    assert _found(24, {24 * k: size * k**power / 9 for k, size in mesh.items()}, name=name) == []


def test_of_one_speed_no_harmonic_is_told_from_a_line_of_the_structure():
    assert _found(24, {48: 1.0, 96: 0.3}, speeds=(150.0, 150.0)) == []


UNIT = "the number of its speed were in {} and not in {}: check its unit"


@pytest.mark.parametrize(
    ("factor", "declared", "meant"),
    [
        (30 / np.pi, "rad/s", "rpm"),
        (np.pi / 30, "rpm", "rad/s"),
        (1 / (2 * np.pi), "rad/s", "Hz"),
        (2 * np.pi, "Hz", "rad/s"),
    ],
)
def test_a_speed_in_another_unit_is_told_by_where_its_mesh_stands(factor, declared, meant):
    """Both shafts are declared to turn `factor` times as fast as they do."""
    seen = {23 * number / factor: size for number, size in ((1, 1.0), (2, 0.4), (3, 0.1))}
    speeds = (150.0 * factor, 190.0 * factor)
    (message,) = _found(23, seen, speeds=speeds, gear=41)
    assert message.endswith(UNIT.format(meant, declared))


def test_what_a_shaft_makes_once_or_twice_a_turn_is_no_mesh_of_another_unit():
    runout = {2.0: 1.0, 4.0: 0.4, 6.0: 0.2}  # an oval disc, where 19 teeth at rad/s for rpm would be 1.99
    found = _found(19, runout, speeds=(1500.0, 1900.0), gear=41)
    assert not [one for one in found if "check its unit" in one]
