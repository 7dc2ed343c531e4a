"""A network in files for sharing: it says what its checkpoint says, and files that are wrong end in one message."""

import hashlib
import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import torch

from gear_damping.errors import InputError
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.lightning_module import CWT_LSTM, DampingModule, EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import BY_RUN
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator, write_shared
from gear_damping.identification.untrained import build_estimator, fit_front_end

RICKER = {"kind": "ricker", "frequency_min_hz": 20.0, "frequency_max_hz": 240.0, "n_scales": 4}
CWT = replace(CWT_LSTM, settings={"hidden_size": 8}, wavelet=RICKER)
WHOLE = EstimatorConfig("record_cwt_lstm", {"hidden_size": 8})


def built(config):
    """A network with drawn weights and a fitted front end: what is shared knows nothing of how it was trained."""
    generator = torch.Generator().manual_seed(2)
    signals = 1e-5 * torch.randn(30, 400, generator=generator)
    runs = RunSet(signals, 1 + torch.rand(30, generator=generator), 40e3, "noise")
    protocol = BY_RUN.of_whole_records(400) if config is WHOLE else BY_RUN
    data = WindowDataModule(Material(runs, protocol, SensorNoise(None)), seed=1)
    module = build_estimator(config, data, 1e-3)
    fit_front_end(module, data)
    if config is WHOLE:
        module.network.calibrate(*torch.rand(3, 200, generator=generator))
    return module.eval(), signals[3]


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    with torch.random.fork_rng():
        torch.manual_seed(5)
        folder = tmp_path_factory.mktemp("shared")
        write_shared(built(CWT)[0], folder)
    return folder


@pytest.mark.parametrize("config", [CWT, WHOLE], ids=["windows", "records"])
def test_what_is_shared_says_what_was_saved_to_the_last_bit(config, tmp_path):
    module, record = built(config)
    write_shared(module, tmp_path)
    again = load_estimator(tmp_path)
    found, expected = again.predict_record(record, 40e3), module.predict_record(record, 40e3)
    assert torch.equal(found.per_window_percent, expected.per_window_percent)
    assert found[:2] + found[3:] == expected[:2] + expected[3:]
    assert (found.interval95 is not None) == (config is WHOLE)
    assert again.data == module.data
    assert not again.training


@pytest.mark.parametrize("name", ["", "model.json", "model.safetensors"])
def test_folder_and_either_file_are_the_same_network(name, shared):
    assert load_estimator(shared / name).hparams["estimator"] == "cwt_lstm"


def edited(content, **changes):
    return json.dumps(json.loads(content) | changes).encode()


def with_data(content, **changes):
    return edited(content, data=json.loads(content)["data"] | changes)


WRONG = {
    "cut weights": ("model.safetensors", lambda held: held[:-9], "SHA-256"),
    "no weights": ("model.safetensors", None, "cannot be read: No such file"),
    "cut description": ("model.json", lambda held: held[:40], "is no JSON"),
    "no description": ("model.json", None, "cannot be read: No such file"),
    "a list": ("model.json", lambda held: b"[1]", "describes no estimator"),
    "bytes": ("model.json", lambda held: b"\xff\xfe\x00", "is no JSON"),
    "deep": ("model.json", lambda held: b"[" * 100_000, "is no JSON"),
    "another format": ("model.json", lambda held: edited(held, format="other"), "is no description of the format"),
    "a later version": ("model.json", lambda held: edited(held, version=2), "reads up to 1"),
    "another size": ("model.json", lambda held: edited(held, settings={"hidden_size": 9}), "does not describe"),
    "more scales than memory": (
        "model.json",
        lambda held: edited(held, wavelet=RICKER | {"n_scales": 100_000}),
        "n_scales 100000 exceeds",
    ),
    "a list of scales": (
        "model.json",
        lambda held: edited(held, wavelet={"kind": "ricker", "frequencies_hz": [20.0] * 5000}),
        "frequencies_hz of 5000 scales exceeds 4096",
    ),
    "other scales": (
        "model.json",
        lambda held: edited(held, wavelet=RICKER | {"n_scales": 5}),
        "front_end.feature_mean is described as (5,), and is (4,) among the weights",
    ),
    "a long window": ("model.json", lambda held: with_data(held, window=10**9), "a window of 1000000000 samples"),
    "no window": ("model.json", lambda held: with_data(held, window="all"), "window must be a whole number"),
    "long components": (
        "model.json",
        lambda held: with_data(held, record=20_000, components=20_000),
        "components.basis is described as (20000, 20000)",
    ),
    "more units": (
        "model.json",
        lambda held: edited(held, settings={"hidden_size": 4096}),
        "dense.weight is described as",
    ),
    "more units than there may be": (
        "model.json",
        lambda held: edited(held, settings={"hidden_size": 10**6}),
        "must lie within 1 and 4096",
    ),
    "a long description": ("model.json", lambda held: held + b" " * 2**24, "is larger than 16 MiB"),
    "an unknown name": ("model.json", lambda held: edited(held, estimator="os.system"), "no such estimator"),
    "no data": ("model.json", lambda held: edited(held, data=None), "does not describe"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_files_end_in_one_message(case, shared, tmp_path):
    name, change, said = WRONG[case]
    for file in ("model.json", "model.safetensors"):
        shutil.copy(shared / file, tmp_path)
    held = (tmp_path / name).read_bytes()
    (tmp_path / name).unlink()
    if change:
        (tmp_path / name).write_bytes(change(held))
    with pytest.raises(InputError) as caught:
        load_estimator(tmp_path / "model.safetensors")
    (problem,) = caught.value.problems
    assert said in problem.rule
    assert "\n" not in str(problem)


def test_a_folder_without_a_network_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"holds no network.*model\.json and model\.safetensors"):
        load_estimator(tmp_path)


def test_weights_whose_bytes_are_no_safetensors_are_refused_also_where_the_digest_is_right(shared, tmp_path):
    held = b"\xff" * 64  # a header of 2^64 bytes
    (tmp_path / "model.safetensors").write_bytes(held)
    said = edited((shared / "model.json").read_bytes(), weights_sha256=hashlib.sha256(held).hexdigest())
    (tmp_path / "model.json").write_bytes(said)
    with pytest.raises(InputError, match="does not describe the network"):
        load_estimator(tmp_path)


def test_a_bank_of_wavelets_is_no_larger_than_memory(tmp_path):
    """It is no part of the weights, with which it could be compared."""
    write_shared(built(WHOLE)[0], tmp_path)
    held = (tmp_path / "model.json").read_bytes()
    (tmp_path / "model.json").write_bytes(edited(held, settings={"hidden_size": 8, "frame_ms": 1e6}))
    with pytest.raises(InputError, match=r"wavelets of 1e\+06 ms would take .* GiB, and 1 are allowed"):
        load_estimator(tmp_path)


@pytest.mark.parametrize("where", ["data", "wavelet"])
def test_a_checkpoint_is_held_to_the_same_sizes(where, tmp_path):
    module, _ = built(CWT)
    hyper = dict(module.hparams)
    hyper[where] = hyper[where] | {"data": {"window": 10**9}, "wavelet": {"n_scales": 100_000}}[where]
    torch.save({"hyper_parameters": hyper, "state_dict": module.state_dict(), "history": []}, tmp_path / "a.ckpt")
    with pytest.raises(InputError, match=r"GiB|exceeds 4096"):
        load_estimator(tmp_path / "a.ckpt")


class Opens:
    """What pickle would run."""

    def __reduce__(self):
        return Path.touch, (Path("was_here"),)


@pytest.mark.parametrize("where", ["hyper_parameters", "history"])
def test_a_checkpoint_runs_no_code(where, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    module, _ = built(CWT)
    content = {"hyper_parameters": dict(module.hparams), "state_dict": module.state_dict(), "history": []}
    torch.save({**content, where: Opens()}, "best.ckpt")
    with pytest.raises(InputError, match="must be a checkpoint"):
        load_estimator("best.ckpt")
    assert not Path("was_here").exists()


def test_a_checkpoint_names_no_function_that_makes_its_network(tmp_path):
    """Lightning imports what `_instantiator` names."""
    module, record = built(CWT)
    hyper = dict(module.hparams) | {"_instantiator": "gear_damping.no_such_module.run", "plugins": ["evil.py"]}
    torch.save({"hyper_parameters": hyper, "state_dict": module.state_dict(), "history": []}, tmp_path / "a.ckpt")
    assert load_estimator(tmp_path / "a.ckpt").predict_record(record, 40e3)[0] == module.predict_record(record, 40e3)[0]


@pytest.mark.parametrize(
    ("rate", "remedy"), [(25e3, "train at 25000 Hz"), (80e3, "resample the record to 40000 Hz, or train")]
)
def test_a_record_of_another_rate_is_told_what_can_be_done(rate, remedy):
    network = SimpleNamespace(data={"sampling_rate": 40e3, "window": 30})
    with pytest.raises(InputError, match=f"remedy: {remedy}"):
        DampingModule._check_record(network, torch.zeros(100), rate)
