"""Model, records and result agree in their unit: values are converted where they can be, else the two are named."""

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.physics.catalogue import builtin_effects

STIFFNESS, DAMPING, CUBIC = 158.0, 0.75, 5.0  # 1/s^2, 1/s, 1/mm^2/s^2
LINEAR = ["stiffness", "damping_ratio"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A decay from 4 of whatever the unit is said to be, on a hardening spring, by scipy."""
    folder, time = tmp_path_factory.mktemp("cubic"), np.arange(1500) / 100

    def rates(_, state):
        return [state[1], -DAMPING * state[1] - STIFFNESS * state[0] - CUBIC * state[0] ** 3]

    shown = solve_ivp(rates, (0, time[-1]), [4.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-9).y[0]
    shown += 0.003 * np.random.default_rng(0).normal(size=time.size)
    np.savetxt(folder / "x.csv", shown, header="x", comments="")

    def load(unit):
        channels = {"sampling_rate": "100 Hz", "displacement": {"column": "x", "unit": unit}}
        declared = {"system": "oscillator", "records": [{"file": "x.csv", "role": "fit", "channels": channels}]}
        (folder / f"{unit}.yaml").write_text(yaml.safe_dump(declared))
        return gd.load(folder / f"{unit}.yaml")

    return load


def model(unit=None, **cubic):
    oscillator = gd.Oscillator(unit=unit) if unit else gd.Oscillator()
    return gd.Model(oscillator, [gd.ViscousDamping(), gd.CubicStiffness(**cubic)])


@pytest.mark.parametrize("unit", ["mm", "deg"])
def test_the_fitted_model_is_in_the_unit_of_the_records(unit, recorded, tmp_path):
    """It said 1/m^2/s^2, and `unit: m` in the file that it wrote, a million times too much."""
    found = gd.identify(recorded(unit), model()).model
    assert f"coefficient = {found.given['cubic_stiffness.coefficient']:g} 1/{unit}^2/s^2" in str(found)
    assert found.to_config()["unit"] == unit
    again = gd.Model.from_config(found.write(tmp_path / "model.yaml"))
    assert again == found
    kept = gd.identify(recorded(unit), again, free=LINEAR)
    assert kept.damping_ratio_percent["value"] == pytest.approx(2.984, abs=0.01)
    shown = gd.simulate(found, sampling_rate=100, n_samples=200, initial_displacement=4.0).plot()
    assert unit in shown.axes[0].get_ylabel().replace("°", "deg")


def test_what_an_explanation_ends_with_is_in_the_unit_of_the_records(recorded):
    found = gd.explain(
        recorded("mm"), ruled_out=[name for name in builtin_effects() if name != "cubic_stiffness"]
    ).model
    assert found.system.chosen["unit"] == "mm"
    assert found.given["cubic_stiffness.coefficient"] == pytest.approx(CUBIC, rel=0.01)


@pytest.mark.parametrize(("unit", "coefficient"), [(None, 5e6), ("m", 5e6), ("um", 5e-6), ("mm", 5.0)])
def test_values_in_another_unit_of_its_kind_are_converted(unit, coefficient, recorded):
    found = gd.identify(recorded("mm"), model(unit, coefficient=coefficient), free=LINEAR)
    assert found.parameters["stiffness"]["value"] == pytest.approx(STIFFNESS, rel=1e-3)
    assert found.model.given["cubic_stiffness.coefficient"] == pytest.approx(CUBIC)


def test_angles_are_converted_and_kinds_are_not_mixed(recorded):
    of_radians = CUBIC * np.degrees(1) ** 2
    found = gd.identify(recorded("deg"), model("rad", coefficient=of_radians), free=LINEAR)
    assert found.model.given["cubic_stiffness.coefficient"] == pytest.approx(CUBIC)
    said = r"coefficient = 5\.0: is in the unit of the model, 'm', and the records are in 'deg'.*unit='deg'"
    with pytest.raises(gd.InputError, match=said):
        gd.identify(recorded("deg"), model(coefficient=5.0), free=LINEAR)


def test_a_law_of_an_exponent_is_converted_by_it(recorded):
    names = ["stiffness", "viscous_damping.damping_coefficient"]
    law = gd.PowerLawDamping(coefficient=3.0, exponent=2.0)  # 1/m
    found = gd.identify(recorded("mm"), gd.Model(gd.Oscillator(), [gd.ViscousDamping(), law]), free=names)
    assert found.model.given["power_law_damping.coefficient"] == pytest.approx(3e-3)


def test_a_strength_that_nobody_gave_is_not_held_at_its_default(recorded):
    """5.8e16 1/m^2/s^2 were held unsaid, and the fit ran away."""
    found = gd.identify(recorded("mm"), model())
    assert found.parameters["cubic_stiffness.coefficient"]["value"] == pytest.approx(CUBIC, rel=0.01)
    with pytest.raises(gd.InputError, match=r"free: lacks 'cubic_stiffness\.coefficient', which is not known"):
        gd.identify(recorded("mm"), model(), free=LINEAR)
