"""task=identify says when the linear oscillator is not what was measured."""

import json

import closed_forms
import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp
from scipy.signal import lfilter, lsim

import gear_damping as gd
from gear_damping.explanation.evidence.noise import noise_level
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.interface.lack_of_fit import lack_of_fit
from gear_damping.measurement.record import Channel
from gear_damping.tasks.command import main

RATE, OMEGA, DAMPING = 500.0, 40.0, 2.0
TIME = np.arange(1500) / RATE
LINEAR, _ = closed_forms.free_decay(TIME, 1.0, DAMPING, OMEGA**2, 1e-2, 0.0)


def hardening():
    def slope(_, state):
        return [state[1], -DAMPING * state[1] - OMEGA**2 * state[0] * (1 + 2e3 * state[0] ** 2)]

    return solve_ivp(slope, (0, TIME[-1]), [1e-2, 0], "DOP853", TIME, rtol=1e-10, atol=1e-14).y[0]


def identified(folder, response, noise, stated=""):
    """What was said and identification.json, for a decay in millimetres."""
    folder.mkdir(exist_ok=True)
    noisy = response + noise * np.random.default_rng(5).standard_normal(len(response))
    np.savetxt(folder / "decay.csv", np.column_stack([TIME, 1e3 * noisy]), "%.12g", ",", header="t,x", comments="")
    text = "system: oscillator\nrecords:\n- file: decay.csv\n  channels:\n    time: {column: t, unit: s}\n"
    text = text.replace("records:", f"parameters:\n  {stated}\nrecords:") if stated else text
    (folder / "measurement.yaml").write_text(text + "    displacement: {column: x, unit: mm}\n")
    path = folder / "measurement.yaml"
    place = [f"hydra.run.dir={folder / 'run'}", "progress=false"]
    assert main(["task=identify", f"measurement.path={path}", *place]) == 0
    return json.loads((folder / "run" / "identification.json").read_text())


@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_a_hardening_spring_is_no_linear_oscillator(noise, tmp_path, caplog, capsys):
    found = identified(tmp_path, hardening(), noise)
    said = caplog.text + capsys.readouterr().err
    assert found["lack_of_fit"]["significant"]
    assert found["lack_of_fit"]["residual"] == pytest.approx(found["residual"]["fit"]["rmse"])
    assert found["lack_of_fit"]["unit"] == "mm"
    if noise:
        assert found["lack_of_fit"]["noise"] == pytest.approx(1e3 * noise, rel=0.1)
    assert "lack of fit: the linear oscillator leaves" in said
    assert "lack of fit: " in (tmp_path / "run" / "identification.txt").read_text()
    assert f"task=explain measurement.path={tmp_path / 'measurement.yaml'}" in said


@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_a_linear_oscillator_is(noise, tmp_path, caplog, capsys):
    found = identified(tmp_path, LINEAR, noise)
    assert not found["lack_of_fit"]["significant"]
    assert "lack of fit" not in caplog.text + capsys.readouterr().err


@pytest.mark.parametrize(("late", "noise", "is_said"), [(0.5, 1e-5, True), (0.5, 2e-4, False), (0.0, 1e-5, False)])
def test_channels_that_are_half_a_sample_apart_leave_what_the_noise_does_not(late, noise, is_said, tmp_path):
    """Less of the variance than is called a lack of fit, and several times the noise: the intervals do not hold it."""
    time = np.arange(6000) / RATE
    push = lfilter([0.05], [1, -0.95], np.random.default_rng(3).standard_normal(time.size))

    halves = np.arange(2 * time.size) / (2 * RATE)  # exact between the samples of a push that is straight there
    linear = ([[0.0, 1.0], [-400.0, -DAMPING]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]])
    found = lsim(linear, np.interp(halves, time, push), halves)[1][round(2 * late) :: 2]
    found += noise * np.std(found) * 100 * np.random.default_rng(4).standard_normal(time.size)
    np.savez(tmp_path / "a.npz", t=time, u=push, x=found)
    channels = "{time: {column: t, unit: s}, force: {column: u, unit: N}, displacement: {column: x, unit: m}}"
    path = tmp_path / "measurement.yaml"
    path.write_text(f"system: oscillator\nrecords:\n- {{file: a.npz, channels: {channels}}}\n")
    fit = gd.identify(gd.load(path))
    assert ("times the noise of" in fit.table()) is is_said
    assert "lack of fit" not in fit.table()


@pytest.mark.parametrize(("cubic", "is_said"), [(8e5, True), (0.0, False)])
def test_what_a_decay_leaves_before_it_is_over_is_not_hidden_by_the_noise_behind_it(cubic, is_said, tmp_path):
    time = np.arange(4000) / RATE

    def rates(_, state):
        return [state[1], -2 * 0.031 * 45.87 * state[1] - 45.87**2 * state[0] - cubic * state[0] ** 3]

    swing = solve_ivp(rates, (0, 8), [5e-3, 0], "DOP853", time, rtol=1e-10, atol=1e-14).y[0]
    np.savez(tmp_path / "a.npz", t=time, x=swing + 4e-6 * np.random.default_rng(4).standard_normal(time.size))
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: m}}"
    path = tmp_path / "measurement.yaml"
    path.write_text(f"system: oscillator\nrecords:\n- {{file: a.npz, channels: {channels}}}\n")
    fit = gd.identify(gd.load(path))
    assert ("times the noise of" in fit.table()) is is_said
    assert "lack of fit" not in fit.table()


def test_what_goes_on_by_a_drive_that_no_channel_holds_is_no_decay(tmp_path, caplog, capsys):
    found = identified(tmp_path, 1e-2 * np.cos(OMEGA * TIME), 1e-4)
    said = caplog.text + capsys.readouterr().err
    assert found["undamped"].startswith("no damping: ")
    assert "declare the force, or a window behind its end" in said
    assert "no damping" in (tmp_path / "run" / "identification.txt").read_text()
    assert identified(tmp_path / "other", LINEAR, 1e-4)["undamped"] is None


def test_a_random_load_that_no_channel_holds_leaves_no_figure(tmp_path):
    """Ninety periods of 2.5 %: in segments, each of which begins as it likes, the damping comes out near zero."""
    ratio, load = DAMPING / 2 / OMEGA, np.random.default_rng(7).standard_normal(len(TIME))
    pole = np.exp((-ratio * OMEGA + 1j * OMEGA * np.sqrt(1 - ratio**2)) / 100.0)  # from sample to sample
    ambient = lfilter([0, 1.0], [1, -2 * pole.real, abs(pole) ** 2], load)
    found = identified(tmp_path, 1e-2 * ambient / ambient.std(), 1e-5)
    assert found["segment_s"]
    assert found["undamped"].startswith("no damping is told: the motion runs out of step with any ring-down")


def test_a_record_that_waits_for_its_release_is_told_to_be_cut(tmp_path, caplog, capsys):
    at_rest = np.concatenate([np.zeros(len(TIME) // 4), LINEAR[: len(TIME) - len(TIME) // 4]])
    found = identified(tmp_path, at_rest, 1e-5)
    begins = TIME[len(TIME) // 4]
    assert "the motion is not free from the start: leave out " in caplog.text + capsys.readouterr().err
    told = float(found["not_yet_free"].partition("before ")[2].partition(" s")[0])
    assert abs(told - begins) < 0.1 * begins
    assert identified(tmp_path / "other", LINEAR, 1e-5)["not_yet_free"] is None


@pytest.mark.parametrize(("stiffness", "is_said"), [(1700, True), (1601, False)])
def test_a_statement_that_the_records_contradict_is_told(tmp_path, caplog, capsys, stiffness, is_said):
    stated = f"stiffness: {{value: {stiffness}, unit: 1/s^2, uncertainty: 0.1 %}}"
    found = identified(tmp_path, LINEAR, 1e-4, stated)
    said = caplog.text + capsys.readouterr().err
    assert ("of its stated uncertainties away" in said) == is_said
    if is_said:
        assert found["contradicted"].startswith("stiffness lies ")
        away = float(found["contradicted"].split()[2])
        assert 0.9 * abs(np.log(1600 / 1700)) / 1e-3 < away <= 1.1 * abs(np.log(1600 / 1700)) / 1e-3


@pytest.mark.parametrize("noise", [2e-3, 5e-3])
def test_a_decay_below_its_noise_is_not_cut_into_segments(tmp_path, noise):
    """Most of the record's variance is noise, and none of it is left by losing step."""
    found = identified(tmp_path, LINEAR, noise)
    ratio, (low, high) = (found["damping_ratio_percent"][key] for key in ("value", "interval95"))
    assert found["segment_s"] is None
    assert low < 100 * DAMPING / (2 * OMEGA) < high
    assert high - low < 0.8 * ratio
    assert found["natural_frequency_hz"]["value"] == pytest.approx(OMEGA / (2 * np.pi), rel=0.01)


def lacking(predictions, fit, holdout, **more):
    channel = Channel("displacement", LINEAR, "m", **more)
    noise = noise_level([*fit, *holdout], {record.name: channel for record in (*fit, *holdout)})
    return lack_of_fit(predictions, fit, holdout, channel, noise)


def test_held_out_records_decide_where_there_are_some():
    fit, other = (FitRecord(name, torch.as_tensor(LINEAR.copy()), RATE) for name in ("fit", "other"))
    predictions = {"fit": fit.response, "other": 0.9 * other.response}
    assert not lacking(predictions, [fit], [])["significant"]
    found = lacking(predictions, [fit], [other])
    assert found["significant"]
    assert found["percent_of_signal"] == pytest.approx(10, rel=1e-2)


def test_a_declared_noise_is_what_the_residual_is_held_against():
    record = FitRecord("fit", torch.as_tensor(LINEAR.copy()), RATE)
    off = {"fit": record.response + 1e-4 * torch.sin(torch.arange(1500.0))}
    found = lacking(off, [record], [], noise=np.float64(1e-5))
    assert json.loads(json.dumps(found))["significant"]
    assert not lacking(off, [record], [], noise=1e-4)["significant"]


def test_a_record_too_short_for_its_noise_is_not_judged():
    record = FitRecord("fit", torch.as_tensor(LINEAR[:6].copy()), RATE)
    assert lacking({"fit": record.response}, [record], [], lowpass=1.0) is None


def test_a_noise_stated_a_hundred_times_too_large_is_said(tmp_path):
    noisy = LINEAR + 1e-5 * np.random.default_rng(5).standard_normal(len(LINEAR))
    np.savetxt(tmp_path / "decay.csv", np.column_stack([TIME, 1e3 * noisy]), "%.12g", ",", header="t,x", comments="")
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm, noise: 1 mm}}"
    path = tmp_path / "measurement.yaml"
    path.write_text(f"system: oscillator\nrecords:\n- {{file: decay.csv, channels: {channels}}}\n")
    assert "noise is stated as 1 mm, and the simulation follows" in gd.identify(gd.load(path)).table()
