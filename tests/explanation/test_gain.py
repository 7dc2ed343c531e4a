"""What is said of fitted parameters."""

from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
import torch

from gear_damping.explanation.answer import gain, report_fields
from gear_damping.explanation.answer.gain import mean_stiffness, parameters_of
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model import covariance
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.fitting import fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.simulate import simulate

NOISE = 1e-8


def test_a_gap_whose_far_flank_is_never_touched_has_its_whole_range_as_interval():
    effects = [effect_class(name)() for name in ("fourier_mesh_stiffness", "viscous_damping", "backlash")]
    model = Model(GearPair(), effects)
    given = {"pinion_torque": 150.0, "pinion_speed": 300.0, "backlash.gap": 1e-4}
    start = {"initial_displacement": 1.8e-5}
    runs = simulate(model, model.values(1, **given, **start), sampling_rate=40e3, n_samples=300)
    response = runs.response[0] + NOISE * torch.randn(300, generator=torch.Generator().manual_seed(0)).double()
    records = (FitRecord("run", response, 40e3),)
    evidence = Evidence("gear_pair", records, records, {}, None, one_record=False, noise=NOISE)
    free = (
        FreeParameter("viscous_damping.damping_coefficient", 60.0, logarithmic=True),
        FreeParameter("backlash.gap", 8e-5, logarithmic=True, lower=0, upper=1e-2),
    )
    outcome = fit_hypothesis(Hypothesis(GearPair(), tuple(effects), given, free), evidence)
    covariances = covariance_of(outcome, evidence)
    gap = parameters_of(outcome, covariances, "backlash", evidence)["gap"]
    declared = model.parameters()["backlash.gap"]
    assert gap["interval95"] == [declared.lower, declared.upper]
    assert gap["told"] is False
    damping = parameters_of(outcome, covariances, "viscous_damping", evidence)["damping_coefficient"]
    low, high = damping["interval95"]
    assert "told" not in damping
    assert low < 64.5 < high
    assert high - low < 6.0


@pytest.mark.parametrize(
    ("end", "resting", "has_run"),
    [
        (-1, (), True),
        (-1, (("law.width", -1),), False),
        (1, (("law.width", -1),), True),
        (1, (("law.width", 1),), False),
        (0, (), False),
    ],
)
def test_what_rests_at_its_end_of_what_there_is_has_run_into_nothing(end, resting, has_run, monkeypatch):
    monkeypatch.setattr(gain, "_interval", lambda *_: gain.Interval(1.0, (0.0, 2.0), "1"))
    monkeypatch.setattr(gain, "unit_of", lambda *_: "1")
    free = (SimpleNamespace(name="law.width", declared_name="law.width"),)
    problem = SimpleNamespace(free=free, unknowns=SimpleNamespace(at_bound=lambda _: torch.tensor([end])))
    fitted, hypothesis = SimpleNamespace(shared=None), SimpleNamespace(model=None)
    outcome = SimpleNamespace(problem=problem, fitted=fitted, hypothesis=hypothesis)
    found = gain.parameters_of(outcome, None, "law", None, resting)
    assert found["width"]["at_bound"] is has_run


def test_the_mean_stiffness_knows_the_shape_of_the_teeth():
    """The product of two series, one of them written out here, over a period."""
    effects = [effect_class(name)() for name in ("fourier_mesh_stiffness", "mesh_stiffness_shape")]
    shape = {"in_phase": (0.08, -0.05, 0.0), "quadrature": (0.0, 0.06, 0.03)}
    model = Model(GearPair(), effects)
    given = {f"mesh_stiffness_shape.{part}": values for part, values in shape.items()}
    prepared = model.prepare(model.values(2, **given, **{"fourier_mesh_stiffness.edge": 0.1}))
    angle = np.arange(4096) * 2 * np.pi / 4096
    ideal = np.full(4096, 2e8 + 2e8 * 0.6)
    for h in range(1, 9):
        size = np.sinc(0.1 * h) * 2 * 2e8 / (h * np.pi) * np.sin(h * np.pi * 0.6)
        ideal += size * np.cos(h * (angle - np.pi * 0.6))
    factor = 1 + sum(a * np.cos((h + 1) * angle) for h, a in enumerate(shape["in_phase"]))
    factor += sum(b * np.sin((h + 1) * angle) for h, b in enumerate(shape["quadrature"]))
    found = mean_stiffness(model, prepared)
    assert found.tolist() == pytest.approx([np.mean(ideal * factor)] * 2, rel=1e-9)
    assert abs(float(found[0]) / float(prepared.derived["mean_stiffness"][0]) - 1) > 0.003  # it counts


def test_beside_several_causes_no_coordinate_is_known_better_than_records_agree_on_it(monkeypatch):
    moves = torch.tensor([[0.3, 0.0], [-0.1, 0.0], [0.1, 0.0], [-0.3, 0.0]], dtype=torch.float64)
    monkeypatch.setattr(covariance, "moves_without_one", lambda outcome: outcome)
    monkeypatch.setattr(covariance, "has_records", lambda outcome: True)
    known = torch.tensor([[0.01, 0.002], [0.002, 0.04]], dtype=torch.float64)
    found = covariance.wider_of_both(known, moves)
    jackknife = 3 / 4 * (moves[:, 0] - moves[:, 0].mean()).square().sum()  # Efron & Stein (1981)
    assert found.flatten().tolist() == pytest.approx([float(jackknife), 0.002, 0.002, 0.04])
    monkeypatch.setattr(covariance, "has_records", lambda outcome: False)
    assert covariance.wider_of_both(known, moves) is known


def of_records(names):
    """A made-up problem with a row for each record."""
    return SimpleNamespace(records=[SimpleNamespace(record=name) for name in names])


@pytest.mark.parametrize(("names", "enough"), [("abc", True), ("aaabbb", False)])
def test_segments_of_few_records_are_no_records(names, enough):
    assert covariance.has_records(SimpleNamespace(problem=of_records(names))) == enough


DIFFERS = (effect_class("stiffness_by_record")(),)


@pytest.mark.parametrize(
    ("causes", "effects", "unnamed", "known"),
    [
        (0, (), False, "noise"),
        (1, (), False, "noise"),
        (2, (), False, "scatter"),
        (3, (), False, "scatter"),
        (2, DIFFERS, False, "noise"),
        (1, (), True, "scatter"),
        (1, DIFFERS, True, "noise"),
    ],
)
def test_the_scatter_between_records_counts_beside_several_causes_and_a_rest(
    causes, effects, unnamed, known, monkeypatch
):
    monkeypatch.setattr(report_fields, "told_covariance", lambda *_: "noise")
    monkeypatch.setattr(report_fields, "wider_of_both", lambda *_: "scatter")
    fitted = SimpleNamespace(converged=True)
    last = SimpleNamespace(hypothesis=SimpleNamespace(effects=effects), problem=of_records("abc"), fitted=fitted)
    found = SimpleNamespace(accepted=(None,) * causes, outcome=last, left=SimpleNamespace(visible=False))
    judged = SimpleNamespace(found=found, verdict=SimpleNamespace(leaves_unnamed=unnamed))
    assert report_fields._known(judged, None) == known


@pytest.mark.parametrize(
    ("leaves_unnamed", "causes", "visible", "converged", "conditional"),
    [
        (False, 1, False, True, False),
        (True, 1, False, True, True),
        (False, 1, True, True, True),
        (False, 0, True, True, False),
        (False, 1, False, False, True),
    ],
    ids=["all is named", "a part has no name", "not all random", "nothing is missing", "not converged"],
)
def test_damping_is_conditional_where_more_than_noise_is_left(leaves_unnamed, causes, visible, converged, conditional):
    said, after = _told(leaves_unnamed, causes, visible, converged)
    assert said["damping_ratio_percent"]["conditional"] == conditional
    assert after == ("scatter" if conditional else None)


def test_beside_several_causes_the_interval_of_the_damping_counts_the_scatter_between_records_too():
    said, after = _told(leaves_unnamed=False, causes=2, visible=False, converged=True)
    assert not said["damping_ratio_percent"]["conditional"]
    assert after == "scatter"


@pytest.mark.parametrize(("leaves_unnamed", "counted"), [(False, None), (True, "scatter")])
def test_records_that_a_cause_lets_differ_are_not_expected_to_agree(leaves_unnamed, counted):
    assert _told(leaves_unnamed, causes=2, visible=True, converged=True, effects=DIFFERS)[1] == counted


def _told(leaves_unnamed, causes, visible, converged, effects=()):
    """What is said of the gain, and what the interval of the damping after it counts beside the noise."""
    left = SimpleNamespace(visible=visible)
    last = SimpleNamespace(fitted=SimpleNamespace(converged=converged), holdout=[])
    last.hypothesis, last.problem = SimpleNamespace(effects=effects), of_records("abc")
    found = SimpleNamespace(accepted=(None,) * causes, left=left, nominal=last, outcome=last)
    judged = SimpleNamespace(found=found, verdict=SimpleNamespace(leaves_unnamed=leaves_unnamed))
    evidence, ratio, counted = SimpleNamespace(held=()), {"value": 1.0}, []
    with (
        patch.object(report_fields.gain, "damping_ratio", lambda *given: counted.append(given[2]) or dict(ratio)),
        patch.object(report_fields, "told_covariance", lambda *_: None),
        patch.object(report_fields, "moves_without_one", lambda *_: "scatter"),
        patch.object(report_fields, "rig_unit", lambda *_: "m/s"),
        patch.object(report_fields, "_confirmed", lambda *_: None),
        patch.object(report_fields, "damping_by_record", lambda *_: []),
    ):
        return report_fields._gain(judged, evidence, None), counted[-1]


def test_every_law_of_damping_has_its_part_of_the_ratio():
    """By hand: c / (2 sqrt(k m)) of the viscous one, 4 F / (pi V) in the place of c of a dry friction."""
    effects = [effect_class(name)() for name in ("viscous_damping", "coulomb_friction")]
    given = {"stiffness": 900.0, "amplitude": 0.01, "viscous_damping.damping_coefficient": 1.2}
    given |= {"coulomb_friction.force": 0.05, "coulomb_friction.width": 1e-4}
    hypothesis = Hypothesis(Oscillator(), tuple(effects), given, ())
    outcome = SimpleNamespace(hypothesis=hypothesis, flat_given=lambda: given)
    found, velocity = gain._by_law(outcome, {}, 1)
    assert list(found) == ["viscous_damping", "coulomb_friction"]
    assert float(found["viscous_damping"][0]) == pytest.approx(100 * 1.2 / 60)
    assert float(found["coulomb_friction"][0]) == pytest.approx(100 * 4 * 0.05 / (np.pi * velocity) / 60, rel=1e-2)
    assert float(gain._summed(found, 1)[0]) == pytest.approx(sum(float(each[0]) for each in found.values()))
