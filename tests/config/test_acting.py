"""What was said and cannot act on the task that runs is refused; what acts, or says which rig it is, is not."""

import pytest

from gear_damping.config.acting import ACTS, idle_keys
from gear_damping.config.command_line import read_command_line
from gear_damping.config.keys import SCHEMA, TASKS
from gear_damping.config.source import Origin
from gear_damping.tasks.composed import problems_of

RECORD = "measurement=silverbox"
NEEDED = {
    "identify": [RECORD],
    "explain": [RECORD],
    "inspect": [RECORD],
    "evaluate": ["checkpoint=README.md"],
    "plan": ["experiment=plan"],
    "paper": ["experiment=paper_figures"],
}
OF_TRAINING = ("training.max_epochs=3", "training=paper", "protocol.window=20", "wavelet.n_scales=9", "seeds=2")
OF_A_DATA_SET = ("family.perturbation=0.2", "simulator.n_runs=9", "simulator.n_samples=900", "data_folder=outputs")
OF_ONE_TASK = (
    "explain.minutes=2", "ruled_out=[backlash]", "figures=[table_1]", "evaluation.known_model=true", "sweep=outputs",
    "resume=outputs", "write_measurement=true", "plan.joint=true",
)  # fmt: skip


def problems(task, *words):
    typed = read_command_line([f"task={task}", *NEEDED.get(task, ()), *words])
    assert not typed.problems
    return problems_of(typed.overrides)


IDLE = [
    *(("identify", word, "task=train") for word in OF_TRAINING),
    *(("explain", word, "it acts in task=train") for word in OF_TRAINING),
    *(("simulate", word, "it acts in task=train") for word in OF_TRAINING),
    *(("evaluate", word, "it acts in task=train") for word in OF_TRAINING),
    *(("collect", word, "it acts in task=train") for word in OF_TRAINING),
    *(("identify", word, "it acts in task=train, task=simulate, task=evaluate") for word in OF_A_DATA_SET),
    *(("explain", word, "it acts in task=train, task=simulate, task=evaluate") for word in OF_A_DATA_SET),
    *(("collect", word, "it acts in task=train, task=simulate, task=evaluate") for word in OF_A_DATA_SET),
    *(("inspect", word, "it acts in task=") for word in (*OF_TRAINING, *OF_A_DATA_SET, *OF_ONE_TASK)),
    *(("train", word, "it acts in task=") for word in OF_ONE_TASK if not word.startswith("resume")),
    *((task, "write_measurement=true", "it acts in task=simulate") for task in ("evaluate", "identify", "collect")),
    *((task, "checkpoint=README.md", "it acts in task=evaluate, task=identify") for task in ("simulate", "explain")),
    *((task, "checkpoint=nowhere", "it acts in task=evaluate, task=identify") for task in ("inspect", "collect")),
    *((task, "seed=3", "it acts in task=train") for task in ("identify", "explain", "inspect", "collect")),
    ("train", "checkpoint=README.md", "resume=FOLDER goes on with the interrupted training in that folder"),
    ("paper", "training.noise_snr_db=[1,30]", "it makes every effect, family and protocol itself"),
    ("evaluate", "training.noise_snr_db=[1,30]", "it acts in task=train;"),
    ("evaluate", "model.names=[raw_lstm]", "it acts in task=train, task=identify"),
    ("simulate", "model.hidden_size=9", "it acts in task=train, task=identify"),
    ("explain", "model=wavelet_ridge", "it acts in task=train, task=identify"),
    ("explain", "measurement.channel=force", "it acts in task=identify"),
    ("inspect", "measurement.channel=force", "it acts in task=identify"),
    ("simulate", "simulator.force_gain=2", "it acts in task=identify"),
    ("collect", "simulator.backlash.gap_um=5", "it acts in task=train"),
    ("identify", "simulator.backlash.gap_um=5", "give simulator.extended=…"),
    ("identify", "simulator.n_teeth_pinion=31", "give simulator.extended=…"),
    ("identify", "experiment=eccentricity", "nothing that it gives acts there, simulator.pinion_eccentricity"),
    ("explain", "experiment=eccentricity", "what is known of the rig is said under parameters there"),
    ("explain", "simulator.backlash.gap_um=5", "what is known of the rig is said under parameters there"),
    ("explain", "simulator.extended=nowhere.yaml", "task=identify fits it to records"),
    *((task, f"family={one}", "it acts in task=train, task=simulate, task=evaluate")
      for task in ("identify", "explain", "inspect") for one in ("paper", "field", "bench")),
    ("plan", "family=paper", "plan.speeds says how fast the tests run"),
    ("plan", "family=field", "plan.speeds says how fast the tests run"),
    *((task, "family=none", "it acts in task=train") for task in ("identify", "explain", "inspect")),
    ("inspect", "simulator=oscillator", "it acts in task=train"),
]  # fmt: skip


@pytest.mark.parametrize(("task", "word", "said"), IDLE)
def test_what_cannot_act_is_refused(task, word, said):
    own = ["simulator=oscillator", "family=none"] if word.startswith("simulator.force") else []
    found = [one for one in problems(task, *own, word) if f"has no effect in task={task}: " in one.rule]
    key, _, value = word.partition("=")
    assert [(one.key, one.value) for one in found] == [(key, value)]
    assert said in str(found[0])
    assert "; remedy: leave it out" in str(found[0])


ACTING = [
    ("simulate", ["experiment=limit", "simulator.n_runs=8", "write_measurement=true"]),
    ("simulate", ["training=smoke", "seed=3", "data_folder=outputs/data"]),
    ("simulate", ["write_measurement=false", "checkpoint=null", "measurement=none"]),
    ("evaluate", ["experiment=backlash", "family=field", "evaluation.snr_db=[30,10]", "training=smoke"]),
    ("evaluate", ["model.plugins=[docs/examples/my_estimator.py]"]),
    ("plan", ["family=paper", "plan.speeds_rpm=null", "seed=3", "simulator.damping_ratio_percent=0.3"]),
    ("plan", ["family=none", "seed=3", "simulator.damping_ratio_percent=0.3", "plan.joint=true"]),
    ("plan", ["simulator.pinion_torque=90", "plan.speeds_rpm=null", "simulator.pinion_speed_rpm=1234"]),
    ("plan", ["experiment=backlash"]),
    ("train", ["experiment=limit", "training.devices=2", "seeds=2"]),
    ("paper", ["training=smoke", "simulator.n_runs=12", "protocol.windows_per_epoch=64", "figures=[table_1]"]),
    ("identify", ["simulator=oscillator", "family=none", "simulator.solver.accuracy=1e-3", "progress=false"]),
    ("identify", ["experiment=baseline", "model=classical"]),
    ("identify", ["experiment=explain_ship_roll"]),
    ("identify", ["checkpoint=README.md", "model.plugins=[docs/examples/my_estimator.py]"]),
    ("explain", ["simulator=oscillator", "family=none", "simulator.plugins=[docs/examples/my_effect.py]"]),
    ("explain", ["explain.minutes=2", "ruled_out=[backlash]", "hydra.run.dir=outputs/there", "name=mine"]),
    ("inspect", ["name=mine", "hydra.run.dir=outputs/there", "measurement.plugins=[docs/examples/my_format.py]"]),
    ("collect", ["sweep=outputs", "progress=false"]),
]


@pytest.mark.parametrize(("task", "words"), ACTING)
def test_what_acts_is_taken(task, words):
    assert problems(task, *words) == []


def test_an_extended_rig_takes_what_comes_on_top_of_it_and_no_data_set(tmp_path):
    path = tmp_path / "extended.yaml"
    path.write_text("system: gear_pair\nfourier_mesh_stiffness: {}\npower_law_damping: {}\n")
    given = [f"simulator.extended={path}", "simulator.backlash.gap_um=5", "simulator.pinion_torque=100"]
    assert problems("identify", *given, "experiment=eccentricity", "model=classical") == []
    assert problems("identify", *given, "simulator.solver.accuracy=1e-4", "model=classical") == []
    assert problems("identify", *given, "family=field") == [], "the speed of the file counts, and not that of bench"
    (found,) = problems("identify", *given, "simulator.n_runs=3")
    assert found.key == "simulator.n_runs"
    assert "task=identify" not in found.rule.partition(": ")[2]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["measurement.channel=velocty"], "which takes every channel of a record"),
        (["model.hidden_size=9"], "and none is named"),
        (["model.hidden_size=9", "checkpoint=README.md"], "and none is named"),
        (["model.plugins=[docs/examples/my_estimator.py]"], "and none is named"),
    ],
)
def test_what_only_estimators_read_is_refused_where_none_is_asked(words, said):
    (found,) = problems("identify", *words)
    assert found.key == words[0].partition("=")[0]
    assert said in found.rule
    assert ("model=classical" in found.remedy) == (len(words) == 1)


@pytest.mark.parametrize("task", ["identify", "explain"])
def test_a_simulator_that_the_measurement_contradicts_is_refused(task, tmp_path):
    """What is measured says which rig is simulated, so that another one has no effect; a file on top has its own."""
    path = tmp_path / "measurement.yaml"
    channels = "{sampling_rate: 1 kHz, transmission_error: {column: x, unit: um}}"
    conditions = "{pinion_speed: 900 rpm, pinion_torque: 60 Nm}"
    record = f"{{file: a.csv, channels: {channels}, conditions: {conditions}}}"
    path.write_text(f"system: gear_pair\nrecords:\n  - {record}\n")
    file = f"measurement.path='{path}'"
    (found,) = problems(task, file, "simulator=oscillator", "family=none")
    assert (found.key, found.value) == ("simulator", "oscillator")
    assert "says system: gear_pair" in found.rule
    assert "leave it out" in found.remedy
    assert problems(task, file, "simulator=gear_pair") == problems(task, file) == []
    (found,) = problems(task, "simulator=gear_pair")
    assert "says system: oscillator" in found.rule


@pytest.mark.parametrize("word", ["model=classical", "model=output_error", "checkpoint=README.md"])
def test_the_solver_has_no_effect_on_estimators(word):
    (found,) = problems("identify", "simulator.solver.accuracy=1e-9", word)
    assert (found.key, found.value) == ("simulator.solver.accuracy", "1e-9")
    assert "has no effect: it acts on the fit of a simulation" in found.rule


@pytest.mark.parametrize("word", ["model=classical", "checkpoint=README.md"])
def test_estimators_are_asked_about_a_channel(word):
    assert problems("identify", "measurement.channel=displacement", word) == []


OSCILLATOR = ["simulator=oscillator", "family=none", "simulator.damping_ratio_percent=1"]


@pytest.mark.parametrize(
    ("words", "key", "by"),
    [
        (["experiment=plan", "simulator.pinion_speed_rpm=1234"], "simulator.pinion_speed_rpm", "plan.speeds"),
        (["experiment=plan", "simulator.pinion_speed=123"], "simulator.pinion_speed", "plan.speeds"),
        ([*OSCILLATOR, "plan.amplitudes=[1cm]", "simulator.initial_displacement=3"],
         "simulator.initial_displacement", "plan.amplitudes"),
    ],
)  # fmt: skip
def test_what_the_tests_of_a_plan_set_is_refused_beside_them(words, key, by):
    typed = read_command_line(["task=plan", *words])
    (found,) = problems_of(typed.overrides)
    assert found.key == key
    assert str(found).startswith(f"{key} = '{found.value}': has no effect beside {by}: every test has one of these")
    assert "; remedy: leave one of them out" in str(found)


@pytest.mark.parametrize("key", ["simulator.stiffness", "simulator.stifness"])
def test_of_a_key_that_cannot_act_no_other_name_is_offered(key):
    (found,) = problems("identify", f"{key}=300")
    assert "did you mean" not in str(found)
    assert "has no effect in task=identify: the fit is one of the nominal rig" in found.rule


class OwnExperiment(Origin):
    """Where values come from with an experiment of one's own."""

    def given_by(self, group):
        return {"task": "identify", "name": "mine", "training.max_epochs": 3, "measurement.path": "a.yaml"}


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ((), ["training.max_epochs"]),
        (("++training.max_epochs=4",), ["training.max_epochs"]),
        (("++task=identify",), []),
        (("++task=collect",), ["experiment"]),
    ],
)
def test_an_experiment_is_held_to_its_task_and_with_another_one_typed_has_to_give_something(typed, said):
    task = typed[0].partition("=")[2] if typed and "task" in typed[0] else "identify"
    found = list(idle_keys({"task": task}, OwnExperiment(typed, {"experiment": "mine"})))
    assert [key for key, *_ in found] == said


def test_every_key_and_task_of_the_table_exists():
    assert {task for tasks in ACTS.values() for task in tasks} == set(TASKS)
    known = {*SCHEMA, "simulator", "family", "model", "wavelet", "plan"}
    assert {key.split(".")[0] for key in ACTS} == known - {"task", "name", "progress"}
