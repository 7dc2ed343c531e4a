"""The network of whole records: its features, its likelihood, the intervals that it states, and what it refuses."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.stats import norm

from gear_damping.config.settings import read_settings
from gear_damping.errors import InputError
from gear_damping.identification.compare import Repeats, compare_models
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.features import FrameFrontEnd
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.networks import BINS, LEVELS, RecordLSTM
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import BY_RUN, PAPER
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.trainer import Place, Training, fit_estimator, predict_windows
from gear_damping.tasks.command import main
from gear_damping.tasks.composed import composed

RATE, SAMPLES = 1000.0, 200
SETTINGS = {"hidden_size": 12, "bands": 8, "lowest_hz": 20.0, "highest_hz": 160.0, "frame_ms": 10.0}
CONFIG = EstimatorConfig("record_cwt_lstm", SETTINGS)
TRAINING = Training(max_epochs=25, batch_size=64, patience=25, learning_rate=0.01, schedule="cosine", gradient_clip=1.0)


def decays(n_runs):
    """Free decays of 50 Hz with random phase and size and a damping ratio of 1 to 6 %."""
    generator = torch.Generator().manual_seed(1)
    ratio = 1 + 5 * torch.rand(n_runs, generator=generator)
    phase, size = 6.28 * torch.rand(n_runs, 1, generator=generator), 0.5 + torch.rand(n_runs, 1, generator=generator)
    angle = 2 * torch.pi * 50 * torch.arange(SAMPLES) / RATE
    signals = size * torch.exp(-ratio[:, None] / 100 * angle) * torch.cos(angle + phase)
    return RunSet(1e-5 * signals, ratio, RATE, "decays")


def data(n_runs, protocol=BY_RUN):
    noise = SensorNoise((10.0, 40.0))
    return WindowDataModule(Material(decays(n_runs), protocol.of_whole_records(SAMPLES), noise), seed=1)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    return fit_estimator(CONFIG, data(1200), TRAINING, Place(tmp_path_factory.mktemp("record")), seed=1)


def test_a_feature_is_the_log_energy_under_a_gaussian_window():
    frequencies, duration = [60.0, 100.0], 0.01
    front = FrameFrontEnd(RATE, frequencies, duration, 0.02)
    signal = torch.randn(3, SAMPLES, generator=torch.Generator().manual_seed(3))
    found = front._transform(signal).double().numpy()
    time = np.arange(SAMPLES) / RATE
    values = signal.double().numpy()
    values = values - values.mean(1, keepdims=True)
    norm_of = np.sqrt((np.exp(-((np.arange(-40, 41) / RATE / duration) ** 2) / 2) ** 2).sum())
    for frame, centre in enumerate(np.arange(0, SAMPLES, 20) / RATE):
        window = np.exp(-(((time - centre) / duration) ** 2) / 2) * (np.abs(time - centre) <= 0.0400001) / norm_of
        for band, frequency in enumerate(frequencies):
            said = np.log(np.abs((values * window * np.exp(-2j * np.pi * frequency * time)).sum(1)) ** 2)
            np.testing.assert_allclose(found[:, frame, band], said, atol=2e-4)


def test_the_loss_is_the_likelihood_of_a_normal_distribution():
    network = RecordLSTM(4, 6).double()
    labels = torch.tensor([1.0, 2.0, 4.0], dtype=torch.float64)
    network.begin(labels)
    features = torch.randn(3, 5, 4, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    loss, found = network.loss(features, labels)
    mean, deviation = (one.detach().numpy() for one in network.distribution(features))
    scale = float(network.label_scale)
    direct = -norm.logpdf(labels.numpy(), mean, deviation).mean() - np.log(scale * np.sqrt(2 * np.pi))
    assert loss.item() == pytest.approx(direct, rel=1e-9)
    np.testing.assert_allclose(found.detach().numpy(), mean)


def test_intervals_hold_as_many_as_they_say_though_the_deviations_are_wrong():
    """Stated deviations are half of the true ones where they are small, and twice them where they are large."""
    network, generator = RecordLSTM(2), torch.Generator().manual_seed(5)
    for part in ("calibrate", "check"):
        true = torch.exp(torch.randn(20000, generator=generator))
        labels, found = torch.zeros(20000) + 9, 9 + true * torch.randn(20000, generator=generator)
        stated = torch.where(true < 1, true / 2, true * 2)
        if part == "calibrate":
            network.calibrate(found, stated, labels)
    for level in LEVELS:
        low, high = network.interval(found, stated, level)
        held = (low <= labels) & (labels <= high)
        assert float(held.float().mean()) == pytest.approx(level, abs=0.01)
        for sure in (true < 0.5, true > 2):  # of each kind, not only of all
            assert float(held[sure].float().mean()) == pytest.approx(level, abs=0.04)


def test_few_runs_state_no_interval():
    network = RecordLSTM(2)
    network.calibrate(torch.zeros(2 * BINS), torch.arange(2.0 * BINS) + 1, torch.ones(2 * BINS))
    low, high = network.interval(torch.zeros(1), torch.ones(1), 0.95)
    assert bool(low.isnan())
    assert bool(high.isnan())


def test_it_learns_and_its_intervals_hold_on_other_runs(trained):
    windows = data(1200)
    true, predicted = predict_windows(trained.estimator, windows.test_dataloader())
    assert float((predicted - true).square().mean().sqrt()) < 0.35 * float(true.std())
    inputs, labels = next(iter(windows.test_dataloader()))
    module = trained.estimator
    with torch.no_grad():
        low, high = module.network.interval(*module.network.distribution(module.front_end(inputs)), 0.9)
    assert 0.8 < float(((low <= labels) & (labels <= high)).float().mean()) < 0.97


def test_its_checkpoint_says_how_sure_it_is_of_the_beginning_of_a_record(trained):
    estimator = load_estimator(trained.best_checkpoint)
    record = decays(5).signals[3]
    found, longer = (estimator.predict_record(torch.cat([record] * n), RATE) for n in (1, 2))
    assert found[:2] == longer[:2]
    assert found.interval95 == longer.interval95
    low, high = found.interval95
    assert low < found.damping_ratio_percent < high
    assert found.spread_percent > 0
    with pytest.raises(InputError, match="200 samples"):
        estimator.predict_record(record[:150], RATE)


def test_the_rate_of_learning_falls_to_nothing(trained):
    rates = [epoch["learning_rate"] for epoch in trained.history]
    assert rates == sorted(rates, reverse=True)
    assert rates[-1] < 1e-6 < 0.009 < rates[0]


def test_it_is_compared_beside_networks_of_windows(tmp_path):
    models = {"raw_lstm": EstimatorConfig("raw_lstm", {"hidden_size": 4}), "record_cwt_lstm": CONFIG}
    protocol = replace(BY_RUN, windows_per_epoch=256)
    repeats = Repeats(replace(TRAINING, max_epochs=1), [0])
    found = compare_models(Material(decays(60), protocol), models, repeats, Place(tmp_path))
    runs = found["predictions"]["record_cwt_lstm"]
    assert len(runs["true"]) == len(runs["per_run"]["true"]) == 9  # a record is one prediction
    assert len(found["predictions"]["raw_lstm"]["true"]) == 9 * 12


def test_a_cut_inside_a_record_is_refused():
    with pytest.raises(ValueError, match="protocol=by_run"):
        PAPER.of_whole_records(SAMPLES)


@pytest.mark.parametrize(
    ("overrides", "key", "said"),
    [
        (["protocol=paper"], "protocol.name", "cuts inside records"),
        (["protocol.window=40"], "protocol.window", "sees whole records"),
        (["wavelet=morlet"], "wavelet", "acts on networks of the transform"),
        (["training.noise_snr_db=[30,1]"], "training.noise_snr_db", "two numbers that ascend"),
        (["training.noise_snr_db=[1,300]"], "training.noise_snr_db", "within -100 and 200"),
        (["training.noise_snr_db=[1,30]", "+simulator.sensor_noise={}"], "training.noise_snr_db", "takes the place"),
        (["training.schedule=linear"], "training.schedule", "one of constant, cosine"),
    ],
)
def test_keys_that_would_do_nothing_are_refused(overrides, key, said):
    with pytest.raises(InputError) as caught:
        read_settings(*composed(["model=record_cwt_lstm", *overrides]))
    assert any(problem.key == key and said in problem.rule for problem in caught.value.problems)


def test_a_frequency_beyond_the_rate_is_said(tmp_path):
    with pytest.raises(ValueError, match="highest_hz"):
        fit_estimator(EstimatorConfig("record_cwt_lstm"), data(60), TRAINING, Place(tmp_path), seed=1)


def test_a_record_is_told_with_its_interval_from_the_command_line(tmp_path):
    """Train on a few runs, record one more, identify it."""
    few = ["simulator.n_runs=700", "simulator.n_samples=400", "training.max_epochs=1", "model.hidden_size=4"]
    own = [f"data_folder={tmp_path}/data", "progress=false"]
    run = tmp_path / "trained"
    assert main(["experiment=limit", *few, "protocol.validation_fraction=0.5", f"hydra.run.dir={run}", *own]) == 0
    one = ["task=simulate", "experiment=limit", "simulator.n_runs=1", few[1], "write_measurement=true"]
    assert main([*one, f"hydra.run.dir={tmp_path}/sim", *own]) == 0
    asked = [f"measurement.path={tmp_path}/sim/measurement/measurement.yaml"]
    checkpoint = run / "record_cwt_lstm" / "seed_0" / "best.ckpt"
    found = ["task=identify", *asked, f"checkpoint={checkpoint}", f"hydra.run.dir={tmp_path}/found", "progress=false"]
    assert main(found) == 0
    content = json.loads((tmp_path / "found" / "identification.json").read_text())
    low, high = content["damping_ratio_percent"]["interval95"]
    assert low < content["damping_ratio_percent"]["value"] < high
    assert content["records"]["run_1"]["interval95"] == [low, high]
