"""The LSTM on raw windows: our fit, a bare torch loop of the same network, and Keras."""

import tempfile
from collections.abc import Callable

import numpy as np

WINDOW, UNITS, DROPOUT, RUNS, SAMPLES = 30, 60, 0.2, 64, 2000
Run = Callable[[], None]


def records() -> tuple[np.ndarray, np.ndarray]:
    """Signals (run, time) and labels in %."""
    generator = np.random.default_rng(0)
    return generator.standard_normal((RUNS, SAMPLES), dtype="float32"), np.linspace(0.5, 5, RUNS, dtype="float32")


def _data(batch_size: int, windows: int):
    import torch

    from gear_damping.identification.datamodule import Material, WindowDataModule
    from gear_damping.identification.protocols import Protocol
    from gear_damping.identification.runs import RunSet

    torch.set_num_threads(1)
    signals, labels = (torch.as_tensor(a) for a in records())
    runs = RunSet(signals=signals, damping_ratio_percent=labels, sampling_rate=40e3, id="benchmark")
    protocol = Protocol("by_run", window=WINDOW, windows_per_epoch=windows)
    return WindowDataModule(Material(runs, protocol), batch_size=batch_size)


def validation_windows() -> int:
    """Windows that a fit of ours validates on once an epoch."""
    return len(_data(1, 1).split.validation)


def ours(batch_size: int, windows: int, epochs: int, validation: int) -> Run:
    """`fit_estimator` whole: files, validation and all."""
    from gear_damping.identification.lightning_module import RAW_LSTM
    from gear_damping.identification.trainer import Place, Shown, Training, fit_estimator

    data = _data(batch_size, windows)

    def run() -> None:
        with tempfile.TemporaryDirectory() as folder:
            training = Training(max_epochs=epochs, batch_size=batch_size)
            fit_estimator(RAW_LSTM, data, training, Place(folder), shown=Shown(progress=False))

    return run


def torch_bare(batch_size: int, windows: int, epochs: int, validation: int) -> Run:
    """The same network, windows, loss and optimiser, and the same validation, in a plain loop."""
    import torch

    from gear_damping.identification.lightning_module import RAW_LSTM
    from gear_damping.identification.untrained import build_estimator, fit_front_end

    data = _data(batch_size, windows)

    def run() -> None:
        module = build_estimator(RAW_LSTM, data, 1e-3)
        fit_front_end(module, data)
        source = data._source("train")
        optimiser = torch.optim.Adam(module.parameters(), lr=1e-3, fused=True)
        for _ in range(epochs):
            module.train()
            for chosen in torch.randperm(len(source.index))[:windows].split(batch_size):
                inputs, true = source.batch(chosen, None)
                loss = ((module(inputs) - true).square().mean() + 1e-12).sqrt()
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
            module.eval()
            with torch.no_grad():
                for inputs, true in data.val_dataloader():
                    (module(inputs) - true).square().sum()

    return run


def keras(batch_size: int, windows: int, epochs: int, validation: int) -> Run:
    """As in the paper's stack: materialised windows, model.fit."""
    import keras as library

    signals, labels = records()
    every = np.lib.stride_tricks.sliding_window_view(signals, WINDOW, axis=1)
    inputs = every.reshape(-1, WINDOW, 1)[: windows + validation].copy()
    true = np.repeat(labels, every.shape[1])[: windows + validation]
    model = library.Sequential(
        [library.layers.Input((WINDOW, 1)), library.layers.LSTM(UNITS), library.layers.Dropout(DROPOUT),
         library.layers.Dense(1)]
    )  # fmt: skip
    model.compile(optimizer="adam", loss="mse")

    def run() -> None:
        model.fit(
            inputs[:windows], true[:windows], batch_size=batch_size, epochs=epochs, verbose=0,
            validation_data=(inputs[windows:], true[windows:]), validation_batch_size=4096,
        )  # fmt: skip

    return run
