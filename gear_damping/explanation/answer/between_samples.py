"""What a measured load does between its samples, and how much of a motion that may be."""

from math import pi

from gear_damping.explanation.model.hypothesis import natural_frequency_hz
from gear_damping.explanation.state import State
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.traits import Trait


def between_samples(state: State) -> float:
    """Share of the fitted records' variance, in %, that a load straight between its samples would make; 0 of a decay.

    A series is interpolated as one without content above half its rate. One that is straight between its samples is
    weaker by sinc^2(f / f_s), about 1 - (pi f / f_s)^2 / 3, and moves a resonance at f by as much less.
    """
    evidence, nominal = state.bench.evidence, state.nominal
    rates = [record.sampling_rate for record in evidence.fit if _is_driven(record)]
    if not rates or not evidence.has(Trait.REST):
        return 0.0
    frequency = natural_frequency_hz(nominal.hypothesis.model, nominal.flat_given())
    return 100 * ((pi * frequency / min(rates)) ** 2 / 3) ** 2


def _is_driven(record: FitRecord) -> bool:
    """Whether a load was measured that is not known to hold from sample to sample."""
    return any(name not in record.held for name in record.inputs)
