"""Of several free decays whose roles nobody says whole ones are held out: the end of one shows no law that grows."""

import numpy as np
import pytest
import torch
import yaml
from scipy.integrate import solve_ivp

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects

TIME = np.arange(600) / 100.0
LAWS = {n: kind for n, kind in builtin_effects().items() if n.endswith(("stiffness", "damping", "friction"))}


def evidence(folder, sizes, role=None, force=False, decays=True):
    records, random = [], np.random.default_rng(2)
    for number, size in enumerate(sizes):
        swing = size * np.exp(-0.2 * TIME * decays) * np.cos(2 * np.pi * 2 * TIME) + 1e-3 * random.normal(
            size=TIME.size
        )
        np.savez(folder / f"{number}.npz", t=TIME, x=swing, f=np.sin(TIME))
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
        channels |= {"force": {"column": "f", "unit": "N"}} if force else {}
        records.append({"name": f"size {size}", "file": f"{number}.npz", "channels": channels})
    if role:
        records[0]["role"] = role
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return evidence_of(load_measurement(folder / "measurement.yaml"))


def test_one_of_middling_size_is_held_out_whole(tmp_path):
    found = evidence(tmp_path, (4.0, 1.0, 2.0))
    assert [record.name for record in found.holdout] == ["size 2.0"]
    found = evidence(tmp_path, (4.0, 1.0, 3.0, 2.0))
    assert [record.name for record in found.holdout] == ["size 2.0"]
    assert [record.name for record in found.fit] == ["size 4.0", "size 1.0", "size 3.0"]
    assert not found.one_record


@pytest.mark.parametrize("more", [{"sizes": (4.0, 1.0)}, {"sizes": (4.0, 1.0, 2.0), "force": True}])
def test_of_two_or_of_driven_ones_a_third_is_that_still_moves(tmp_path, more):
    """From where a third of the energy is still to come: the end of a decay shows no law that grows with it."""
    found = evidence(tmp_path, **more)
    assert len(found.holdout) == len(found.fit) == 2 * len(more["sizes"])
    for number, size in enumerate(more["sizes"]):
        parts = [one for pair in zip(found.fit, found.holdout, strict=True) for one in pair][4 * number :][:4]
        assert [part.name for part in parts] == [f"size {size} (part {k} of 4)" for k in (1, 2, 3, 4)]
        assert parts[0].record == parts[2].record == f"size {size}"  # which have one offset and one level
        pieces = torch.cat([part.response for part in parts])
        assert len(pieces) == len(TIME)
        early, late = parts[1].response, parts[3].response
        assert len(early) + len(late) == pytest.approx(len(TIME) / 3, abs=2)
        assert float(early.square().sum() / pieces.square().sum()) > 0.1  # all of the last third holds .005 of it


def test_of_a_motion_that_goes_on_the_end_is(tmp_path):
    found = evidence(tmp_path, (4.0, 1.0), force=True, decays=False)
    assert [record.name for record in found.holdout] == ["size 4.0 (part 2 of 2)", "size 1.0 (part 2 of 2)"]
    assert len(found.fit) == 2


@pytest.mark.parametrize(("slows", "parts"), [(0.0, ["(part 2 of 2)"]), (1.0, ["(part 2 of 4)", "(part 4 of 4)"])])
def test_of_a_place_that_no_spring_holds_the_rate_counts(tmp_path, slows, parts):
    """It goes on and on: about where it came to it would always have moved most at the beginning."""
    turned = np.where(slows, (1 - np.exp(-slows * TIME)) / max(slows, 1e-9), TIME)
    np.savez(tmp_path / "0.npz", t=TIME, x=turned + 1e-4 * np.random.default_rng(2).normal(size=TIME.size))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "rad"}}
    declared = {
        "system": "oscillator",
        "parameters": {"stiffness": 0},
        "records": [{"file": "0.npz", "channels": channels}],
    }
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    held = evidence_of(load_measurement(tmp_path / "measurement.yaml")).holdout
    assert [one.name.partition(" ")[2] for one in held] == parts


@pytest.mark.parametrize(
    ("name", "parameter", "size", "ratio"),
    [
        ("cubic_stiffness", "coefficient", 0.8, 0.031),  # 1/(mm² s²): it shows at the beginning,
        ("coulomb_friction", "force", 10.0, 0.008),  # mm/s²: and this at the end
        (None, None, 0.0, 0.031),
    ],
)
def test_of_one_decay_what_grows_and_what_lasts_is_named(name, parameter, size, ratio, tmp_path):
    """Over the end, .03 of 5 mm, the spring was `consistent`: nothing that takes more than 2.5 % of the variance."""
    time = np.arange(2000) / 250.0

    def rates(_, state):
        place, rate = state
        more = place**3 if name == "cubic_stiffness" else np.tanh(rate / 0.01)
        return [rate, -2 * ratio * 45.87 * rate - 45.87**2 * place - size * more]

    swing = solve_ivp(rates, (0, 8), [5.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-9).y[0]
    np.savez(tmp_path / "a.npz", t=time, x=swing + 0.004 * np.random.default_rng(4).normal(size=time.size))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
    declared = {"system": "oscillator", "records": [{"file": "a.npz", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    answer = explain(load_measurement(tmp_path / "measurement.yaml"), library=LAWS).content
    assert answer["verdict"] == ("explained" if name else "consistent")
    assert [cause["name"] for cause in answer["causes"]] == [name] * bool(name)
    for cause in answer["causes"]:  # in the file's millimetres
        low, high = cause["parameters"][parameter]["interval95"]
        assert low < size < high


def test_roles_that_are_said_count(tmp_path):
    found = evidence(tmp_path, (4.0, 1.0, 2.0), role="holdout")
    assert [record.name for record in found.holdout] == ["size 4.0"]
