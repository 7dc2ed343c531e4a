"""A torque of the other shaft is told by the mesh that comes out stiffer by the ratio of the teeth."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.answer import other_shafts_torque
from gear_damping.explanation.answer.other_shafts_torque import torque_of_the_other_shaft


@pytest.mark.parametrize(
    ("stiffer", "teeth", "missed", "is_said"),
    [
        (1.8, (21, 37), 0.6, True),
        (0.55, (37, 21), 0.6, True),  # of a pair that speeds up
        (1.4, (21, 37), 0.6, False),
        (1.8, (21, 37), 0.1, False),  # 1 % of the variance: the stiffness alone was stated wrong
        (1.15, (33, 37), 0.6, False),  # as well an error of the stiffness
        (1.8, (None, 37), 0.6, False),
    ],
)
def test_it_is_said_where_stiffness_and_teeth_agree_and_little_is_followed(
    stiffer, teeth, missed, is_said, monkeypatch
):
    monkeypatch.setattr(other_shafts_torque, "nrmse", lambda residuals, records: missed)
    parameters = {"mesh_stiffness_max": 2.9e8, "n_teeth_pinion": teeth[0], "n_teeth_gear": teeth[1]}
    outcome = SimpleNamespace(values={"fourier_mesh_stiffness.maximum": stiffer * 2.9e8}, fit_residuals=[])
    said = torque_of_the_other_shaft(
        outcome, SimpleNamespace(parameters=parameters, fitted=(), channel=SimpleNamespace(name="acceleration"))
    )
    assert bool(said) is is_said
    if is_said:
        assert f"give it times {teeth[0]}/{teeth[1]}" in said


@pytest.mark.parametrize("stated", [None, 2.9e8])
def test_nothing_is_said_without_a_stated_or_a_fitted_stiffness(stated):
    evidence = SimpleNamespace(parameters={"mesh_stiffness_max": stated, "n_teeth_pinion": 21, "n_teeth_gear": 37})
    assert torque_of_the_other_shaft(SimpleNamespace(values={}), evidence) == ""


@pytest.mark.parametrize(("channel", "names_it"), [("transmission_error", True), ("acceleration", False)])
def test_a_torque_of_the_other_shaft_may_be_an_angle_of_it(channel, names_it, monkeypatch):
    """Of arcsec beside the wrong `shaft` the torque alone was blamed."""
    monkeypatch.setattr(other_shafts_torque, "nrmse", lambda residuals, records: 0.6)
    parameters = {"mesh_stiffness_max": 2.9e8, "n_teeth_pinion": 21, "n_teeth_gear": 37}
    outcome = SimpleNamespace(values={"fourier_mesh_stiffness.maximum": 1.8 * 2.9e8}, fit_residuals=[])
    evidence = SimpleNamespace(parameters=parameters, fitted=(), channel=SimpleNamespace(name=channel))
    said = torque_of_the_other_shaft(outcome, evidence)
    assert "give it times 21/37" in said
    assert ("check its `shaft`" in said) == names_it
