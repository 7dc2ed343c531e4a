"""A strength that moves no record has no size that records could differ in."""

import pytest

from gear_damping.explanation.settings import SearchSettings
from tests.explanation.decisions.of_evidence import of_one_size


@pytest.mark.parametrize(("moves", "holds"), [(1.0, False), (0.01, True)])
def test_what_no_record_tells_differs_between_none(moves, holds):
    """A gap that no motion crosses: of any width, by rounding a different one in each record."""
    assert of_one_size([0.0, 0.9, -0.9], 0.01, SearchSettings(), moves) is holds
