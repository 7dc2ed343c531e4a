"""The damping ratio of simulated runs counts every law, as `identify` does; networks learn that which is stated."""

import numpy as np
import pytest
import torch

import gear_damping as gd
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.interface import evaluated

VISCOUS, FRICTION, STIFFNESS, AMPLITUDE = 2.0, 5.0, 1e4, 0.01  # 1 m/s at the reference amplitude
OF_VISCOUS, OF_FRICTION = 100 * VISCOUS / 200, 100 * 4 * FRICTION / np.pi / 200  # c_eq over 2 sqrt(k m)


def runs_with(effect, **given):
    system = gd.Oscillator(stiffness=STIFFNESS, amplitude=AMPLITUDE, initial_displacement=AMPLITUDE)
    model = gd.Model(system, [gd.ViscousDamping(damping_coefficient=VISCOUS), effect])
    return gd.simulate(model, sampling_rate=1000, n_samples=600, **given)


@pytest.fixture(scope="module")
def with_friction():
    return runs_with(gd.CoulombFriction(force=FRICTION))


def test_dry_friction_counts_beside_a_viscous_law(with_friction):
    by_law = with_friction.damping_ratio_by_law
    assert with_friction.damping_ratio_percent == pytest.approx([OF_VISCOUS + OF_FRICTION], rel=2e-3)
    assert by_law["viscous_damping"] == pytest.approx([OF_VISCOUS])
    assert by_law["coulomb_friction"] == pytest.approx([OF_FRICTION], rel=2e-3)


# at 1 m/s: damping that grows with the deflection is 4/(3 pi) of that at it; of two directions the mean counts;
# hysteresis yields at once, as friction of share k z_y
OTHERS = {
    "deflection": (
        gd.HuntCrossleyDamping(damping_coefficient=3.0, exponent=1.0, reference_deflection=AMPLITUDE),
        100 * 3.0 * 4 / (3 * np.pi) / 200,
    ),
    "directions": (
        gd.AsymmetricFriction(
            force_forward=4.0, force_backward=2.0, damping_forward=1.5, damping_backward=0.5, width=1e-3
        ),
        100 * (1.0 + 4 * 3.0 / np.pi) / 200,
    ),
    "hysteresis": (gd.HystereticDamping(share=0.05, yield_deflection=1e-4), 100 * 4 * 0.05 * 1e4 * 1e-4 / np.pi / 200),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_every_other_law_counts_with_what_it_takes(kind):
    effect, expected = OTHERS[kind]
    assert runs_with(effect).damping_ratio_percent == pytest.approx([OF_VISCOUS + expected], rel=0.02)


def test_identify_says_the_same_of_the_same_model(with_friction, tmp_path):
    rows = "".join(f"{t:.6f},{x:.9g}\n" for t, x in zip(with_friction.time, with_friction.displacement[0], strict=True))
    (tmp_path / "swing.csv").write_text("t,x\n" + rows)
    text = (
        "system: oscillator\nrecords:\n  - name: r\n    file: swing.csv\n    channels:\n"
        "      time: {column: 0, unit: s}\n      displacement: {column: 1, unit: m}\n"
    )
    (tmp_path / "measurement.yaml").write_text(text)
    record = gd.load(tmp_path / "measurement.yaml")
    told = gd.identify(record, with_friction.model).damping_ratio_percent
    speed = told["reference_velocity"]
    at_speed = gd.simulate(with_friction.model, sampling_rate=1000, n_samples=20, amplitude=speed / 100)
    assert told["value"] == pytest.approx(at_speed.damping_ratio_percent[0], rel=2e-3)
    assert told["by_law"]["coulomb_friction"] == pytest.approx(
        at_speed.damping_ratio_by_law["coulomb_friction"][0], rel=2e-3
    )


def test_what_is_learnt_and_bounded_is_the_ratio_of_the_law(with_friction):
    runs = with_friction.runs
    assert runs.stated_ratio_percent.tolist() == pytest.approx([OF_VISCOUS])
    free = gd.bound(with_friction, noise=1e-5)["damping_ratio"]
    coefficient = gd.bound(with_friction, "viscous_damping.damping_coefficient", noise=1e-5)
    assert free == pytest.approx(coefficient["viscous_damping.damping_coefficient"] * 100 / 200)


def test_estimators_are_held_to_all_laws_and_networks_to_what_they_learn(with_friction, monkeypatch):
    network = object.__new__(evaluated.NetworkEstimator)
    said = {network: OF_VISCOUS, (other := gd.estimator("log_decrement")): OF_VISCOUS + OF_FRICTION}
    monkeypatch.setattr(
        evaluated, "_said", lambda one, *_: Estimates.without_interval(torch.tensor([said[one]], dtype=torch.float64))
    )
    for passed in ("_require_alike", "_strange"):
        monkeypatch.setattr(evaluated, passed, lambda *_: {})
    found = gd.evaluate({"network": network, "other": other}, with_friction, snr_db=40).content["snr_db"]["40"]
    errors = {name: one["rmse_percent"] for name, one in found["estimators"].items()}
    assert errors == pytest.approx({"network": 0.0, "other": 0.0, "mean": 0.0}, abs=0.01)


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        (
            [gd.ViscousDamping(), gd.HystereticDamping(yield_deflection=1e-9)],
            "hysteretic_damping has none that could be",
        ),
        ([gd.CubicStiffness(coefficient=1.0)], "there is no damping law"),
    ],
)
def test_runs_without_a_ratio_are_not_evaluated(effects, said):
    system = gd.Oscillator(stiffness=STIFFNESS, amplitude=AMPLITUDE, initial_displacement=1e-9)
    runs = gd.simulate(gd.Model(system, effects), sampling_rate=1000, n_samples=100)
    with pytest.raises(gd.InputError, match=f"runs: have no damping ratio .*: {said}.*; remedy: give the model"):
        gd.evaluate({"mine": gd.estimator("log_decrement")}, runs, snr_db=30)
