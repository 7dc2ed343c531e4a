"""What is visible, significant, settled, lost, and of one size."""

from types import SimpleNamespace
from unittest.mock import patch

import torch

from gear_damping.explanation.evidence.excess import excess, is_all, is_settled
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.useful_samples import of_useful_length
from gear_damping.explanation.explain import is_lost_by
from gear_damping.explanation.model import homogeneity
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.statistics.family_wise import Effect, Residual, family_wise
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.gear_pair import GearPair
from tests.explanation.decisions.declared import decides
from tests.explanation.decisions.made_up import bench, left, outcome

SAMPLES = 4000


def white(samples: int, seed: int) -> torch.Tensor:
    return torch.randn(samples, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


@decides("level", (True, False))
def visible(settings: SearchSettings):
    """An effect at 3 and at 2 standard deviations, alone in its family: p is about .003 and .04."""
    column = white(SAMPLES, 1)[:, None]
    column /= column.norm()
    noise = white(SAMPLES, 2)
    noise -= column[:, 0] * float(column.T @ noise)
    blocks = torch.arange(SAMPLES) // 20
    seen = (noise + size * column[:, 0] for size in (3.0, 2.0))
    return tuple(bool(family_wise(Residual(r, blocks, 1.0), [Effect("a", column)], level=settings.level)) for r in seen)


def significant(residual: float, settings: SearchSettings, samples: int = SAMPLES) -> bool:
    """A residual of so many noise variances beside a signal of variance 1."""
    response = white(samples, 3)
    noise = NoiseLevel({"a": 0.1}, "declared", 1e9, True)
    left = torch.full((samples,), 0.1 * residual**0.5, dtype=torch.float64)
    return excess([left], [FitRecord("a", response / response.std(), 100.0)], noise, settings).significant


@decides("standard_errors", (True, False))
def beyond_chance(settings: SearchSettings):
    """One standard error of the variance of 4000 samples is 2.2 %."""
    return significant(1.15, settings), significant(1.045, settings)


@decides("least_excess", (True, False))
def worth_calling_significant(settings: SearchSettings):
    """0.1 and 0.01 % of the signal's variance, where chance would leave a thousandth of that."""
    noise = NoiseLevel({"a": 1e-4}, "declared", 1e12, True)
    response = white(SAMPLES, 4)
    record = FitRecord("a", response / response.std(), 100.0)
    sizes = (torch.full((SAMPLES,), share**0.5, dtype=torch.float64) for share in (1e-3, 1e-4))
    return tuple(excess([residual], [record], noise, settings).significant for residual in sizes)


@decides("settled_share", (True, False))
def settled_by_share(settings: SearchSettings):
    return tuple(is_settled(left(percent), left(100.0), settings) for percent in (1.0, 5.0))


@decides("settled_misfit", (True, False))
def settled_by_misfit(settings: SearchSettings):
    return tuple(is_settled(left(0.1, misfit), left(100.0), settings) for misfit in (1.1, 2.0))


@decides("named_share", (True, False))
def all_is_named(settings: SearchSettings):
    return tuple(is_all(left(percent, threshold=50.0), left(100.0), settings) for percent in (3.0, 10.0))


@decides("lost_share", (True, False))
def lost(settings: SearchSettings):
    response = white(SAMPLES, 5)
    evidence = SimpleNamespace(has=GearPair.has, fitted=[FitRecord("a", response, 100.0)], settings=settings)
    residuals = (SimpleNamespace(fit_residuals=[response * share**0.5]) for share in (0.8, 0.2))
    return tuple(is_lost_by(nominal, evidence) for nominal in residuals)


@decides("most_growth", (True, False))
def unpredictable(settings: SearchSettings):
    grown = (SimpleNamespace(error_amplification=error_amplification) for error_amplification in (5.0, 1.2))
    return tuple(State(bench(settings), one, one).is_unpredictable for one in grown)


@decides("random_share", (True, False))
def takes_the_random_part_for_noise(settings: SearchSettings):
    raised = SimpleNamespace(joined=lambda noise: "raised")
    seen = (SimpleNamespace(visible=True, taken=taken, random=raised) for taken in (0.1, 0.5))
    return tuple(bench(settings).knowing(one).noise == "raised" for one in seen)


def of_one_size(shifts: list[float], error: float, settings: SearchSettings, moves: float = 1.0) -> bool:
    """Whether strengths that differ by these shares, known to `error`, count as one; they move records by `moves`."""
    count, length = len(shifts), 400
    columns = torch.zeros(count * length, count, dtype=torch.float64)
    residual = torch.zeros(count * length, dtype=torch.float64)
    for place, shift in enumerate(shifts):
        rows = slice(place * length, (place + 1) * length)
        columns[rows, place] = 1.0
        noise = torch.tensor([1.0, 1.0, -1.0, -1.0] * (length // 8) + [-1.0, -1.0, 1.0, 1.0] * (length // 8))
        residual[rows] = shift + error * length**0.5 / 2**0.5 * noise.double()
    parameter = SimpleNamespace(name="a.strength", logarithmic=True)
    problem = SimpleNamespace(free=[parameter], n_shared=1, response=SimpleNamespace(length=length))
    model = outcome(problem=problem, hypothesis=SimpleNamespace(effects=()))
    model.linearisation = SimpleNamespace(sensitivity=torch.full((1, 1, 1, 1), moves), residual=[None])
    evidence = SimpleNamespace(settings=settings, sampling_rate=1.0, noise=1.0)
    with (
        patch.object(homogeneity, "groups_of", lambda _: ([*range(count)], [str(k) for k in range(count)])),
        patch.object(homogeneity, "_orthogonal_columns", lambda *_: (columns, residual)),
        patch.object(homogeneity, "time_scale", lambda *_: 1.0),
    ):
        return homogeneity.homogeneity(model, "a", evidence).holds


@decides("homogeneity_tolerance", (True, False))
def one_size_within_a_tolerance(settings: SearchSettings):
    """Known to a thousandth: strengths of a deviation of 12 % and of 50 %."""
    return tuple(of_one_size([-s, -s / 3, s / 3, s], 1e-3, settings) for s in (0.16, 0.67))


@decides("homogeneity_level", (True, False))
def one_size_beyond_chance(settings: SearchSettings):
    """Deviations of which chance would make as large ones in 20 % and in 2 %."""
    return tuple(of_one_size([-s, -s / 3, s / 3, s], 1e-3, settings) for s in (0.217, 0.316))


@decides("most_samples", (True, False))
def a_record_that_is_searched_whole(settings: SearchSettings):
    """Three records, of 3000, 8000 and 25 000 samples: whether the second and the third stay whole."""
    records = tuple(FitRecord("one", torch.zeros(n, dtype=torch.float64), 1.0) for n in (3000, 8000, 25000))
    evidence = Evidence("oscillator", records, (), Known({}, {}), None, one_record=False, settings=settings)
    kept = of_useful_length(evidence).evidence.fit
    return tuple(len(a.response) == len(b.response) for a, b in zip(records[1:], kept[1:], strict=True))
