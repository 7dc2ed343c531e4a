"""Teeth that take up their load over half a pitch, as helical ones do: damping is not what hides missing corners."""

from dataclasses import replace

import pytest
from second_rig import pair
from second_rig.case import Case, Stream, write
from second_rig.channels import ERROR_UM, WHITE
from second_rig.files import Table
from second_rig.motion import Run
from second_rig.sensors import Noise

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.explain import fitting_solver, with_noise
from gear_damping.explanation.steps import calibrate
from gear_damping.measurement.load import load_measurement

SOFT = 0.5  # of a mesh period


@pytest.fixture
def evidence(tmp_path, monkeypatch):
    monkeypatch.setattr(pair, "EDGE", SOFT)
    rig = pair.steel_rig((41, 47), 2.5e-3, 0.03, (2e-3, 3e-3), 0.04, gain=1.3)
    rig = replace(rig, contact_ratio=1.36)  # and one more pair that carries always
    told = replace(rig, one_pair=0.95 * rig.one_pair, two_pairs=0.95 * rig.two_pairs, damping_ratio=0.03)
    runs = tuple(Run(40e3, 0.12, round(rig.speed_at(tuning)), 60.0) for tuning in (0.18, 0.24, 0.33, 0.41))
    write(
        Case(rig, runs, ERROR_UM, Table("csv", "te"), Noise(WHITE, 30), Stream(5, 0), "", None, told), tmp_path / "case"
    )
    measurement = load_measurement(tmp_path / "case" / "measurement.yaml")
    found = evidence_of(measurement)
    found = replace(found, fit=(*found.fit, *found.holdout), holdout=(), sealed=True)
    return rig, with_noise(found, measurement, lambda _: None)[0]


@pytest.mark.slow
@pytest.mark.parametrize(("edges", "is_right"), [(calibrate.EDGES, True), ((0.0,), False)])
def test_the_damping_of_soft_teeth_is_found_where_the_wave_may_lack_its_corners(evidence, monkeypatch, edges, is_right):
    monkeypatch.setattr(calibrate, "EDGES", edges)
    rig, measured = evidence
    found = calibrate.calibrated(measured, fitting_solver(None)).nominal
    ratio = found.values["viscous_damping.damping_coefficient"] / rig.viscous
    assert (abs(ratio - 1) < 0.05) is is_right
    assert (found.fitted.cost < 2 * measured.noise**2 * sum(len(r.response) for r in measured.fit)) is is_right
