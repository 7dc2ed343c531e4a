"""Under which conditions each effect is shown."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

Values = Mapping[str, float | tuple[float, ...]]

SETTLING = 8  # turns of the pinion before anything is looked at
TURNS = 8  # turns of the pinion that are looked at: whole turns of pinion and gear
SAMPLES_PER_TURN = 2048  # of the pinion: about 100 a tooth
SPEED_RPM = 2500.0  # the natural frequency lies between the sixth and the seventh mesh harmonic: no resonance
DAMPING = 184.4  # N s/m, 1 % of critical
MEAN_STIFFNESS = 3.2e8  # N/m, of the default mesh
OSCILLATOR_STIFFNESS = (2 * pi * 5) ** 2  # 1/s^2: 5 Hz
OSCILLATOR_RATE, OSCILLATOR_SAMPLES = 1000.0, 4000  # Hz and samples: 4 s


@dataclass(frozen=True)
class Case:
    """Conditions of the two runs that are compared.

    Args:
        values: The effect's parameters (own names, SI) that differ from its defaults.
        also: Further effects of both runs, with their parameters.
        without: What stands in for the effect in the run without it: flat names and values of the nominal.
        given: Parameters of the system, SI.
        speed_rpm: Speed of the pinion.
        force: Amplitude (per unit of mass) and frequency (Hz) of a sine that drives an oscillator; none where absent.
        note: A sentence for the page.
    """

    values: Values = field(default_factory=dict)
    also: Mapping[str, Values] = field(default_factory=dict)
    without: Mapping[str, Values] = field(default_factory=dict)
    given: Values = field(default_factory=dict)
    speed_rpm: float = SPEED_RPM
    force: tuple[float, float] | None = None
    note: str = ""


NOMINAL: dict[str, Values] = {
    "fourier_mesh_stiffness": {},
    "viscous_damping": {"damping_coefficient": DAMPING},
}
OSCILLATOR_NOMINAL: dict[str, Values] = {"viscous_damping": {"damping_coefficient": 1.2}}
OSCILLATOR_GIVEN: Values = {"stiffness": OSCILLATOR_STIFFNESS, "initial_displacement": 1.0}

_TURN = 60 / SPEED_RPM  # s
CASES: dict[str, Case] = {
    "viscous_damping": Case({"damping_coefficient": DAMPING + 64.5}, note="0.35 % of critical on top of the 1 %."),
    "fourier_mesh_stiffness": Case(
        without={"fourier_mesh_stiffness": {"maximum": MEAN_STIFFNESS, "minimum": MEAN_STIFFNESS}},
        note="The run without it has the same mean stiffness, and it is constant.",
    ),
    "rectangular_mesh_stiffness": Case(
        without={"fourier_mesh_stiffness": {}},
        note="The run without it has the first eight harmonics of the same wave.",
    ),
    "backlash": Case(speed_rpm=3300.0, note="At 3300 rpm, a resonance of the mesh, where the teeth separate."),
    "squeeze_film_damping": Case(also={"backlash": {}}, note="Both runs have `backlash`."),
    "unbalance": Case(also={"bearing_flexibility": {}}, note="Both runs have `bearing_flexibility`."),
    "torque_variation": Case(
        {"step_times": tuple((SETTLING + turns) * _TURN for turns in (1.0, 3.0, 5.0))},
        note="The steps are put into the turns that are shown.",
    ),
    "shaft_angle_error": Case(
        note="The simulation is driven by the recorded angle: the difference is what a false angle alone leaves."
    ),
    "accelerometer_gravity": Case(note="Of an accelerometer on the base circle of the pinion."),
    "mesh_stiffness_shape": Case({"in_phase": (0.02, -0.01), "quadrature": (0.01, 0.0)}),
    "offset_force": Case({"force": 100.0}),
    "dead_zone": Case(
        {"width": 60.0},
        force=(200.0, 2.0),
        note="At rest at first; a force of 200 a unit of mass drives both runs at 2 Hz, and 60 of it are kept back.",
    ),
    "quadratic_stiffness": Case({"coefficient": 0.1 * OSCILLATOR_STIFFNESS}),
    "second_mode": Case({"frequency": 2.5 * OSCILLATOR_STIFFNESS**0.5 / (2 * pi)}),
    "mains_hum": Case({"amplitude": 5e-6}),
    "noncollocated_mode": Case(
        {"frequency": 2.5 * OSCILLATOR_STIFFNESS**0.5 / (2 * pi), "residue_ratio": 0.5},
        force=(200.0, 2.0),
        note="At rest at first; a force of 200 a unit of mass drives both runs at 2 Hz.",
    ),
    "sine_restoring": Case(
        {"stiffness": OSCILLATOR_STIFFNESS},
        given={"stiffness": 0.0},
        note="A pendulum let go at 1 rad; the run without it has the same stiffness, and it is linear.",
    ),
}


def case_of(name: str) -> Case:
    """The conditions of an effect by name; the defaults where it needs no others."""
    return CASES.get(name, Case())
