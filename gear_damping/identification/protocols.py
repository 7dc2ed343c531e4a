"""How runs become training, validation and test windows: the three protocols."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.errors import nearest
from gear_damping.identification.runs import RunSet
from gear_damping.identification.seeding import seeded_generator
from gear_damping.identification.windows import window_starts, windows_of_runs

NAMES = ("by_run", "paper", "paper_many_runs")


class Split(NamedTuple):
    """Windows of the three parts, each (windows, 2): run and first sample."""

    train: Tensor
    validation: Tensor
    test: Tensor


@dataclass(frozen=True)
class Protocol:
    """What is trained on and what is scored.

    | name | split | CWT columns |
    |---|---|---|
    | `by_run` | other runs for validation and for test | of the window alone |
    | `paper` | ONE run, one label: the last part by time is the test | of the WHOLE run |
    | `paper_many_runs` | the same cut inside each of many runs | of the WHOLE run |

    Under the two chronological protocols the validation windows are drawn from the training windows, as in
    the paper, so they overlap; the columns of a training window also see samples beyond the window and beyond
    the cut, and every test window belongs to a run (and label) that was trained on. Their figures say how
    well a run is remembered, not how well damping is identified. No training window overlaps the test part.

    Args:
        name: One of the three.
        window: Samples that the estimator sees at once.
        stride: Samples between the starts of training windows.
        evaluation_stride: The same for validation and test windows. Where validation windows are drawn from
            the training windows, one in this many of those drawn is used.
        validation_fraction: Part of the runs (by_run) or of the training windows (others), 0 < f < 1.
        test_fraction: Part of the runs (by_run) or of the time of each run (others), 0 < f < 1.
        windows_per_epoch: Training windows drawn afresh for each epoch; None takes all.
        run: Number of the run that `paper` takes.

    Raises:
        ValueError: a value breaks its rule.
    """

    name: str = "by_run"
    window: int = 30
    stride: int = 1
    evaluation_stride: int = 15
    validation_fraction: float = 0.15
    test_fraction: float = 0.15
    windows_per_epoch: int | None = 16384
    run: int = 0

    def __post_init__(self) -> None:
        if self.name not in NAMES:
            raise ValueError(f"name must be one of {', '.join(NAMES)}, got {self.name!r}: " + nearest(self.name, NAMES))
        for name in ("window", "stride", "evaluation_stride"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1 sample, got {getattr(self, name)!r}")
        for name in ("validation_fraction", "test_fraction"):
            if not 0 < getattr(self, name) < 1:
                raise ValueError(f"{name} must be between 0 and 1, got {getattr(self, name)!r}")
        if self.windows_per_epoch is not None and self.windows_per_epoch < 1:
            raise ValueError(f"windows_per_epoch must be at least 1 or None, got {self.windows_per_epoch!r}")

    def of_whole_records(self, n_samples: int) -> "Protocol":
        """The same with records in the place of windows.

        Raises:
            ValueError: it cuts records.
        """
        if self.chronological:
            raise ValueError(f"{self.name} cuts inside records, and a network of whole records needs protocol=by_run")
        return replace(self, window=n_samples, stride=1, evaluation_stride=1)

    @property
    def chronological(self) -> bool:
        """Whether training and test share runs; then CWT columns are of the whole run."""
        return self.name != "by_run"

    def split(self, run_set: RunSet, seed: int, test_runs: RunSet | None = None) -> Split:
        """The windows of each part.

        Args:
            run_set: The runs to split.
            seed: Decides which runs (by_run) or which training windows (others) are drawn.
            test_runs: Runs to test on instead of a part of `run_set`; by_run only. The test windows then
                number these runs.

        Raises:
            ValueError: there are too few runs or samples, or `test_runs` comes with another protocol.
        """
        if test_runs is not None and self.chronological:
            raise ValueError(f"test_runs belong to protocol by_run, got {self.name!r}: choose by_run")
        if self.chronological:
            return self._chronological(run_set, seed)
        return self._by_run(run_set, seed, test_runs)

    def _by_run(self, run_set: RunSet, seed: int, test_runs: RunSet | None) -> Split:
        order = torch.randperm(len(run_set), generator=seeded_generator(seed, "split"))
        n_test = 0 if test_runs is not None else _part(len(run_set), self.test_fraction)
        n_validation = _part(len(run_set), self.validation_fraction)
        if n_test + n_validation >= len(run_set):
            raise ValueError(f"run_set has {len(run_set)} runs, too few to split: simulate more")
        test, validation, train = order.tensor_split([n_test, n_test + n_validation])
        scored = run_set if test_runs is None else test_runs
        return Split(
            self._windows(train, run_set, 0, run_set.n_samples, self.stride),
            self._windows(validation, run_set, 0, run_set.n_samples, self.evaluation_stride),
            self._windows(
                test if test_runs is None else torch.arange(len(scored)),
                scored, 0, scored.n_samples, self.evaluation_stride,
            ),
        )  # fmt: skip

    def _chronological(self, run_set: RunSet, seed: int) -> Split:
        if self.name == "paper" and not 0 <= self.run < len(run_set):
            raise ValueError(f"run must be below {len(run_set)}, the number of runs, got {self.run}")
        runs = torch.tensor([self.run]) if self.name == "paper" else torch.arange(len(run_set))
        cut = run_set.n_samples - _part(run_set.n_samples, self.test_fraction)
        before = self._windows(runs, run_set, 0, cut, self.stride)
        order = torch.randperm(len(before), generator=seeded_generator(seed, "split"))
        validation, train = order.tensor_split([_part(len(before), self.validation_fraction)])
        test = self._windows(runs, run_set, cut, run_set.n_samples, self.evaluation_stride)
        if not len(train):
            raise ValueError("too few windows to split: use longer runs or a smaller stride")
        kept = validation[:: self.evaluation_stride]
        return Split(before[train.sort().values], before[kept.sort().values], test)

    def _windows(self, runs: Tensor, run_set: RunSet, first: int, end: int, stride: int) -> Tensor:
        if end - first < self.window:
            raise ValueError(
                f"window {self.window} is longer than a part of a run ({end - first} of {run_set.n_samples} "
                "samples): use longer runs or a shorter window"
            )
        return windows_of_runs(runs.sort().values, window_starts(first, end, self.window, stride))


def _part(total: int, fraction: float) -> int:
    return max(1, round(total * fraction))


BY_RUN = Protocol("by_run")
PAPER = Protocol("paper", evaluation_stride=1, validation_fraction=0.2, test_fraction=0.2, windows_per_epoch=None)
PAPER_MANY_RUNS = Protocol("paper_many_runs", validation_fraction=0.2, test_fraction=0.2)
PROTOCOLS = {protocol.name: protocol for protocol in (BY_RUN, PAPER, PAPER_MANY_RUNS)}
