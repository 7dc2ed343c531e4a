"""Where a free motion begins in a record that was started before it: at rest, or held away from it."""

from dataclasses import replace
from math import ceil

from gear_damping.explanation.evidence.noise import floor_variance
from gear_damping.explanation.evidence.silent_end import largest_of_noise
from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.output_error.records import FitRecord

BLOCKS, FEWEST_SAMPLES = 200, 8  # into which a record is cut, of so many samples at least
STILL = 0.03  # of the largest movement within a block: a rig that hangs still sways a little
LEAST_WAIT = 1.0  # natural periods: a motion passes its turning points faster
AT_REST = 0.5  # of the largest deflection that follows: nearer, the rig was not held away but is moved by a hand
PUSH = 2.0  # natural periods after the first movement, within which a hand lets go


def released_at(record: FitRecord) -> int:
    """The sample from which a motion without an input is free; 0 where it is from the start, or nothing tells.

    A record that was started first holds nothing but noise until the rig moves. Held away from its rest it is free from
    there; pushed out of its rest it is from where it turns back.
    """
    if record.inputs:
        return 0
    series, total = record.response, len(record.response)
    block = max(FEWEST_SAMPLES, ceil(total / BLOCKS))
    waited = _silent_samples(record, block)
    if not 0 < waited < total - block:
        return 0
    rest = series[waited:]
    frequency = first_frequency(replace(record, response=rest, inputs={}, others=(), stamps=None), driven=False)
    if frequency <= 0 or waited * frequency < LEAST_WAIT * record.sampling_rate:
        return 0
    end = min(len(rest), ceil(PUSH * record.sampling_rate / frequency))
    deflection = (rest - rest.mean()).abs()[:end]
    held = float((series[:waited].median() - rest.mean()).abs())
    return waited if held > AT_REST * float(deflection.max()) else waited + int(deflection.argmax())


def _silent_samples(record: FitRecord, block: int) -> int:
    """Samples before the first block that holds more than noise, the whole blocks of them."""
    count = len(record.response) // block
    power = record.response[: count * block].unflatten(0, (count, block)).var(1)
    limit = floor_variance(record) * largest_of_noise(count, block)
    moves = (power > max(limit, STILL**2 * float(power.max()))).nonzero()
    return int(moves[0]) * block if len(moves) else 0
