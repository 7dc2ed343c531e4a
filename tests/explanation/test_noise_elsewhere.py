"""The noise of a record that was not fitted follows from that of those that were."""

import pytest

from gear_damping.explanation.evidence.noise import NoiseLevel


@pytest.mark.parametrize(
    ("floors", "levels", "own", "expected"),
    [
        ((1.0, 2.0), (2.5, 5.0), 3.0, 7.5),  # noise of another colour, as much more everywhere
        ((1.0, 2.0), (5.0, 5.0), 3.0, 5.0),  # a load that is as large everywhere
        ((1.0, 1.0), (2.5, 5.0), 1.0, (0.5 * (2.5**2 + 5.0**2)) ** 0.5),
        ((1.0, 2.0), (1.0, 2.0), 3.0, 3.0),  # no more than the floors
        ((1.0, 2.0), (2.5, 5.0), 9.0, 22.5),
        ((1.0, 2.0), (5.0, 5.0), 9.0, 9.0),
    ],
)
def test_the_noise_of_a_record_that_was_not_fitted(floors, levels, own, expected):
    floor, known = (
        NoiseLevel(dict(zip("ab", values, strict=True)), "spectral floor", 100.0, True) for values in (floors, levels)
    )
    assert known.elsewhere(floor, own) == pytest.approx(expected)
