"""A drive that turns one way: its constant force is told, and that friction and a load are the same in it."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import yaml
from scipy.signal import cont2discrete, lfilter

import gear_damping as gd
from gear_damping.explanation.answer import acting

RATE, GAIN, DAMPING, LOAD = 500.0, 7.0, 4.8, 9.0


def speed(torque, load):
    """Of a' = gain * torque - load - damping * v from rest, by scipy's exact hold."""
    top, bottom, _ = cont2discrete(([1.0], [1.0, DAMPING]), 1 / RATE, method="zoh")
    return lfilter(top[0], bottom, GAIN * torque - load)


@pytest.fixture(params=["one way", pytest.param("both ways", marks=pytest.mark.slow)])
def said(request, tmp_path):
    """The sentences of a drive under a steady load, and whether it turns one way."""
    one_way, records = request.param == "one way", []
    for number, held in enumerate((1.9, 2.4, 3.1, 2.7)):
        random = np.random.default_rng(number)
        torque = np.full(1500, held) + 0.3 * np.repeat(random.normal(size=15), 100)
        torque = torque if one_way else torque * np.repeat([1, -1, 1], 500)
        v = speed(torque, LOAD) + 0.002 * random.normal(size=1500)
        name = f"run_{number}.csv"
        np.savetxt(tmp_path / name, np.column_stack([torque, v]), "%.9g", ",", header="T,v", comments="")
        channels = {"sampling_rate": f"{RATE:g} Hz", "velocity": {"column": "v", "unit": "rad/s"}}
        channels["force"] = {"column": "T", "unit": "N*m", "hold": True}
        role = "holdout" if number == 3 else "fit"
        records.append({"name": name[:-4], "file": name, "role": role, "channels": channels})
    declared = {"system": "oscillator", "parameters": {"stiffness": "0 1/s^2"}, "records": records}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    return one_way, gd.explain(gd.load(tmp_path / "measurement.yaml"))


def test_a_constant_force_of_motion_one_way_is_a_load_or_friction(said):
    one_way, answer = said
    assert answer.verdict == "consistent"
    load = answer.content["parameters"]["offset_force.force"]
    assert load["interval95"][0] < -LOAD < load["interval95"][1]
    told = [one for one in answer.content["sentences"] if one.startswith("A constant force of")]
    assert len(told) == one_way
    assert all("1.29 of the measured force" in one and "dry friction and a steady load" in one for one in told)
    assert re.search(r"The viscous damping is 4\.(79|80)\d* 1/s", str(answer))


def test_a_force_that_nothing_shows_is_said(tmp_path):
    """A free decay beside the noise of a force sensor that nothing pushes on."""
    time, random = np.arange(2000) / RATE, np.random.default_rng(11)
    records = []
    for number in range(3):
        swing = np.exp(-0.4 * time) * np.cos(2 * np.pi * 8 * time + number) + 0.003 * random.normal(size=time.size)
        name = f"run_{number}.csv"
        columns = np.column_stack([0.1 * random.normal(size=time.size), swing])
        np.savetxt(tmp_path / name, columns, "%.9g", ",", header="F,x", comments="")
        channels = {"sampling_rate": f"{RATE:g} Hz", "displacement": {"column": "x", "unit": "mm"}}
        channels["force"] = {"column": "F", "unit": "N"}
        records.append({"file": name, "role": "holdout" if number == 2 else "fit", "channels": channels})
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    answer = gd.explain(gd.load(tmp_path / "measurement.yaml"))
    assert answer.verdict == "consistent"
    said = [one for one in answer.content["sentences"] if one.startswith("What moved does not show the measured force")]
    assert len(said) == 1


@pytest.mark.parametrize(
    ("rates", "is_one_way"),
    [([[1.0, 2.0], [3.0, 1.0]], True), ([[1.0, 2.0], [-3.0, -1.0]], False), ([[-2.0, 0.01], [-1.0, -3.0]], True)],
)
def test_segments_go_one_way_together(rates, is_one_way):
    """A motor on a triangle of speed turned one way in each of its segments: it was said to turn one way."""
    motions = [torch.tensor([[0.0, 0.0], rate]) for rate in rates]
    problem = SimpleNamespace(motion=lambda *_: motions)
    outcome = SimpleNamespace(problem=problem, fitted=SimpleNamespace(shared=None, states=None))
    assert acting._is_one_way(outcome) is is_one_way
