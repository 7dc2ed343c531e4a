"""WAV files, which vibration recorders write: samples are fractions of full scale."""

import warnings
from os import SEEK_CUR
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.io import wavfile

from gear_damping.measurement.formats.table import ArrayTable, Held, Table, unreadable

SUFFIXES = (".wav",)
_RIFF, _NAME, _TO_BITS = 12, 4, 14  # bytes: of the head of the file, of a chunk's name or size, before the bits


def read(path: Path, max_bytes: int) -> Table:
    """The channels of a WAV file by index, integers divided by full scale, with its sampling rate.

    Raises:
        InputError: not a readable WAV file.
    """
    with unreadable(path, "not a readable WAV file", "export uncompressed PCM or float"), warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # chunks of metadata that scipy skips
        rate, samples = wavfile.read(path)
        bits = _bits(path)
    scaled, note = _fractions(samples, bits)
    channels = np.atleast_2d(scaled.T)
    table = ArrayTable(path, [Held("", one.shape, lambda one=one: one) for one in channels if one.size])
    table.sampling_rate = float(rate)
    table.full_scale = 1.0 if samples.dtype.kind in "iu" or np.max(np.abs(samples), initial=0.0) <= 1.0 else None
    table.notes = (note,)
    return table


def _bits(path: Path) -> int:
    """The bits of a sample, as the header of a file that was read says them."""
    with path.open("rb") as file:
        order = "big" if file.read(_RIFF)[:4] == b"RIFX" else "little"
        while (name := file.read(_NAME)) != b"fmt ":
            size = int.from_bytes(file.read(_NAME), order)
            file.seek(size + size % 2, SEEK_CUR)  # chunks begin at even bytes
            if not name:
                raise ValueError("no format is stated")
        return int.from_bytes(file.read(_NAME + _TO_BITS + 2)[-2:], order)


def _fractions(samples: NDArray, bits: int) -> tuple[NDArray[np.float64], str]:
    """Integers become fractions of full scale; scipy hands 24 bits over in the upper bytes of 32.

    Args:
        samples: As scipy reads them.
        bits: Of a sample in the file.
    """
    values = samples.astype(np.float64)
    if samples.dtype.kind == "f":
        if np.max(np.abs(samples), initial=0.0) <= 1.0:
            return values, "WAV holds floating-point samples within ±1: with a `range` they are shares of it"
        return values, "WAV holds floating-point samples: taken as they are"
    scale = float(2 ** (8 * samples.dtype.itemsize - 1))
    if samples.dtype.kind == "u":  # 8-bit WAV counts from 0 to 255 with zero at 128
        values = values - scale
    said = f"WAV holds integers of {bits} bits: divided by {2 ** (bits - 1)}, so that full scale is 1"
    return values / scale, said
