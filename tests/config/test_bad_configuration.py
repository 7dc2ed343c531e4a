"""Whatever is wrong is named with its key, value, rule, remedy and place, all of it at once."""

import pytest

from gear_damping.config.command_line import read_command_line
from gear_damping.tasks.command import main
from gear_damping.tasks.composed import problems_of

FAULTS = {
    "unknown_effect": (["simulator.backlsh.gap=1"], ["simulator.backlsh", "did you mean 'backlash'"]),
    "unknown_parameter": (["simulator.backlash.gab=1"], ["simulator.backlash.gab", "did you mean 'gap'"]),
    "below_its_bound": (
        ["simulator.backlash.gap=-1"],
        ["simulator.backlash.gap = -1", "within 0", "nearest valid value 0"],
    ),
    "wrong_unit": (["simulator.backlash.gap={value:1,unit:kg}"], ["simulator.backlash.gap", "'kg'", "'m'"]),
    "unknown_unit": (["simulator.backlash.gap={value:1,unit:furlong}"], ["simulator.backlash.gap", "furlong"]),
    "text_for_a_number": (["simulator.pinion_speed_rpm=fast"], ["pinion_speed_rpm = 'fast'", "finite number in rpm"]),
    "not_finite": (["simulator.pinion_torque=.nan"], ["simulator.pinion_torque", "finite"]),
    "given_twice": (["simulator.pinion_speed=400", "simulator.pinion_speed_rpm=9"], ["pinion_speed", "given twice"]),
    "list_for_a_number": (["simulator.pinion_torque=[1,2]"], ["simulator.pinion_torque = [1, 2]"]),
    "number_for_a_list": (["simulator.profile_error.amplitudes=1"], ["profile_error.amplitudes", "list of numbers"]),
    "unknown_option": (["simulator.backlash.as_printed=maybe"], ["backlash.as_printed", "True"]),
    "effect_as_number": (["simulator.backlash=3"], ["simulator.backlash = 3", "null (off)"]),
    "two_meshes": (
        ["simulator.rectangular_mesh_stiffness={}"],
        ["there are 2 mesh stiffnesses", "add simulator.fourier_mesh_stiffness=null"],
    ),
    "effect_of_the_other_system": (["simulator.sine_restoring={}"], ["sine_restoring", "oscillator"]),
    "law_is_off": (["simulator.damping_law=viscous_damping"], ["damping_law", "power_law_damping"]),
    "solver_key": (["simulator.solver.acuracy=1"], ["simulator.solver.acuracy", "did you mean 'accuracy'"]),
    "solver_engine": (["simulator.solver.engine=fast"], ["simulator.solver.engine", "auto, native, eager"]),
    "missing_plugin": (["simulator.plugins=[nope.py]"], ["simulator.plugins", "nope.py", "no such file"]),
    "unknown_choice": (["experiment=backlsh"], ["experiment = 'backlsh'", "did you mean 'backlash'"]),
    "blank_in_a_path": (
        ["measurement.path=my", "data.csv"],
        ["data.csv: is not an override", '"measurement.path=my data.csv'],
    ),
    "a_file_for_a_path": (
        ["task=inspect", "conf/config.yaml"],
        ["conf/config.yaml: is not an override", "write measurement.path=conf/config.yaml"],
    ),
    "data_for_a_path": (["task=inspect", "data=a.csv"], ["data: no such key", "write measurement.path=FILE"]),
    "unknown_key": (["sed=3"], ["sed: no such key", "did you mean 'seed'"]),
    "key_of_no_group": (["explain.ruled_out=[backlash]"], ["explain.ruled_out", "did you mean 'ruled_out', which"]),
    "key_of_no_group_in_a_model": (["model.checkpoint=a"], ["model.checkpoint", "did you mean 'checkpoint', which"]),
    "key_of_no_group_in_a_simulator": (["simulator.seed=3"], ["simulator.seed", "did you mean 'seed', which"]),
    "key_of_no_group_in_a_plan": (["experiment=plan", "plan.seed=3"], ["plan.seed", "did you mean 'seed', which"]),
    "list_in_the_unit_of_its_key": (
        ["experiment=plan", "plan.speeds_rpm=3000"],
        ["plan.speeds_rpm = 3000", "must be a list of numbers in rpm", "write [3000]"],
    ),
    "unknown_plus_key": (["+foo=3"], ["foo: no such key", "command line: foo=3"]),
    "no_override": (["backlash"], ["backlash: is not an override"]),
    "of_another_task": (["task=simulate", "explain.accepted_t=4"], ["explain.accepted_t", "acts in task=explain"]),
    "decided_by_the_study": (
        ["experiment=paper_figures", "protocol=by_run"],
        ["protocol = 'by_run'", "has no effect in task=paper: it makes every effect, family and protocol itself"],
    ),
    "effect_of_the_study": (["experiment=paper_figures", "simulator.backlash.gap=1e-4"], ["simulator.backlash.gap"]),
    "figures_of_another_task": (["figures=[figure_07]"], ["figures", "no effect in task=train: it acts in task=paper"]),
    "no_such_figure": (["experiment=paper_figures", "figures=[figure_16]"], ["figures", "figure_15"]),
    "nothing_of_a_study": (["experiment=paper_figures", "resume=tests"], ["resume = 'tests'", "no finished part"]),
    "outside_a_search": (["task=explain", "explain.level=2"], ["explain.level = 2", "within 0.0001 and 0.5"]),
    "wrong_task": (["task=fly"], ["task = 'fly'", "identify"]),
    "whole_number": (["training.batch_size=2.5"], ["training.batch_size = 2.5", "whole number"]),
    "positive": (["training.learning_rate=0"], ["training.learning_rate", "just above 0"]),
    "group_as_value": (["++training=5"], ["training = '5'", "no such choice"]),
    "window_longer_than_runs": (["protocol.window=5000"], ["protocol.window = 5000", "2000"]),
    "above_nyquist": (["wavelet.frequency_max_hz=30000"], ["wavelet.frequency_max_hz", "20000"]),
    "order_of_frequencies": (["wavelet.frequency_min_hz=20000"], ["wavelet.frequency_min_hz", "below"]),
    "ratio_needs_by_run": (
        ["experiment=damping_ratio", "protocol=paper"],
        ["simulator.damping_ratio_percent", "protocol=by_run", "conf/experiment/damping_ratio.yaml"],
    ),
    "no_measurement": (["task=identify"], ["measurement.path", "needs a measurement", "conf/measurement/none.yaml"]),
    "no_checkpoint": (["task=evaluate"], ["checkpoint", "best.ckpt"]),
    "missing_checkpoint": (["task=evaluate", "checkpoint=nope.ckpt"], ["checkpoint = 'nope.ckpt'", "no such file"]),
    "spread_of_nothing": (["family.spreads.xx={uniform:[1,2]}"], ["family.spreads.xx", "no such parameter"]),
    "spread_upside_down": (["family.spreads.pinion_torque={factor:[2,1]}"], ["pinion_torque", "swap them"]),
    "spread_of_odd_form": (["family.spreads.pinion_torque=3"], ["pinion_torque", "uniform"]),
    "endless_key": (["a" * 5000 + "=3"], ["a" * 40 + "…", "a key of 5000 letters", "--help"]),
    "broken_override": (["simulator.pinion_torque=[1"], ["simulator.pinion_torque=[1", "close every bracket"]),
    "several_values_without_multirun": (["seed=1,2"], ["seed = '1,2'", "add --multirun"]),
    "deletion_of_a_number": (["~model=1e-3"], ["configuration", "deletion value must be a string", "--help"]),
    "folder_too_long": ([f"hydra.run.dir={'a' * 5000}"], ["hydra.run.dir", "cannot be made: File name too long"]),
    "unknown_flag": (["--multirn"], ["--multirn: no such flag", "--multirun"]),
    "no_family": (["family=null"], ["family = 'null'", "no such choice"]),
    "drawn_by_the_family": (
        ["experiment=noise", "family.spreads.module={uniform:[1,2],unit:mm}", "simulator.module=0.003"],
        ["simulator.module = 0.003", "the family draws it"],
    ),
    "decided_by_the_ratio": (
        ["simulator.power_law_damping.coefficient=5"],
        ["simulator.power_law_damping.coefficient = 5", "the damping ratio decides it"],
    ),
    "nothing_to_resume": (["resume=tests"], ["resume = 'tests'", "no checkpoint"]),
    "folder_as_checkpoint": (["task=evaluate", "checkpoint=tests"], ["checkpoint = 'tests'", "is a folder"]),
    "folder_as_measurement": (
        ["task=explain", "measurement.path=tests"],
        ["measurement.path = 'tests'", "is a folder", "(from command line: measurement.path=tests)"],
    ),
    "file_as_data_folder": (
        ["task=simulate", "data_folder=README.md"],
        ["data_folder = 'README.md'", "cannot be made", "(from command line: data_folder=README.md)"],
    ),
    "no_seeds": (["seeds=0"], ["seeds = 0", "nearest valid value 1", "(from command line: seeds=0)"]),
    "list_of_another_length": (
        ["simulator.pitch_error.shaft=gear"],
        ["simulator.pitch_error.values", "40 teeth", "(from command line: simulator.pitch_error.shaft=gear)"],
    ),
    "run_folder_below_a_file": (["hydra.run.dir=README.md/run"], ["hydra.run.dir", "cannot be made"]),
    "run_folder_where_none_can_be": (["hydra.run.dir=/proc/run"], ["hydra.run.dir", "cannot be made"]),
    "system_beside_the_group_of_another": (
        ["simulator.system=oscillator"],
        ["simulator.system = 'oscillator'", "the parameters of a gear_pair", "simulator=oscillator family=none"],
    ),
    "no_extended_file": (["simulator.extended=nope.yaml"], ["simulator.extended", "nope.yaml", "cannot be read"]),
    "torque_of_the_gear_that_follows": (
        ["simulator.gear_torque=100"],
        ["simulator.gear_torque = 100", "where simulator.gear_torque_mode is balanced", "gear_torque_mode=held"],
    ),
    "mass_that_the_paper_prints": (
        ["simulator.as_printed=true", "simulator.inertia_gear=9e-3", "simulator.pressure_angle_deg=25"],
        ["simulator.inertia_gear = 0.009: has no effect", "pressure_angle_deg", "beside simulator.as_printed=true"],
    ),
    "mass_that_friction_does_not_read": (
        ["simulator.as_printed=true", "simulator.tooth_friction={}", "simulator.equivalent_mass=0.5"],
        ["simulator.equivalent_mass = 0.5: has no effect beside simulator.as_printed=true"],
    ),
    "accuracy_of_given_steps": (
        ["simulator.solver.accuracy=1e-8", "simulator.solver.substeps=4"],
        [
            "simulator.solver.accuracy = 1e-08: has no effect beside simulator.solver.substeps=4",
            "leave one of them out",
        ],
    ),
    "perturbed_rest": (
        ["family.start=rest", "family.perturbation=0.2"],
        ["family.perturbation = 0.2: has no effect where family.start is rest", "choose family.start=static"],
    ),
    "one_run_of_all": (
        ["protocol.run=3"],
        ["protocol.run = 3: acts in protocol=paper", "this is by_run", "choose protocol=paper"],
    ),
    "one_run_of_many": (["protocol=paper_many_runs", "protocol.run=3"], ["this is paper_many_runs"]),
    "how_long_is_simulated": (
        ["simulator.duration=2", "simulator.noise=1"],
        [
            "simulator.duration: no such effect or parameter; remedy: write simulator.n_samples",
            "sensor_noise.snr_db=30",
        ],
    ),
    "family_of_a_gear_for_an_oscillator": (
        ["task=identify", "measurement=silverbox", "simulator=oscillator"],
        [
            "simulator.pinion_speed_rpm: no such effect or parameter; remedy: choose family=none",
            "family.spreads.pinion_torque: the model has no such parameter; remedy: choose family=none",
            "conf/family/bench.yaml",
        ],
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_named(name, caplog, capsys):
    arguments, said = FAULTS[name]
    code = main(arguments)
    text = caplog.text + capsys.readouterr().err
    assert code == 1
    for words in said:
        assert words in text
    assert "Traceback" not in text


@pytest.mark.parametrize(
    "words",
    [
        ["simulator.gear_torque=100", "simulator.gear_torque_mode=held"],
        ["simulator.as_printed=true"],
        ["simulator.as_printed=true", "simulator.tooth_friction={}", "simulator.inertia_gear=9e-3"],
        ["simulator.solver.substeps=4"],
        ["family.start=rest"],
        ["family=paper", "protocol=paper", "protocol.run=3"],
    ],
)
def test_what_the_values_beside_it_leave_in_force_is_taken(words):
    assert problems_of(read_command_line(words).overrides) == []


def test_what_is_to_be_installed_can_be_pasted_into_any_shell(monkeypatch):
    """A shell reads brackets without quotes as a pattern."""
    monkeypatch.setattr("gear_damping.config.command_line.find_spec", lambda name: None)
    (problem,) = read_command_line(["--multirun", "hydra/launcher=joblib"]).problems
    assert problem.remedy == "pip install 'gear-damping[joblib]'"


def test_a_key_is_refused_once(caplog):
    assert main(["task=simulate", "protocol.run=3"]) == 1
    assert caplog.text.count("- protocol.run") == 1


def test_all_problems_at_once(caplog):
    arguments = ["model=bth", "simulator.backlash.gap=-1", "training.batch_size=0", "seed=x", "+foo=3"]
    assert main(arguments) == 1
    assert "5 problems" in caplog.text
    for key in ("model", "simulator.backlash.gap", "training.batch_size", "seed", "foo"):
        assert f"- {key}" in caplog.text


def test_help_names_tasks_groups_and_keys(capsys):
    assert main(["--help"]) == 0
    said = capsys.readouterr().out
    for word in ("experiment", "backlash", "identify", "training.max_epochs", "--multirun"):
        assert word in said


def test_a_file_whose_name_has_brackets_needs_no_quotes():
    path = "/measured/run (2).csv"
    typed = read_command_line(["task=inspect", f"measurement.path={path}"])
    assert not typed.problems
    assert f'++measurement.path="{path}"' in typed.overrides


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--multirun", "seed=1,2", "hydra.run.dir=there"], "this is a sweep; remedy: use hydra.sweep.dir=FOLDER"),
        (["hydra.sweep.dir=there"], "this is one run; remedy: use hydra.run.dir=FOLDER"),
    ],
)
def test_one_run_and_a_sweep_have_each_a_place(words, said):
    (problem,) = read_command_line(words).problems
    assert said in str(problem)
    assert not read_command_line(["--multirun", "seed=1,2", "hydra.sweep.dir=there"]).problems
    assert not read_command_line(["seed=1", "hydra.run.dir=there"]).problems
