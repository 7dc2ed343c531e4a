"""Runs, splits, windows, noise and batches."""

from dataclasses import replace

import pytest
import torch

from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.noise import SensorNoise, ac_rms_of_runs, noisy_records
from gear_damping.identification.protocols import BY_RUN, PAPER, PAPER_MANY_RUNS, Protocol
from gear_damping.identification.runs import RunSet
from gear_damping.identification.windows import gather_windows, window_starts, windows_of_runs

WINDOW = 30


def ramps(n_runs=20, n_samples=200, offset=0):
    """Run r is r * 1000 + time: a window's content says where it came from."""
    run = torch.arange(n_runs, dtype=torch.float32)
    signals = 1000 * (run[:, None] + offset) + torch.arange(n_samples)
    return RunSet(signals, 0.1 + 0.01 * run, 1000.0, "ramps", {"speed": run})


def tones(n_runs=6, n_samples=20000):
    generator = torch.Generator().manual_seed(3)
    amplitude = 10 ** torch.linspace(-6, 2, n_runs)
    phase = 6.28 * torch.rand(n_runs, 1, generator=generator)
    time = torch.arange(n_samples) / 1000
    signals = amplitude[:, None] * (50 + torch.sin(300 * time + phase))
    return RunSet(signals, torch.full((n_runs,), 0.3), 1000.0, "tones")


def runs_of(index):
    return set(index[:, 0].tolist())


# --- runs


def test_subset_takes_runs_with_their_labels_and_quantities():
    part = ramps().subset(torch.tensor([7, 2]))
    assert part.signals[:, 0].tolist() == [7000, 2000]
    assert part.quantities["speed"].tolist() == [7, 2]
    assert part.damping_ratio_percent == pytest.approx([0.17, 0.12])
    assert (part.id, part.sampling_rate) == ("ramps", 1000.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"signals": torch.zeros(3)}, "shape"),
        ({"signals": torch.zeros(20, 50, dtype=torch.float64)}, "float32"),
        ({"signals": torch.full((20, 5), float("nan"))}, "finite"),
        ({"damping_ratio_percent": torch.zeros(3)}, "damping_ratio_percent must have shape"),
        ({"damping_ratio_percent": torch.full((20,), -1.0)}, ">= 0"),
        ({"quantities": {"speed": torch.zeros(2)}}, "speed must have shape"),
        ({"sampling_rate": 0.0}, "sampling_rate"),
    ],
)
def test_runs_that_break_a_rule_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(ramps(), **change)


# --- protocols


def test_by_run_no_run_is_in_two_parts_and_every_run_in_one():
    split = BY_RUN.split(ramps(), seed=1)
    parts = [runs_of(index) for index in split]
    assert sorted(run for part in parts for run in part) == list(range(20))
    assert [len(part) for part in parts] == [14, 3, 3]
    assert split.train.shape == (14 * 171, 2)
    assert split.test.shape == (3 * 12, 2)
    assert int(split.train[:, 1].max()) == 170


def test_by_run_the_seed_decides_the_runs():
    one, same, other = (runs_of(BY_RUN.split(ramps(), seed).test) for seed in (1, 1, 2))
    assert one == same != other


def test_by_run_with_test_runs_tests_on_all_of_those_and_on_no_other():
    split = BY_RUN.split(ramps(), 1, test_runs=ramps(5, 100))
    assert runs_of(split.test) == set(range(5))
    assert int(split.test[:, 1].max()) <= 70
    assert runs_of(split.train) | runs_of(split.validation) == set(range(20))
    assert not runs_of(split.train) & runs_of(split.validation)


@pytest.mark.parametrize("stride", [1, 7])
@pytest.mark.parametrize("protocol", [PAPER, PAPER_MANY_RUNS])
def test_chronological_training_ends_before_the_test_begins(protocol, stride):
    split = replace(protocol, stride=stride, run=3).split(ramps(), 1)
    last_trained = torch.cat([split.train, split.validation])[:, 1].max() + WINDOW - 1
    assert last_trained < 160 == split.test[:, 1].min()
    assert len(split.train) == len(split.train.unique(dim=0))
    drawn = {tuple(window) for window in split.validation.tolist()}
    assert not drawn & {tuple(window) for window in split.train.tolist()}


def test_paper_takes_one_run_and_a_fifth_of_its_windows_to_validate():
    split = replace(PAPER, run=3).split(ramps(n_samples=2000), 1)
    assert [len(part) for part in split] == [1257, 314, 371]
    assert all(runs_of(part) == {3} for part in split)


def test_paper_many_runs_tests_on_the_runs_that_it_trains_on():
    split = PAPER_MANY_RUNS.split(ramps(), 1)
    assert runs_of(split.train) == runs_of(split.test) == set(range(20))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "by_runs"}, "did you mean 'by_run'"),
        ({"window": 0}, "window"),
        ({"test_fraction": 1.0}, "test_fraction"),
        ({"windows_per_epoch": 0}, "windows_per_epoch"),
    ],
)
def test_protocols_that_break_a_rule_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Protocol(**arguments)


@pytest.mark.parametrize(
    ("protocol", "runs", "test_runs", "message"),
    [
        (BY_RUN, ramps(2), None, "too few to split"),
        (BY_RUN, ramps(n_samples=29), None, "window 30 is longer"),
        (replace(PAPER, run=20), ramps(), None, "run must be below 20"),
        (PAPER, ramps(), ramps(), "choose by_run"),
        (PAPER, ramps(n_samples=140), None, "window 30 is longer"),
    ],
)
def test_splits_that_cannot_be_are_refused(protocol, runs, test_runs, message):
    with pytest.raises(ValueError, match=message):
        protocol.split(runs, 1, test_runs)


# --- windows


@pytest.mark.parametrize("shape", [(4, 50), (4, 50, 3)])
def test_gathered_windows_are_the_slices(shape):
    values = torch.randn(shape, generator=torch.Generator().manual_seed(1))
    index = torch.tensor([[0, 0], [3, 20], [1, 43], [3, 20]])
    found = gather_windows(values, index, 7)
    assert torch.equal(found, torch.stack([values[run, start : start + 7] for run, start in index.tolist()]))


def test_starts_stay_inside():
    assert window_starts(5, 20, 4, 3).tolist() == [5, 8, 11, 14]
    assert windows_of_runs(torch.tensor([2, 4]), torch.tensor([0, 9])).tolist() == [
        [2, 0], [2, 9], [4, 0], [4, 9],
    ]  # fmt: skip


# --- noise


@pytest.mark.parametrize("snr_db", [0.0, 20.0, 35.0])
def test_noise_has_the_ratio_to_the_ac_part_of_each_run(snr_db):
    runs = tones().signals.double()
    noise = noisy_records(runs, torch.arange(6), SensorNoise(snr_db), 1, "runs") - runs
    ratio = 20 * torch.log10(runs.std(dim=1) / noise.std(dim=1))
    # 20000 samples know a deviation to 0.5 %, that is 0.043 dB.
    assert (ratio - snr_db).abs().max() < 0.2
    assert torch.allclose(ac_rms_of_runs(runs), runs.std(dim=1, correction=0))


def test_noise_of_a_range_draws_its_ratio_for_each_row():
    rows = torch.zeros(4000, 400)
    generator = torch.Generator().manual_seed(1)
    noisy = SensorNoise((10.0, 30.0)).add(rows, torch.ones(4000), generator)
    ratio = -20 * torch.log10(noisy.std(dim=1))
    assert 9 < ratio.min() < 10.5
    assert 29.5 < ratio.max() < 31
    assert abs(float(ratio.mean()) - 20) < 0.5
    assert abs(float(ratio.std()) - 20 / 12**0.5) < 0.3


def test_clean_noise_changes_nothing_and_wrong_ranges_are_refused():
    rows = torch.ones(2, 5)
    assert torch.equal(SensorNoise(None).add(rows, torch.ones(2), torch.Generator()), rows)
    with pytest.raises(ValueError, match="low, high"):
        SensorNoise((30.0, 10.0))


def test_the_noise_of_a_record_knows_nothing_of_the_other_records():
    runs = tones().signals
    noise = SensorNoise((1.0, 50.0))
    every = noisy_records(runs, torch.arange(6), noise, 1, "runs")
    assert torch.equal(noisy_records(runs, torch.tensor([4, 1]), noise, 1, "runs"), every[[4, 1]])
    assert not torch.equal(noisy_records(runs, torch.arange(6), noise, 2, "runs"), every)
    assert not torch.equal(noisy_records(runs, torch.arange(6), noise, 1, "test_runs"), every)


# --- batches


class At:
    """Stands for a trainer that is in an epoch."""

    def __init__(self, epoch):
        self.current_epoch = epoch
        self.strategy = self
        self.root_device = torch.device("cpu")


def epoch_of(data, epoch):
    data.trainer = At(epoch)
    return list(data.train_dataloader())


def module(noise=None, seed=1, protocol=BY_RUN, runs=None, test_runs=None, **arguments):
    protocol = replace(protocol, windows_per_epoch=100)
    material = Material(runs or ramps(), protocol, SensorNoise(noise), test_runs)
    return WindowDataModule(material, seed=seed, **arguments)


def test_a_training_batch_is_windows_of_training_runs_with_their_labels():
    data = module(batch_size=32)
    batches = epoch_of(data, 0)
    assert [len(labels) for _, labels in batches] == [32, 32, 32, 4]
    windows, labels = (torch.cat(part) for part in zip(*batches, strict=True))
    run, start = windows[:, 0].long() // 1000, windows[:, 0].long() % 1000
    assert {(r, s) for r, s in zip(run.tolist(), start.tolist(), strict=True)} <= {
        tuple(window) for window in data.split.train.tolist()
    }
    assert torch.equal(windows, windows[:, :1] + torch.arange(WINDOW))
    assert torch.allclose(labels, 0.1 + 0.01 * run)


def test_windows_are_drawn_afresh_each_epoch_and_alike_for_a_seed():
    first, second = (torch.cat([x for x, _ in epoch_of(module(), epoch)]) for epoch in (0, 1))
    assert not torch.equal(first, second)
    assert torch.equal(first, torch.cat([x for x, _ in epoch_of(module(), 0)]))
    assert not torch.equal(first, torch.cat([x for x, _ in epoch_of(module(seed=2), 0)]))


def test_noise_is_fresh_in_each_batch_and_epoch_and_alike_for_a_seed():
    flat = RunSet(torch.zeros(20, 200) + torch.arange(200) % 2, torch.full((20,), 0.3), 1000.0, "flat")

    def residuals(epoch, seed=1):
        return [x - x.round() for x, _ in epoch_of(module(40.0, seed, runs=flat, batch_size=50), epoch)]

    def alike(x, y):  # to the rounding of the sum
        return torch.allclose(x, y, atol=1e-6)

    one, two = residuals(0)
    assert 0.003 < one.std() < 0.007  # 0.5 at 40 dB
    assert not alike(one, two)
    assert not alike(one, residuals(1)[0])
    assert not alike(one, residuals(0, seed=2)[0])
    assert all(torch.equal(*pair) for pair in zip((one, two), residuals(0), strict=True))


@pytest.mark.parametrize("protocol", [BY_RUN, PAPER_MANY_RUNS])
@pytest.mark.parametrize("part", ["val_dataloader", "test_dataloader"])
def test_noise_of_evaluation_stays_whatever_the_batches(protocol, part):
    def windows(**arguments):
        return torch.cat([x for x, _ in getattr(module(20.0, protocol=protocol, **arguments), part)()])

    data = module(20.0, protocol=protocol)
    assert torch.equal(windows(), windows(evaluation_batch_size=7))
    assert torch.equal(next(iter(getattr(data, part)()))[0], next(iter(getattr(data, part)()))[0])
    assert not torch.equal(windows(), windows(seed=2))


def test_overlapping_evaluation_windows_share_the_noise_of_their_record():
    data = WindowDataModule(Material(ramps(), replace(BY_RUN, evaluation_stride=1), SensorNoise(20.0)), seed=1)
    windows = next(iter(data.test_dataloader()))[0]
    assert torch.equal(windows[0, 1:], windows[1, :-1])
    assert not torch.equal(windows[0], windows[0].round())


def test_labels_of_evaluation_belong_to_the_windows():
    for noise in (None, 60.0):
        windows, labels = next(iter(module(noise).test_dataloader()))
        assert torch.allclose(labels, 0.1 + 0.01 * (windows.mean(dim=1) / 1000).floor())


def test_test_runs_are_what_is_tested():
    data = module(test_runs=ramps(5, 100, offset=50))
    windows, labels = next(iter(data.test_dataloader()))
    assert windows.min() >= 50000
    assert torch.equal(labels, data.test_runs.damping_ratio_percent[data.test_window_runs])


def test_clean_signals_are_held_once():
    runs = ramps()
    data = module(runs=runs)
    for loader in (data.train_dataloader(), data.val_dataloader(), data.test_dataloader()):
        assert loader.source.values.data_ptr() == runs.signals.data_ptr()


def test_rates_that_differ_are_refused():
    with pytest.raises(ValueError, match="500 Hz and run_set 1000 Hz"):
        module(test_runs=replace(ramps(), sampling_rate=500.0))
