"""`gd.plan`: its words, table, content and pictures; what it refuses."""

import math
from pathlib import Path

import pytest

import gear_damping as gd
from gear_damping.identification.test_plan import checks
from gear_damping.interface import planned_page

RPM = math.pi / 30
SENSOR = gd.PlannedSensor("transmission_error", noise=1e-6)


def gears(*effects, **given):
    return gd.Model(gd.GearPair(**given), [gd.FourierMeshStiffness(), gd.PowerLawDamping(), *effects])


def made(**changed):
    given = {"durations": (0.02, 0.01), "sampling_rate": 20e3, "speeds": (1500 * RPM, 5500 * RPM),
             "torques": (100.0, 200.0), "settle": 0.02}  # fmt: skip
    return gd.PlannedTests(**(given | changed))


@pytest.fixture(scope="module")
def plan():
    sensors = [SENSOR, gd.PlannedSensor("encoder", noise=0.1, channel="gear_speed", cost=3)]
    goal = gd.PlanGoal(percent=1.0, most_tests=3, costs=gd.PlanCosts(1, 10, 2, 0.5))
    return gd.plan(gears(), made(), sensors, unknown=["fourier_mesh_stiffness.maximum"], goal=goal)


def test_every_test_is_there_with_each_sensor_and_with_all(plan):
    assert len(plan.tests) == 2 * 2 * 2 * 3
    content = plan.content["tests"]
    assert {tuple(one["sensors"]) for one in content} == {("transmission_error",), ("encoder",),
                                                          ("transmission_error", "encoder")}  # fmt: skip
    first = content[0]
    assert first["tests"] == [{"speed_rpm": pytest.approx(1500), "torque_nm": 100.0, "duration_s": 0.01}]
    assert first["cost"] == pytest.approx(1 + 10 * 0.01 + 2 + 0.5)
    assert content[1]["cost"] == pytest.approx(first["cost"] + 3)
    longer = content[3]
    assert longer["tests"][0]["duration_s"] == 0.02
    key = "half_interval95_percent_of_ratio"
    assert longer["exponent_known"][key] < first["exponent_known"][key] < first["exponent_unknown"][key]


def test_the_cheapest_set_reaches_what_is_wanted(plan):
    if plan.cheapest is not None:
        assert plan.cheapest.alone.percent <= 1.0
        assert plan.sentences[0].startswith("the cheapest set that knows the damping ratio within ± 1 % of it: ")
    assert plan.best.alone.percent == min(one.alone.percent for one in plan.front)
    assert plan.content["best"]["cost"] == plan.best.cost
    assert "every set of up to 3 tests was tried" in plan.sentences[1]
    assert "0.35 % of critical at a velocity amplitude of 0.577 m/s" in plan.sentences[2]
    assert "Plan of 24 tests" in repr(plan)


def test_what_cannot_be_reached_is_said():
    found = gd.plan(gears(), made(torques=()), [SENSOR], goal=gd.PlanGoal(percent=1e-6, most_tests=1))
    assert found.cheapest is None
    expected = "no single test knows the damping ratio within ± 1e-6 % of it; the best: "
    assert found.sentences[0].startswith(expected)


def test_tables_fit_a_terminal(plan):
    text = plan.table()
    assert max(map(len, text.splitlines())) <= 100
    assert sum("all" in line.split() for line in text.split("what more money")[0].splitlines()) == 8
    assert "2 of 24" in plan.table(2)
    assert "±" in text
    assert "n free" in text


def test_pictures(plan):
    assert plan.map.percent.shape == (len(plan.map.torques), len(plan.map.speeds))
    assert {1500.0, 5500.0} <= set((plan.map.speeds / RPM).round(6))
    shown = planned_page.picture(plan.found, plan.map, None).shown
    place = (list(plan.map.torques).index(100.0), 0)
    single = next(one for one in plan.tests if one.tests == ((0, 1),) and one.sensors == (0, 1))
    assert shown.percent[place] == pytest.approx(single.alone.percent, rel=1e-3)
    figure = plan.plot()
    assert figure.axes[0].get_xlabel() == "pinion speed / rpm"
    rig = gd.Model(gd.Oscillator(stiffness=1e4, amplitude=0.01), [gd.ViscousDamping(damping_coefficient=1.0)])
    decays = gd.PlannedTests((0.5, 1.0), 500.0, amplitudes=(0.01, 0.02))
    other = gd.plan(rig, decays, [gd.PlannedSensor("acceleration", snr_db=20)])
    assert other.map is None
    axes = other.plot().axes[0]
    assert axes.get_xlabel() == "length of the record / s"
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[:2] == ["0.01 m", "0.02 m"]
    curve = axes.lines[0].get_ydata()
    longest = next(one for one in other.tests if one.tests == ((0, 1),))
    assert curve[-1] == pytest.approx(longest.alone.percent, rel=1e-6)


REFUSED = {
    "no_axis_of_gears": (lambda: gd.plan(gears(), made(amplitudes=(1.0,)), [SENSOR]), "amplitudes.*a gear pair has"),
    "one number": (lambda: gd.plan(gears(), made(durations=0.1), [SENSOR]), "plan.durations.*must be a list.*[0.1]"),
    "twice": (lambda: gd.plan(gears(), made(torques=(1.0, 1.0)), [SENSOR]), "torques.*names one value twice"),
    "no_records": (lambda: gd.plan(gears(), made(durations=()), [SENSOR]), "durations: must be given"),
    "too_short": (lambda: gd.plan(gears(), made(durations=(1e-4,)), [SENSOR]), "must be 0.0008 s or more"),
    "no_sensor": (lambda: gd.plan(gears(), made(), []), "1 to 6 sensors"),
    "no_channel": (lambda: gd.plan(gears(), made(), [gd.PlannedSensor("pinion_sped", 1.0)]),
            "did you mean 'pinion_speed"),
    "no_noise": (lambda: gd.plan(gears(), made(), [gd.PlannedSensor("gear_speed")]), "one of noise and snr_db"),
    "noise_below_0": (lambda: gd.plan(gears(), made(), [gd.PlannedSensor("gear_speed", -1.0)]), "must be positive"),
    "unknown": (lambda: gd.plan(gears(), made(), [SENSOR], unknown=["inertia_gaer"]), "did you mean 'inertia_gear'"),
    "the_start": (lambda: gd.plan(gears(), made(), [SENSOR], unknown=["initial_velocity"]), "is always unknown"),
    "the_damping": (lambda: gd.plan(gears(), made(), [SENSOR], unknown=["power_law_damping.coefficient"]),
            "wants to know"),
    "the_exponent": (lambda: gd.plan(gears(), made(), [SENSOR], unknown=["power_law_damping.exponent"]),
            "plan.joint"),
    "set_anew": (lambda: gd.plan(gears(), made(), [SENSOR], unknown=["pinion_torque"]), "unknown_each"),
    "load_noise": (lambda: gd.plan(gears(gd.LoadNoise()), made(), [SENSOR]), "load_noise.*nobody knows"),
    "quantised": (lambda: gd.plan(gears(gd.SensorQuantisation(step=1e-6)), made(), [SENSOR]), "no slope"),
    "two_laws": (lambda: gd.plan(gears(gd.ViscousDamping()), made(), [SENSOR]), "the model has 2"),
    "no_such_law": (lambda: gd.plan(gears(), made(), [SENSOR], goal=gd.PlanGoal(law="viscous_damping")),
            "no damping law"),
    "no_exponent": (lambda: gd.plan(oscillator(), decays(), [gd.PlannedSensor("displacement", 1.0)],
                                    goal=gd.PlanGoal(joint=True)), "viscous_damping has none"),
    "known_exponent": (lambda: gd.plan(gears(), made(), [SENSOR], goal=gd.PlanGoal(exponent=0.1)), "plan.joint=true"),
    "no_speeds": (lambda: gd.plan(oscillator(), decays(speeds=(1.0,)), [gd.PlannedSensor("velocity", 1.0)]),
                  "speeds.*an oscillator has"),
    "no_turning": (lambda: gd.plan(oscillator(), decays(), [gd.PlannedSensor("velocity", 1.0)],
                                   goal=gd.PlanGoal(costs=gd.PlanCosts(per_speed=1.0))), "does not turn"),
    "no_motion": (lambda: gd.plan(oscillator(), decays(amplitudes=()), [gd.PlannedSensor("velocity", snr_db=9)]),
                  "stands still"),
}  # fmt: skip


def oscillator():
    return gd.Model(gd.Oscillator(stiffness=1e4), [gd.ViscousDamping(damping_coefficient=1.0)])


def decays(**changed):
    return gd.PlannedTests(**({"durations": (0.5,), "sampling_rate": 500.0, "amplitudes": (0.01,)} | changed))


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_planned_is_refused(name):
    ask, rule = REFUSED[name]
    with pytest.raises(gd.InputError, match=rule):
        ask()


def test_a_law_of_several_may_be_named():
    model = gears(gd.ViscousDamping(damping_coefficient=30.0))
    found = gd.plan(model, made(torques=(), speeds=()), [SENSOR], goal=gd.PlanGoal(law="viscous_damping"))
    assert found.content["rig"]["damping_law"] == "viscous_damping"


def test_irregular_motion_promises_nothing():
    """The flanks clatter about 2100 rpm at 75 N m: an error of the start has grown beyond all bounds in 0.1 s.

    At which of these speeds it does, the last bits of the processor decide.
    """
    model = gears(gd.Backlash(gap=1e-4), pinion_torque=75.0)
    speeds = tuple(speed * RPM for speed in (*range(1900, 2301, 50), 5500))
    clatter = made(durations=(0.1,), speeds=speeds, torques=(), settle=None, sampling_rate=40e3)
    found = gd.plan(model, clatter, [SENSOR])
    fine = found.found.survey.fine[:, 0].tolist()
    assert fine[-1]
    assert not all(fine)
    assert [test.alone.percent < math.inf for test in found.tests] == fine
    assert any(f"{fine.count(False)} of 10 tests diverge or move irregularly" in one for one in found.sentences)


def test_a_record_without_a_slope_is_told(monkeypatch):
    """Steps of a sensor have none; an effect of one's own that does the same is not known by its name."""
    monkeypatch.setattr(checks, "NOISY", ())
    rig = gd.Model(gd.Oscillator(stiffness=1e4, amplitude=0.01),
                   [gd.ViscousDamping(damping_coefficient=1.0), gd.SensorQuantisation(step=2e-8)])  # fmt: skip
    with pytest.raises(gd.InputError, match="no test tells anything"):
        gd.plan(rig, decays(), [gd.PlannedSensor("displacement", 1e-4)])


def test_a_wide_interval_is_said_to_promise_nothing():
    found = gd.plan(oscillator(), decays(durations=(0.1,)), [gd.PlannedSensor("displacement", 1e-3)])
    assert 50 < found.best.alone.percent < math.inf
    assert any("beyond ± 50 % some estimates run off" in one for one in found.sentences)


def test_the_example_of_the_page_runs():
    page = (Path(__file__).parents[2] / "docs" / "plan.md").read_text(encoding="utf-8")
    code = page.split("```python")[1].split("```")[0]
    told = {}
    exec(compile(code.replace("count=200", "count=4"), "plan.md", "exec"), told)
    assert told["found"].cheapest.alone.percent <= 3
