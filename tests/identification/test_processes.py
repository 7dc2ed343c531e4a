"""A fit by several processes: shares of batches, and the curve of one process."""

from dataclasses import replace

import pytest
import torch

from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.processes import Share
from gear_damping.identification.protocols import BY_RUN
from gear_damping.identification.runs import RunSet
from gear_damping.identification.trainer import Place, Training, fit_estimator

TRAINING = Training(max_epochs=12, batch_size=64, learning_rate=0.005)


def windows():
    """Free decays of 50 Hz with random phase and a damping ratio of 1 to 20 %: an easy task."""
    generator = torch.Generator().manual_seed(1)
    ratio = 1 + 19 * torch.rand(60, generator=generator)
    phase = 6.28 * torch.rand(60, 1, generator=generator)
    angle = 2 * torch.pi * 50 * torch.arange(150) / 1000
    signals = torch.exp(-ratio[:, None] / 100 * angle) * torch.cos(angle + phase)
    runs = RunSet(1e-5 * signals, ratio, 1000.0, "decays")
    return WindowDataModule(Material(runs, replace(BY_RUN, windows_per_epoch=650), SensorNoise(40.0)), seed=1)


@pytest.mark.parametrize("members", [8, 7, 2, 1])
def test_shares_of_a_batch_hold_every_member_and_none_is_empty(members):
    batch = torch.arange(members)
    parts = [Share(rank, 3).part(batch) for rank in range(3)]
    assert set(torch.cat(parts).tolist()) == set(range(members))
    assert max(map(len, parts)) - min(map(len, parts)) <= 1
    assert min(map(len, parts)) > 0
    assert members < 3 or len(torch.cat(parts)) == members  # once each


def test_processes_share_the_batches_of_one():
    def batches(share):
        data = windows()
        data.batch_size, data.share = 64, share
        data.trainer = None
        loader = data.train_dataloader()
        loader.epoch = lambda: 3
        return [labels for _, labels in loader]

    whole, halves = batches(Share()), [batches(Share(rank, 2)) for rank in range(2)]
    for all_of_it, first, second in zip(whole, *halves, strict=True):
        assert torch.equal(all_of_it[0::2], first)
        assert torch.equal(all_of_it[1::2], second)


def own_network(path, line):
    """The estimator of a file with a network like RAW, which does something more in each training step."""
    path.write_text(OWN.replace("LINE", line))
    return EstimatorConfig("own", plugins=(str(path),))


@pytest.mark.slow
def test_two_processes_give_the_validation_curve_of_one(tmp_path):
    """By gloo on the CPU; what parts them is rounding. Each notes its rank and the sizes of what it trained on."""
    notes = tmp_path / "notes"
    notes.mkdir()
    line = f"Path({str(notes)!r}, os.environ.get('LOCAL_RANK', 'alone') + f'_{{len(features)}}').touch()"
    config, curves = own_network(tmp_path / "own.py", line), {}
    for count in (1, 2):
        found = fit_estimator(config, windows(), replace(TRAINING, devices=count), Place(tmp_path / str(count)), seed=1)
        curves[count] = torch.tensor([epoch["val_rmse_percent"] for epoch in found.history])
    assert {path.name for path in notes.iterdir()} == {"alone_64", "alone_10", "0_32", "0_5", "1_32", "1_5"}
    assert curves[1].min() < 0.96 * curves[1][0]  # something was learned
    assert torch.allclose(curves[2], curves[1], rtol=1e-3)
    names = {path.name for path in (tmp_path / "2").iterdir() if not path.name.startswith("events")}
    assert names == {"best.ckpt", "last.ckpt"}


@pytest.mark.slow
def test_a_process_that_fails_ends_the_fit(tmp_path):
    line = "1 / int(os.environ['LOCAL_RANK'] == '0')"
    with pytest.raises(RuntimeError, match=r"one of 2 processes of a training failed:(?s:.*)ZeroDivisionError"):
        fit_estimator(own_network(tmp_path / "own.py", line), windows(), replace(TRAINING, devices=2),
                      Place(tmp_path / "fit"), seed=1)  # fmt: skip


OWN = """
import os
from pathlib import Path
from gear_damping.identification.estimators.base import WindowEstimator
from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingLSTM


class Noting(DampingLSTM):
    def state(self, features):
        if self.training:
            LINE
        return super().state(features)


class Own(WindowEstimator):
    name = "own"
    reference = "none"

    def front_end(self, transform):
        return FrontEnd()

    def network(self, n_features):
        return Noting(n_features, 8, dropout=0.0)
"""
