"""task=plan from the command line to its files."""

import json

import pytest

from gear_damping.tasks.command import main

QUICK = ["task=plan", "simulator=oscillator", "family=none", "simulator.amplitude=0.01", "plan.amplitudes=[1cm,2cm]",
         "plan.durations=[0.5,1]", "plan.sensors.response.noise=0.2mm", "plan.unknown=[stiffness]", "progress=false",
         "simulator.viscous_damping.damping_coefficient=1.0"]  # fmt: skip


@pytest.fixture
def said(caplog, capsys):
    """What was said since."""
    caplog.set_level("INFO")
    return lambda: caplog.text + capsys.readouterr().err


def made(folder, *more):
    assert main([*QUICK, *more, f"hydra.run.dir={folder}"]) == 0
    return json.loads((folder / "plan.json").read_text())


def test_it_writes_table_values_and_picture(tmp_path, said):
    content = made(tmp_path / "run", "plan.wanted_percent=4", "plan.simulated_tests=40")
    text = (tmp_path / "run" / "plan.txt").read_text()
    assert max(map(len, text.split("\n\n\n")[0].splitlines())) <= 100
    assert content["cheapest"]["sensors"] == ["response"]
    assert content["rig"]["damping_ratio_percent"] == pytest.approx(0.5)
    half = content["cheapest"]["exponent_known"]["half_interval95_percent_of_ratio"]
    assert half <= 4
    assert content["simulated"]["count"] == 40
    promised = content["simulated"]["damping_ratio"]["promised"]
    assert promised == pytest.approx(half / 100 * 0.5 / 1.959964)
    for told in (text, said()):
        assert "the cheapest set that knows the damping ratio within ± 4 % of it" in told
        assert "40 simulated and fitted tests of it" in told
    assert (tmp_path / "run" / "plan_map.png").stat().st_size > 10_000
    run = json.loads((tmp_path / "run" / "run.json").read_text())
    assert run["status"] == "finished"
    assert run["metrics"] == {"reached": True, "percent": half, "cost": content["cheapest"]["cost"]}


def test_a_damping_ratio_that_is_asked_for_is_that_of_the_rig(tmp_path):
    more = [one for one in QUICK if "coefficient" not in one]
    folder = tmp_path / "run"
    assert main([*more, "simulator.damping_ratio_percent=2", f"hydra.run.dir={folder}"]) == 0
    content = json.loads((folder / "plan.json").read_text())
    assert content["rig"]["damping_ratio_percent"] == pytest.approx(2.0)


def test_what_cannot_be_reached_is_said(tmp_path, said):
    content = made(tmp_path / "run", "plan.wanted_percent=1e-4", "plan.most_tests=2")
    assert content["cheapest"] is None
    assert len(content["best"]["tests"]) == 2
    assert "no set of up to 2 tests knows the damping ratio within" in said()


def test_what_cannot_be_planned_ends_in_one_message(tmp_path, said):
    assert main([*QUICK, "plan.speeds_rpm=[100]", f"hydra.run.dir={tmp_path / 'run'}"]) != 0
    text = said()
    assert "plan.speeds" in text
    assert "is nothing that an oscillator has" in text
    assert "Traceback" not in text


@pytest.mark.parametrize("unit", ["mm", None])
def test_figures_of_a_rig_in_millimetres_are_no_metres(tmp_path, said, unit):
    """They were said as 50 m and 152 m/s; of a rig whose unit nobody knows, none is said."""
    path = tmp_path / "extended_simulator.yaml"
    path.write_text("system: oscillator\namplitude: 12.7\nstiffness: 142.5\nviscous_damping: {}\n"
                    + (f"unit: {unit}\n" if unit else ""))  # fmt: skip
    rig = ["simulator=oscillator", "family=none", f"simulator.extended={path}", "progress=false"]
    plan = ["task=plan", "plan.amplitudes=[10,50]", "plan.durations=[2]", "simulator.damping_ratio_percent=1"]
    assert main([*rig, *plan, f"hydra.run.dir={tmp_path / 'plan'}"]) == 0
    assert main([*rig, "task=simulate", "simulator.initial_displacement=20", "write_measurement=true",
                 f"hydra.run.dir={tmp_path / 'simulated'}"]) == 0  # fmt: skip
    told = said() + (tmp_path / "plan" / "plan.txt").read_text()
    assert " m/s" not in told
    assert "0 m," not in told
    assert ("0 mm, 2 s" in told) == ("velocity amplitude of 152 mm/s" in told) == (unit == "mm")
    content = json.loads((tmp_path / "plan" / "plan.json").read_text())
    amplitudes = [one["tests"][0]["amplitude"] for one in content["tests"]]
    assert (content["rig"]["unit"], amplitudes) == (unit, [10, 50])
    shown = json.loads((tmp_path / "simulated" / "simulation.json").read_text())
    assert (shown["unit"], shown["channels"]["velocity"]["unit"]) == ((unit, "mm/s") if unit else ("", ""))
    declared = (tmp_path / "simulated" / "measurement" / "measurement.yaml").read_text()
    assert f"unit: {unit or repr('1')}" in declared
    assert ("amplitude&nbsp;/&nbsp;mm" in (tmp_path / "plan" / "report.html").read_text()) == (unit == "mm")


@pytest.mark.parametrize(("start", "far"), [("1mm", True), ("1.2m", False)])
def test_a_start_far_from_the_stated_amplitude_is_said(tmp_path, said, start, far):
    """The ratio was that of the default amplitude of 1 m, and nothing said that the motion is a thousandth of it."""
    run = ["task=simulate", "simulator=oscillator", "family=none", f"simulator.initial_displacement={start}"]
    assert main([*run, "simulator.n_samples=100", "progress=false", f"hydra.run.dir={tmp_path / 'run'}"]) == 0
    assert ("that of simulator.amplitude, 1 m; the motion begins at 1 mm" in said()) == far


@pytest.mark.parametrize(("amplitude", "far"), [("0.015", False), ("1", True)])
def test_tests_far_from_the_stated_amplitude_are_said(tmp_path, said, amplitude, far):
    """`simulate` said it, and a plan with amplitudes of its own did not."""
    made(tmp_path / "run", f"simulator.amplitude={amplitude}")
    assert ("that of the rig's amplitude, 1 m; the tests begin at 0.01 m … 0.02 m, and a damping" in said()) == far
