"""Training: learning happens, stops, resumes, is interrupted, and leaves checkpoints that predict alone."""

import logging
import resource
import signal
from dataclasses import replace

import pytest
import torch
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from gear_damping.errors import InputError
from gear_damping.identification import datamodule as datamodule_file
from gear_damping.identification.controls import mean_predictor
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.lightning_module import CWT_LSTM, RAW_LSTM
from gear_damping.identification.lightning_support import WholeCheckpoints
from gear_damping.identification.metrics import rmse_percent
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import BY_RUN, PAPER_MANY_RUNS
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.trainer import Place, Shown, Training, fit_estimator, predict_windows
from gear_damping.identification.windows import gather_windows

RICKER = {"kind": "ricker", "frequency_min_hz": 20.0, "frequency_max_hz": 240.0, "n_scales": 4}
RAW = replace(RAW_LSTM, settings={"hidden_size": 8})
CWT = replace(CWT_LSTM, settings={"hidden_size": 8}, wavelet=RICKER)
TRAINING = Training(max_epochs=4, batch_size=64, learning_rate=0.02, schedule="constant")
SMALL = replace(BY_RUN, windows_per_epoch=640)


def decays(n_runs=60, n_samples=150):
    """Free decays of 50 Hz with random phase and a damping ratio of 1 to 20 %: an easy task."""
    generator = torch.Generator().manual_seed(1)
    ratio = 1 + 19 * torch.rand(n_runs, generator=generator)
    phase = 6.28 * torch.rand(n_runs, 1, generator=generator)
    angle = 2 * torch.pi * 50 * torch.arange(n_samples) / 1000
    signals = torch.exp(-ratio[:, None] / 100 * angle) * torch.cos(angle + phase)
    return RunSet(1e-5 * signals, ratio, 1000.0, "decays")


def windows(protocol=SMALL, noise=40.0):
    return WindowDataModule(Material(decays(), protocol, SensorNoise(noise)), seed=1)


def fit(folder, config=RAW, training=TRAINING, protocol=SMALL, resume=None, hparams=()):
    shown = Shown(hparams=dict(hparams))
    return fit_estimator(config, windows(protocol), training, Place(folder, resume), seed=1, shown=shown)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trained")
    return folder, fit(folder, hparams={"snr_db": 40.0})


def errors(result):
    return [epoch["val_rmse_percent"] for epoch in result.history]


@pytest.mark.parametrize("config", [RAW, CWT], ids=["raw", "cwt"])
def test_a_tiny_network_beats_the_mean_predictor_by_half(config, tmp_path):
    data = WindowDataModule(Material(decays(200, 60), replace(SMALL, windows_per_epoch=3000)), seed=1)
    result = fit_estimator(config, data, replace(TRAINING, max_epochs=20), Place(tmp_path), seed=1)
    true, predicted = predict_windows(result.estimator, data.test_dataloader())
    reference = rmse_percent(true, torch.full_like(true, mean_predictor(data.training_labels)))
    assert rmse_percent(true, predicted) < 0.5 * reference


def test_a_fit_depends_on_its_seed_and_not_on_torchs(trained, tmp_path):
    state = torch.random.get_rng_state()
    with torch.random.fork_rng():
        torch.manual_seed(99)
        again = fit(tmp_path / "again")
    assert errors(again) == errors(trained[1])
    other = fit_estimator(RAW, windows(), replace(TRAINING, max_epochs=1), Place(tmp_path / "other"), seed=2)
    assert errors(other)[0] != errors(again)[0]
    assert torch.equal(torch.random.get_rng_state(), state)


def test_a_login_node_of_a_cluster_trains_without_a_warning(tmp_path, monkeypatch):
    """Warnings are errors here; Lightning has one where it finds `srun`."""
    (tmp_path / "srun").write_text("#!/bin/sh\n")
    (tmp_path / "srun").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    assert len(fit(tmp_path / "fit", training=replace(TRAINING, max_epochs=1)).history) == 1


def test_a_fit_leaves_two_checkpoints_and_events_and_nothing_else(trained):
    names = {path.name for path in trained[0].iterdir()}
    assert {"best.ckpt", "last.ckpt"} < names
    assert all(name.startswith("events.out.tfevents") for name in names - {"best.ckpt", "last.ckpt"})


def test_tensorboard_shows_each_epoch_and_the_table_of_hyperparameters(trained):
    events = EventAccumulator(str(trained[0])).Reload()
    assert {"train_loss", "val_loss", "val_rmse_percent", "learning_rate"} <= set(events.Tags()["scalars"])
    assert [event.value for event in events.Scalars("val_rmse_percent")] == pytest.approx(errors(trained[1]))
    assert events.Scalars("learning_rate")[0].value == pytest.approx(0.02)
    assert events.Scalars("hp/val_rmse_percent")[0].value == pytest.approx(trained[1].best_validation_rmse)


def test_the_best_checkpoint_is_that_of_the_lowest_validation_error(trained):
    data = windows()
    true, predicted = predict_windows(trained[1].estimator, data.val_dataloader())
    assert rmse_percent(true, predicted) == pytest.approx(min(errors(trained[1])), rel=1e-5)


@pytest.mark.parametrize("protocol", [SMALL, replace(PAPER_MANY_RUNS, windows_per_epoch=640)])
@pytest.mark.parametrize("config", [RAW, CWT], ids=["raw", "cwt"])
def test_a_checkpoint_alone_predicts(config, protocol, tmp_path):
    result = fit(tmp_path, config, replace(TRAINING, max_epochs=1), protocol)
    content = torch.load(tmp_path / "best.ckpt", weights_only=True)
    hparams = content["hyper_parameters"]
    seen = hparams["data"]
    assert (seen["sampling_rate"], seen["window"], seen["id"]) == (1000.0, 30, "decays")
    assert hparams["wavelet"] == (RICKER if config is CWT else None)
    assert content["state_dict"]["front_end.signal_scale"] == result.estimator.front_end.signal_scale
    assert not list(tmp_path.rglob("*.yaml"))

    estimator = load_estimator(tmp_path / "best.ckpt")
    record = decays().signals[7]
    found = estimator.predict_record(record, 1000.0)
    values = estimator.front_end.columns(record[None]) if seen["whole_run"] else record[None]
    index = torch.stack([torch.zeros(121, dtype=torch.long), torch.arange(121)], dim=1)
    with torch.no_grad():
        each = estimator(gather_windows(values, index, 30))
    assert torch.allclose(found.per_window_percent, each, rtol=1e-5)
    assert found.damping_ratio_percent == pytest.approx(float(each.mean()), rel=1e-5)
    assert found.spread_percent == pytest.approx(float(each.std(correction=0)), rel=1e-4)


@pytest.mark.parametrize(
    ("values", "rate", "messages"),
    [
        (torch.zeros(100), 500.0, ["1000 Hz", "500 Hz", "resample"]),
        (torch.zeros(29), 1000.0, ["30 samples"]),
        (torch.full((100,), float("nan")), 1000.0, ["finite"]),
        (torch.zeros(29), 500.0, ["30 samples", "resample"]),
    ],
)
def test_records_that_do_not_fit_are_refused(values, rate, messages, trained):
    with pytest.raises(InputError) as caught:
        trained[1].estimator.predict_record(values, rate)
    assert all(message in str(caught.value) for message in messages)


def test_a_rate_that_is_right_to_rounding_is_taken(trained):
    estimator, record = trained[1].estimator, decays().signals[7]
    assert estimator.predict_record(record, 1000.4)[0] == estimator.predict_record(record, 1000.0)[0]


@pytest.mark.parametrize("content", [None, b"not a checkpoint"])
def test_files_that_are_no_checkpoint_are_refused(content, tmp_path):
    path = tmp_path / "best.ckpt"
    if content:
        path.write_bytes(content)
    with pytest.raises(InputError, match="must be a checkpoint"):
        load_estimator(path)


def test_a_checkpoint_that_finds_no_room_leaves_the_one_before(trained, tmp_path):
    path, held = tmp_path / "last.ckpt", (trained[0] / "last.ckpt").read_bytes()
    path.write_bytes(held)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, limits[1]))
    try:
        with pytest.raises(OSError, match="too large") as caught:
            WholeCheckpoints().save_checkpoint({"weights": torch.zeros(10_000)}, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert caught.value.filename == str(path)
    assert path.read_bytes() == held
    assert [one.name for one in tmp_path.iterdir()] == ["last.ckpt"]


@pytest.mark.parametrize("same_folder", [True, False])
def test_a_resumed_fit_ends_where_an_uninterrupted_one_does(same_folder, trained, tmp_path):
    half = fit(tmp_path / "half", training=replace(TRAINING, max_epochs=2))
    folder = tmp_path / ("half" if same_folder else "whole")
    resumed = fit(folder, resume=half.last_checkpoint)
    assert errors(resumed) == errors(trained[1])
    assert resumed.best_checkpoint == folder / "best.ckpt"
    for name, weights in trained[1].estimator.state_dict().items():
        assert torch.equal(weights, resumed.estimator.state_dict()[name]), name


def test_a_finished_fit_is_not_trained_again(trained, tmp_path):
    again = fit(tmp_path, resume=trained[0] / "last.ckpt")
    assert again.history == trained[1].history
    assert (tmp_path / "best.ckpt").read_bytes() == (trained[0] / "best.ckpt").read_bytes()


def test_resuming_from_another_data_set_is_refused(trained, tmp_path):
    data = WindowDataModule(Material(replace(decays(), id="others"), SMALL), seed=1)
    with pytest.raises(ValueError, match="'decays', not of 'others'"):
        fit_estimator(RAW, data, TRAINING, Place(tmp_path, trained[0] / "last.ckpt"))


def test_training_stops_when_the_error_stops_falling_and_stays_stopped(tmp_path):
    training = Training(max_epochs=30, batch_size=320, patience=2, learning_rate=0.5)
    result = fit(tmp_path, training=training)
    found = errors(result)
    assert len(found) < 30
    assert len(found) - 1 - found.index(min(found)) == 2
    assert len(load_estimator(tmp_path / "last.ckpt").history) == len(found)
    assert fit(tmp_path, training=training, resume=result.last_checkpoint).history == result.history
    patient = fit(tmp_path, training=replace(training, patience=4), resume=result.last_checkpoint)
    later = errors(patient)
    assert later[: len(found)] == found
    assert len(later) - 1 - later.index(min(later)) == 4


@pytest.fixture
def heeded():
    """Ctrl-C is heeded, as in a terminal: a shell that starts tests in the background has it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt_after(monkeypatch, batches):
    """Let the user press Ctrl-C at a training batch."""
    made = []
    batch = datamodule_file.WindowSource.batch

    def counted(source, chosen, generator):
        made.append(1)
        if len(made) == batches:
            signal.raise_signal(signal.SIGINT)
        return batch(source, chosen, generator)

    monkeypatch.setattr(datamodule_file.WindowSource, "batch", counted)


@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("batches", [5, 30])
def test_an_interruption_reaches_the_caller_and_can_be_resumed(batches, trained, tmp_path, monkeypatch):
    handler = signal.getsignal(signal.SIGINT)
    with monkeypatch.context() as patched:
        interrupt_after(patched, batches)
        with pytest.raises(KeyboardInterrupt):
            fit(tmp_path)
    assert signal.getsignal(signal.SIGINT) is handler
    resumed = fit(tmp_path, resume=tmp_path / "last.ckpt")
    assert errors(resumed) == errors(trained[1])


@pytest.mark.usefixtures("heeded")
def test_an_interruption_before_the_first_step_does_not_mute_the_next_one(tmp_path, monkeypatch):
    handler = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(WindowDataModule, "setup", lambda *_, **__: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        fit(tmp_path)
    assert signal.getsignal(signal.SIGINT) is handler


def test_a_fit_says_nothing_by_itself(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # What Lightning adds on import where the application has no handlers yet: every line comes twice.
    logging.getLogger("lightning.pytorch").addHandler(logging.StreamHandler())
    fit(tmp_path / "fit", training=replace(TRAINING, max_epochs=1))
    assert capfd.readouterr() == ("", "")
    assert not logging.getLogger("lightning.pytorch").handlers
    assert [path.name for path in tmp_path.iterdir()] == ["fit"]


def test_threads_are_as_before(tmp_path):
    before = torch.get_num_threads()
    fit(tmp_path, training=replace(TRAINING, max_epochs=1))
    assert torch.get_num_threads() == before


def test_a_fit_that_diverges_says_so(tmp_path):
    with pytest.raises(RuntimeError, match="finite validation error"):
        fit(tmp_path, training=Training(max_epochs=2, batch_size=64, learning_rate=1e38))


def test_budgets_that_break_a_rule_are_refused():
    with pytest.raises(ValueError, match="patience must be positive"):
        Training(patience=0)
