"""What held-out records decide when they are opened, on made-up residuals; and how records are left out before."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import pytest
import torch

from gear_damping.explanation.budget import Budget
from gear_damping.explanation.model.cross_fit import folds_of
from gear_damping.explanation.model.opened import _better_of_each
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.steps import confirm
from gear_damping.explanation.trials.bench import Bench
from gear_damping.identification.output_error.holdout import HeldOut
from gear_damping.identification.output_error.records import FitRecord

BLOCKS, BLOCK = 16, 50
LENGTH = BLOCKS * BLOCK
DIFFERS = ("differs", "differs too")  # causes whose size is another one in every record
NOISE = torch.randn(LENGTH, dtype=torch.float64, generator=torch.Generator().manual_seed(8))


def model(free=1, size=0.0, cost=1.0, causes=()):
    """A model that leaves noise and a wave of so many noise levels on held-out records."""
    wave = size * torch.cos(torch.arange(LENGTH, dtype=torch.float64))
    effects = [SimpleNamespace(name=name, requires=()) for name in causes]
    hypothesis = SimpleNamespace(free=[None] * free, causes=causes, effects=effects)
    return SimpleNamespace(holdout=[NOISE + wave], hypothesis=hypothesis, fitted=SimpleNamespace(cost=cost))


def refit(name, outcome, at_bound=False):
    return SimpleNamespace(name=name, outcome=outcome, is_at_bound=at_bound)


class MadeUp(Bench):
    """A bench whose models without a cause are given."""

    def without(self, outcome, name):
        return self.failed[name]

    def excess(self, outcome):
        return SimpleNamespace(percent=1.0)


def state_of(causes, outcome, fits=(), without=None):
    """A state with causes (name, rivals), its model and the fits of rivals."""
    record = SimpleNamespace(duration=1.0)
    evidence = SimpleNamespace(settings=SearchSettings(), held=[record], fitted=[record])
    noise = SimpleNamespace(value=1.0, correlation=1.0)
    bench = MadeUp(evidence, noise, lambda text: None, None, noise, failed=without or {})
    accepted = tuple(Accepted(name, refit(name, outcome), 0.5, rivals) for name, rivals in causes)
    nominal = SimpleNamespace(own={}, **vars(model(size=3.0)))
    return State(bench, nominal, outcome, accepted, first_fits=tuple(fits))


@pytest.fixture(autouse=True)
def residuals_as_they_are():
    with (
        patch.object(confirm, "opened", lambda outcome, *_: outcome),
        patch.object(confirm, "block_samples", lambda *_: [BLOCK]),
        patch.object(confirm, "homogeneity", lambda outcome, name, _: SimpleNamespace(holds=name not in DIFFERS)),
    ):
        yield


@pytest.mark.parametrize(("beside", "named"), [(("a", "b"), ["a", "b"]), (("a", "c", "b"), ["a"]), (("b",), ["a"])])
def test_a_cause_that_was_not_needed_beside_one_that_is_none_is_back(beside, named):
    alone, before = model(cost=9.0, causes=("a",)), model(cost=2.0, causes=beside)
    both = state_of([("a", ()), ("c", ())], model(causes=("a", "c")), without={"c": alone})
    before.fitted.converged = True
    back = Accepted("b", refit("b", before), 0.1, ())
    state = replace(both, pruned=(back,), bench=replace(both.bench, budget=Budget(0.0)))
    with patch.object(confirm, "excess", lambda *_: None):
        found = confirm.without(confirm.Confirmed(state, None, None, None, 5.0, is_opened=True), "c").state
    assert [cause.name for cause in found.accepted] == named
    assert found.outcome is (before if len(named) > 1 else alone)
    assert len(found.pruned) == 2 - len(named)


def test_a_rival_that_held_out_records_refute_leaves_the_set():
    fits = [refit("alike", model()), refit("refuted", model(size=1.0))]
    found = confirm._told_apart(state_of([("named", ("alike", "refuted", "never fitted"))], model(), fits))
    assert (found.accepted[0].name, found.accepted[0].confusable) == ("named", ("alike", "never fitted"))


def test_a_cause_that_held_out_records_refute_gives_way_to_its_rival():
    better = model(cost=0.9)
    fits = [refit("worse fit", model()), refit("better", better), refit("bounded", model(0), at_bound=True)]
    found = confirm._told_apart(state_of([("named", ("worse fit", "better", "bounded"))], model(size=1.0), fits))
    assert (found.accepted[0].name, found.accepted[0].confusable) == ("better", ("worse fit", "bounded"))
    assert found.outcome is better


@pytest.mark.parametrize(
    ("cause", "rival", "named"), [("named", "differs", "named"), ("differs too", "differs", "differs")]
)
def test_a_rival_with_another_size_in_every_record_takes_the_place_of_none_that_has_one(cause, rival, named):
    fits = [refit(rival, model())]
    found = confirm._told_apart(state_of([(cause, (rival,))], model(size=1.0), fits))
    assert found.accepted[0].name == named


def test_a_cause_among_others_that_adds_nothing_is_taken_out():
    without = {"needed": model(size=2.0), "idle": model(size=0.0)}
    found, t = confirm._validated(state_of([("needed", ()), ("idle", ())], model(), without=without))
    assert [cause.name for cause in found.accepted] == ["needed"]
    assert t > SearchSettings().confirmed_t


def test_what_adds_nothing_to_predictions_is_no_cause():
    worse = model(size=3.001)
    found, t = confirm._validated(state_of([("named", ())], worse))
    assert (found.accepted, t) == ((), 0.0)
    assert found.outcome is found.nominal
    assert found.rejected[0].name == "named"


def problem_of(records):
    response = SimpleNamespace(length=max(len(r.response) for r in records))
    return SimpleNamespace(records=records, response=response)


def record(name, samples=80, **conditions):
    return FitRecord(name, torch.zeros(samples, dtype=torch.float64), 10.0, conditions=conditions)


def test_operating_conditions_are_left_out_whole():
    speeds = (100.0, 200.0, 100.0, 300.0)
    records = [record(str(i), pinion_speed=speed, pinion_torque=50.0) for i, speed in enumerate(speeds)]
    assert folds_of(problem_of(records))[:, 0].tolist() == [0, 1, 0, 2]


def test_a_rival_that_the_best_one_encompasses_is_none():
    best, beaten, both, neither = (refit(name, name) for name in ("best", "beaten", "both", "neither"))
    seen = {("best", "beaten"), ("best", "both"), ("both", "best")}
    bench = Bench(SimpleNamespace(settings=SearchSettings(), sealed=True), None, None, None, None)
    with patch.object(Bench, "encompasses", lambda _, first, other: (first.name, other.name) in seen):
        kept = bench._not_encompassed(best, [best, beaten, both, neither])
    assert [fit.name for fit in kept] == ["best", "both", "neither"]


def test_without_a_cause_the_others_are_held_against_the_same_records():
    fewer, all_of_it = model(size=2.0), model()
    state = state_of([("needed", ()), ("doubtful", ())], all_of_it, without={"doubtful": fewer})
    excess = SimpleNamespace(percent=3.0)
    found = confirm.Confirmed(state, None, None, None, 9.0, is_opened=True)
    with (
        patch.object(MadeUp, "ranked", lambda *_: []),
        patch.object(MadeUp, "assessed", lambda *_: "what is left"),
        patch.object(confirm, "excess", lambda residuals, *_: excess if residuals[0] is fewer.holdout[0] else None),
    ):
        found = confirm.without(found, "doubtful")
    assert [cause.name for cause in found.state.accepted] == ["needed"]
    assert (found.state.outcome, found.state.left, found.after) == (fewer, "what is left", excess)
    assert found.state.rejected[0].name == "doubtful"
    assert found.t == confirm._t(state.nominal, fewer, state)


def test_a_model_without_a_cause_is_the_one_before_it_came_where_that_is_better():
    """A fit from where all causes were may end in another valley."""
    astray, before, other = model(cost=5.0), model(cost=2.0, causes=("needed",)), model(cost=1.0, causes=("doubtful",))
    state = state_of([("needed", ()), ("doubtful", ())], model(), without={"doubtful": astray})
    state = state.with_cause(0, Accepted("needed", refit("needed", before), 0.5, ()))
    state = state.with_cause(1, Accepted("doubtful", refit("doubtful", other), 0.5, ()))
    assert confirm._fewer(state, "doubtful") is before
    near = state_of([("needed", ()), ("doubtful", ())], model(), without={"doubtful": model(cost=1.5)})
    near = near.with_cause(0, state.accepted[0])
    assert confirm._fewer(near, "doubtful").fitted.cost == 1.5


def test_of_held_out_records_each_has_the_better_of_its_two_predictions():
    """The angle of one begins in the right valley from another model's, that of the other all around."""

    def found(left, angle):
        residuals = [torch.full((4,), one, dtype=torch.float64) for one in left]
        own = {f"mesh_phase@{name}": angle for name in ("a", "b")}
        return HeldOut([residual + 1 for residual in residuals], residuals, angle, own)

    better = _better_of_each(found((0.1, 5.0), 1.0), found((3.0, 0.2), 2.0), ["a", "b"])
    assert [float(one[0]) for one in better.residuals] == [0.1, 0.2]
    assert [float(one[0]) for one in better.predictions] == pytest.approx([1.1, 1.2])
    assert better.own == {"mesh_phase@a": 1.0, "mesh_phase@b": 2.0}
    assert better.error_amplification == 2.0
