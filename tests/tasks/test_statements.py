"""What a run says of its damping and stability, where there is such a thing and where there is not."""

import numpy as np
import pytest

from gear_damping.config.settings import read_settings
from gear_damping.errors import InputError
from gear_damping.simulation.floquet import floquet_multiplier
from gear_damping.simulation.plan import run_plan
from gear_damping.simulation.prior import Prior, Uniform
from gear_damping.tasks.command import main
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of

UNDRIVEN = ["simulator=oscillator", "family=none", "simulator.initial_displacement=0.1"]
PENDULUM = ["simulator.sine_restoring.stiffness=10000", "simulator.viscous_damping.damping_coefficient=2"]
NO_LAW = ["simulator.damping_law=null", "simulator.viscous_damping=null"]
GEAR_AS_GIVEN = ["simulator.damping_law=null", "family.spreads.damping_ratio_percent=null"]


@pytest.fixture
def simulate(tmp_path, caplog, capsys):
    def run(*arguments, task="simulate", code=0):
        size = ["simulator.n_runs=2", "simulator.n_samples=200"] if task == "simulate" else []
        place = [f"hydra.run.dir={tmp_path / 'run'}", f"data_folder={tmp_path / 'data'}", "progress=false"]
        assert main([f"task={task}", *size, *place, *arguments]) == code
        text = caplog.text + capsys.readouterr().err
        assert "Traceback" not in text
        return text

    return run


def ratio_of(tmp_path):
    with np.load(tmp_path / "run" / "runs.npz") as runs:
        return runs["damping_ratio_percent"]


def test_a_gear_at_standstill_has_no_multiplier(simulate):
    text = simulate("simulator.pinion_speed_rpm=0")
    assert "damping ratio 0." in text
    assert "Floquet" not in text


def test_a_gear_without_load_has_no_multiplier(simulate):
    text = simulate("simulator.pinion_torque=0", *GEAR_AS_GIVEN, "simulator.viscous_damping={}", "family.start=rest")
    assert "wrote" in text
    assert "Floquet" not in text


def test_without_a_damping_law_no_ratio_is_stated(simulate, tmp_path):
    text = simulate(*UNDRIVEN, *NO_LAW)
    assert "no damping ratio is stated: the model has no damping law" in text
    assert "% of critical" not in text
    assert np.isnan(ratio_of(tmp_path)).all()


def test_dry_friction_alone_counts_with_what_it_takes(simulate, tmp_path):
    stiff = ["simulator.stiffness=1e4", "simulator.amplitude=0.01"]  # 1 m/s at the reference amplitude
    text = simulate(*UNDRIVEN, *NO_LAW, *stiff, "simulator.coulomb_friction.force=5")
    expected = 100 * 4 * 5 / np.pi / (2 * 100)  # c_eq = 4 F / (pi V) over 2 sqrt(k m)
    np.testing.assert_allclose(ratio_of(tmp_path), expected, rtol=2e-3)
    assert "damping ratio 3.18" in text
    assert "(coulomb_friction" not in text


def test_several_laws_are_told_apart(simulate):
    stiff = ["simulator.stiffness=1e4", "simulator.amplitude=0.01", "simulator.viscous_damping.damping_coefficient=2"]
    text = simulate(*UNDRIVEN, *stiff, "simulator.coulomb_friction.force=5")
    assert "damping ratio 4.180 … 4.180 % of critical (viscous_damping 1.000 … 1.000, coulomb_friction 3.180" in text


def test_a_law_without_a_ratio_is_named(simulate, tmp_path):
    small = ["simulator.stiffness=1e4", "simulator.hysteretic_damping.yield_deflection=1e-6"]
    text = simulate(*UNDRIVEN, *small, "simulator.initial_displacement=1e-6", "simulator.amplitude=1")
    assert "no damping ratio can be stated: hysteretic_damping has none that could be worked out at" in text
    assert np.isnan(ratio_of(tmp_path)).all()


def test_without_a_linear_stiffness_no_ratio_is_stated(simulate, tmp_path):
    text = simulate(*UNDRIVEN, "simulator.stiffness=0", "simulator.cubic_stiffness.coefficient=1")
    assert "no damping ratio can be stated: there is no linear stiffness" in text
    assert "nan" not in text
    assert np.isnan(ratio_of(tmp_path)).all()


def test_the_small_swings_of_a_pendulum_have_a_ratio(simulate):
    text = simulate(*UNDRIVEN, "simulator.stiffness=0", *PENDULUM)
    assert "no linear stiffness" not in text
    assert "damping ratio 1.000 … 1.000 % of critical" in text


def test_above_critical_damping_there_is_no_decrement(simulate):
    text = simulate(*UNDRIVEN, "simulator.viscous_damping.damping_coefficient=400")
    assert "damping ratio 200.000 … 200.000 % of critical, at" in text


def test_the_multiplier_says_what_it_leaves_out(simulate):
    assert "(stable; of its linear mesh alone, without bearing_flexibility)" in simulate(
        "simulator.bearing_flexibility={}", "simulator.backlash={}"
    )


def test_the_multiplier_of_a_plain_mesh_is_said_as_it_is(simulate):
    assert "(stable)" in simulate("simulator.backlash={}")


REFUSED = {
    "no_torque": (
        ["simulator.pinion_torque=0"],
        ["simulator.damping_law = 'power_law_damping'", "simulator.pinion_torque is 0", "(from conf/simulator/"],
    ),
    "no_stiffness": (
        [*UNDRIVEN, "simulator.stiffness=0", "simulator.damping_ratio_percent=1"],
        ["simulator.damping_law = 'viscous_damping'", "simulator.stiffness is 0"],
    ),
    "no_amplitude": (
        [
            *UNDRIVEN, "simulator.viscous_damping=null", "simulator.power_law_damping={}", "simulator.amplitude=0",
            "simulator.damping_law=power_law_damping", "simulator.damping_ratio_percent=1",
        ],
        ["simulator.damping_law = 'power_law_damping'", "simulator.amplitude is 0"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_ratio_that_no_coefficient_has_is_refused_before_the_run(name, simulate):
    arguments, said = REFUSED[name]
    text = simulate(*arguments, code=1)
    for words in (*said, "carries no damping ratio", "simulator.damping_law=null"):
        assert words in text
    assert "diverged" not in text


def test_a_plan_says_it_too():
    plan = plan_of(read_settings(*composed([])))
    still = Prior("still", {"damping_ratio_percent": Uniform(0.1, 0.2)})
    with pytest.raises(InputError, match=r"simulator\.pinion_torque is 0"):
        run_plan(type(plan)(plan.model, {"pinion_torque": 0.0}, still, 2, 4e4, 20, 0, "power_law_damping"))


def test_a_multiplier_of_a_mesh_that_does_not_turn_is_refused():
    plan = plan_of(read_settings(*composed(["++task=simulate", "++simulator.pinion_speed=0", "++simulator.n_runs=1"])))
    with pytest.raises(ValueError, match="pinion_speed and the mean load must not be 0"):
        floquet_multiplier(run_plan(plan))


def test_nothing_is_learnt_from_runs_without_a_ratio(simulate):
    text = simulate(*UNDRIVEN, *NO_LAW, task="train", code=1)
    assert "simulator.damping_law: task=train needs an effect that states a damping ratio" in text


def test_nothing_is_learnt_from_runs_without_a_stiffness(simulate):
    text = simulate(*UNDRIVEN, "simulator.stiffness=0", "simulator.cubic_stiffness.coefficient=1", task="train", code=1)
    assert "simulator.stiffness = 0: must be positive" in text


def test_not_one_run_left_is_refused_whatever_share_is_tolerated(simulate):
    wild = ["simulator.power_law_damping.exponent=5", "simulator.power_law_damping.coefficient=1e12"]
    text = simulate(*GEAR_AS_GIVEN, *wild, "simulator.diverged_share=1", code=1)
    assert "simulator.diverged_share = 1: leaves no run" in text


def test_a_gear_at_standstill_is_trained_on(simulate):
    quick = [
        "experiment=backlash", "training=smoke", "training.max_epochs=1", "simulator.n_runs=12", "model=raw_lstm",
        "simulator.n_samples=120", "protocol.windows_per_epoch=128", "simulator.pinion_speed_rpm=0",
    ]  # fmt: skip
    text = simulate(*quick, task="train")
    assert "Floquet" not in text
    assert "everything lies in" in text
