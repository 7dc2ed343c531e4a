"""The reference of docs/measurement.md says what the declarations say."""

import math
from pathlib import Path

import numpy as np
import pytest

import gear_damping as gd
from gear_damping.identification.output_error.observe import motion
from gear_damping.identification.output_error.records import Observed
from gear_damping.measurement.layout import FILES
from gear_damping.reporting.measurement_page import BEGIN, END, main, reference, with_reference
from gear_damping.schema.mappings import inner_model, names

PAGE = Path(__file__).resolve().parents[2] / "docs" / "measurement.md"


def test_the_page_is_what_the_declarations_say():
    text = PAGE.read_text(encoding="utf-8")
    assert with_reference(text) == text, "docs/measurement.md is not what the declarations say: run 'make docs'"


def test_the_reference_holds_every_key():
    said = reference()

    def look(model):
        for name, info in names(model).items():
            assert f"| `{name}` |" in said, name
            if inner := inner_model(info):
                look(inner)

    for model in FILES.values():
        look(model)


def test_which_module_of_helical_teeth_is_meant_is_said():
    """With the transverse ones the base radius is the one that the normal ones and the helix angle have."""
    normal, angle, helix, teeth = 2e-3, math.radians(20), math.radians(25), 31
    transverse = gd.GearPair(
        n_teeth_pinion=teeth,
        module=normal / math.cos(helix),
        pressure_angle=math.atan(math.tan(angle) / math.cos(helix)),
    )
    run = gd.simulate(gd.Model(transverse, [gd.FourierMeshStiffness()]), sampling_rate=1e4, n_samples=2)
    expected = teeth * normal / 2 / math.hypot(math.cos(helix), math.tan(angle))
    assert float(run.runs.derived["base_radius_pinion"]) == pytest.approx(expected, rel=1e-6)
    said = reference()
    assert "of helical ones the transverse one, the normal one over cos(helix angle)" in said
    assert "of helical teeth the transverse one, whose tangent is that of the normal one over cos(helix angle)" in said
    assert "Of helical teeth everything is in the transverse plane" in PAGE.read_text(encoding="utf-8")


def test_the_sign_of_a_base_that_moves_is_said():
    """A base that is pushed off leaves the mass behind; against the ground a mass without spring stays where it is."""
    rig = gd.Model(gd.Oscillator(stiffness=0.0))
    inputs = {"base_acceleration": np.full(50, 2.0)}
    run = gd.simulate(rig, sampling_rate=100, n_samples=50, inputs=inputs, solver=gd.Solver(acceleration=True))
    assert run.displacement[0, -1] == pytest.approx(-(0.49**2), rel=1e-6)
    shown = motion(run.runs, Observed("acceleration", absolute=True))
    assert shown.abs().max() < 1e-9
    text = PAGE.read_text(encoding="utf-8")
    assert text.count("x'' + c x' + k x = -a_b") == 2
    assert "against the ground, x'' + a_b, both positive the same way" in reference()


def test_what_stands_around_the_reference_is_kept(tmp_path):
    page = tmp_path / "measurement.md"
    page.write_text(f"# Mine\n\nbefore\n\n{BEGIN}\nstale\n{END}\n\nafter\n")
    assert main(["--folder", str(tmp_path)]) == 0
    text = page.read_text()
    assert text.startswith("# Mine\n\nbefore\n\n")
    assert text.endswith(f"{END}\n\nafter\n")
    assert "stale" not in text
    assert "| `lowpass` |" in text
