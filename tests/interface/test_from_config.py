"""What stands in a `simulator` node acts on the model that is made of it, or is refused."""

import pytest

import gear_damping as gd

OSCILLATOR = {"system": "oscillator", "stiffness": 631.65, "initial_displacement": 0.01, "viscous_damping": {}}
PAIR = {"system": "gear_pair", "pinion_speed_rpm": 1500, "fourier_mesh_stiffness": {}, "viscous_damping": {}}
RATIO = {"damping_law": "viscous_damping", "damping_ratio_percent": 2}


@pytest.mark.parametrize("node", [OSCILLATOR, PAIR])
def test_a_damping_ratio_decides_the_coefficient_of_its_law(node):
    """2 % were simulated at 128 %, and 3 % of a gear pair at 0.35 %: the default of the coefficient."""
    model = gd.Model.from_config(node | RATIO)
    found = gd.simulate(model, sampling_rate=200, n_samples=20).damping_ratio_percent
    assert found == pytest.approx(2.0, rel=1e-9)
    assert gd.Model.from_config(model.to_config()) == model


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"damping_ratio_percent": 2}, "no effect carries a damping ratio; remedy: give damping_law: viscous_damping"),
        (
            {**RATIO, "viscous_damping": {"damping_coefficient": 1}},
            "damping_coefficient = 1.0: is given beside damping_ratio_percent, which decides it",
        ),
        ({"extended": "extended_simulator.yaml"}, "names another file, .*; remedy: give from_config its path alone"),
        ({"stiffness": "1579 N/m"}, r"the unit 'N/m' is not one of the kind of '1/s\^2'"),
        ({"viscous_damping": {"damping_coefficient": "2.5 N*s/m"}}, "is not one of the kind of '1/s'"),
    ],
)  # fmt: skip
def test_what_cannot_act_is_refused(more, said):
    with pytest.raises(gd.InputError, match=said):
        gd.Model.from_config(OSCILLATOR | more)


def test_lengths_of_an_oscillator_are_said_in_any_unit():
    node = {
        "stiffness": "600 1/s^2",
        "initial_displacement": "3 mm",
        "cubic_stiffness": {"coefficient": "3 1/mm^2/s^2"},
    }
    given = gd.Model.from_config(OSCILLATOR | node).given
    assert given["initial_displacement"] == pytest.approx(0.003)
    assert given["cubic_stiffness.coefficient"] == pytest.approx(3e6)
    assert given["stiffness"] == 600
