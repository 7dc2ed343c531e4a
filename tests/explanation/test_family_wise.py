"""The statistics of an explanation against slow computations of their own, on small made-up arrays."""

import numpy as np
import pytest
import torch
from scipy import signal, stats

from gear_damping.explanation.statistics.bursts import BURST_KURTOSIS, kurtosis
from gear_damping.explanation.statistics.family_wise import (
    Effect,
    Lines,
    Residual,
    block_numbers,
    cube_root,
    family_wise,
)
from gear_damping.explanation.statistics.whitening import Autoregression, _is_stable, autoregression

SAMPLES, BLOCK = 1200, 6


def orthonormal(rng, samples, count):
    return torch.as_tensor(np.linalg.qr(rng.normal(size=(samples, count)))[0])


def found_in(rng, effects, residual, **more):
    blocks = block_numbers([SAMPLES], [BLOCK])
    nuisance = more.pop("nuisance", None)
    return family_wise(Residual(torch.as_tensor(residual), blocks, 1.0, nuisance), effects, **more)


def ar(rng, coefficients, samples):
    return signal.lfilter([1.0], [1.0, *(-a for a in coefficients)], rng.normal(size=samples + 500))[500:]


def test_nothing_is_visible_in_noise_as_often_as_the_level_says():
    rng = np.random.default_rng(20)
    effects = [Effect(f"e{i}", orthonormal(rng, SAMPLES, 1 + i % 4)) for i in range(30)]
    p = np.array([found_in(rng, effects, rng.normal(size=SAMPLES), draws=400).p for _ in range(200)])
    assert stats.kstest(p, "uniform").pvalue > 0.01
    assert (p < 0.05).sum() <= stats.binom.ppf(0.999, 200, 0.05)


def test_noise_whose_variance_changes_is_no_effect():
    rng = np.random.default_rng(21)
    effects = [Effect(f"e{i}", orthonormal(rng, SAMPLES, 2)) for i in range(20)]
    swell = 1 + 2 * np.sin(np.arange(SAMPLES) / 150) ** 2
    p = np.array([found_in(rng, effects, swell * rng.normal(size=SAMPLES), draws=400).p for _ in range(100)])
    assert (p < 0.05).sum() <= stats.binom.ppf(0.999, 100, 0.05)


@pytest.mark.parametrize("count", [1, 4])
def test_an_effect_of_six_deviations_is_visible_and_bears_its_name(count):
    rng = np.random.default_rng(22)
    effects = [Effect(f"e{i}", orthonormal(rng, SAMPLES, count)) for i in range(20)]
    hidden = 6.0 * effects[7].columns[:, 0].numpy()
    found = found_in(rng, effects, hidden + rng.normal(size=SAMPLES))
    assert found
    assert found.largest == "e7"
    assert found.shows("e7")


def test_the_maximum_is_that_of_a_loop_over_signs():
    rng = np.random.default_rng(23)
    columns, residual = orthonormal(rng, SAMPLES, 3), rng.normal(size=SAMPLES)
    found = found_in(rng, [Effect("e", columns)], residual)
    sums = (columns.numpy() * residual[:, None]).reshape(SAMPLES // BLOCK, BLOCK, 3).sum(1)
    signs = np.random.default_rng(24).choice([-1.0, 1.0], size=(4000, len(sums)))
    drawn = ((signs @ sums) ** 2).sum(1)
    p = (drawn >= (sums.sum(0) ** 2).sum()).mean()
    assert found.p == pytest.approx(p, abs=4 * (p * (1 - p) * (1 / 2000 + 1 / 4000)) ** 0.5 + 1e-3)


def test_a_whole_effect_counts_with_its_sign_only():
    rng = np.random.default_rng(25)
    column = orthonormal(rng, SAMPLES, 1)
    there = 6.0 * column[:, 0].numpy() + rng.normal(size=SAMPLES)
    assert found_in(rng, [Effect("e", column, one_sided=True)], there)
    assert not found_in(rng, [Effect("e", column, one_sided=True)], -there)
    assert found_in(rng, [Effect("e", column)], -there)


def test_a_pulse_in_few_blocks_is_held_against_the_pooled_variance():
    rng = np.random.default_rng(26)
    pulse = np.zeros((SAMPLES, 1))
    pulse[300:312, 0] = 12**-0.5
    effect = [Effect("e", torch.as_tensor(pulse))]
    found = [found_in(rng, effect, rng.normal(size=SAMPLES)).statistic for _ in range(300)]
    assert stats.kstest(found, "norm").pvalue > 0.01  # signs of two blocks could give no p below a quarter
    assert found_in(rng, effect, 6 * pulse[:, 0] + rng.normal(size=SAMPLES))


def test_what_the_nuisance_took_widens_a_score():
    """With a nuisance in every block signs that are flipped overstate what is left of a score."""
    rng = np.random.default_rng(27)
    samples, block = 240, 24
    p = []
    for _ in range(300):
        nuisance = np.linalg.qr(rng.normal(size=(samples, 40)))[0]
        column = rng.normal(size=samples)
        column -= nuisance @ (nuisance.T @ column)
        effect = Effect("e", torch.as_tensor(column[:, None] / np.linalg.norm(column)))
        residual = rng.normal(size=samples)
        residual -= nuisance @ (nuisance.T @ residual)
        blocks = block_numbers([samples], [block // 2])
        found = family_wise(
            Residual(torch.as_tensor(residual), blocks, 1.0, torch.as_tensor(nuisance)), [effect], draws=400
        )
        p.append(found.p)
    assert abs((np.array(p) < 0.1).mean() - 0.1) < 3.5 * (0.09 / 300) ** 0.5


def test_the_strongest_of_many_lines_is_chance_until_it_is_not():
    rng = np.random.default_rng(28)
    quiet = torch.as_tensor(rng.chisquare(6, size=200))
    assert not found_in(rng, [], rng.normal(size=SAMPLES), lines=[Lines("line", quiet, 6.0)])
    loud = quiet.clone()
    loud[17] = 60.0  # p of 5e-11 for one, of 1e-8 for 200
    assert found_in(rng, [], rng.normal(size=SAMPLES), lines=[Lines("line", loud, 6.0)]).largest == "line"


def test_what_gives_no_number_shows_nothing():
    rng = np.random.default_rng(29)
    none = Lines("line", torch.full((3,), torch.nan, dtype=torch.float64), 6.0)
    found = found_in(rng, [], rng.normal(size=SAMPLES), lines=[none])
    assert not found
    assert found.largest is None
    effect = Effect("e", orthonormal(rng, SAMPLES, 2))
    assert found_in(rng, [effect], rng.normal(size=SAMPLES), lines=[none]).by_name.keys() == {"e"}


def test_the_cube_root_is_normal():
    values = torch.as_tensor(stats.chi2(5).ppf([0.01, 0.1, 0.5, 0.9, 0.99, 0.9999]))
    expected = stats.norm.ppf([0.01, 0.1, 0.5, 0.9, 0.99, 0.9999])
    tails = 0.08  # what the approximation leaves there
    np.testing.assert_allclose(cube_root(values, 5.0, 5.0), expected, atol=tails)


def test_blocks_stay_within_rows_and_a_short_end_joins_the_block_before():
    numbers = block_numbers([10, 7], [4, 4])
    assert numbers.tolist() == [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 3, 3, 3, 3, 4, 4, 4]
    assert block_numbers([9], [4]).tolist() == [0, 0, 0, 0, 1, 1, 1, 1, 1]


@pytest.mark.parametrize("coefficients", [(), (0.9,), (1.6, -0.8)])
def test_an_autoregression_is_found_from_short_rows(coefficients):
    rng = np.random.default_rng(30)
    rows = [torch.as_tensor(ar(rng, coefficients, 800)) for _ in range(3)]
    found = autoregression(rows)
    assert found.order >= len(coefficients)
    padded = np.pad(coefficients, (0, found.order - len(coefficients)))
    np.testing.assert_allclose(found.coefficients, padded, atol=0.12)
    long = ar(rng, coefficients, 400_000)
    assert found.variance == pytest.approx(long.var(), rel=0.2)
    shares = np.correlate(long[:100_000], long[:100_000], "full")[99_999:] / (100_000 * long.var())
    assert found.correlation == pytest.approx(2 * (shares[:200] ** 2).sum() - 1, rel=0.15)


def test_whitened_rows_are_white_and_of_the_variance_of_the_innovations():
    rng = np.random.default_rng(31)
    row = torch.as_tensor(ar(rng, (1.6, -0.8), 4000))
    law = autoregression([row])
    white = law.whitened(row)
    assert white[: law.order].abs().max() == 0
    assert float(white[law.order :].var()) == pytest.approx(1.0, rel=0.1)
    lagged = np.corrcoef(white[law.order : -1], white[law.order + 1 :])[0, 1]
    assert abs(lagged) < 0.05


@pytest.mark.parametrize("columns", [1, 70])
def test_columns_of_many_rows_are_whitened_as_their_law_says(columns):
    rng = np.random.default_rng(36)
    signals = rng.normal(size=(2, 700, columns)).cumsum(1)
    law = Autoregression(torch.as_tensor(np.array([0.6, 0.2])), 1.0, torch.as_tensor(np.array([0.1, 0.05])))
    law_of_lags = [1, -0.6, -0.2, -0.05, -0.05, *[-0.0125] * 4]
    filtered = signal.lfilter(law_of_lags, [1.0], signals, axis=1)
    white = law.whitened_columns(torch.as_tensor(signals)).numpy()
    np.testing.assert_allclose(white[:, 8:], filtered[:, 8:], atol=1e-9)
    assert not white[:, :8].any()


def test_degrees_that_a_regression_took_are_given_back():
    rng = np.random.default_rng(32)
    values, taken = rng.normal(size=600), np.linalg.qr(rng.normal(size=(600, 120)))[0]
    left = torch.as_tensor(values - taken @ (taken.T @ values))
    assert autoregression([left], 120).variance == pytest.approx(1.0, rel=0.15)
    assert autoregression([left]).variance < 0.9


def pink(rng, samples):
    """Noise whose power goes with 1/f, of unit variance."""
    frequency = np.fft.rfftfreq(2 * samples)
    frequency[0] = frequency[1]
    waves = rng.normal(size=frequency.size) + 1j * rng.normal(size=frequency.size)
    found = np.fft.irfft(waves / np.sqrt(frequency))[:samples]
    return (found - found.mean()) / found.std()


def test_noise_that_goes_with_one_over_f_is_made_white_by_octaves_of_its_past():
    rng = np.random.default_rng(33)
    rows = [torch.as_tensor(pink(rng, samples)) for samples in (16000, 12000)]
    law = autoregression(rows)
    assert len(law.octaves) >= 3
    white = law.whitened(rows[0])
    assert white[: law.memory].abs().max() == 0
    left = white[law.memory :].numpy()
    power = np.abs(np.fft.rfft(left)) ** 2 / left.size / law.innovation
    coloured = np.abs(np.fft.rfft(rows[0].numpy())) ** 2
    low, high = slice(10, 100), slice(2000, 7000)
    assert 0.5 < power[low].mean() / power[high].mean() < 1.5
    assert coloured[low].mean() / coloured[high].mean() > 50


def test_an_octave_of_the_past_is_the_mean_of_its_samples():
    rng = np.random.default_rng(34)
    row, near, far = rng.normal(size=60), (0.3, -0.1), (0.2, 0.4)
    law = Autoregression(torch.tensor(near, dtype=torch.float64), 1.0, torch.tensor(far, dtype=torch.float64))
    assert (law.order, law.memory) == (4, 8)
    wanted = [
        row[t] - 0.3 * row[t - 1] + 0.1 * row[t - 2] - 0.2 * row[t - 4 : t - 2].mean() - 0.4 * row[t - 8 : t - 4].mean()
        for t in range(8, 60)
    ]
    np.testing.assert_allclose(law.whitened(torch.as_tensor(row))[8:], wanted, rtol=1e-12)
    np.testing.assert_allclose(law.lags, [0.3, -0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1], rtol=1e-15)


@pytest.mark.parametrize(("lags", "stable"), [((0.5, 0.2), True), ((0.9, 0.2), False), ((0.0, 0.0, -0.99), True)])
def test_a_long_memory_is_stable_where_its_poles_lie_inside_the_unit_circle(lags, stable):
    assert (np.abs(np.roots([1, *(-np.array(lags))])).max() < 1) == stable
    assert _is_stable(torch.tensor(lags, dtype=torch.float64)) == stable


@pytest.mark.parametrize(
    ("law", "wanted"), [(stats.norm, 3.0), (stats.laplace, BURST_KURTOSIS), (stats.uniform(-1, 2), 1.8)]
)
def test_the_kurtosis_is_that_of_known_laws(law, wanted):
    values = law.rvs(size=400_000, random_state=np.random.default_rng(35))
    assert kurtosis(values) == pytest.approx(wanted, rel=0.03)
    assert kurtosis(values) == pytest.approx(stats.kurtosis(values, fisher=False), rel=0.01)
    assert kurtosis(np.zeros(9)) == 3.0  # nothing comes in no bursts
