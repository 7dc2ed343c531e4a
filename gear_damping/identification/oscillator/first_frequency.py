"""A first guess of the natural frequency, from the part of a record that holds its motion."""

from math import log

import numpy as np

from gear_damping.identification.output_error.records import FitRecord

MOTION, STROKE = 0.999, 0.5  # share of the energy that is the motion; of a record: less is a stroke
CHANCE = 1e-3  # that noise alone has a peak that counts as one of the motion
FEWEST_SAMPLES = 20  # of a round of the fit: several for each of its unknowns


def first_frequency(record: FitRecord, driven: bool = True) -> float:
    """A first guess of the natural frequency in Hz: the highest peak of the response per unit of force.

    Args:
        record: The record.
        driven: Whether the response is divided by the force, where there is one.
    """
    place, window = _motion(record)
    response = record.response.numpy()[place]
    response = response - float(record.response.mean())
    frequency = np.fft.rfftfreq(len(response), 1 / record.sampling_rate)
    width = max(1, len(frequency) // 400)
    smooth = _smoothed(response * window, width)
    drives = [record.inputs[n][place] for n in ("force", "base_acceleration") if driven and n in record.inputs]
    drives = [drive for drive in drives if float(drive.max()) > float(drive.min())]  # a constant one drives nothing
    if drives:
        force = drives[0].numpy()
        drive = _smoothed((force - force.mean()) * window, width)
        smooth = np.where(drive > 1e-3 * drive.max(), smooth / np.maximum(drive, 1e-300), 0)
    first = max(1, width // 2)
    if not drives and smooth[first:].max() < _of_noise(smooth[first:]):  # what dies away early a window hardly shows
        smooth = _smoothed(response, width)
    return float(frequency[first + int(np.argmax(smooth[first:]))])


def _smoothed(values: np.ndarray, width: int) -> np.ndarray:
    """The periodogram of (n,) values as a running mean over some bins."""
    return np.convolve(np.abs(np.fft.rfft(values)) ** 2, np.ones(width) / width, mode="same")


def _of_noise(spectrum: np.ndarray) -> float:
    """A peak that white noise passes in one of a thousand records: powers are exponential, with a median of ln 2."""
    return float(np.median(spectrum)) / log(2) * log(len(spectrum) / CHANCE)


def is_stroke(record: FitRecord) -> bool:
    """Whether the motion fills a small part of a record."""
    place, _ = _motion(record)
    return place.stop - place.start < STROKE * len(record.response)


def _motion(record: FitRecord) -> tuple[slice, np.ndarray]:
    """The samples that hold the motion, and a window for their spectrum.

    A stroke that has long rung out fills a small part of its record, where a window over all of it has hardly risen.
    """
    energy = np.cumsum((record.response.numpy() - float(record.response.mean())) ** 2)
    first, last = np.searchsorted(energy, np.array([1 - MOTION, MOTION]) * energy[-1])
    if last - first >= STROKE * len(energy) or last - first < FEWEST_SAMPLES:
        return slice(0, len(energy)), np.hanning(len(energy))
    first = max(0, int(first) - (int(last) - int(first)) // 10)  # the stroke comes before what it moves
    tail = np.hanning(2 * ((last - first) // 4))
    return slice(first, int(last)), np.concatenate([np.ones(last - first - len(tail) // 2), tail[len(tail) // 2 :]])
