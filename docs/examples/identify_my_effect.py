"""The parameters of one's own effect from measured free decays, with 95 % intervals.

python docs/examples/identify_my_effect.py PATH/measurement.yaml
"""

import sys
from math import pi
from pathlib import Path

import torch

from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.output_error.least_squares import Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.uncertainty import covariance, interval
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

NAME, FILE = "shear_thinning_damping", Path(__file__).with_name("my_effect.py")


def identify(measurement: Path) -> dict[str, tuple[float, tuple[float, float]]]:
    """Value and interval of the stiffness and of both parameters of the effect, per unit of mass."""
    records = [
        FitRecord(r.name, torch.as_tensor(r.channels["displacement"].values), r.sampling_rate)
        for r in load_measurement(measurement).records
    ]
    rate = 2 * pi * first_frequency(records[0])
    amplitude = float(records[0].response.abs().max())
    free = [
        FreeParameter("stiffness", rate**2, logarithmic=True),
        FreeParameter(f"{NAME}.damping_coefficient", 0.05 * rate, logarithmic=True),
        FreeParameter(f"{NAME}.thinning_velocity", rate * amplitude, logarithmic=True, lower=1e-3 * rate * amplitude),
    ]
    model = Model(Oscillator(), [effect_class(NAME, [FILE])()])
    problem = OutputErrorProblem(model, {"amplitude": amplitude}, free, records)
    few_periods = round(4 * 2 * pi / rate * records[0].sampling_rate)
    # Logarithmic coordinates, 0 at the first guess; give several rows where one guess may be far off.
    starts = torch.zeros(1, len(free), dtype=torch.float64)
    fitted = fit(problem, starts, Rounds(horizons=[few_periods / records[0].sampling_rate, None]))
    covariances = covariance(problem, fitted, few_periods)
    return {p.name: interval(lambda z, p=p, i=i: p.value(z[i]), fitted.shared, covariances) for i, p in enumerate(free)}


if __name__ == "__main__":
    for name, (value, (low, high)) in identify(Path(sys.argv[1])).items():
        print(f"{name:<45}{value:>12.5g}   ({low:.5g} … {high:.5g})")
