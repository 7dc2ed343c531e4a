"""What a GPU gains for transform and training, beside one core: `python -m benchmarks.gpu` where there is one.

Each place has a process of its own; a figure is the wall time of the median of three calls behind a first one.
"""

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import torch

from benchmarks.engines import own, training
from benchmarks.members import N_SAMPLES, SAMPLING_RATE
from gear_damping.signals.wavelets import RickerCWT

SIGNALS, SCALES, EPOCHS, WINDOWS, ROUNDS = 4096, 32, 3, 65536, 3


def main() -> None:
    """Both places in turn, as rows of a table; or one place, named by the argument."""
    if len(sys.argv) > 1:
        for work, batch, microseconds in _rows(sys.argv[1]):
            print(json.dumps([work, sys.argv[1], batch, f"{microseconds:.3g}"]), flush=True)
        return
    if not torch.cuda.is_available():
        raise SystemExit("this machine has no GPU that PyTorch sees")
    print(
        f"{torch.cuda.get_device_name()}, torch {torch.__version__}\n\n| item | place | batch | µs |\n|---|---|---|---|"
    )
    for place in ("gpu", "cpu"):
        hidden = {"CUDA_VISIBLE_DEVICES": ""} if place == "cpu" else {}
        command = [sys.executable, "-m", "benchmarks.gpu", place]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ | hidden) as process:
            for line in process.stdout:
                print("| " + " | ".join(map(str, json.loads(line))) + " |", flush=True)


def _rows(place: str) -> Iterator[tuple[str, int, float]]:
    wavelet = RickerCWT(SAMPLING_RATE, frequency_min_hz=200, frequency_max_hz=8000, n_scales=SCALES)
    signals = own.cwt_signals(SIGNALS, N_SAMPLES).to("cuda" if place == "gpu" else "cpu")
    millions = SIGNALS * N_SAMPLES * SCALES / 1e6
    yield "a million coefficients", SIGNALS, _seconds(place, lambda: wavelet(signals)) * 1e6 / millions
    for batch in (256, 4096):
        fit = training.ours(batch, WINDOWS, EPOCHS, 0)
        yield "a training window", batch, _seconds(place, fit) * 1e6 / (EPOCHS * WINDOWS)


def _seconds(place: str, run: Callable) -> float:
    times = []
    for _ in range(ROUNDS + 1):
        began = time.perf_counter()
        run()
        if place == "gpu":
            torch.cuda.synchronize()
        times.append(time.perf_counter() - began)
    return statistics.median(times[1:])


if __name__ == "__main__":
    main()
