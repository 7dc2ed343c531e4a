"""A trained network in files: the checkpoint of its training, or safetensors beside JSON, which are for sharing.

Both hold numbers and names. Nothing in them is run: a name is looked up in the catalogue, and a network of one's own
needs its file named beside it.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import safetensors.torch
import torch

from gear_damping.errors import InputError, Problem, unread, written_whole
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.network_files import CHECKPOINT, DESCRIPTION, STEM, WEIGHTS, holds_network
from gear_damping.identification.sizes import refuse_other_shapes, refuse_window

FORMAT = "gear_damping.network"
VERSION = 1  # of the JSON; a reader refuses later ones
ARGUMENTS = ("estimator", "data", "settings", "wavelet", "learning_rate")  # of DampingModule, which a file may give
KEY = "checkpoint"
DECLARES = (".yaml", ".yml")  # ends of files in which people declare measurements and simulators
MOST_BYTES = 2**24  # of a JSON: ours hold a few thousand


def load_estimator(path: Path | str, plugins: Sequence[str] = ()) -> DampingModule:
    """The network of a checkpoint or of shared files, ready to predict on the CPU.

    Args:
        path: A checkpoint, `model.safetensors` or `model.json`, or the folder of either.
        plugins: The user's own estimator files.

    Raises:
        InputError: a file is missing or damaged, holds no estimator, or one that no file declares.
    """
    files = files_of(path)
    if len(files) == 1:
        return _from_checkpoint(files[0], plugins)
    return _from_shared(*files, plugins)


def files_of(path: Path | str) -> tuple[Path, ...]:
    """The files that a network is read from: a checkpoint, or description and weights.

    Raises:
        InputError: the path is a folder that holds neither.
    """
    path = Path(path)
    if path.is_dir():
        description = path / (STEM + DESCRIPTION)
        if not holds_network(path):
            remedy = f"give a folder with {STEM}{DESCRIPTION} and {STEM}{WEIGHTS}, or a checkpoint"
            raise InputError(Problem(KEY, "holds no network", str(path), remedy))
        path = description if description.exists() else path / CHECKPOINT
    if path.suffix in (WEIGHTS, DESCRIPTION):
        return path.with_suffix(DESCRIPTION), path.with_suffix(WEIGHTS)
    return (path,)


def description_of(module: DampingModule) -> dict[str, Any]:
    """What a network is, as plain values, without its weights."""
    named = {name: module.hparams[name] for name in ARGUMENTS if name != "learning_rate"}
    return {"format": FORMAT, "version": VERSION, **named}


def write_shared(module: DampingModule, folder: Path) -> tuple[Path, Path]:
    """Write `model.safetensors` and `model.json`, which tell together what a checkpoint tells of a prediction.

    Args:
        module: The network.
        folder: Made if missing.

    Returns:
        Description and weights.
    """
    folder.mkdir(parents=True, exist_ok=True)
    description, weights = (folder / (STEM + suffix) for suffix in (DESCRIPTION, WEIGHTS))
    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in module.state_dict().items()}
    content = safetensors.torch.save(tensors, {"format": "pt"})
    with written_whole(weights) as unfinished:
        unfinished.write_bytes(content)
    said = description_of(module) | {"weights_sha256": hashlib.sha256(content).hexdigest()}
    with written_whole(description) as unfinished:
        unfinished.write_text(json.dumps(said, indent=1) + "\n")
    return description, weights


def read_description(path: Path) -> dict[str, Any]:
    """The content of a JSON file that describes an estimator, whichever kind.

    Raises:
        InputError: it cannot be read, or is none.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            rule = f"is larger than {MOST_BYTES // 2**20} MiB, and no description is"
            raise InputError(Problem(KEY, rule, str(path), "give what `save` of an estimator wrote"))
        content = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(unread(error, path, KEY)) from error
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(KEY, f"is no JSON: {error}", str(path))) from error
    if not isinstance(content, dict):
        raise InputError(Problem(KEY, "describes no estimator", str(path), "give what `save` of an estimator wrote"))
    return content


def _from_checkpoint(path: Path, plugins: Sequence[str]) -> DampingModule:
    if path.suffix.lower() in DECLARES:
        rule, remedy = "declares something, and is no saved estimator", "give a best.ckpt, or what `save` wrote"
        raise InputError(Problem(KEY, rule, str(path), remedy))
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
        module = _restored(content["hyper_parameters"], content["state_dict"], plugins)
        module.on_load_checkpoint(content)
    except InputError:
        raise
    except Exception as error:  # a damaged file fails in as many ways as there are readers
        rule = f"must be a checkpoint of a trained estimator ({_said(error)})"
        raise InputError(Problem(KEY, rule, str(path), "give the best.ckpt of a training run")) from error
    return module


def _from_shared(description: Path, weights: Path, plugins: Sequence[str]) -> DampingModule:
    content = read_description(description)
    if content.get("format") != FORMAT or not isinstance(content.get("version"), int):
        rule = f"is no description of the format {FORMAT}"
        raise InputError(Problem(KEY, rule, str(description), f"give the {STEM}{DESCRIPTION} that a training left"))
    if content["version"] > VERSION:
        rule = f"is of version {content['version']} of its format, and this program reads up to {VERSION}"
        raise InputError(Problem(KEY, rule, str(description), "take a newer gear_damping"))
    try:
        held = weights.read_bytes()
    except OSError as error:
        rule, remedy = f"cannot be read: {error.strerror}", f"keep it beside {description.name}"
        raise InputError(Problem(KEY, rule, str(weights), remedy)) from error
    if hashlib.sha256(held).hexdigest() != content.get("weights_sha256"):
        rule = f"is damaged, or not the file that {description.name} describes: its SHA-256 is another"
        raise InputError(Problem(KEY, rule, str(weights), "take both files from one source, whole"))
    try:
        return _restored(content, safetensors.torch.load(held), plugins)
    except InputError:
        raise
    except Exception as error:  # a description can be wrong in many ways
        rule = f"does not describe the network of {weights.name} ({_said(error)})"
        raise InputError(Problem(KEY, rule, str(description), "take both files from one source, whole")) from error


def _restored(given: Mapping[str, Any], weights: Mapping[str, torch.Tensor], plugins: Sequence[str]) -> DampingModule:
    """The network of these arguments with these weights."""
    arguments = {name: given[name] for name in ARGUMENTS if name in given}
    _refuse_sizes(arguments, weights, plugins)
    with torch.random.fork_rng(devices=[]):  # a new network draws weights, which the file then replaces
        module = DampingModule(**arguments, plugins=tuple(plugins))
    module.load_state_dict(weights)
    return module.eval()


def _refuse_sizes(given: Mapping[str, Any], weights: Mapping[str, torch.Tensor], plugins: Sequence[str]) -> None:
    """Raise ValueError where the network of these arguments is another than the weights', or too large to predict."""
    try:
        with torch.device("meta"):  # takes no memory, whatever sizes are stated
            stated = DampingModule(**given, plugins=tuple(plugins))
    except (NotImplementedError, RuntimeError):  # of a network of one's own that looks at its numbers when it is made
        if not plugins:
            raise
        return
    refuse_window(stated.data["window"], stated.front_end.n_features)
    refuse_other_shapes(stated.state_dict(), weights)


def _said(error: Exception) -> str:
    """The error in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
