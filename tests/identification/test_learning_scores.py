"""Metrics by hand, the controls, and the comparison of models."""

import json
from dataclasses import replace

import pytest
import torch

from gear_damping.identification.compare import Repeats, compare_models
from gear_damping.identification.controls import mean_predictor, white_noise_runs
from gear_damping.identification.datamodule import Material
from gear_damping.identification.lightning_module import CWT_LSTM, RAW_LSTM
from gear_damping.identification.metrics import (
    epochs_to_convergence,
    interval_of_rmse,
    means_over_runs,
    median_relative_error,
    rmse_paper,
    rmse_percent,
    scores,
    skill,
)
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import BY_RUN, PAPER
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.trainer import Place, Training

TRUE = torch.tensor([1.0, 2.0, 4.0, 5.0])
PREDICTED = torch.tensor([1.0, 3.0, 2.0, 4.0])
RICKER = {"kind": "ricker", "frequency_min_hz": 20.0, "frequency_max_hz": 240.0, "n_scales": 4}
MODELS = {
    "raw_lstm": replace(RAW_LSTM, settings={"hidden_size": 6}),
    "cwt_lstm": replace(CWT_LSTM, settings={"hidden_size": 6}, wavelet=RICKER),
}
TRAINING = Training(max_epochs=6, batch_size=64, learning_rate=0.02)
SMALL = replace(BY_RUN, windows_per_epoch=640)
MIXTURE = SensorNoise((20.0, 40.0))
KEYS = {"rmse_percent", "rmse_paper", "median_relative_error", "skill", "rmse_percent_per_run", "epochs"}


def decays(n_runs=60, n_samples=60, seed=1):
    """Free decays of 50 Hz with random phase and a damping ratio of 1 to 20 %."""
    generator = torch.Generator().manual_seed(seed)
    ratio = 1 + 19 * torch.rand(n_runs, generator=generator)
    phase = 6.28 * torch.rand(n_runs, 1, generator=generator)
    angle = 2 * torch.pi * 50 * torch.arange(n_samples) / 1000
    signals = torch.exp(-ratio[:, None] / 100 * angle) * torch.cos(angle + phase)
    return RunSet(1e-5 * signals, ratio, 1000.0, "decays")


CLEAN = Material(decays(), SMALL)
NOISY = replace(CLEAN, noise=MIXTURE)


def test_errors_by_hand():
    assert rmse_percent(TRUE, PREDICTED) == pytest.approx((6 / 4) ** 0.5)
    assert rmse_paper(TRUE, PREDICTED) == pytest.approx(3**0.5)
    assert median_relative_error(TRUE, PREDICTED) == pytest.approx((0.2 + 0.5) / 2)


def test_skill_by_hand():
    assert skill(TRUE, PREDICTED, 3.0) == pytest.approx(1 - 6 / 10)
    assert skill(TRUE, TRUE, 3.0) == 1
    assert skill(TRUE, torch.full((4,), 3.0), 3.0) == 0
    assert skill(torch.full((4,), 0.3), torch.full((4,), 0.31), 0.3) is None


def test_epochs_to_convergence_by_hand():
    assert epochs_to_convergence([2.0, 1.06, 1.04, 1.0, 1.5]) == 3
    assert epochs_to_convergence([1.0]) == 1
    assert epochs_to_convergence([]) == 0


def test_means_over_runs_by_hand():
    runs = torch.tensor([7, 3, 7, 3])
    label, mean, deviation = means_over_runs(torch.tensor([1.0, 2.0, 1.0, 2.0]), PREDICTED, runs)
    assert label.tolist() == [2, 1]
    assert mean.tolist() == [3.5, 1.5]
    assert deviation.tolist() == pytest.approx([0.5, 0.5])
    found = scores(torch.tensor([1.0, 2.0, 1.0, 2.0]), PREDICTED, runs, 1.5)
    assert found["rmse_percent_per_run"] == pytest.approx(((1.5**2 + 0.5**2) / 2) ** 0.5)
    assert found.keys() == KEYS - {"epochs"}


def test_the_interval_of_an_error_is_that_of_runs_and_not_of_their_windows():
    """100 runs with errors of standard normal size: the mean square is known to sqrt(2 / 100)."""
    errors = torch.randn(100, generator=torch.Generator().manual_seed(3), dtype=torch.float64)
    for windows in (1, 50):
        predicted = errors.repeat_interleave(windows)
        runs = torch.arange(100).repeat_interleave(windows)
        low, high = interval_of_rmse(torch.zeros_like(predicted), predicted, runs)
        expected = float(errors.square().std() / 10 / (2 * errors.square().mean().sqrt()))  # by the delta method
        assert (high - low) / (2 * 1.96) == pytest.approx(expected, rel=0.1)
        assert low < float(errors.square().mean().sqrt()) < high
    assert interval_of_rmse(torch.zeros(5), torch.ones(5), torch.zeros(5)) is None


def test_the_mean_predictor_says_the_mean_label():
    assert mean_predictor(torch.tensor([0.1, 0.1, 0.4])) == pytest.approx(0.2)


def test_white_noise_keeps_labels_and_nothing_of_the_signals():
    runs = decays(n_samples=3000)
    loud = replace(runs, signals=runs.signals * torch.linspace(1, 100, len(runs))[:, None])
    noise = white_noise_runs(loud, seed=1)
    assert torch.equal(noise.damping_ratio_percent, loud.damping_ratio_percent)
    deviation = noise.signals.std(dim=1)
    assert (deviation / loud.signals.var(dim=1).mean().sqrt() - 1).abs().max() < 0.06
    cross = (noise.signals[:, 1:] * noise.signals[:, :-1]).mean(dim=1) / deviation**2
    assert cross.abs().max() < 0.1
    assert torch.equal(noise.signals, white_noise_runs(loud, seed=1).signals)
    assert not torch.equal(noise.signals, white_noise_runs(loud, seed=1, data="test_runs").signals)


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    folder = tmp_path_factory.mktemp("comparison")
    lines = []
    found = compare_models(NOISY, MODELS, Repeats(TRAINING, [1, 2]), Place(folder), announce=lines.append)
    return folder, found, lines


def test_the_comparison_has_every_score_of_every_model_and_control(comparison):
    _, found, lines = comparison
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["models"].keys() == MODELS.keys()
    assert found["controls"].keys() == {"mean", "white_noise"}
    for summary in (*found["models"].values(), *found["controls"].values()):
        assert summary.keys() == KEYS | {"per_seed"}
        assert summary["per_seed"].keys() == KEYS | {"rmse_interval95"}
        both = (summary["per_seed"][key] for key in ("rmse_percent", "rmse_interval95"))
        assert all(low < error < high for error, (low, high) in zip(*both, strict=True))
        values = torch.tensor(summary["per_seed"]["rmse_percent"], dtype=torch.float64)
        assert summary["rmse_percent"]["mean"] == pytest.approx(float(values.mean()))
        assert summary["rmse_percent"]["std"] == pytest.approx(float(values.std()))
        assert summary["epochs"] == pytest.approx(sum(summary["per_seed"]["epochs"]) / 2)
    assert found["seeds"] == [1, 2]
    assert len(lines) == 6


def test_the_predictions_are_those_that_were_scored(comparison):
    _, found, _ = comparison
    for name, summary in (found["models"] | found["controls"]).items():
        true, predicted = (torch.tensor(found["predictions"][name][key]) for key in ("true", "predicted"))
        assert rmse_percent(true, predicted) == pytest.approx(summary["per_seed"]["rmse_percent"][0])
        assert len(found["predictions"][name]["per_run"]["spread"]) == 9


def test_controls_know_nothing_and_models_learn(comparison):
    _, found, _ = comparison
    assert found["controls"]["mean"]["skill"] == pytest.approx(0, abs=1e-6)
    assert found["controls"]["mean"]["epochs"] == 0
    assert abs(found["controls"]["white_noise"]["skill"]) < 0.2
    assert found["models"]["cwt_lstm"]["skill"] > 0.25


def test_checkpoints_of_a_comparison_can_be_loaded_by_name(comparison):
    folder, _, _ = comparison
    assert load_estimator(folder / "cwt_lstm" / "seed_2" / "best.ckpt").hparams["estimator"] == "cwt_lstm"


def test_an_interrupted_comparison_trains_only_what_is_missing(comparison, tmp_path):
    folder, found, _ = comparison
    resumed = compare_models(NOISY, MODELS, Repeats(TRAINING, [1, 2]), Place(tmp_path, folder))
    assert resumed == found


def test_test_runs_are_scored_instead(tmp_path):
    test_runs = decays(5, seed=9)
    models = {"raw_lstm": MODELS["raw_lstm"]}
    training = replace(TRAINING, max_epochs=1)
    found = compare_models(replace(CLEAN, test_runs=test_runs), models, Repeats(training, [1]), Place(tmp_path))
    for name in ("raw_lstm", "white_noise", "mean"):
        per_run = found["predictions"][name]["per_run"]
        assert per_run["true"] == pytest.approx(test_runs.damping_ratio_percent.tolist())
    assert found["models"]["raw_lstm"]["rmse_percent"]["std"] == 0


def test_with_one_label_there_is_no_skill_and_white_noise_scores_like_the_signal(tmp_path):
    """The paper's protocol as printed: every estimator finds the one label, with no signal at all."""
    repeats = Repeats(replace(TRAINING, max_epochs=5), [1])
    found = compare_models(Material(decays(2, 600), PAPER), MODELS, repeats, Place(tmp_path))
    errors = found["models"] | found["controls"]
    assert all(summary["skill"] is None for summary in errors.values())
    label = float(decays(2, 600).damping_ratio_percent[0])
    assert errors["white_noise"]["rmse_percent"]["mean"] < 0.1 * label
    assert errors["mean"]["rmse_percent"]["mean"] < 1e-6


@pytest.mark.parametrize(
    ("models", "seeds", "message"),
    [({}, [1], "empty"), (MODELS, [], "empty"), ({"mean": RAW_LSTM}, [1], "like the controls")],
)
def test_comparisons_of_nothing_are_refused(models, seeds, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        compare_models(CLEAN, models, Repeats(TRAINING, seeds), Place(tmp_path))
