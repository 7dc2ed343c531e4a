"""What a task needs of the values that it reads, and which of them act beside the others."""

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import torch

from gear_damping.config.acting import ACTS, OFF, Found
from gear_damping.config.folders import RESUMABLE, read_record, resumable
from gear_damping.config.light import no_file
from gear_damping.config.shown import going_on
from gear_damping.config.whole import Whole
from gear_damping.identification.network_files import holds_network
from gear_damping.physics.terms import HeldLoad
from gear_damping.simulation.prior import DAMPING_RATIO

# Keys that decide what a network is and learns from, and those below them that do not.
OF_ITS_RUNS = ("simulator", "family", "seed", "protocol", "wavelet", "model")
NOT_OF_ITS_RUNS = ("protocol.windows_per_epoch", "protocol.evaluation_stride", "model.names", "model.plugins")
MOST_SAID = 3  # keys of a message: more of them are another experiment


def _checkpoint(whole: Whole) -> Found:
    path = whole["checkpoint"] if whole["task"] in ACTS["checkpoint"] else None
    many = whole["task"] == "evaluate" and path is not None and any(Path(path).glob("*/seed_*/best.ckpt"))
    if path is not None and not many and not (Path(path).is_file() or holds_network(Path(path))):
        rule = "is a folder that holds no network" if Path(path).is_dir() else no_file(Path(path))
        yield "checkpoint", rule, path, "give the path of a best.ckpt, or of a folder with model.json"
    if whole["task"] == "evaluate" and path is None:
        yield "checkpoint", "task=evaluate needs a trained estimator", None, "checkpoint=…/best.ckpt"


def _estimators(whole: Whole) -> Found:
    """Networks are trained and then asked by their checkpoint; estimators of records need neither."""
    task, names = whole["task"], whole["model"]["names"]
    of_records = () if whole.models is None else whole.models.of_records
    if of_records and task == "train":
        rule = f"{', '.join(of_records)} has nothing to learn: it takes a record by itself, in task=identify"
        yield "model.names", rule, names, "choose task=identify, or name networks only"
    elif of_records and whole["checkpoint"] is not None:
        rule = f"is of a network, and model names {', '.join(of_records)}"
        yield "checkpoint", rule, whole["checkpoint"], "leave one of them out"
    elif task == "identify" and whole["checkpoint"] is None and set(names) - set(of_records):
        is_asked = of_records or any(key in ("model", "model.names") for key, _ in whole.origin.typed())
        rule = "names a network, which tells nothing before it is trained"
        remedy = "give its checkpoint=…/best.ckpt, or choose model=classical"
        yield from [("model.names", rule, names, remedy)] if is_asked else []


def _of_estimators(whole: Whole) -> Found:
    """What only estimators read, where task=identify asks none: it fits every record through all channels."""
    if whole["task"] != "identify" or whole.models is None or whole.models.of_records:
        return
    is_fit = whole["checkpoint"] is None
    kept = ("model.names",) if is_fit else ("model.names", "model.plugins")
    for key, value in whole.origin.typed():
        if key == "measurement.channel" and is_fit and value != OFF[key]:
            rule = "has no effect on a fit, which takes every channel of a record: estimators are asked about one"
            yield key, rule, value, "leave it out, or add model=classical or checkpoint=…"
        elif key.startswith("model.") and key not in kept:
            rule = "has no effect: it acts on estimators that take a record by themselves, and none is named"
            yield key, rule, value, "leave it out, or choose model=classical" if is_fit else "leave it out"


def _solver_of_a_fit(whole: Whole) -> Found:
    """The solver of a fit, where neither estimators of records nor a network simulate with its settings."""
    asked = (whole.models is not None and whole.models.of_records) or whole["checkpoint"] is not None
    if whole["task"] != "identify" or not asked or whole.simulator.extended is not None:
        return
    for key, value in whole.origin.typed():
        if key.startswith("simulator.solver"):
            rule = "has no effect: it acts on the fit of a simulation, and estimators take a record by themselves"
            yield key, rule, value, "leave it out, or leave out model and checkpoint, and the simulation is fitted"


def _wavelet_of_networks(whole: Whole) -> Found:
    """The transform is one of networks that say so: the others have their own, or none."""
    models = whole.models
    if models is None or models.transforming:
        return
    for key, value in whole.origin.typed() if models.whole else ():
        if key == "wavelet" or key.startswith("wavelet."):
            rule = "acts on networks of the transform, and none is named"
            yield key, rule, value, "leave it out, or name cwt_lstm"


def _whole_records(whole: Whole) -> Found:
    """Networks of whole records know no windows, and no cut inside a record."""
    names = whole.models.whole if whole.models is not None and whole["task"] == "train" else ()
    if names and whole["protocol"]["name"] != "by_run":
        rule = f"cuts inside records, and {', '.join(names)} sees whole ones"
        yield "protocol.name", rule, whole["protocol"]["name"], "choose protocol=by_run"
    for key, value in whole.origin.typed() if names and len(names) == len(whole.models.names) else ():
        if key in ("protocol.window", "protocol.stride", "protocol.evaluation_stride"):
            yield key, f"acts on networks of windows, and {', '.join(names)} sees whole records", value, "leave it out"


def _evaluated(whole: Whole) -> Found:
    """What an evaluation needs of the runs."""
    if whole["task"] == "evaluate" and DAMPING_RATIO not in whole.simulator.family.distributions:
        rule = "has no range of damping ratios, beside which an estimate could be good"
        yield "family", rule, whole.simulator.family.name, "choose family=bench, field or paper"
    drawn = [effect.name for effect in whole.simulator.model.effects if isinstance(effect, HeldLoad)]
    if whole["task"] == "evaluate" and whole["evaluation"]["known_model"] and drawn:
        rule = f"{', '.join(drawn)} is drawn, and no estimator knows it"
        yield "evaluation.known_model", rule, True, "leave it out"
    if whole["task"] == "evaluate" and whole["evaluation"]["snr_db"] and whole.simulator.sensor_noise_db is not None:
        rule = "takes the place of simulator.sensor_noise, and both are given"
        yield "evaluation.snr_db", rule, whole["evaluation"]["snr_db"], "leave one of them out"


def _devices(whole: Whole) -> Found:
    """Processes of one training stand on a GPU each, or all on cores."""
    count, asked = torch.cuda.device_count(), whole["training"]["devices"]
    if 0 < count < asked:
        yield "training.devices", f"exceeds the GPUs of this machine, {count}", asked, f"training.devices={count}"


def _noise_twice(whole: Whole) -> Found:
    """The noise of training records is drawn, or is that of the simulated sensor."""
    drawn = whole["training"]["noise_snr_db"]
    if drawn is not None and whole["task"] == "train" and whole.simulator.sensor_noise_db is not None:
        rule = "takes the place of simulator.sensor_noise, and both are given"
        yield "training.noise_snr_db", rule, drawn, "leave one of them out"


def _resume(whole: Whole) -> Found:
    path, task = whole["resume"], whole["task"]
    if path is not None and task in RESUMABLE and not resumable(task, Path(path)):
        what, kind = ("finished part", "study") if task == "paper" else ("checkpoint", "training")
        yield "resume", f"holds no {what} to go on from", path, f"give the folder of an interrupted {kind}"
    elif path is not None and task == "train":
        yield from _resumed_otherwise(whole, path)


def _resumed_otherwise(whole: Whole, path: str) -> Found:
    """A training goes on with the runs, the windows and the networks that it began with."""
    record = _begun(Path(path))
    if record is None:  # of a folder that was copied in part: its checkpoints say the rest
        return
    begun, command = record
    ours = json.loads(json.dumps(whole.config, default=str))
    found = [one for key in OF_ITS_RUNS for one in _differing(key, begun.get(key), ours.get(key))]
    if not found:
        return
    said = ", ".join(f"{key} = {was} (here {now})" for key, was, now in found[:MOST_SAID])
    rule = f"was begun with {said}{' and others' if len(found) > MOST_SAID else ''}"
    yield "resume", rule, path, f"repeat its command: {going_on(command, Path(path))}"


def _begun(folder: Path) -> tuple[Mapping[str, Any], str] | None:
    """The configuration and the command of a run; None where its run.json does not say them."""
    record = read_record(folder) or {}
    config, command = record.get("config"), record.get("command")
    return (config, command) if isinstance(config, Mapping) and isinstance(command, str) else None


def _differing(key: str, was: Any, now: Any) -> Iterator[tuple[str, Any, Any]]:
    """Each key below this one that has another value; of keys of one side alone an effect, for versions know others."""
    if isinstance(was, Mapping) and isinstance(now, Mapping):
        for name in {**was, **now}:
            if (name in was and name in now) or isinstance(was.get(name, now.get(name)), Mapping):
                yield from _differing(f"{key}.{name}", was.get(name), now.get(name))
    elif was != now and key not in NOT_OF_ITS_RUNS:
        yield key, was, now


BY_TASK: tuple[tuple[tuple[str, ...], Callable[[Whole], Found]], ...] = (
    (("task", "checkpoint"), _checkpoint),
    (("task", "checkpoint", "model"), _estimators),
    (("task", "checkpoint", "model", "measurement"), _of_estimators),
    (("task", "checkpoint", "model", "simulator"), _solver_of_a_fit),
    (("model", "wavelet"), _wavelet_of_networks),
    (("task", "model", "protocol"), _whole_records),
    (("task", "evaluation", "simulator", "family"), _evaluated),
    (("task", "training", "simulator"), _noise_twice),
    (("training",), _devices),
    (("task", "resume"), _resume),
)
