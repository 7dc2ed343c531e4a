"""How fast the shafts of a rig turn on the whole is no vibration, and no model of the mesh foretells it.

A drive lets its speed sway by a ten-thousandth or so, in waves that are longer than a turn. In the speed of a shaft
that is more than some vibrations are. Where both torques are measured they tell how the shafts speed up, but for the
noise and the zeros of their sensors, which add up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi

from gear_damping.identification.output_error.records import FitRecord, Observed, SlowChange
from gear_damping.physics.systems.gear_pair import teeth_of

VARIES = 1e-3  # of the speed, standard deviation: what a drive lets it vary in waves about as long as a record
FEWEST_TERMS, MOST_TERMS = 3, 12  # polynomials: a wave as long as twice a record, and what does not cost too much
PER_TURN = 1.0  # polynomials to a turn of the slower shaft: they follow waves of two turns, and nothing of one turn


def gear_ratio(values: Mapping[str, float]) -> float:
    """Teeth of the pinion over those of the gear, as stated or as usual."""
    pinion, gear = teeth_of(values)
    return pinion / gear


def with_slow_rotation(records: Sequence[FitRecord], gear_ratio: float) -> list[FitRecord]:
    """Records of a gear pair whose shaft speeds change slowly by an unknown part of their own.

    Args:
        records: Of a rig with shafts.
        gear_ratio: Teeth of the pinion over those of the gear.
    """
    turning = [(record, abs(record.conditions.get("pinion_speed", 0.0)) * min(gear_ratio, 1.0)) for record in records]
    turns = min((slowest / (2 * pi) * record.duration for record, slowest in turning), default=0.0)
    terms = min(max(FEWEST_TERMS, int(PER_TURN * turns)), MOST_TERMS)
    span = max((record.duration for record in records), default=0.0)
    fastest = max((abs(record.conditions.get("pinion_speed", 0.0)) for record in records), default=0.0)

    def swaying(channel: Observed) -> Observed:
        ratio = {"pinion_speed": 1.0, "gear_speed": gear_ratio}.get(channel.name, 0.0)
        deviation = VARIES * fastest * ratio
        return replace(channel, slow=SlowChange(terms, span, deviation)) if deviation else channel

    return [
        replace(r, observed=swaying(r.observed), others=tuple((swaying(o), values) for o, values in r.others))
        for r in records
    ]
