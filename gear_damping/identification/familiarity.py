"""Whether a record is like the runs of a training: what is left of it beside their principal components, and its noise.

The runs of a family differ in a few numbers, so that some tens of components hold each to far below its noise. What
else is in a record, of a hidden effect or another rig, is left over, where the noise of a sensor leaves the same in
every band. The measure is the power left below half the Nyquist frequency over that above it; its threshold comes from
simulated runs that the components were not made from (subspace residual with a conformal threshold: Jackson and
Mudholkar 1979, Technometrics 21(3); Vovk, Gammerman and Shafer 2005).
"""

from dataclasses import dataclass
from math import ceil, inf

import torch
from torch import Tensor, nn

from gear_damping.identification.noise import SensorNoise, ac_rms_of_runs
from gear_damping.identification.seeding import seeded_generator

COMPONENTS = 64  # at most; a quarter of the runs at most, which are to make more of them than themselves
RUNS_EACH, MOST_RUNS = 4, 1000  # runs a component, and that components are made from
CALIBRATIONS = 1000  # noisy records that the threshold comes from, at least: runs are used again with other noise
FALSE_ALARMS = 0.04  # of records like those of the training: what a threshold lets through, below the 5 % wanted
TRUNCATED = 0.9  # of clean runs that hold less beside the components than a clean record is allowed
LEAST_RUNS = 50  # of a training, and to calibrate by
ANY_SENSOR = SensorNoise((20.0, 60.0))  # that a training without noise is calibrated with: records have some
ITERATIONS = 6  # of the subspace: what is far below the noise need not be told apart


@dataclass(frozen=True)
class Familiarity:
    """How like the training a record is: `measure`, and the `threshold` that it stays below where it is."""

    measure: float
    threshold: float

    @property
    def is_strange(self) -> bool:
        """Whether the record is unlike what the training held."""
        return not self.measure <= self.threshold  # nan is

    @property
    def sentence(self) -> str:
        """What is unlike."""
        share = f"{100 * (1 - FALSE_ALARMS):.0f} %"
        return (
            f"what no run of the training holds is {self.measure:.3g} times the noise above half the Nyquist "
            f"frequency, and {share} of unseen runs stay below {self.threshold:.3g}"
        )


class Components(nn.Module):
    """The principal components of training records, with a threshold.

    Args:
        samples: Of a record.
        components: How many.
    """

    def __init__(self, samples: int, components: int) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(samples))
        self.register_buffer("basis", torch.zeros(samples, components))
        self.register_buffer("truncated", torch.zeros(()))
        self.register_buffer("threshold", torch.tensor(inf))

    @property
    def samples(self) -> int:
        """Of a record that it can be asked about."""
        return len(self.mean)

    def fit(self, signals: Tensor, others: Tensor, noise: SensorNoise, seed: int) -> None:
        """Make the components from clean runs, and the threshold from other ones with noise.

        Args:
            signals: Runs of the training, (runs, time).
            others: Runs to calibrate by, (runs, time).
            noise: What a sensor adds to either.
            seed: Of the noise and of the directions that components are sought in.
        """
        chosen = signals[:MOST_RUNS].double()
        self.mean.copy_(chosen.mean(0))
        scaled = (chosen - self.mean) / _power(chosen).sqrt().clamp(min=torch.finfo(torch.float32).tiny)[:, None]
        self.basis.copy_(_directions(scaled, self.basis.shape[1], seeded_generator(seed, "components")))
        clean = self._left(others)
        self.truncated.copy_((clean.square().mean(1) / _power(others)).quantile(TRUNCATED))
        noise = ANY_SENSOR if noise.is_clean else noise
        again = ceil(CALIBRATIONS / len(others))
        generator = seeded_generator(seed, "calibration noise")
        measured = [self.measure(noise.add(others, ac_rms_of_runs(others), generator)) for _ in range(again)]
        measures, rank = torch.cat(measured), ceil((len(others) * again + 1) * (1 - FALSE_ALARMS))
        self.threshold.copy_(measures.kthvalue(rank).values)

    def measure(self, records: Tensor) -> Tensor:
        """Power left at low frequencies over that at high ones, (records,).

        Args:
            records: (records, time), of which the first `samples` are looked at.
        """
        records = records[:, : self.samples]
        left = self._left(records)
        spectrum = torch.fft.rfft(left).abs().square()
        middle = spectrum.shape[1] // 2
        low, high = spectrum[:, 1:middle].mean(1), spectrum[:, middle:].mean(1)
        return low / (high + self.truncated * _power(records) * left.shape[1]).clamp(min=torch.finfo(low.dtype).tiny)

    def strange(self, records: Tensor) -> Tensor:
        """Which records are unlike those of the training, (records,)."""
        return ~(self.measure(records) <= self.threshold)  # nan is

    def forward(self, record: Tensor) -> Familiarity | None:
        """Of one record (time,); None where it is shorter than the runs of the training."""
        if len(record) < self.samples:
            return None
        return Familiarity(float(self.measure(record[None])), float(self.threshold))

    def _left(self, records: Tensor) -> Tensor:
        """What the components do not hold, (records, time)."""
        basis = self.basis.double()
        about = records.double() - self.mean
        return about - (about @ basis) @ basis.T


def _power(records: Tensor) -> Tensor:
    """Of each record about its mean, (records,)."""
    return records.double().var(1, correction=0)


def _directions(scaled: Tensor, count: int, generator: torch.Generator) -> Tensor:
    """The first principal directions, (time, count), by subspace iteration (Halko, Martinsson and Tropp 2011)."""
    random = torch.randn(scaled.shape[1], count, generator=generator, dtype=scaled.dtype)
    basis = torch.linalg.qr(random).Q
    for _ in range(ITERATIONS):
        basis = torch.linalg.qr(scaled.T @ (scaled @ basis)).Q
    return basis


def components_for(runs: int, others: int) -> int:
    """How many components so many runs make; 0 where they are too few to tell what is like them."""
    return 0 if min(runs, others) < LEAST_RUNS else min(COMPONENTS, runs // RUNS_EACH)
