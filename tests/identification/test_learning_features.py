"""Front-ends: what they see, and what their normalisation is fitted on."""

from dataclasses import replace

import pytest
import torch

from gear_damping.errors import InputError
from gear_damping.identification.catalogue import make_wavelet
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.features import FrontEnd, WaveletFrontEnd
from gear_damping.identification.lightning_module import CWT_LSTM, RAW_LSTM, DampingModule, EstimatorConfig
from gear_damping.identification.networks import DampingLSTM
from gear_damping.identification.protocols import BY_RUN, PAPER, PAPER_MANY_RUNS
from gear_damping.identification.runs import RunSet
from gear_damping.identification.untrained import build_estimator, fit_front_end
from gear_damping.identification.windows import gather_windows

RATE = 1000.0
RICKER = {"kind": "ricker", "frequency_min_hz": 20.0, "frequency_max_hz": 240.0, "n_scales": 5}
CWT = replace(CWT_LSTM, wavelet=RICKER, settings={"hidden_size": 4})
RAW = replace(RAW_LSTM, settings={"hidden_size": 4})


def noise(*shape, seed=1):
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed))


def runs(signals):
    return RunSet(signals, torch.linspace(0.1, 0.6, len(signals)), RATE, "noise")


def fitted(config, signals, protocol=BY_RUN):
    data = WindowDataModule(Material(runs(signals), protocol), seed=1)
    estimator = build_estimator(config, data, 1e-3)
    fit_front_end(estimator, data)
    return estimator, data


def test_raw_features_are_the_window():
    assert torch.equal(FrontEnd()(noise(3, 30)), noise(3, 30)[..., None])


@pytest.mark.parametrize(("kind", "n_features"), [("ricker", 5), ("morlet", 10)])
def test_wavelet_features_are_the_coefficients_at_each_sample(kind, n_features):
    front_end = WaveletFrontEnd(make_wavelet(RICKER | {"kind": kind}, RATE))
    found = front_end(noise(3, 30))
    expected = make_wavelet(RICKER | {"kind": kind}, RATE)(noise(3, 30))
    assert found.shape == (3, 30, n_features)
    assert torch.equal(found[1, 7, :5], expected[1, :, 7].real)
    if kind == "morlet":
        assert torch.equal(found[1, 7, 5:], expected[1, :, 7].imag)


def test_unknown_wavelets_are_refused():
    with pytest.raises(ValueError, match="did you mean 'ricker'"):
        make_wavelet({"kind": "riker"}, RATE)


@pytest.mark.parametrize("config", [RAW, CWT])
@pytest.mark.parametrize("protocol", [BY_RUN, PAPER_MANY_RUNS])
def test_features_of_the_training_windows_have_mean_0_and_deviation_1(config, protocol):
    estimator, data = fitted(config, 1e-5 * noise(20, 500) + 3e-5, protocol)
    features = estimator.front_end(data.training_inputs())
    deviation, mean = torch.std_mean(features, dim=(0, 1), correction=0)
    assert mean.abs().max() < 1e-4
    assert (deviation - 1).abs().max() < 1e-4


def test_a_constant_part_of_the_signal_makes_no_step_at_the_ends_of_a_window():
    plain, with_constant = (
        estimator.front_end(data.training_inputs())
        for estimator, data in (fitted(CWT, noise(20, 200) + constant) for constant in (0, 100))
    )
    assert torch.allclose(plain, with_constant, atol=1e-3)


def test_the_same_windows_serve_one_estimator_after_another():
    estimator, data = fitted(CWT, noise(20, 300), PAPER_MANY_RUNS)
    raw = build_estimator(RAW, data, 1e-3)
    fit_front_end(raw, data)
    assert next(iter(data.test_dataloader()))[0].ndim == 2
    assert raw.front_end.signal_scale == estimator.front_end.signal_scale


def test_a_constant_feature_stays_finite():
    estimator, data = fitted(RAW, torch.full((20, 100), 2.0))
    assert torch.equal(estimator.front_end(data.training_inputs()).unique(), torch.zeros(1))


@pytest.mark.parametrize("config", [RAW, CWT])
def test_by_run_normalisation_sees_no_run_but_those_of_training(config):
    signals = noise(20, 200)
    clean, data = fitted(config, signals)
    poisoned = signals.clone()
    held_out = torch.cat([data.split.validation, data.split.test])[:, 0].unique()
    poisoned[held_out] = 1e9
    found, _ = fitted(config, poisoned)
    assert_buffers_equal(found, clean)
    poisoned[data.split.train[0, 0]] = 1e9
    with pytest.raises(AssertionError):
        assert_buffers_equal(fitted(config, poisoned)[0], clean)


@pytest.mark.parametrize("protocol", [PAPER, PAPER_MANY_RUNS])
def test_chronological_normalisation_of_raw_windows_sees_no_sample_of_the_test(protocol):
    signals = noise(20, 200)
    clean, _ = fitted(RAW, signals, protocol)
    poisoned = signals.clone()
    poisoned[:, 160:] = 1e9
    assert_buffers_equal(fitted(RAW, poisoned, protocol)[0], clean)


def assert_buffers_equal(one, two):
    for (name, value), other in zip(one.front_end.named_buffers(), two.front_end.buffers(), strict=True):
        assert torch.equal(value, other), name


def outside_changed(signals, start, window=30):
    changed = signals + 100 * noise(*signals.shape, seed=9)
    changed[:, start : start + window] = signals[:, start : start + window]
    return changed


def test_by_run_features_see_the_window_alone():
    estimator, _ = fitted(CWT, noise(20, 300))
    record, index = noise(1, 300, seed=4), torch.tensor([[0, 100]])
    one, two = (gather_windows(x, index, 30) for x in (record, outside_changed(record, 100)))
    assert torch.equal(estimator.front_end(one), estimator.front_end(two))


def test_columns_of_whole_runs_see_beyond_the_window_and_beyond_the_cut():
    """What the paper's protocol does, and why its figures are not those of `by_run`."""
    estimator, _ = fitted(CWT, noise(20, 300), PAPER_MANY_RUNS)
    record, start = noise(1, 300, seed=4), 240 - 30  # the last training window
    one, two = (estimator.front_end.columns(x)[:, start : start + 30] for x in (record, outside_changed(record, start)))
    assert (one - two).abs().max() > 10


def test_by_run_refuses_columns_of_whole_runs():
    data = WindowDataModule(Material(runs(noise(20, 100)), BY_RUN))
    with pytest.raises(ValueError, match="by_run must transform windows"):
        data.use_columns(FrontEnd().columns)


def test_columns_of_whole_runs_are_those_of_the_run_at_the_window():
    estimator, data = fitted(CWT, noise(20, 300), PAPER_MANY_RUNS)
    columns = next(iter(data.test_dataloader()))[0]
    run, start = data.split.test[5].tolist()
    whole = estimator.front_end.columns(data.run_set.signals[run : run + 1])
    assert torch.allclose(columns[5], whole[0, start : start + 30], atol=1e-5)


def test_windows_can_be_transformed_one_by_one_under_the_papers_protocol():
    estimator, data = fitted(replace(CWT, whole_run_columns=False), noise(20, 300), PAPER)
    assert estimator.data["whole_run"] is False
    assert next(iter(data.test_dataloader()))[0].ndim == 2


def test_the_network_is_an_lstm_of_60_units_that_says_positive_values():
    network = DampingLSTM(3)
    lstm = 4 * 60 * (3 + 60 + 2)
    assert sum(weights.numel() for weights in network.parameters()) == lstm + 61
    found = network(100 * noise(50, 30, 3))
    assert found.shape == (50,)
    assert (found > 0).all()


def test_training_starts_at_the_mean_label():
    data = WindowDataModule(Material(runs(noise(20, 200)), BY_RUN), seed=1)
    estimator = build_estimator(RAW, data, 1e-3)
    with torch.no_grad():
        estimator.network.dense.weight.zero_()
        found = estimator(noise(5, 30))
    assert torch.allclose(found, data.training_labels.mean())


def test_wavelets_that_a_checkpoint_could_not_hold_are_refused():
    with pytest.raises(ValueError, match="plain"):
        EstimatorConfig("cwt_lstm", wavelet=RICKER | {"frequency_min_hz": torch.tensor(20.0)})
    assert DampingModule("raw_lstm", {"sampling_rate": RATE, "window": 30}).hparams["wavelet"] is None


def test_an_estimator_or_a_setting_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match=r"'raw_lstn': no such estimator; remedy: did you mean 'raw_lstm'\?.*its file"):
        EstimatorConfig("raw_lstn")
    with pytest.raises(ValueError, match=r"no setting \['layers'\]; it has hidden_size, dropout"):
        EstimatorConfig("raw_lstm", {"layers": 2})
    with pytest.raises(ValueError, match="dropout must lie within"):
        EstimatorConfig("raw_lstm", {"dropout": 1.0})
