"""A system from outside: one file is simulated, identified and explained, with the effects whose needs it meets."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.physics.catalogue import builtin_effects, system_catalogue
from gear_damping.physics.systems.traits import Trait
from gear_damping.tasks.command import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my_system.py"
PAYLOAD, MOUNT, STIFFNESS, DAMPING, CUBIC = 3.0, 0.6, 4800.0, 4.0, 6e7  # kg, kg, N/m, N s/m, N/m^3
MASS = PAYLOAD + MOUNT / 3
RATE, SAMPLES, NOISE = 400.0, 600, 2e-6  # Hz, samples, m
TIME = np.arange(SAMPLES) / RATE
RIG = f"system: isolator\nparameters: {{payload_mass: {PAYLOAD} kg, mount_mass: {MOUNT} kg}}\nrecords:\n"


def swing(start, cubic=0.0, force=lambda time: 0.0):
    """Displacements in m by an integrator of their own."""

    def slope(time, state):
        return [state[1], (force(time) - DAMPING * state[1] - STIFFNESS * state[0] - cubic * state[0] ** 3) / MASS]

    return solve_ivp(slope, (0, TIME[-1]), [start, 0], "DOP853", TIME, rtol=1e-10, atol=1e-14, max_step=0.01).y[0]


def write(folder, **records):
    """A measurement.yaml of an isolator with a CSV file in mm a record."""
    text, noise = RIG, np.random.default_rng(1)
    for name, values in records.items():
        table = np.column_stack([TIME, 1e3 * (values + NOISE * noise.standard_normal(SAMPLES))])
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header="time,x", comments="")
        channels = "{time: {column: time, unit: s}, displacement: {column: x, unit: mm, datum: absolute}}"
        text += f"- {{file: {name}.csv, channels: {channels}}}\n"
    (folder / "measurement.yaml").write_text(text)
    return folder / "measurement.yaml"


def test_it_simulates_what_its_equation_says():
    isolator = system_catalogue([EXAMPLE])["isolator"]
    system = isolator(payload_mass=PAYLOAD, mount_mass=MOUNT, mount_stiffness=STIFFNESS)
    effects = [gd.ViscousDamping(damping_coefficient=DAMPING), gd.CubicStiffness(coefficient=CUBIC)]
    force = np.sin(30 * TIME)
    runs = gd.simulate(
        gd.Model(system, effects), sampling_rate=RATE, n_samples=SAMPLES, inputs={"force": force},
        solver=gd.Solver(accuracy=1e-7),
    )  # fmt: skip
    expected = swing(0.0, CUBIC, lambda time: np.sin(30 * time))
    assert np.abs(runs.displacement[0] - expected).max() < 1e-4 * np.abs(expected).max()


def test_its_damping_is_identified_in_si(tmp_path):
    record = gd.load(write(tmp_path, decay=swing(4e-3)), plugins=[EXAMPLE])
    fit = gd.identify(record)
    truth = {"damping_coefficient": (DAMPING, "N*s/m"), "mount_stiffness": (STIFFNESS, "N/m")}
    for name, (value, unit) in truth.items():
        low, high = fit.parameters[name]["interval95"]
        assert low - (high - low) < value < high + (high - low), name
        assert fit.parameters[name]["unit"] == unit
    critical = 2 * (STIFFNESS * MASS) ** 0.5
    assert fit.damping_ratio_percent["value"] == pytest.approx(100 * DAMPING / critical, rel=2e-3)
    assert "per unit of mass" not in fit.table()


def test_a_hidden_effect_is_named_with_its_size(tmp_path):
    path = write(tmp_path, far=swing(4e-3, CUBIC), near=swing(2.5e-3, CUBIC))
    answer = gd.explain(gd.load(path, plugins=[EXAMPLE]))
    assert answer.verdict == "explained"
    (cause,) = answer.content["causes"]
    found = cause["parameters"]["coefficient"]
    assert (cause["name"], found["unit"]) == ("cubic_stiffness", "N/m^3")
    assert found["value"] == pytest.approx(CUBIC, rel=0.01)
    assert answer.content["system"] == "isolator"


def test_by_command_it_is_simulated_and_its_records_are_read_back(tmp_path):
    run = tmp_path / "run"
    assert main([
        "task=simulate", "simulator=oscillator", "family=none", f"simulator.plugins=[{EXAMPLE}]",
        "simulator.system=isolator", "~simulator.stiffness", "simulator.damping_law=null",
        f"simulator.payload_mass={PAYLOAD}", "simulator.initial_displacement=0.004", "simulator.amplitude=0.004",
        "simulator.n_samples=300", "simulator.sampling_rate=400", "write_measurement=true", "progress=false",
        f"hydra.run.dir={run}", f"data_folder={tmp_path / 'data'}",
    ]) == 0  # fmt: skip
    read = gd.load(run / "measurement" / "measurement.yaml", plugins=[EXAMPLE])
    assert read.system == "isolator"
    assert read.parameters["payload_mass"].value == PAYLOAD
    assert read.records[0].channels["displacement"].values[0] == pytest.approx(0.004, rel=1e-3)


def test_it_gets_the_effects_whose_needs_it_meets():
    isolator = system_catalogue([EXAMPLE])["isolator"]
    fitting = {name for name, kind in builtin_effects().items() if isolator.has(*kind.needs)}
    assert {"inertia_error", "second_mode", "cubic_stiffness", "backlash"} <= fitting  # its mass is known; it swings
    assert not {"tooth_crack", "torque_ripple", "load_noise", "shaft_angle_error"} & fitting
    with pytest.raises(gd.InputError, match=r"tooth_crack: does not go with the system 'isolator'.*it needs gear_pair"):
        gd.Model(isolator(), [gd.ToothCrack()])


def test_without_its_file_it_is_unknown(tmp_path):
    path = write(tmp_path, decay=swing(4e-3))
    with pytest.raises(gd.InputError, match=r"system.*isolator"):
        gd.load(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('spring = "mount_stiffness"', 'spring = "stiffness"', "names 'stiffness' as its spring or gain"),
        ('name = "isolator"', 'name = "an isolator"', "lacks name"),
        ("frozenset({Trait.REST, Trait.MASS})", '{"rest"}', "lacks traits, a frozenset from"),
        ("frozenset({Trait.REST, Trait.MASS})", "frozenset({Trait.REST})", "they need the traits rest and mass"),
        ('name = "isolator"', 'name = "oscillator"', "repeats the name 'oscillator'"),
        ('FORCE: "N"', '"push": "N"', r"names the channels \['push'\], which no record has"),
        ('Parameter("mount_mass"', 'Parameter("payload_mass"', "duplicate parameter name: 'payload_mass'"),
    ],
)
def test_a_file_that_is_no_system_is_refused(tmp_path, old, new, said):
    text = EXAMPLE.read_text()
    assert old in text
    (tmp_path / "odd.py").write_text(text.replace(old, new))
    path = write(tmp_path, decay=swing(4e-3))
    with pytest.raises(gd.InputError, match=said):
        gd.load(path, plugins=[tmp_path / "odd.py"])


def test_an_effect_that_names_a_system_is_told_to_say_its_needs(tmp_path):
    text = EXAMPLE.with_name("my_effect.py").read_text()
    (tmp_path / "odd.py").write_text(text.replace("    dissipative = True\n", '    systems = ("oscillator",)\n'))
    with pytest.raises(gd.InputError, match=r"names systems: say in needs what it needs of one, from .*'shafts'"):
        gd.explain(None, plugins=[tmp_path / "odd.py"])


def test_the_page_shows_the_file_as_it_is_and_every_trait():
    page = (ROOT / "docs" / "your_own_system.md").read_text()
    assert f"```python\n{EXAMPLE.read_text()}```" in page
    assert all(f"| `{trait}` |" in page for trait in Trait)
