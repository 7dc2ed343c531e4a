"""Training of the LSTM beside a bare torch loop and Keras."""

from benchmarks.engines.training import validation_windows
from benchmarks.harness import OWN, PEERS, Contestant, PeerError, Process, absent, interleave, rows
from benchmarks.simulating import Log

FEW, MANY = 1, 4  # epochs: what the further ones cost is measured, start-up left out


def train(batch: int, windows: int, rounds: int, log: Log) -> list[dict]:
    """Training windows of the LSTM, with the same validation once an epoch; an item is a training window."""
    options = {"batch_size": batch, "windows": windows, "validation": validation_windows()}
    shorts, longs = [], []
    for name, python in (("ours", OWN), ("torch_bare", OWN), ("keras", PEERS)):
        try:
            pair = [_started(name, python, options | {"epochs": epochs}, windows) for epochs in (FEW, MANY)]
        except PeerError as problem:
            log(f"  {name}: left out ({problem})")
            pair = [absent(name, problem), absent(name, problem)]
        shorts.append(pair[0])
        longs.append(pair[1])
    interleave([c for pair in zip(shorts, longs, strict=True) for c in pair], rounds)
    for short, long in zip(shorts, longs, strict=True):
        long.times = [
            {kind: many[kind] - few[kind] for kind in ("cpu", "wall")}
            for few, many in zip(short.times, long.times, strict=False)
        ]
        long.about |= {"reason": short.about["reason"]} if "reason" in short.about else {}
        short.close()
        long.close()
    return rows("train", batch, longs)


def _started(name: str, python: object, options: dict, windows: int) -> Contestant:
    process = Process(python, "training", name, options)
    process.run()
    about = {"setting": f"{windows} windows an epoch"}
    return Contestant(name, process, windows * (MANY - FEW), about)
