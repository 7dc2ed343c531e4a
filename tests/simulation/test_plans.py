"""Families, plans, and data sets on disk."""

import json
from dataclasses import replace

import pytest
import torch

from gear_damping.errors import InputError
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation import plan as plan_module
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.prior import Label, Prior, Uniform, draw_values

DISTRIBUTIONS = {"damping_ratio_percent": Uniform(0.1, 0.6), "pinion_torque": Uniform(0.8, 1.2, relative=True)}
PRIOR = Prior("bench", DISTRIBUTIONS)


@pytest.fixture
def plan():
    effects = [effect_class(name)() for name in ("fourier_mesh_stiffness", "power_law_damping", "load_noise")]
    return SimulationPlan(
        Model(GearPair(), effects), {"load_noise.snr_db": 40.0}, PRIOR, 12, 40e3, 60, 5, "power_law_damping"
    )


def test_labels_are_the_drawn_ratios_at_the_nominal_velocity(plan):
    runs = run_plan(plan)
    ratio = runs.damping_ratio_percent
    assert ratio.min() >= 0.1
    assert ratio.max() <= 0.6
    assert ratio.std() > 0.05
    assert runs.reference_velocity.unique().shape == (1,)
    assert float(runs.reference_velocity[0]) == pytest.approx(0.577, rel=2e-3)
    alpha = runs.values["power_law_damping.coefficient"]
    torch.testing.assert_close(alpha / ratio, (alpha / ratio)[:1].expand(12))


def test_one_ratio_for_every_run(plan):
    runs = run_plan(replace(plan, damping_ratio_percent=0.3))
    torch.testing.assert_close(runs.damping_ratio_percent, torch.full((12,), 0.3, dtype=torch.float64))


def test_static_start_is_near_the_static_deflection_and_rest_is_at_zero(plan):
    generator = torch.Generator().manual_seed(0)
    values, _ = draw_values(plan.model, plan.given, PRIOR, 400, generator, Label("power_law_damping"))
    torque = values["pinion_torque"]
    share = values["initial_displacement"] / (torque / 0.0281907786 / 3.2e8)
    assert float(share.mean()) == pytest.approx(1, abs=0.02)
    assert float(share.std()) == pytest.approx(0.1, rel=0.15)
    rest, _ = draw_values(plan.model, plan.given, replace(PRIOR, start="rest"), 5, generator)
    assert not rest["initial_displacement"].any()


def test_the_same_plan_is_read_from_disk_and_another_is_not(plan, tmp_path, monkeypatch):
    first = run_plan(plan, folder=tmp_path)
    manifest = json.loads(next(tmp_path.glob("*.json")).read_text())
    assert manifest["hash"] == plan.hash
    assert manifest["plan"]["seed"] == 5
    assert manifest["plan"]["solver"]["accuracy"] == 1e-5

    def refuse(*_, **__):
        raise AssertionError("simulated again")

    monkeypatch.setattr(plan_module, "simulate", refuse)
    second = run_plan(plan, folder=tmp_path)
    torch.testing.assert_close(second.response, first.response, rtol=0, atol=0)
    with pytest.raises(AssertionError, match="simulated again"):
        run_plan(replace(plan, seed=6), folder=tmp_path)
    with pytest.raises(AssertionError, match="simulated again"):
        run_plan(replace(plan, given={"load_noise.snr_db": 41.0}), folder=tmp_path)


def test_an_unfinished_data_set_is_made_again(plan, tmp_path):
    run_plan(plan, folder=tmp_path)
    next(tmp_path.glob("*.json")).unlink()
    runs = run_plan(plan, folder=tmp_path)
    assert len(runs.status) == 12
    assert list(tmp_path.glob("*.json"))


def test_too_many_diverged_runs_are_refused(plan):
    wild = replace(plan, damping_law=None, given={**plan.given, "power_law_damping.coefficient": -1e6})
    with pytest.raises(InputError, match="12 of 12 runs diverged"):
        run_plan(wild)
    kept = run_plan(replace(wild, diverged_share=1.0))
    assert kept.n_diverged == 12
    assert len(kept.status) == 0


def test_distributions_and_laws_that_do_not_exist(plan):
    generator = torch.Generator()
    with pytest.raises(InputError, match="pinion_torque"):
        draw_values(plan.model, {}, Prior("x", {"pinion_torqe": Uniform(0, 1)}), 2, generator)
    with pytest.raises(InputError, match="viscous_damping"):
        draw_values(plan.model, {}, PRIOR, 2, generator, Label("viscous_damping"))


@pytest.mark.parametrize("part", ["driver.cpp", "vectors.h", "tsit5.py", "backlash.py"])
def test_every_source_that_makes_runs_counts_in_their_digest(part, plan, tmp_path, monkeypatch):
    root = plan_module.SOURCES
    for file in (one for room in ("physics", "simulation") for one in (root / room).rglob("*")):
        if file.suffix in (".py", ".cpp", ".h"):
            (tmp_path / file.relative_to(root)).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file.relative_to(root)).write_bytes(file.read_bytes())
    before = plan.hash
    monkeypatch.setattr(plan_module, "SOURCES", tmp_path)
    assert plan.hash == before  # nothing but these files of the package
    (changed,) = tmp_path.rglob(part)
    changed.write_bytes(changed.read_bytes() + b"\n")
    assert plan.hash != before
