"""Ricker transforms by other libraries, float32, the scales in samples as given."""

from collections.abc import Callable

import numpy as np

Run = Callable[[], np.ndarray]


def _signals(path: str) -> np.ndarray:
    return np.load(path)


def pywavelets(signals: str, scales: list[float], method: str) -> Run:
    import pywt

    values = _signals(signals)
    return lambda: pywt.cwt(values, scales, "mexh", method=method, axis=-1)[0].swapaxes(0, 1)[:2]


def ptwt(signals: str, scales: list[float]) -> Run:
    import ptwt as library
    import torch

    torch.set_num_threads(1)
    values = torch.as_tensor(_signals(signals))
    return lambda: library.cwt(values, np.asarray(scales), "mexh")[0].swapaxes(0, 1)[:2].numpy()


def ssqueezepy(signals: str, scales: list[float]) -> Run:
    """The real part of its complex Mexican hat; `nv` only keeps it from guessing the spacing of the scales."""
    import ssqueezepy as library

    values, chosen = _signals(signals), np.sort(np.asarray(scales, dtype="float32"))
    wavelet = library.Wavelet(("cmhat", {"mu": 0.0, "s": 1.0}), dtype="float32")

    def run() -> np.ndarray:
        found = library.cwt(values, wavelet, scales=chosen, l1_norm=False, nv=8, padtype="zero")[0]
        return found[:2, ::-1].real  # ours run from the longest scale to the shortest

    return run
