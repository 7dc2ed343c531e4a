"""The Ricker wavelet transform beside other libraries."""

import tempfile
from pathlib import Path

import numpy as np

from benchmarks import reference
from benchmarks.engines import own
from benchmarks.harness import OWN, PEERS, Contestant, PeerError, Process, absent
from benchmarks.members import N_SAMPLES
from benchmarks.simulating import Log, contest

COMPARED = 2  # records that are compared with the defining sum


def cwt(batch: int, n_scales: int, rounds: int, log: Log) -> list[dict]:
    """Ricker coefficients of records of 2000 samples in float32; an item is a million coefficients."""
    items = batch * N_SAMPLES * n_scales / 1e6
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "signals.npy")
        np.save(path, own.cwt_signals(batch, N_SAMPLES).numpy())
        shape = {"batch": batch, "n_samples": N_SAMPLES, "n_scales": n_scales}
        peer = {"signals": path, "scales": own.scales(n_scales)}
        plans = [
            ("ours", OWN, "own", shape, "padded FFT, float32"),
            ("irfft", OWN, "own", shape, "inverse FFTs of that size alone"),
            ("pywavelets", PEERS, "cwt_peers", peer | {"method": "conv"}, "method conv, its default"),
            ("pywavelets", PEERS, "cwt_peers", peer | {"method": "fft"}, "method fft"),
            ("ptwt", PEERS, "cwt_peers", peer, ""),
            ("ssqueezepy", PEERS, "cwt_peers", peer, "one thread"),
        ]
        expected = direct_sum(np.load(path)[:COMPARED].astype(float), peer["scales"])
        return contest("cwt", batch, [_contestant(plan, items, expected, log) for plan in plans], rounds)


def _contestant(plan: tuple, items: float, expected: np.ndarray, log: Log) -> Contestant:
    name, python, module, options, setting = plan
    engine = "cwt" if name == "ours" else name
    about = {"setting": setting} if setting else {}
    try:
        process = Process(python, module, engine, options)
        process.run()
        if name == "irfft":
            return Contestant(name, process, items, about)
        _, result = process.result()
    except PeerError as problem:
        log(f"  {name}: left out ({problem})")
        return absent(name, problem)
    about["error_p90"] = transform_error(result, expected)
    log(f"  {name}: error {about['error_p90']:.1e}")
    return Contestant(name, process, items, about)


def transform_error(result: np.ndarray, expected: np.ndarray) -> float:
    """Relative error at the 90th percentile over rows (record, scale), a common factor left out.

    Libraries differ by a constant factor in how they normalise the wavelet.
    """
    scaled = result * (result * expected).sum() / (result * result).sum()
    rows = (np.reshape(a, (-1, a.shape[-1])) for a in (scaled, expected))
    return float(np.percentile(reference.errors(*rows), 90))


def direct_sum(signals: np.ndarray, scales: list[float]) -> np.ndarray:
    """The defining sum s^-1/2 sum_k x[k] psi((k - n) / s), (record, scale, time)."""
    count = signals.shape[1]
    lags = np.arange(-count + 1, count)
    rows_of = []
    for s in scales:
        t = lags / s
        psi = 2 / (np.sqrt(3) * np.pi**0.25) * (1 - t**2) * np.exp(-(t**2) / 2) / np.sqrt(s)
        rows_of.append([np.convolve(x, psi)[count - 1 : 2 * count - 1] for x in signals])
    return np.swapaxes(np.array(rows_of), 0, 1)
