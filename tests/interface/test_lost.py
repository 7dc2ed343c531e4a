"""A gear pair whose records are mostly missed is told so, however random the rest looks."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.interface import identified_gears


@pytest.mark.parametrize(("left", "percent"), [(0.9, 81.0), (0.75, 56.25), (0.6, None), (0.01, None)])
def test_more_than_half_of_the_variance_is_lost(left, percent, monkeypatch):
    monkeypatch.setattr(identified_gears, "nrmse", lambda residuals, records: left)
    evidence = SimpleNamespace(fitted=(), settings=SearchSettings())
    found = SimpleNamespace(evidence=evidence, outcome=SimpleNamespace(fit_residuals=[]))
    assert identified_gears._lost(found) == (percent and pytest.approx(percent))
