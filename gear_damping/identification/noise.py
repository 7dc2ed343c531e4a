"""Sensor noise at a signal-to-noise ratio relative to the AC part of each run's channel.

The effect `sensor_noise` of the physics says the same level for the record of a simulation, one draw of it. Networks
need the noise by itself: fresh in every epoch, of a level that may be drawn too, keyed by the number of the run and
not by its place in a batch, and without an import of the physics. Only one of the two is ever added: a run that is
trained on is simulated clean, and the configuration refuses both (`config/by_task.py`).
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.identification.seeding import seeded_generator


@dataclass(frozen=True)
class SensorNoise:
    """White Gaussian noise of the sensor.

    Args:
        snr_db: 20 log10 of the AC root mean square of the run over that of the noise: one value, or the
            limits (low, high) between which each draw is uniform; None for a clean sensor.

    Raises:
        ValueError: the limits are not two numbers in ascending order.
    """

    snr_db: float | tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.snr_db, (tuple, list)):
            if len(self.snr_db) != 2 or not self.snr_db[0] <= self.snr_db[1]:
                raise ValueError(f"snr_db must be one value or (low, high), got {self.snr_db!r}")
            object.__setattr__(self, "snr_db", (float(self.snr_db[0]), float(self.snr_db[1])))

    @property
    def is_clean(self) -> bool:
        """Whether there is no noise at all."""
        return self.snr_db is None

    def add(self, values: Tensor, ac_rms: Tensor, generator: torch.Generator) -> Tensor:
        """`values` (batch, time) with fresh noise; each row draws its own SNR where that is a range.

        Args:
            values: Signals or windows of signals, (batch, time).
            ac_rms: AC root mean square of the run that each row belongs to, (batch,).
            generator: Source of the noise, on the device of `values`.
        """
        if self.is_clean:
            return values
        noise = torch.randn(values.shape, generator=generator, device=values.device, dtype=values.dtype)
        return torch.addcmul(values, noise, self._level(ac_rms, generator)[:, None])

    def _level(self, ac_rms: Tensor, generator: torch.Generator) -> Tensor:
        if not isinstance(self.snr_db, tuple):
            return ac_rms * 10 ** (-self.snr_db / 20)
        low, high = self.snr_db
        draw = torch.rand(ac_rms.shape, generator=generator, device=ac_rms.device, dtype=ac_rms.dtype)
        return ac_rms * 10 ** (-(low + (high - low) * draw) / 20)


def ac_rms_of_runs(signals: Tensor) -> Tensor:
    """Root mean square of each run about its mean, (runs,), without a copy of the signals at a time."""
    return torch.stack([signal.std(correction=0) for signal in signals])


def noisy_records(signals: Tensor, runs: Tensor, noise: SensorNoise, seed: int, data: str) -> Tensor:
    """Copies of whole runs as the sensor would give them, one realisation per run.

    The noise is keyed by the number of the run, so it is the same whatever other runs, batches or
    windows are asked for.

    Args:
        signals: All runs, (all runs, time).
        runs: Numbers of the runs to copy, (runs,).
        noise: The sensor.
        seed: Seed of the realisation.
        data: Name of the set that the numbers belong to ("runs" or "test_runs").
    """
    copies = signals[runs]
    for row, run in zip(copies, runs.tolist(), strict=True):
        generator = seeded_generator(seed, "sensor noise", data, run, device=signals.device)
        row.copy_(noise.add(row[None], row.std(correction=0)[None], generator)[0])
    return copies
