"""The limits of hidden effects: against closed forms and against tests that are really made."""

from dataclasses import replace

import numpy as np
import pytest
from hidden.catalogue import HIDDEN
from hidden.draft import Wanted, draft
from hidden.limit import _cosine, _crossing, amplitude_of, degrees_of, limits, wanted_noncentrality
from scipy.stats import chi2

DURATION = 0.01


@pytest.mark.parametrize(("degrees", "root"), [(1, 3.86), (2, 4.2), (8, 5.0), (17, 5.7)])
def test_noncentrality_is_that_of_the_tables(degrees, root):
    assert wanted_noncentrality(degrees) == pytest.approx(root**2, rel=0.02)


@pytest.mark.parametrize("degrees", [1, 3])
def test_a_test_with_this_noncentrality_has_its_power(degrees):
    source = np.random.default_rng(4)
    mean = np.zeros(degrees)
    mean[0] = wanted_noncentrality(degrees) ** 0.5
    drawn = ((source.standard_normal((20000, degrees)) + mean) ** 2).sum(1)
    assert np.mean(drawn > chi2.isf(0.01, degrees)) == pytest.approx(0.9, abs=0.01)


def test_an_offset_can_be_seen_where_its_sum_over_the_noise_says():
    """A constant is orthogonal to nearly all that calibration frees: its noncentrality is n b^2 / sigma^2."""
    found = limits("sensor_offset", 3, duration=DURATION, snr_db=30.0)
    one = draft(Wanted("sensor_offset", 3, DURATION, 30.0))
    largest, _ = amplitude_of("sensor_offset", one.params[0], 0.0)
    samples = one.n * len(one.records)
    noise = _noise_of(one)
    alone = noise * (wanted_noncentrality(1) / samples) ** 0.5 / largest
    assert alone < found.seen < 4 * alone


def _noise_of(one):
    from hidden import draw_case

    return draw_case("sensor_offset", 3, duration=DURATION, snr_db=30.0, size=1e-6).truth["noise_std"]


def test_a_quieter_sensor_shows_as_much_less_as_its_noise_is_smaller():
    loud, quiet = (limits("cubic_stiffness", 5, duration=DURATION, snr_db=snr).seen for snr in (20.0, 40.0))
    assert loud / quiet == pytest.approx(10.0, rel=0.1)


def test_what_looks_like_another_effect_needs_to_be_larger():
    found = limits("coulomb_friction", 5, duration=DURATION, rivals=("power_law_damping", "sensor_offset"))
    assert found.nearest == "power_law_damping"
    assert 0.8 < found.cosine < 1.0
    assert found.named == pytest.approx(found.seen / (1 - found.cosine**2) ** 0.5, rel=0.25)


def test_the_same_class_is_no_rival():
    found = limits("coulomb_friction", 5, duration=DURATION, rivals=("power_law_damping",), same=lambda a, b: True)
    assert (found.nearest, found.cosine) == ("", 0.0)
    assert found.named == found.seen


def test_degrees_count_amplitudes_and_phases():
    cases = {"coulomb_friction": 1, "pinion_eccentricity": 2, "profile_error": 6, "tooth_crack": 2, "pitch_error": 20}
    for name, count in cases.items():
        params = HIDDEN[name].draw(np.random.default_rng(0), 0.05)
        assert degrees_of(HIDDEN[name], params) == count, name


def test_a_size_is_found_between_and_beyond_those_tried():
    sizes = np.geomspace(1 / 4096, 1, 9)
    strength = 100.0 * sizes**2
    for wanted in (1e-8, 0.01, 30.0, 900.0):
        assert _crossing(strength, wanted) == pytest.approx((wanted / 100) ** 0.5)


def test_the_cosine_is_that_of_the_nearest_vector_of_a_span():
    span = np.array([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    assert _cosine(np.array([0.0, 3.0, 4.0]), span) == pytest.approx(0.6)
    assert _cosine(np.array([0.0, 3.0, 4.0]), 0 * span) == 0.0


def test_a_case_is_drawn_at_a_share_of_the_largest_size():
    from hidden import draw_case

    half, whole = (draw_case("cubic_stiffness", 5, duration=0.002, size=size) for size in (0.5, 1.0))
    values = [case.truth["effects"][0]["parameters"]["coefficient"] for case in (half, whole)]
    assert values[0] == pytest.approx(0.5 * values[1])
    assert replace(half.origin, params=None).targets == [None]
