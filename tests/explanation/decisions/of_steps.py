"""Which causes a step accepts, where it goes on, and the word for what was found."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import torch

from gear_damping.explanation import search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import faint, pairs, single
from gear_damping.explanation.steps.judge import CONSISTENT, EXPLAINED, PARTLY, UNEXPLAINED, Known, verdict
from gear_damping.explanation.trials import comparison, told_size
from tests.explanation.decisions.declared import decides
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome, scored

BLOCKS, BLOCK = 16, 10


def is_accepted(t: float, leaves: float, settings: SearchSettings) -> bool:
    """Whether the best fit is taken, of a nominal model that leaves 10 %."""
    found, nominal = fit(t=t), outcome()
    state = State(bench(settings, [(nominal, left(10.0)), (found.outcome, left(leaves))]), nominal, nominal)
    return single._best([found], state) is found


@decides("accepted_t", (True, False))
def accepted_by_t(settings: SearchSettings):
    return tuple(is_accepted(t, 1.0, settings) for t in (5.0, 1.0))


@decides("least_share", (True, False))
def accepted_by_share(settings: SearchSettings):
    return tuple(is_accepted(50.0, leaves, settings) for leaves in (5.0, 9.0))


@decides("confirmed_t", (True, False))
def confirmed(settings: SearchSettings):
    """What it adds has its sign in 16 of 16 blocks, t = 4, and in 10 of 16, t = 1."""
    worth = []
    for right in (16, 10):
        signs = torch.tensor([1.0] * right + [-1.0] * (BLOCKS - right), dtype=torch.float64)
        old = torch.ones(BLOCKS * BLOCK, dtype=torch.float64)
        before = outcome(left_out=[old])
        found = fit(cost=0.5)
        found.outcome.left_out = [old - 0.1 * signs.repeat_interleave(BLOCK)]
        with patch.object(comparison, "block_samples", lambda *_: [BLOCK]):
            worth.append(faint._is_worth(found, before, SimpleNamespace(taken=0.1), bench(settings, judged=[])))
    return tuple(worth)


@decides("most_causes", 4)
def causes_of_one_answer(settings: SearchSettings):
    """Where there is always one more."""
    more = patch.object(
        search, "_with_more", lambda s: (replace(s, accepted=(*s.accepted, None)), len(s.accepted) < 60)
    )
    with more, patch.object(search, "looked", lambda state: state):
        return len(search._extended(State(bench(settings), outcome(), outcome())).accepted)


@decides("most_calibrations", (True, False))
def calibrated_anew(settings: SearchSettings):
    model = outcome()
    anew = []
    for done in (2, 3):
        state = State(bench(settings), model, model, calibrations=done)
        with (
            patch.object(type(state.bench), "without", lambda *_: model),
            patch.object(type(state.bench), "is_as_good", lambda *_: True),
        ):
            anew.append(search._calibrated_anew(state, fit()) is not None)
    return tuple(anew)


@decides("bent_misfit", ("unshaped", "shaped"))
def first_place_to_begin(settings: SearchSettings):
    """What leaves ten noise variances has bent to what is not its own; one and a half have not."""
    begun = []
    for misfit in (10.0, 1.5):
        nominal, places = outcome(), []
        state = State(bench(settings, [(nominal, left(5.0, misfit))]), nominal, nominal)
        places_of = {name: lambda _, name=name, places=places: places.append(name) for name in ("unshaped", "shaped")}
        with (
            patch.object(single, "_unshaped", places_of["unshaped"]),
            patch.object(single, "_shaped", places_of["shaped"]),
            patch.object(single, "flanks_change", lambda evidence: False),
            patch.object(single, "stay_closed", lambda evidence: True),
        ):
            single._first_fits(state)
        begun.append(places[0])
    return tuple(begun)


@decides("pair_bases", 3)
def bases_of_pairs(settings: SearchSettings):
    state = State(bench(settings), outcome(), outcome())
    return len(pairs._bases([fit(name) for name in NAMES], state))


@decides("pair_seconds", 4)
def seconds_of_pairs(settings: SearchSettings):
    """Of effects none of which contains another."""
    plain = SimpleNamespace(cause=SimpleNamespace(simpler=None))
    state = State(bench(settings, library=dict.fromkeys(NAMES, plain)), outcome(), outcome())
    ranked = [scored(place, 0.5) for place in range(len(NAMES))]
    kind = type(state.bench)
    with patch.object(kind, "ranked", lambda *_: ranked), patch.object(kind, "full_fit", lambda *_: fit(cost=0.1)):
        return len(pairs._seconds(fit(), state))


@decides("pair_share", [NAMES[0], NAMES[1]])
def bases_in_the_place_of_a_cause(settings: SearchSettings):
    """The cause took .8 by itself, the others .6 and .2."""
    nominal = outcome()
    tried = tuple(fit(NAMES[place], squares=1 - taken) for place, taken in enumerate((0.8, 0.6, 0.2)))
    state = State(bench(settings), nominal, nominal, (SimpleNamespace(name=NAMES[0]),), first_fits=tried)
    state = replace(state, accepted=(SimpleNamespace(name=NAMES[0]),))
    with (
        patch.object(pairs, "_seconds", lambda base, _: [base]),
        patch.object(pairs, "_held", lambda *_: []),
        patch.object(pairs, "_bases", lambda fits, _: list(fits)),
    ):
        return [pair.first.name for pair in pairs._instead(state)]


def size_is_told(sizes: list[float], apart: float, settings: SearchSettings) -> bool:
    """Strengths of so many standard errors each alone, whose columns have `apart` as the cosine between them."""
    samples, count = 2048, len(sizes)
    index = torch.arange(samples)
    axes = torch.stack([1 - 2.0 * (index >> bit & 1) for bit in (3, 5)], 1).double()  # entries of one modulus
    columns = axes[:, :1].clone() if count == 1 else torch.stack([axes[:, 0], _turned(axes, apart)], 1)
    residual = (1 - 2.0 * (index & 1)).double()  # beside both, of variance 1
    free = [SimpleNamespace(name=f"a.s{k}", logarithmic=False, scale=1.0, start=0.0) for k in range(count)]
    for parameter, size in zip(free, sizes, strict=True):
        parameter.value = lambda shared, size=size: size / samples**0.5
    problem = SimpleNamespace(free=free, records=[SimpleNamespace(sampling_rate=1.0)])
    problem.response = SimpleNamespace(weights=torch.ones(samples))
    problem.level = lambda residual: torch.ones(())
    model = outcome(problem=problem, hypothesis=None)
    model.fitted.shared = torch.zeros(count)
    model.fitted.prediction = SimpleNamespace(residual=residual.reshape(1, 1, -1))
    candidate = SimpleNamespace(non_nested=False, strengths=range(count), hypothesis=SimpleNamespace(common=free))
    refit = SimpleNamespace(name="a", score=SimpleNamespace(candidate=candidate))
    with (
        patch.object(told_size, "_orthogonal_columns", lambda *_: columns),
        patch.object(told_size, "time_scale", lambda *_: 0.0),
    ):
        return told_size.is_told(model, refit, SimpleNamespace(settings=settings, noise=1.0))


def _turned(axes: torch.Tensor, cosine: float) -> torch.Tensor:
    return cosine * axes[:, 0] + (1 - cosine**2) ** 0.5 * axes[:, 1]


@decides("told_level", (True, False))
def told_together(settings: SearchSettings):
    """A squared statistic of 9 and of 4.5: chance makes as large ones in .3 and in 3 %."""
    return tuple(size_is_told([square**0.5], 0.0, settings) for square in (9.0, 4.5))


@decides("told_alone_level", (True, False))
def told_alone(settings: SearchSettings):
    """Two strengths that are told together; each alone by a squared statistic of 6 and of 2."""
    return tuple(size_is_told([(square / (1 - 0.9**2)) ** 0.5] * 2, 0.9, settings) for square in (6.0, 2.0))


def said(settings: SearchSettings, before, after, *, count=1, seen=True, rest=True, **known) -> str:
    """The word for a search that ended with so many causes."""
    declared = SimpleNamespace(sentence="a law", one_class=())
    own = {"confusable": (), "looks_like": (), "share": 1.0, "effect": SimpleNamespace(cause=declared)}
    causes = tuple(SimpleNamespace(name=name, **own) for name in NAMES[:count])
    looked = [SimpleNamespace(visible=one, taken=0.5) for one in (seen, rest)]
    found = SimpleNamespace(
        bench=SimpleNamespace(settings=settings), accepted=causes, seen=looked[0], left=looked[1],
        nominal=None, outcome=None, beyond_sensor=lambda _: left(0.0, 1.0), is_at_bound=lambda _: False,
    )  # fmt: skip
    return verdict(found, before, after, Known(**known)).word


@decides("small_misfit", (UNEXPLAINED, CONSISTENT))
def something_is_missing(settings: SearchSettings):
    """Significant, but nothing in it is visible: it takes a misfit to be something."""
    before = (left(8.0, misfit) for misfit in (6.0, 2.0))
    return tuple(said(settings, one, one, count=0, seen=False) for one in before)


@decides("gross_percent", (UNEXPLAINED, CONSISTENT))
def fitted_records_miss_something(settings: SearchSettings):
    """Held-out records tell nothing; the fitted ones miss 12 and 2 % of their variance."""
    before = left(4.0, 9.0, threshold=20.0)
    return tuple(said(settings, before, before, count=0, fitted=fitted) for fitted in (12.0, 2.0))


@decides("taken_by_all", (PARTLY, UNEXPLAINED))
def two_causes_leave_a_residual(settings: SearchSettings):
    before = left(100.0, 500.0)
    return tuple(said(settings, before, left(rest, 50.0), count=2) for rest in (5.0, 20.0))


@decides("taken_by_one", (PARTLY, UNEXPLAINED))
def one_cause_leaves_a_residual(settings: SearchSettings):
    before = left(100.0, 500.0)
    return tuple(said(settings, before, left(rest, 50.0), is_one=True) for rest in (30.0, 70.0))


@decides("random_misfit", (PARTLY, EXPLAINED))
def nominal_model_leaves_less_than_noise(settings: SearchSettings):
    """What looked random was more than noise where even the nominal model left only half of it."""
    return tuple(said(settings, left(100.0, misfit), left(0.1), rest=False) for misfit in (0.5, 1.5))
