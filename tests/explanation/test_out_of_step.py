"""Records that a simulation loses are named where nobody recorded an angle; made-up residuals."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.steps.out_of_step import out_of_step
from gear_damping.identification.output_error.records import FitRecord

WAVE = torch.sin(torch.arange(200, dtype=torch.float64))


def state_of(share, speed=90.0, inputs=(), shafts=True):
    """A search that leaves a share of the power of the second of two records."""
    conditions = {"pinion_speed": speed}
    angle = {name: torch.zeros(200, dtype=torch.float64) for name in inputs}
    records = [FitRecord(name, WAVE, 100.0, inputs=angle, conditions=conditions) for name in ("calm", "belt")]
    evidence = SimpleNamespace(fitted=records, settings=SearchSettings(), has=lambda trait: shafts)
    left = [0.01 * WAVE, share**0.5 * WAVE]
    return SimpleNamespace(bench=SimpleNamespace(evidence=evidence), outcome=SimpleNamespace(fit_residuals=left))


def test_a_record_that_is_lost_is_named_with_what_would_keep_it_in_step():
    said = out_of_step(state_of(0.9))
    assert "belt" in said
    assert "calm" not in said
    assert "`pinion_angle`" in said


@pytest.mark.parametrize(
    "kept",
    [
        {"share": 0.3},
        {"share": 0.9, "speed": 0.0},
        {"share": 0.9, "inputs": ("pinion_angle",)},
        {"share": 0.9, "shafts": False},
    ],
    ids=["most is followed", "it stands", "its angle is known", "no shafts"],
)
def test_nothing_is_said_where_nothing_turns_unseen(kept):
    assert out_of_step(state_of(**kept)) == ""
