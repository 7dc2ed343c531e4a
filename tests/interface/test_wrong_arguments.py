"""Mistakes in a user's own Python: the message names the argument, the rule and the remedy."""

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

import gear_damping as gd

YAML = """
system: oscillator
records:
- file: decay.csv
  channels: {time: {column: t, unit: s}, displacement: {column: x, unit: m}}
"""


@pytest.fixture
def record(tmp_path):
    time = np.arange(200) / 100
    decay = np.exp(-time) * np.cos(20 * time)
    np.savetxt(tmp_path / "decay.csv", np.c_[time, decay], delimiter=",", header="t,x", comments="")
    (tmp_path / "measurement.yaml").write_text(YAML)
    return gd.load(tmp_path / "measurement.yaml")


@pytest.mark.parametrize("ask", [gd.identify, gd.damping, gd.explain])
def test_a_path_in_the_place_of_a_measurement_is_answered(ask):
    with pytest.raises(gd.InputError, match=r"measurement = 'a\.yaml': .*; remedy: give what gd\.load"):
        ask("a.yaml")


def test_one_free_name_is_one_name(record):
    with pytest.raises(gd.InputError, match=r"free = \['damping_ratio'\]"):
        gd.identify(record, free="damping_ratio")


@pytest.mark.parametrize("minutes", ["1", 0, -2, True, float("nan")])
def test_minutes_are_a_positive_number(record, minutes):
    with pytest.raises(gd.InputError, match=r"minutes = .*: must be a positive number"):
        gd.explain(record, minutes=minutes)


def test_a_misspelt_argument_is_told_from_a_threshold(record):
    with pytest.raises(gd.InputError, match=r"minute: .* did you mean 'minutes'"):
        gd.explain(record, minute=1)


def test_a_file_of_data_is_no_declaration(record):
    data = record.source.parent / "decay.csv"
    with pytest.raises(gd.InputError, match=r"task=inspect measurement.path=.*decay.csv writes one") as caught:
        gd.load(data)
    assert len(str(caught.value)) < 1000


def test_a_long_value_is_cut_in_a_message(record):
    (record.source).write_text(f"system: {'x' * 5000}\nrecords: []\n")
    with pytest.raises(gd.InputError) as caught:
        gd.load(record.source)
    assert len(str(caught.value)) < 2000


def test_what_nothing_moves_is_said():
    """`amplitude` is the unit of length of the solver, and lets nothing go."""
    model = gd.Model(gd.Oscillator(stiffness=1e4, amplitude=0.01), [gd.ViscousDamping(damping_coefficient=1.0)])
    with pytest.warns(UserWarning, match=r"nothing moves: .* give initial_displacement, initial_velocity or a force"):
        runs = gd.simulate(model, sampling_rate=1e3, n_samples=200)
    with pytest.raises(gd.InputError, match=r"nothing moves: .* remedy: give initial_displacement"):
        gd.bound(runs, snr_db=30)
    with pytest.raises(gd.InputError, match=r"nothing moves: .* remedy: give initial_displacement"):
        gd.evaluate({"decrement": gd.estimator("log_decrement")}, runs, snr_db=[30])


def test_a_bare_system_is_no_model(record):
    with pytest.raises(gd.InputError, match=r"model = .*: is no model: .*; remedy: give a gd\.Model"):
        gd.identify(record, gd.Oscillator())


@pytest.fixture(scope="module")
def decays():
    law = gd.ViscousDamping(damping_coefficient=2)
    model = gd.Model(gd.Oscillator(stiffness=1e4, initial_displacement=0.01), [law])
    return gd.simulate(model, sampling_rate=1e3, n_samples=400)


def test_a_bound_is_of_one_level(decays):
    with pytest.raises(gd.InputError, match=r"snr_db = .*: is one level; remedy: ask once for each"):
        gd.bound(decays, snr_db=[30, 20])


def test_estimators_are_named_and_one_level_is_one(decays):
    ridge = gd.estimator("wavelet_ridge")
    with pytest.raises(gd.InputError, match=r"estimators = .*: must be named"):
        gd.evaluate([ridge], decays)
    assert list(gd.evaluate({"ridge": ridge}, decays, snr_db=30, bound=False).content["snr_db"]) == ["30"]


def test_one_sensor_and_one_unknown_are_one(decays):
    tests = gd.PlannedTests(durations=(0.5, 1.0), sampling_rate=1e3, amplitudes=(0.005,))
    sensor = gd.PlannedSensor("displacement", noise=1e-4)
    one = gd.plan(decays.model, tests, sensor, unknown="stiffness")
    assert one.content == gd.plan(decays.model, tests, [sensor], unknown=["stiffness"]).content


def test_runs_that_a_stiff_damping_lets_diverge_are_said_and_the_remedy_helps():
    model = gd.Model(gd.Oscillator(stiffness=1000.0), [gd.PowerLawDamping(coefficient=5000.0, exponent=2)])
    asked = {"sampling_rate": 100, "n_samples": 20, "initial_displacement": 0.05}
    with pytest.warns(UserWarning, match=r"1 of 1 runs diverged: .* give solver=gd.Solver\(substeps=...\)"):
        gd.simulate(model, **asked)
    found = gd.simulate(model, **asked, solver=gd.Solver(substeps=64)).displacement

    def rates(_, state):
        return state[1], -5000 * state[1] * abs(state[1]) - 1000 * state[0]

    times = np.arange(20) / 100
    true = solve_ivp(rates, (0, times[-1]), (0.05, 0.0), "Radau", times, rtol=1e-9, atol=1e-12).y
    np.testing.assert_allclose(found[0], true[0], rtol=1e-4)


MODEL = gd.Model(gd.Oscillator(stiffness=400), [gd.ViscousDamping(damping_coefficient=0.8)])
SAMPLED = {"sampling_rate": 200, "n_samples": 400}


@pytest.fixture(scope="module")
def runs():
    return gd.simulate(MODEL, **SAMPLED, initial_displacement=0.01)


@pytest.mark.parametrize("given", ["a.yaml", np.zeros(50), {"t": [1, 2]}])
def test_an_estimator_takes_a_measurement(given):
    with pytest.raises(gd.InputError, match=r"measurement = .*: must be a measurement; remedy: give what gd\.load"):
        gd.estimator("log_decrement").predict(given)


def test_a_force_as_arrays_come_drives_the_runs():
    force = np.sin(np.arange(400) / 10)
    read_only, forced = force.copy(), gd.simulate(MODEL, **SAMPLED, inputs={"force": force})
    read_only.flags.writeable = False
    backwards = force[::-1].copy()[::-1]
    grown = torch.tensor(force, requires_grad=True)
    for other in (read_only, backwards, grown, force.tolist()):
        again = gd.simulate(MODEL, **SAMPLED, inputs={"force": other})
        np.testing.assert_array_equal(again.displacement, forced.displacement)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"inputs": np.zeros(400)}, r"inputs: must say which series is which, .*\{'force': ARRAY\}"),
        ({"inputs": {"force": np.zeros(400, complex)}}, r"inputs\.force: must be real"),
        ({"inputs": {"force": ["a"] * 400}}, r"inputs\.force: must hold numbers"),
        ({"initial_displacement": [0.01, 0.02]}, r"initial_displacement: must be one number, and holds 2"),
        ({"initial_displacement": [0.01, 0.02], "batch": 3}, r"must be one number or 3, one for each run, and holds 2"),
        ({"initial_displacement": "1 cm"}, r"initial_displacement = '1 cm': must hold numbers alone; .* SI"),
        ({"initial_displacement": 1j}, r"initial_displacement = 1j: must be real"),
    ],
)
def test_what_no_run_can_begin_with_is_answered(given, said):
    with pytest.raises(gd.InputError, match=said):
        gd.simulate(MODEL, **SAMPLED, **given)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"free": ["damping_ratio", "damping_ratio"]}, r"free = \[.*\]: names one twice"),
        ({"free": "dampingratio"}, r"free = 'dampingratio': no such parameter"),
        ({"noise": [1e-4, 1e-4]}, r"noise: must be one number, and holds 2"),
        ({"noise": "0.1 mm"}, r"noise = '0\.1 mm': must hold numbers alone"),
        ({"samples": -5}, r"samples = -5: .*; remedy: leave it out"),
        ({"samples": 0}, r"samples = 0: must lie within"),
        ({"samples": 100.5}, r"^- samples = 100\.5: must be a whole number"),
        ({"samples": "100"}, r"^- samples = '100': must be a whole number"),
        ({"expected": [1]}, r"expected = '\[1\]': must say how well which parameter is known; .*\{'stiffness': 10"),
        ({"expected": {"stiffness": "a"}}, r"expected\.stiffness = \"'a'\": must be one number"),
        ({"noise": None, "snr_db": True}, r"snr_db = True: must be a number in dB; .* snr_db=30"),
        ({"noise": None, "snr_db": "30"}, r"snr_db = '30': must be a number in dB"),
        ({"noise": None, "snr_db": np.inf}, r"^- snr_db = inf: must be finite, in dB"),
        ({"noise": None, "snr_db": np.nan}, r"^- snr_db = nan: must be finite, in dB"),
    ],
)
def test_a_bound_of_what_has_none_is_answered(runs, given, said):
    with pytest.raises(gd.InputError, match=said):
        gd.bound(runs, **{"noise": 1e-4, **given})


@pytest.mark.parametrize(
    ("free", "said"),
    [
        (
            "gear_torque",
            r"free = 'gear_torque': has no effect where gear_torque_mode is balanced: .*; remedy: leave it",
        ),
        (["damping_ratio", "gear_phase"], r"^- free = 'gear_phase': does not act on the response.*; remedy: leave it"),
        (
            ["pinion_torque", "torque_gain"],
            r"free = 'torque_gain': has no bound in a run, .*; remedy: leave one of them",
        ),
    ],
)
def test_a_bound_of_what_the_response_does_not_tell_is_refused(free, said):
    """All of them came out as nan, those of the start beside them too."""
    pair = gd.Model(gd.GearPair(pinion_speed=300), [gd.FourierMeshStiffness(), gd.ViscousDamping()])
    with pytest.raises(gd.InputError, match=said):
        gd.bound(gd.simulate(pair, sampling_rate=4e4, n_samples=300), free, snr_db=30)


def test_what_is_known_beforehand_alone_has_a_bound_too():
    pair = gd.Model(gd.GearPair(pinion_speed=300), [gd.FourierMeshStiffness(), gd.ViscousDamping()])
    run = gd.simulate(pair, sampling_rate=4e4, n_samples=300)
    found = gd.bound(run, ["gear_phase", "damping_ratio"], snr_db=30, expected={"gear_phase": 0.2})
    assert found["gear_phase"] == pytest.approx(0.2)
    assert found["damping_ratio"] == pytest.approx(gd.bound(run, snr_db=30)["damping_ratio"], rel=1e-12)


def test_one_name_is_one_name_of_a_bound_too(runs):
    one, listed = (gd.bound(runs, free=free, noise=1e-4) for free in ("damping_ratio", ["damping_ratio"]))
    assert one["damping_ratio"] == listed["damping_ratio"]


def test_a_level_in_words_is_answered(runs):
    with pytest.raises(gd.InputError, match=r"snr_db: must hold numbers alone; .* dB"):
        gd.evaluate({"mine": gd.estimator("log_decrement")}, runs, snr_db="30 dB")


def test_one_effect_that_is_ruled_out_is_one_name(record):
    with pytest.raises(gd.InputError, match=r"ruled_out = 'backlsh': no such effect; .*backlash"):
        gd.explain(record, ruled_out="backlsh")


@pytest.mark.parametrize("size", ["1MB", 0, True])
def test_the_size_of_a_file_is_a_number_of_bytes(record, size):
    with pytest.raises(gd.InputError, match=r"max_bytes = .*: must be a positive number of bytes"):
        gd.load(record.source, max_bytes=size)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda record: gd.identify(record, solver="rk4"), r"solver = .*rk4.*must be a Solver; .*gd\.Solver"),
        (lambda record: gd.simulate(MODEL, **SAMPLED, solver=4), r"solver = .*4.*: must be a Solver"),
        (lambda record: gd.damping(record, laws={"a": 3}), r"laws: is no fitted simulation"),
        (
            lambda record: gd.identify(record, MODEL, free={"stiffness": 300}),
            r"free: holds names alone, .*\['stiffness'\]",
        ),
        (lambda record: gd.identify(record, MODEL, free=["stiffness", "stiffness"]), r"free = .*: names one twice"),
        (
            lambda record: gd.plan(MODEL, gd.PlannedTests([0.1], 1000.0), [], goal=5),
            r"goal = .*5.*: must be a PlanGoal",
        ),
    ],
)
def test_arguments_of_another_kind_are_answered(record, ask, said):
    with pytest.raises(gd.InputError, match=said):
        ask(record)


RIG = {"stiffness": 2103.8, "amplitude": 0.01}
SEEN = gd.PlannedSensor("displacement", noise=1e-4)


def planned(sensor=SEEN, goal=None, unknown=(), **tests):
    rig = gd.Model(gd.Oscillator(**RIG), [gd.ViscousDamping(damping_coefficient=1.835)])
    given = {"durations": [1.0, 2.0], "sampling_rate": 500, "amplitudes": (0.01,)} | tests
    return gd.plan(rig, gd.PlannedTests(**given), sensor, goal=goal, unknown=unknown)


@pytest.mark.parametrize(
    "said",
    [
        {"durations": np.array([1.0, 2.0]), "amplitudes": torch.tensor([0.01], dtype=torch.float64)},
        {"durations": ["1 s", "2000 ms"], "sampling_rate": "500 Hz", "settle": "0 s", "amplitudes": ["1 cm"]},
        {"sensor": gd.PlannedSensor("displacement", noise="0.1 mm")},
        {"goal": gd.PlanGoal(percent="10 %", repeats=np.int64(1))},
    ],
)
def test_a_plan_takes_arrays_and_quantities(said):
    assert planned(**said).content == planned(settle=0.0 if "settle" in said else None).content


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"sampling_rate": None}, "plan.sampling_rate = 'None': must be a number in Hz; remedy: for example 2 or"),
        ({"sampling_rate": 0}, "plan.sampling_rate = 0.0: must lie within"),
        ({"durations": "1 s"}, "plan.durations = 1.0: must be a list; remedy: write [1]"),
        ({"durations": None}, "plan.durations = 'None': must be a list"),
        ({"durations": ["3 kg"]}, "plan.durations[0] = 3.0: the unit 'kg' is not one of the kind of 's'"),
        ({"settle": "soon"}, "plan.settle = 'soon': must be a number in s"),
        ({"sensor": gd.PlannedSensor("displacement", noise=1e-4, cost="2 min")}, "cost = '2 min': must be a number"),
        ({"sensor": "displacement"}, "sensors = \"'displacement'\": must be a PlannedSensor"),
        ({"goal": gd.PlanGoal(percent=0.1, repeats=2.5)}, "plan.repeats = 2.5: must be a whole number"),
        ({"goal": gd.PlanGoal(costs=gd.PlanCosts(per_test="a"))}, "plan.cost.per_test = 'a': must be a number"),
        ({"unknown": 3}, "unknown = '3': must be a list"),
        ({"unknown": [3]}, "unknown = '3': must be an Unknown"),
        ({"sensor": gd.PlannedSensor("displacement", noise=1e-4, offset="no")},
         "plan.sensors.displacement.offset = 'no': must be True or False"),
        ({"sensor": gd.PlannedSensor("displacement", snr_db=float("nan"))},
         "plan.sensors.displacement.snr_db = nan: must be a finite level in dB"),
        ({"sensor": gd.PlannedSensor("displacement", snr_db=float("inf"))},
         "plan.sensors.displacement.snr_db = inf: must be a finite level in dB"),
        ({"goal": gd.PlanGoal(joint="no")}, "plan.joint = 'no': must be True or False"),
        ({"sensor": gd.PlannedSensor("displacement", snr_db=1000)},
         "plan.sensors.displacement.snr_db = 1000.0: must lie within -40 and 200"),
        ({"sensor": [SEEN, gd.PlannedSensor("displacement", noise=2e-4)]},
         "plan.sensors = 'displacement': names one twice; remedy: name each differently"),
        ({"sensor": gd.PlannedSensor(3, noise=1e-4, channel="displacement")}, "plan.sensors.name = 3: must be a name"),
        ({"goal": gd.PlanGoal(percent=float("inf"))}, "plan.wanted_percent = inf: must be a finite number"),
        ({"goal": gd.PlanGoal(percent=1e9)}, "plan.wanted_percent = 1000000000.0: must lie strictly between"),
        ({"goal": gd.PlanGoal(most_tests=10**9)}, "plan.most_tests = 1000000000: must lie within 1 and 100"),
        ({"goal": gd.PlanGoal(repeats=10**9)}, "plan.repeats = 1000000000: must lie within 1 and 100"),
        ({"goal": gd.PlanGoal(costs=gd.PlanCosts(per_second=1e300))},
         "plan.cost.per_second = 1e+300: must lie within 0 and 1e+12"),
        ({"unknown": gd.Unknown(3)}, "plan.unknown.name = 3: must be a name; remedy: for example 'stiffness'"),
        ({"unknown": "force_gain"},
         "plan.unknown = 'force_gain': has no effect: it scales a force, and none drives the tests of a plan"),
        ({"unknown": [gd.Unknown("stiffness", each=1)]}, "plan.unknown.stiffness.each = 1: must be True or False"),
    ],
)  # fmt: skip
def test_what_is_no_plan_is_answered(said, told):
    with pytest.raises(gd.InputError) as caught:
        planned(**said)
    assert told in str(caught.value)


@pytest.mark.parametrize("wrong", [{"count": "100"}, {"count": 2.5}, {"count": 20, "seed": "a"}, {"of": 3}])
def test_simulated_tests_are_counted(wrong):
    with pytest.raises(gd.InputError, match=f"{list(wrong)[-1]} = .*: must be a "):
        planned().simulated(**wrong)


@pytest.mark.parametrize(
    ("name", "value"),
    [("accuracy", "high"), ("accuracy", 0), ("substeps", 2.5), ("engine", "gpu"), ("chunk", 0), ("acceleration", 1)],
)
def test_settings_of_a_solver_are_checked(name, value):
    model = gd.Model(gd.Oscillator(**RIG), [gd.ViscousDamping()])
    with pytest.raises(gd.InputError, match=rf"solver\.{name} = .*: must "):
        gd.simulate(model, sampling_rate=500, n_samples=10, solver=gd.Solver(**{name: value}))


def test_numbers_of_numpy_are_numbers_of_a_solver():
    model, given = gd.Model(gd.Oscillator(**RIG), [gd.ViscousDamping(damping_coefficient=1.0)]), {"sampling_rate": 500}
    solver = gd.Solver(accuracy=np.float32(1e-4), chunk=np.int64(8))
    assert len(gd.simulate(model, n_samples=10, initial_displacement=0.01, solver=solver, **given)) == 1


def test_of_two_levels_of_noise_one_is_left_out():
    model = gd.Model(gd.Oscillator(**RIG), [gd.ViscousDamping(damping_coefficient=1.0)])
    runs = gd.simulate(model, sampling_rate=500, n_samples=200, initial_displacement=0.01)
    with pytest.raises(
        gd.InputError, match=r"noise = '1e-05': is given beside snr_db.*; remedy: leave out one of the two"
    ):
        gd.bound(runs, noise=1e-5, snr_db=30)


def test_a_declaration_is_no_estimator(record):
    with pytest.raises(
        gd.InputError, match=r"declares something, and is no saved estimator; remedy: give a best"
    ) as caught:
        gd.load_estimator(record.source)
    assert "Error" not in str(caught.value)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("range: ±50 mm", "write range: 50 mm, without a sign"),
        ("range: full", "say it in the unit of the channel or one of its kind, as range: 5 mm for one in mm"),
        ("noise: 1 %", "noise = '1 %': the unit '%' is not one of the kind of 'm'; remedy: it is in the unit of"),
    ],
)
def test_limits_of_a_channel_are_in_its_unit(record, said, told):
    record.source.write_text(YAML.replace("unit: m}", f"unit: m, {said}}}"))
    with pytest.raises(gd.InputError) as caught:
        gd.load(record.source)
    assert told in str(caught.value)


LAW = gd.ViscousDamping(damping_coefficient=0.8)
HELD = gd.Model(gd.Oscillator(stiffness=400, unit="mm"), [LAW])


@pytest.mark.parametrize(
    ("part", "name", "said"),
    [
        (
            HELD.system,
            "stiffness",
            r"oscillator\.stiffness = 9.0: cannot be set.* Oscillator\(stiffness=9, unit='mm'\)",
        ),
        (HELD.system, "stifness", r"oscillator\.stifness = 9.0: no such parameter.* did you mean 'stiffness'"),
        (HELD.system, "given", r"oscillator\.given = 9.0: no such parameter"),
        (LAW, "damping_coefficient", r"cannot be set: .*another one, ViscousDamping\(damping_coefficient=9\)"),
        (HELD, "effects", r"model\.effects = 9.0: cannot be set: .*another one with it: gd\.Model\("),
        (HELD, "stiffness", r"model\.stiffness = 9.0: cannot be set: "),
    ],
)
def test_what_is_made_is_fixed(part, name, said):
    """Else it would read as the new value, and every simulation went on with the old one."""
    with pytest.raises(gd.InputError, match=said):
        setattr(part, name, 9.0)


def test_a_law_of_ones_own_may_hold_what_it_makes():
    class Held(type(LAW)):
        def __init__(self):
            super().__init__(damping_coefficient=0.8)
            self.network = torch.zeros(1)

    own = Held()
    own.network = None
    with pytest.raises(gd.InputError, match="cannot be set"):
        own.damping_coefficient = 3


@pytest.mark.parametrize("channel", [0, "", ["displacement"]])
@pytest.mark.parametrize("ask", [gd.damping, lambda *a, **k: gd.estimator("log_decrement").predict(*a, **k)])
def test_a_channel_is_named(record, ask, channel):
    with pytest.raises(gd.InputError, match=r"channel = .*: must be a name; .* channel='displacement'"):
        ask(record, channel=channel)


TAKEN = {"log_decrement": gd.estimator("log_decrement")}


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda record: gd.identify(record, free=3), r"free = 3: must be names; .* free=\["),
        (lambda record: gd.identify(record, MODEL, free=[3]), r"free = 3: must be names"),
        (lambda record: gd.identify(record, log=3), r"log = 3: must be a function.* log=print"),
        (lambda record: gd.identify(record, progress="x"), r"progress = 'x': must be a function"),
        (lambda record: gd.explain(record, ruled_out=3), r"ruled_out = 3: must be names"),
        (lambda record: gd.explain(record, accepted_t="4"), r"accepted_t = '4': must be a number; .* accepted_t=3"),
        (
            lambda record: gd.explain(record, listener=print),
            r"listener = .*: must be a Listener; .*gd\.Listener\(print",
        ),
        (lambda record: gd.explain(record, listener=gd.Listener(3)), r"listener\.log = 3: must be a function"),
        (lambda record: gd.damping(record, laws=3), r"laws: must be named, .* laws=\{"),
        (lambda record: gd.damping(record, 3), r"estimators = 3: must be names"),
        (
            lambda record: gd.damping(record, {"log_decrement": 3}),
            r"estimators\.log_decrement = 3: must be settings by",
        ),
        (lambda record: gd.load_estimator(3), r"path = 3: must be a path; .* best\.ckpt"),
        (lambda record: gd.Model.from_config(None), r"node: must be a path; .*mapping"),
        (lambda record: MODEL.write(3), r"path = 3: must be a path"),
        (lambda record: gd.bound(record, snr_db=30), r"runs: must be a simulation, .*gd\.simulate"),
        (lambda record: gd.evaluate(TAKEN, record), r"runs: must be a simulation, .*gd\.simulate"),
        (lambda record: gd.simulate(MODEL, **SAMPLED, stiffness=None), r"stiffness: must hold numbers alone"),
        (lambda record: gd.simulate(MODEL, **SAMPLED, stiffness=np.nan), r"stiffness: must be finite, .*leave it out"),
    ],
)
def test_an_argument_of_a_wrong_type_is_named(record, ask, said):
    with pytest.raises(gd.InputError, match=said):
        ask(record)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"seed": "x"}, r"seed = 'x': must be a whole number"),
        ({"seed": -1}, r"seed = -1: must be at least 0"),
        ({"snr_db": np.nan}, r"snr_db = nan: must be levels in dB; .* snr_db=30"),
        ({"snr_db": []}, r"snr_db = \[\]: names no level"),
        ({"bound": "no"}, r"bound = 'no': must be True or False"),
        ({"bound": 1}, r"bound = 1: must be True or False"),
    ],
)
def test_noise_that_cannot_be_drawn_is_answered(runs, given, said):
    with pytest.raises(gd.InputError, match=said):
        gd.evaluate(TAKEN, runs, **given)


@pytest.mark.parametrize(
    "ask",
    [
        lambda path, record: gd.load(record.source, plugins=path),
        lambda path, record: gd.explain(record, plugins=path),
        lambda path, record: gd.damping(record, plugins=path),
        lambda path, record: gd.estimator("mine", plugins=path),
    ],
)
def test_one_path_of_a_plugin_is_one_path(record, ask):
    with pytest.raises(gd.InputError, match=r"plugins = 'mine\.py': no such file"):
        ask("mine.py", record)
    with pytest.raises(gd.InputError, match=r"plugins = 3: must be paths of Python files"):
        ask(3, record)


@pytest.mark.parametrize("number", [np.int64(8), np.float32(8), np.float64(8)])
def test_numbers_of_numpy_are_numbers(record, number):
    usual = gd.estimator("wavelet_ridge", omega0=8).predict(record)["decay"]
    found = gd.estimator("wavelet_ridge", omega0=number).predict(record)["decay"]
    assert found.damping_ratio_percent == usual.damping_ratio_percent
    found = gd.damping(record, {"wavelet_ridge": {"omega0": number}}).found["wavelet_ridge"]["decay"]
    assert found.damping_ratio_percent == usual.damping_ratio_percent
    with pytest.raises(gd.InputError, match=r"minutes = -8(\.0)?: must be a positive number"):
        gd.explain(record, minutes=-number)


def test_a_report_is_a_page(record, tmp_path):
    answer = gd.explain(record, minutes=0.001)
    with pytest.raises(gd.InputError, match=r"path = '.*a\.pdf': a report is an HTML file; remedy: write .*a\.html"):
        answer.report(tmp_path / "a.pdf")
    with pytest.raises(gd.InputError, match=r"path = 3: must be a path"):
        answer.report(3)
    assert answer.report(tmp_path / "a.html").is_file()


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_an_oscillator_is_told_per_unit_of_mass_as_it_is_identified(unit):
    model = gd.Model(gd.Oscillator(stiffness=400, unit=unit), [LAW, gd.CubicStiffness(coefficient=3.0)])
    lines = [line.strip() for line in str(model).splitlines()]
    assert {"stiffness = 400 1/s^2", "viscous_damping.damping_coefficient = 0.8 1/s"} < {*lines}
    assert f"cubic_stiffness.coefficient = 3 1/{unit}^2/s^2" in lines
    for ask in (lambda: gd.Oscillator(stiffness=-1, unit=unit), lambda: gd.simulate(model, **SAMPLED, stiffness=-1)):
        with pytest.raises(gd.InputError, match=r"stiffness = -1\.0: must lie within 0 … 1e\+18 1/s\^2"):
            ask()
    coefficient = {"viscous_damping.damping_coefficient": -1}
    with pytest.raises(gd.InputError, match=r"must lie within 0 … 1e\+12 1/s;"):
        gd.simulate(model, **SAMPLED, **coefficient)
    assert "pinion_torque = 9 N*m" in str(gd.Model(gd.GearPair(pinion_torque=9), [gd.FourierMeshStiffness()]))


@pytest.mark.parametrize("given", ["600", ["600"], [None]])
def test_a_text_is_no_number_though_it_looks_like_one(given):
    with pytest.raises(gd.InputError, match=r"stiffness.*: must hold numbers alone; remedy: give real numbers in SI"):
        gd.simulate(MODEL, **SAMPLED, stiffness=given)


def test_one_frequency_of_a_transform_is_one(runs):
    """It was a TypeError."""
    coefficients, frequencies = runs.cwt(frequencies_hz=4.0)
    assert coefficients.shape == (1, 1, SAMPLED["n_samples"])
    assert frequencies.tolist() == [4.0]
    np.testing.assert_array_equal(coefficients, runs.cwt(frequencies_hz=[4.0])[0])
    with pytest.raises(gd.InputError, match="frequencies_hz = '4 Hz': must hold numbers alone"):
        runs.cwt(frequencies_hz="4 Hz")


@pytest.mark.parametrize("seed", ["a", 1.5, None, -1, True])
def test_a_seed_of_the_noise_that_is_recorded_is_a_whole_number(seed, runs):
    """Text and fractions were errors of the generator, and -1 was taken."""
    with pytest.raises(gd.InputError, match=r"^- seed( = .*)?: must .*; remedy: "):
        runs.recorded(seed)
    assert runs.recorded(np.int64(3)).shape == runs.displacement.shape


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"channel": "vel"},
            r"^- channel = 'vel': the runs have no such channel; remedy: choose one of displacement, vel",
        ),
        ({"channel": 3}, r"^- channel = 3: the runs have no such channel"),
        ({"wavelet": 3}, r"^- wavelet = '3': is no wavelet; remedy: choose one of morlet, ricker, or give a class"),
        ({"wavelet": dict}, r"^- wavelet = .*: is no wavelet"),
    ],
)
def test_what_cannot_be_transformed_is_answered(given, said, runs):
    with pytest.raises(gd.InputError, match=said):
        runs.cwt(**given)


def test_what_is_told_of_the_progress_can_be_called():
    with pytest.raises(gd.InputError, match=r"solver\.progress = 3: must be a function"):
        gd.simulate(MODEL, **SAMPLED, solver=gd.Solver(progress=3))


def test_parameters_are_keyword_arguments():
    with pytest.raises(gd.InputError, match=r"^- parameters: is a mapping, .*keyword argument.*\*\*PARAMETERS"):
        gd.simulate(MODEL, **SAMPLED, parameters={"stiffness": 1e4})


def test_one_parameter_in_two_names_is_refused(record, runs):
    free = ["damping_ratio", "viscous_damping.damping_coefficient"]
    with pytest.raises(gd.InputError, match=r"free = \[.*\]: names one parameter twice"):
        gd.bound(runs, free, snr_db=30)
    with pytest.raises(gd.InputError, match=r"^- free = \[.*\]: names one parameter twice: damping_ratio stands for"):
        gd.identify(record, MODEL, free=free)


@pytest.mark.parametrize("run", [1, -1, 0.5, "0"])
def test_a_run_that_is_not_there_is_named(run, runs):
    """It was an IndexError of the tensor."""
    with pytest.raises(gd.InputError, match=r"run = .*must "):
        runs.plot(run=run)


def test_values_without_a_name_are_answered_with_the_names():
    with pytest.raises(gd.InputError, match=r"^- power_law_damping = 240: takes its values by name; .*coefficient=…"):
        gd.PowerLawDamping(240, 2)
