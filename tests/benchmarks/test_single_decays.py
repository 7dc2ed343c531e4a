"""Single decays are drawn as they are declared, and what is said of them is judged by what is hidden."""

import numpy as np
import pytest

from benchmarks.single_decays import DRAWN, LAWS, drawn, judged


def test_a_linear_decay_is_the_closed_form():
    """Its logarithmic decrement over many cycles, by crossings of its rest, whatever its size, zero and unit."""
    law, damping, time, values, _ = drawn(1003)
    assert law == ""
    peaks = [k for k in range(1, len(values) - 1) if values[k - 1] < values[k] >= values[k + 1]]
    rest = values[-len(values) // 20 :].mean()
    sizes, at = values[peaks] - rest, time[peaks]
    loud = sizes > 0.2 * sizes[0]
    slope = np.polynomial.Polynomial.fit(at[loud], np.log(sizes[loud]), 1).convert().coef[1]
    assert -2 * slope == pytest.approx(damping, rel=0.05)


def test_every_law_is_drawn_beside_twice_as_many_linear_ones():
    assert {law: DRAWN.count(law) for law in LAWS} == dict.fromkeys(LAWS, 4)
    assert DRAWN.count("") == 24


@pytest.mark.parametrize(("seed", "named"), [(1000, []), (1024, ["cubic_stiffness"])])
def test_what_is_said_is_kept_with_what_was_hidden(seed, named):
    said = judged(seed)
    assert said["named"] == named == [said["law"]] * bool(said["law"])
    assert said["is_inside"]
