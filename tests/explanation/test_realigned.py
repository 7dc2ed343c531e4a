"""A fit is begun anew from aligned meshes where it loses a record, however little that record weighs beside others."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.steps import calibrate

SAMPLES, NOISE = 4000, 0.1
SIZES = (100.0, 1.0)  # the second record has a ten-thousandth of the power of both


def record(size):
    generator = torch.Generator().manual_seed(int(size))
    stacked = size * torch.randn(SAMPLES, generator=generator, dtype=torch.float64)
    return SimpleNamespace(weight=1.0, stacked=stacked, channels=("displacement",))


def outcome(records, left, cost):
    """A fit that leaves these shares of the power of its records beside their noise."""
    residuals = [
        (share + (NOISE / size) ** 2) ** 0.5 * one.stacked
        for one, share, size in zip(records, left, SIZES, strict=True)
    ]
    return SimpleNamespace(fitted=SimpleNamespace(cost=cost), fit_residuals=residuals)


@pytest.mark.parametrize(
    ("left", "is_begun_anew"),
    [
        ((0.002, 0.002), False),  # both are followed
        ((0.002, 0.4), True),  # the quiet one is lost
        ((0.4, 0.002), True),  # the lively one is
        ((0.0, 0.0), False),  # nothing but noise is left
    ],
)
def test_begun_anew_where_a_record_is_lost(left, is_begun_anew, monkeypatch):
    records = tuple(record(size) for size in SIZES)
    evidence = SimpleNamespace(has_index=False, mesh_index=False, fit=records, fitted=records, noise=NOISE)
    found, better = outcome(records, left, 10.0), outcome(records, (0.0, 0.0), 1.0)
    monkeypatch.setattr(calibrate, "flanks_part", lambda given: False)
    monkeypatch.setattr(calibrate, "begun_aligned", lambda *given: ["wave"])
    monkeypatch.setattr(calibrate, "shaped", lambda *given: better)
    _, _, nominal = calibrate._realigned(evidence, None, found, None)
    assert nominal is (better if is_begun_anew else found)
