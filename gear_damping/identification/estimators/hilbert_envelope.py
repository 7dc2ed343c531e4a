"""The slope of the Hilbert envelope."""

from typing import ClassVar

import numpy as np
import torch

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import decay_rate, estimate_of
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.setting import Setting
from gear_damping.signals.envelope import analytic_signal

ABOVE_NOISE = 3.0  # standard deviations of the noise in the band that an envelope must have to count
STEPS_PER_PERIOD = 4.0  # at which the envelope is read; what is closer tells the same
RINGS = 15.0  # times the damping ratio that the band must be wide: what falls faster falls with the filter
CONTINUED_PERIODS = 8.0  # beyond either end, where the filter rings


class HilbertEnvelope(RecordEstimator):
    """The magnitude of the analytic signal in a band about the frequency; its logarithm falls along a line."""

    name = "hilbert_envelope"
    reference = "Feldman (1994), Mech. Syst. Signal Process. 8(2)"
    settings: ClassVar = (Setting("bandwidth", 0.8, "of the band, over the frequency", 0.1, 1.8),)

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """The mean over all that stands out of the noise."""
        free = recorded.free_vibration
        free.refuse_beyond(100 * self.values["bandwidth"] / RINGS)
        more = round(CONTINUED_PERIODS * free.period)
        values = free.continued(more)
        spectrum = np.fft.rfft(values)
        away = np.abs(np.fft.rfftfreq(values.size, 1 / free.sampling_rate) / free.frequency_hz - 1)
        half = self.values["bandwidth"] / 2
        band = np.clip((1.25 * half - away) / (0.5 * half), 0, 1)  # falls over the outer half of the band
        inside = np.fft.irfft(spectrum * np.sin(band * np.pi / 2) ** 2, values.size)
        found = analytic_signal(torch.as_tensor(inside).unsqueeze(0))[0].numpy()[more : more + free.values.size]
        noise = free.noise * (2 * free.frequency_hz * self.values["bandwidth"] / free.sampling_rate) ** 0.5
        places = np.arange(0, free.values.size, max(1, round(free.period / STEPS_PER_PERIOD)))
        size, phase = np.abs(found[places]), np.unwrap(np.angle(found[places]))
        kept = size > ABOVE_NOISE * noise
        if kept.sum() < 4 * STEPS_PER_PERIOD:
            raise UnsuitedRecord("fewer than four periods stand out of the noise: record a longer ring-down")
        time, size = free.time[places][kept], size[kept]
        rate = decay_rate(time, np.log(size), 1 / size)
        frequency = float(np.polyfit(time, phase[kept], 1)[0]) / (2 * np.pi)
        return estimate_of(rate, frequency, (float(size.max()), float(size.min())))
