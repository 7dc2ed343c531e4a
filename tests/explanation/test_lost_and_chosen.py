"""When records count as lost, which laws are fitted in full, and which fits are rivals, on made-up residuals."""

import math
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.explain import best_is_lost, is_lost_by
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials.bench import Bench
from gear_damping.explanation.trials.refit import chosen
from gear_damping.explanation.trials.score import Score, contains, with_other_sizes
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.systems.known import SYSTEMS
from tests.explanation.decisions.made_up import bench

NOISE, SAMPLES = 1e-3, 800


def lost(system, response, residual):
    record = FitRecord("a", response, 100.0)
    evidence = SimpleNamespace(has=SYSTEMS[system].has, fitted=[record], noise=NOISE, settings=SearchSettings())
    return is_lost_by(SimpleNamespace(fit_residuals=[residual]), evidence)


def decay():
    time = torch.arange(SAMPLES, dtype=torch.float64) / 100
    return torch.exp(-time) * torch.cos(40 * time)


def test_a_stretch_that_is_out_of_step_is_enough_for_an_oscillator():
    response, residual = decay(), torch.zeros(SAMPLES, dtype=torch.float64)
    assert not lost("oscillator", response, residual)
    residual[300:400] = 2 * response[300:400]  # opposite in phase where a thousandth of the energy is left
    assert float(residual.square().sum() / response.square().sum()) < 0.01
    assert lost("oscillator", response, residual)
    assert not lost("gear_pair", response, residual)
    assert lost("gear_pair", response, response)


def test_noise_at_the_end_of_a_decay_is_not_lost():
    response, residual = decay(), torch.zeros(SAMPLES, dtype=torch.float64)
    noise = NOISE * torch.randn(SAMPLES, dtype=torch.float64, generator=torch.Generator().manual_seed(1))
    residual[700:] = noise[700:]
    assert not lost("oscillator", response + noise, residual)


def fit_of(cost, held, seen=True, gain=0.0, fit_gain=0.0):
    outcome = SimpleNamespace(fitted=SimpleNamespace(cost=cost), left_out_cost=held)
    return SimpleNamespace(outcome=outcome, is_seen_in_fit=seen, gain=gain, fit_gain=fit_gain)


@pytest.mark.parametrize(
    ("fits", "expected"),
    [
        ([], False),
        ([fit_of(0.1, 50.0)], True),  # fits by far best, and predicts worse than the nominal model
        ([fit_of(0.1, 5.0)], False),
        ([fit_of(0.9, 50.0)], False),
        ([fit_of(0.1, 50.0, seen=False)], False),
        ([fit_of(0.1, 50.0), fit_of(0.05, 1.0)], False),
    ],
)
def test_the_best_fit_that_loses_the_held_out_records(fits, expected):
    nominal = SimpleNamespace(fitted=SimpleNamespace(cost=1.0), left_out_cost=10.0)
    bench = SimpleNamespace(settings=SearchSettings())
    assert best_is_lost(SimpleNamespace(nominal=nominal, first_fits=fits, bench=bench)) is expected


@pytest.mark.parametrize(
    ("gain", "fit_gain", "expected"), [(0.95, 200.0, True), (0.95, 110.0, False), (0.8, 200.0, False)]
)
def test_a_law_that_fits_clearly_better_and_predicts_nearly_as_well_is_a_rival(gain, fit_gain, expected, monkeypatch):
    monkeypatch.setattr(Bench, "is_as_good", lambda *_: False)
    best = fit_of(1.0, 1.0, gain=1.0, fit_gain=100.0)
    bench = Bench(SimpleNamespace(settings=SearchSettings()), None, None, None, None)
    assert bench._is_rival(fit_of(1.0, 1.0, gain=gain, fit_gain=fit_gain), best) is expected


def score(name, gain):
    effect = effect_class(name)()
    direction = torch.eye(12, dtype=torch.float64)[len(name) % 12]
    hypothesis = SimpleNamespace(effects=[effect], common=())
    candidate = SimpleNamespace(
        name=name, options=(), form=(), non_nested=False, replaced=(), own_levels=False, hypothesis=hypothesis,
        is_law=name.endswith(("stiffness", "damping")), strengths=(0,),
    )  # fmt: skip
    return SimpleNamespace(candidate=candidate, gain=gain, direction=direction, columns=direction[:, None])


@pytest.mark.parametrize("law", ["quadratic_stiffness", "power_law_damping"])
def test_a_law_is_fitted_whatever_gain_is_predicted(law):
    names = ("coulomb_friction", "sensor_offset", "sensor_delay", "sensor_drift", law)
    ranked = [score(name, 0.5 / 10**k) for k, name in enumerate(names)]
    assert law not in {s.candidate.name for s in chosen(ranked, SearchSettings())}
    assert law in {s.candidate.name for s in chosen(ranked, SearchSettings(), laws=True)}
    assert math.isclose(ranked[-1].gain, 5e-5)


def test_the_simpler_law_that_an_effect_contains_is_fitted_too():
    names = ("asymmetric_friction", "power_law_damping", "sensor_delay", "sensor_drift", "coulomb_friction")
    ranked = [score(name, 0.5 / 10**k) for k, name in enumerate(names)]
    assert "coulomb_friction" in {s.candidate.name for s in chosen(ranked, SearchSettings())}
    assert "coulomb_friction" not in {s.candidate.name for s in chosen(ranked[1:], SearchSettings(full_fits=3))}


def test_what_is_contained_is_seen_whatever_else_was_uncertain_beside_it():
    """Scored beside models of which one has two more uncertain parameters: two rows more below the samples."""

    def columns_of(places, rows):
        columns = torch.eye(8, dtype=torch.float64)[:, places]
        columns = torch.cat([columns, torch.zeros(rows, len(places), dtype=torch.float64)])
        return SimpleNamespace(columns=columns, direction=columns[:, 0])

    assert contains(columns_of([3, 4, 5], 2), columns_of([4], 0))
    assert contains(columns_of([3, 4, 5], 0), columns_of([4], 2))
    assert not contains(columns_of([3, 4, 5], 0), columns_of([6], 2))


@pytest.mark.parametrize(
    ("difference", "correlation", "expected"),
    [(2.0, 1.0, True), (40.0, 1.0, False), (40.0, 10.0, True), (-40.0, 1.0, True)],
)
def test_too_little_to_bet_on_does_not_tell_two_apart(difference, correlation, expected):
    """A difference of one sign in every block, of so many noise variances in all."""
    best = torch.full((SAMPLES,), NOISE, dtype=torch.float64)
    other = best * math.sqrt(1 + difference / SAMPLES)
    held = [SimpleNamespace(duration=SAMPLES / 100.0, sampling_rate=100.0)]
    noise = SimpleNamespace(value=NOISE, correlation=correlation)
    evidence = SimpleNamespace(settings=SearchSettings(), judged=held)
    bench = Bench(evidence, noise, None, None, noise)
    outcomes = [SimpleNamespace(left_out=[residual]) for residual in (other, best)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gear_damping.explanation.trials.comparison.block_samples", lambda *_: [SAMPLES // 16])
        assert bench.is_as_good(*outcomes) is expected


def test_errors_of_a_nominal_model_that_is_far_off_make_no_rivals():
    """They count as noise, of 300 times what the best one leaves: one that leaves a tenth of that is told from it."""
    best = torch.full((SAMPLES,), NOISE, dtype=torch.float64)
    other, held = 30 * best, [SimpleNamespace(duration=SAMPLES / 100.0, sampling_rate=100.0)]
    noise = SimpleNamespace(value=300 * NOISE, correlation=1.0)
    bench = Bench(SimpleNamespace(settings=SearchSettings(), judged=held), noise, None, None, noise)
    outcomes = [SimpleNamespace(left_out=[residual]) for residual in (other, best)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gear_damping.explanation.trials.comparison.block_samples", lambda *_: [SAMPLES // 16])
        assert not bench.is_as_good(*outcomes)


def test_what_is_tried_as_a_whole_is_fitted_whatever_gain_is_predicted_at_one_size():
    names = ("coulomb_friction", "power_law_damping", "sensor_delay", "sensor_drift", "sensor_saturation")
    ranked = [score(name, 0.5 / 10**k) for k, name in enumerate(names)]
    ranked[-1].candidate.non_nested = True
    assert "sensor_saturation" not in {s.candidate.name for s in chosen(ranked, SearchSettings())}
    assert "sensor_saturation" in {s.candidate.name for s in chosen(ranked, SearchSettings(), laws=True)}


def test_what_is_tried_as_a_whole_begins_at_every_size_of_its_form():
    def sized(name, form, gain, non_nested=True):
        candidate = SimpleNamespace(name=name, options=(("shaft", form),), form=(form,), non_nested=non_nested)
        direction = torch.ones(2, dtype=torch.float64)
        return Score(candidate, gain, direction, direction, 0.0, direction[:, None])

    small, large = sized("shaft_torsion", "pinion", 0.1), sized("shaft_torsion", "pinion", 0.3)
    other, plain = sized("shaft_torsion", "gear", 0.2), sized("profile_error", "pinion", 0.4, non_nested=False)
    found = with_other_sizes([plain, large, other, small])
    assert [len(one.variants) for one in found] == [0, 1, 0, 1]
    assert found[1].variants[0] is small.candidate
    assert found[3].variants[0] is large.candidate


def test_a_full_fit_is_given_up_where_it_cannot_take_the_place_of_what_is_there(monkeypatch):
    asked = []

    def refitted(candidate, outcome, evidence, solver, against, reach):
        asked.append(reach)
        fitted = SimpleNamespace(cost=6.0, converged=True)
        return SimpleNamespace(
            outcome=SimpleNamespace(fitted=fitted, left_out_cost=1.0), name=candidate.candidate.name, t=0.0
        )

    monkeypatch.setattr("gear_damping.explanation.trials.bench.refitted", refitted)
    fitted = SimpleNamespace(cost=10.0, converged=True)
    before = SimpleNamespace(fitted=fitted, hypothesis=SimpleNamespace(causes=()))
    made_up = bench(SearchSettings())
    ranked = [score("coulomb_friction", 0.5), score("power_law_damping", 0.4)]
    made_up.full_fits(ranked, before, before, reach=5.0)
    assert asked == [5.0, 5.0]
    asked.clear()
    made_up.full_fits(ranked, before, before)
    assert asked == [math.inf, 9.0]  # a quarter of what the first one took
    asked.clear()
    ranked[0].candidate.strengths = tuple(range(20))  # fitted last, and it promises most
    made_up.full_fits(ranked, before, before)
    assert asked == [math.inf, math.inf]


def test_full_fits_of_few_strengths_come_before_those_of_many(monkeypatch):
    asked = []

    def refitted(candidate, outcome, evidence, solver, against, reach):
        asked.append(candidate.candidate.name)
        fitted = SimpleNamespace(cost=6.0, converged=True)
        return SimpleNamespace(
            outcome=SimpleNamespace(fitted=fitted, left_out_cost=1.0), name=candidate.candidate.name, t=0.0
        )

    monkeypatch.setattr("gear_damping.explanation.trials.bench.refitted", refitted)
    fitted = SimpleNamespace(cost=10.0, converged=True)
    before = SimpleNamespace(fitted=fitted, hypothesis=SimpleNamespace(causes=()))
    ranked = [score(name, 0.5) for name in ("coulomb_friction", "power_law_damping")]
    ranked[0].candidate.strengths = tuple(range(20))
    bench(SearchSettings()).full_fits(ranked, before, before)
    assert asked == ["power_law_damping", "coulomb_friction"]


@pytest.mark.parametrize(
    ("non_nested", "gain", "fitted"), [(True, 0.3, True), (True, 0.2, False), (False, 0.3, False), (False, 0.49, True)]
)
def test_another_form_of_what_is_tried_at_a_few_sizes_is_fitted_from_half_of_the_promise(non_nested, gain, fitted):
    """A twisting shaft of the gear promised .24, that of the pinion .16; fitted, the second left a twentieth."""
    gear, pinion = score("shaft_torsion", 0.5), score("shaft_torsion", gain)
    for one, shaft in ((gear, "gear"), (pinion, "pinion")):
        one.candidate.form, one.candidate.non_nested = (("shaft", shaft),), non_nested
    found = chosen([gear, pinion], SearchSettings())
    assert (pinion in found) is fitted
    assert gear in found
