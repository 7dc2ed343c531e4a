"""What was found can be kept in a file and sent to another process, as multiprocessing and joblib do."""

import pickle

import numpy as np
import pytest

import gear_damping as gd

YAML = """
system: oscillator
records:
- file: decay.csv
  channels: {time: {column: t, unit: s}, displacement: {column: x, unit: m}}
"""
MODEL = gd.Model(gd.Oscillator(stiffness=400.0), [gd.ViscousDamping(damping_coefficient=2.0)])


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    folder, time = tmp_path_factory.mktemp("decay"), np.arange(200) / 100
    decay = np.exp(-time) * np.cos(20 * time) + 1e-3 * np.random.default_rng(1).normal(size=200)
    np.savetxt(folder / "decay.csv", np.c_[time, decay], delimiter=",", header="t,x", comments="")
    (folder / "measurement.yaml").write_text(YAML)
    return gd.load(folder / "measurement.yaml")


def again(found):
    return pickle.loads(pickle.dumps(found))


@pytest.mark.parametrize(
    "found",
    [
        lambda record: gd.identify(record),
        lambda record: gd.identify(record, MODEL, solver=gd.Solver(progress=lambda done, total: None)),
        lambda record: gd.damping(record, ["log_decrement"]),
    ],
    ids=["identified", "identified with a model", "damping"],
)
def test_a_fit_is_kept(record, found):
    one = found(record)
    other = again(one)
    assert (other.content, other.table()) == (one.content, one.table())
    other.plot()


def test_an_answer_is_kept_without_who_was_told(record, tmp_path):
    listener, solver = gd.Listener(lambda text: None), gd.Solver(progress=lambda done, total: None)
    one = gd.explain(record, minutes=0.02, listener=listener, solver=solver)
    other = again(one)
    assert (other.content, other.model) == (one.content, one.model)
    first, second = one.report(tmp_path / "first.html"), other.report(tmp_path / "second.html")
    assert first.read_text() == second.read_text()
