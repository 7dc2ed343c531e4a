"""Operating conditions of a measurement: which speeds and torques were recorded, and what for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

FIT, HOLDOUT = "fit", "holdout"
RESONANCE_RPM = 16_350.0  # pinion speed at which the mesh frequency is the natural frequency


@dataclass(frozen=True)
class Condition:
    """One record to take: pinion speed / rpm (negative: reversed), mean torque / N m, role.

    swing: amplitude / N m of one slow cycle of the measured torque in the record. added: recorded later, to
    answer what the first records left open.
    """

    speed: float
    torque: float
    role: str = FIT
    swing: float = 0.0
    added: bool = False


def _near(rng: np.random.Generator, value: float, share: float = 0.08) -> float:
    return float(value * rng.uniform(1.0 - share, 1.0 + share))


def full(rng: np.random.Generator) -> list[Condition]:
    """Three speeds by two torques, and two conditions held out."""
    speeds = [_near(rng, speed) for speed in (1800.0, 3100.0, 4500.0)]
    torques = [_near(rng, torque) for torque in (75.0, 155.0)]
    held_out = [(_near(rng, 2450.0), _near(rng, 115.0)), (_near(rng, 3800.0), _near(rng, 95.0))]
    found = [Condition(speed, torque) for speed in speeds for torque in torques]
    return found + [Condition(speed, torque, HOLDOUT) for speed, torque in held_out]


def reversed_rotation(rng: np.random.Generator) -> list[Condition]:
    """The full plan with one of its speeds and one held-out record turning the other way."""
    plan = full(rng)
    back = {2, 3, 7}
    return [replace(c, speed=-c.speed) if i in back else c for i, c in enumerate(plan)]


def light(rng: np.random.Generator) -> list[Condition]:
    """Near mesh resonances under light load, where teeth separate; in half of the cases torque reversals too."""
    speeds = [_near(rng, RESONANCE_RPM / h, 0.03) for h in (5, 4, 3)]
    torques = [_near(rng, 12.0, 0.3), _near(rng, 60.0)]
    found = [Condition(speed, torque) for speed in speeds for torque in torques]
    found += [Condition(_near(rng, RESONANCE_RPM / h, 0.03), _near(rng, 20.0, 0.3), HOLDOUT) for h in (4, 3)]
    if rng.random() < 0.5:
        found[1], found[-1] = (replace(found[i], torque=10.0, swing=_near(rng, 45.0)) for i in (1, -1))
    return found


def one_record(rng: np.random.Generator) -> list[Condition]:
    """A single record; the rest of a full plan is added later."""
    plan = full(rng)
    first = int(rng.integers(6))
    others = [replace(c, added=True) for i, c in enumerate(plan) if i != first]
    return [plan[first], *others]


def one_condition(rng: np.random.Generator) -> list[Condition]:
    """Three records of one condition, one of them held out; a full plan is added later."""
    plan = full(rng)
    chosen = plan[int(rng.integers(6))]
    return [chosen, chosen, replace(chosen, role=HOLDOUT), *(replace(c, added=True) for c in plan if c != chosen)]


PLANS = {"full": full, "reversed": reversed_rotation, "light": light, "one_record": one_record,
         "one_condition": one_condition}  # fmt: skip
