"""How large an effect must be for anybody to see it in a plan of records, and to tell it from others.

What an effect changes is projected off the sensitivities to what calibration frees and, for the second limit, off what
the nearest other effect could change. The squared norm of what is left, over the variance of the noise, is the
noncentrality of the best test there is. Unknown starts of the records are not counted: they die out soon.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, ncx2

from .catalogue import HIDDEN
from .draft import Draft, Wanted, draft
from .effect import Effect, Params, phase
from .excess import sensitivities
from .knobs import Knobs, stack
from .sizing import clean, members_of, path_of, run

LEVEL, POWER = 0.01, 0.9
SIZES = np.geomspace(1.0 / 4096.0, 1.0, 9)  # shares of the largest at which an effect is tried
RIVAL_SIZE = 1.0 / 16.0  # at which other effects are tried: small enough to be nearly linear
MOST_DRAWS = 6  # of an effect's own parameters: phases, exponents
DISTINCT = 1e-3  # of the largest singular value: a direction of an effect
AMPLITUDES = {
    "power_law_damping": ("coefficient", "N*(s/m)^n"), "coulomb_friction": ("force", "N"),
    "asymmetric_friction": ("force_forward", "N"), "tooth_friction": ("friction_coefficient", "1"),
    "squeeze_film_damping": ("damping_coefficient", "N*s/m"), "hunt_crossley_damping": ("damping_coefficient", "N*s/m"),
    "hysteretic_damping": ("share", "1"), "cubic_stiffness": ("coefficient", "N/m^3"),
    "hertz_stiffness": ("exponent", "1"), "load_dependent_contact": ("growth", "1"),
    "tip_relief": ("depth", "m"),
    "pinion_eccentricity": ("amplitude", "m"), "gear_eccentricity": ("amplitude", "m"),
    "pinion_stiffness_modulation": ("amplitude", "1"), "gear_stiffness_modulation": ("amplitude", "1"),
    "profile_error": ("amplitudes", "m"), "pitch_error": ("values", "m"), "tooth_crack": ("depth", "1"),
    "torque_ripple": ("amplitude", "N*m"), "torque_variation": ("sine_amplitude", "N*m"),
    "windage_drag": ("coefficient", "N*m*s^2"), "bearing_flexibility": ("stiffness", "N/m"),
    "shaft_torsion": ("stiffness", "N*m/rad"), "encoder_error": ("pinion_amplitude", "rad"),
    "shaft_angle_error": ("amplitude", "rad"), "sensor_offset": ("offset", "m"), "sensor_drift": ("rate", "m/s"),
    "sensor_delay": ("delay", "s"), "sensor_lowpass": ("cutoff", "Hz"), "sensor_saturation": ("limit", "m"),
}  # fmt: skip
OTHER_KEYS = {"ramp_change": 1.0, "gear_amplitude": 1.0}  # of an amplitude, where the usual one is not drawn


@dataclass(frozen=True)
class Limit:
    """The limits of an effect in a plan, as shares of its largest size.

    seen: visible with power .9 at a level of .01. named: the same beside the nearest other effect. nearest: that
    effect. cosine: between the two. degrees: of freedom, the amplitudes and phases that nobody knows.
    """

    seen: float
    named: float
    nearest: str
    cosine: float
    degrees: int


def wanted_noncentrality(degrees: int, level: float = LEVEL, power: float = POWER) -> float:
    """That of a chi-squared test with so many degrees of freedom at this level and power."""
    bound = chi2.isf(level, degrees)
    return float(brentq(lambda value: ncx2.sf(bound, degrees, value) - power, 1e-3, 1e3))


def limits(
    name: str,
    seed: int,
    *,
    duration: float = 0.05,
    snr_db: float = 30.0,
    rivals: Collection[str] = (),
    same: Callable[[str, str], bool] = lambda one, other: one == other,
) -> Limit:
    """The limits of an effect in the case of a seed, as `draw_case` draws it with these arguments.

    rivals: other effects that it may be taken for. same: whether data cannot separate two.
    """  # fmt: skip
    one = draft(Wanted(name, seed, duration, snr_db))
    effect, params = one.effects[0], one.params[0]
    others = [HIDDEN[rival] for rival in rivals if not same(rival, name) and HIDDEN[rival].has_size]
    own = [[(effect, effect.at(params, size))] for size in SIZES]
    drawn = [[(rival, p)] for rival in others for p in _drawn(rival, duration, one, seed)]
    seen, columns = _seen(one, [*own, *drawn])
    noise = float(np.sqrt(np.mean(np.var(seen[:, 0], axis=0)))) * 10.0 ** (-snr_db / 20.0)
    left = _beside(_flat(columns), _flat(np.moveaxis(seen[:, 1:] - seen[:, :1], 1, -1)))
    degrees = degrees_of(effect, params)
    sizes, first = (left[:, : len(SIZES)] / noise) ** 2, len(SIZES)
    strength = sizes.sum(0)
    at = _crossing(strength, wanted_noncentrality(degrees))
    direction = left[:, int(np.argmin(np.abs(np.log(SIZES / at))))]
    cosines = {}
    for rival in others:
        count = len(_drawn(rival, duration, one, seed))
        cosines[rival.name] = _cosine(direction, left[:, first : first + count])
        first += count
    nearest = max(cosines, key=cosines.__getitem__, default="")
    cosine = cosines.get(nearest, 0.0)
    apart = max(1.0 - cosine**2, 1e-6)
    return Limit(at, _crossing(strength * apart, wanted_noncentrality(degrees)), nearest, cosine, degrees)


def degrees_of(effect: Effect, params: Params) -> int:
    """Amplitudes that carry its size, and their phases."""
    sized = [key for key in effect.sizes if key in params] or ["size"]
    entries = sum(len(params[key]) if isinstance(params.get(key), list) else 1 for key in sized)
    return entries * (2 if any("phase" in key for key in params) and effect.name != "pitch_error" else 1)


def amplitude_of(name: str, params: Params, torque: float) -> tuple[float, str]:
    """The amplitude that stands for an effect's size, and its unit; of a ripple that goes with the torque its mean."""
    key, unit = AMPLITUDES[name]
    if "share" in params and name == "torque_ripple":
        return abs(params["share"] * torque), unit
    value = params.get(key) or next((params[other] for other in OTHER_KEYS if params.get(other)), 0.0)
    return (float(np.std(value)) if name == "pitch_error" else float(np.max(np.abs(value)))), unit


def power_of_size(name: str) -> float:
    """To which power of its size an effect's amplitude grows."""
    return float(HIDDEN[name].sizes.get(AMPLITUDES[name][0], 1.0))


def _drawn(effect: Effect, duration: float, one: Draft, seed: int) -> list[Params]:
    """Parameters of an effect that differ in what nobody knows beforehand."""
    rng = np.random.default_rng([seed, 5])
    first = effect.at(effect.draw(rng, duration), RIVAL_SIZE)
    count = min(MOST_DRAWS, max(2, degrees_of(effect, first)))
    return [first, *(_turned(effect.at(effect.draw(rng, duration), RIVAL_SIZE), rng) for _ in range(count - 1))]


def _turned(params: Params, rng: np.random.Generator) -> Params:
    return {key: phase(rng) if key.endswith("phase") else value for key, value in params.items()}


def _seen(one: Draft, variants: list[list[tuple[Effect, Params]]]) -> tuple[np.ndarray, np.ndarray]:
    """What the sensors see without and with each variant, (n, 1 + variants, record), and the sensitivities."""
    members: list[Knobs] = [*one.records]
    for variant in variants:
        for record in one.records:
            member = dict(record)
            for effect, params in variant:
                member |= dict(effect.given) | (effect.as_modelled or effect.turn)(params, member | dict(effect.given))
            members.append(member)
    repeats, count = 1 + len(variants), len(one.records)
    knobs = stack(members)
    path = run(knobs, [one], [repeats], one.n, 2)
    base = slice(0, count)
    columns = sensitivities(members_of(knobs, base), path_of(path, base), one.setup.order)
    return clean(one, knobs, path).reshape(one.n, repeats, count), columns


def _flat(values: np.ndarray) -> np.ndarray:
    """(n, record, columns) with samples and records as one."""
    return values.reshape(-1, values.shape[-1])


def _beside(columns: np.ndarray, signals: np.ndarray) -> np.ndarray:
    """Signals without what the columns could do; what diverged is nothing."""
    signals = np.where(np.all(np.isfinite(signals), axis=0), signals, 0.0)
    basis = np.linalg.qr(columns / np.sqrt(np.mean(columns**2, axis=0)))[0]
    return signals - basis @ (basis.T @ signals)


def _cosine(direction: np.ndarray, columns: np.ndarray) -> float:
    """Between a direction and what columns span."""
    sizes = np.linalg.norm(columns, axis=0)
    columns = columns[:, sizes > 0.0] / sizes[sizes > 0.0]
    if not columns.shape[1] or not np.any(direction):
        return 0.0
    basis, singular_values, _ = np.linalg.svd(columns, full_matrices=False)
    basis = basis[:, singular_values > DISTINCT * singular_values[0]]
    return float(np.linalg.norm(basis.T @ direction) / np.linalg.norm(direction))


def _crossing(strength: np.ndarray, wanted: float) -> float:
    """The size at which a noncentrality is reached, by its logarithm; beyond the ends as the nearest sizes go on."""
    good = strength > 0.0
    sizes, values = np.log(SIZES[good]), np.log(np.maximum.accumulate(strength[good]))
    target = np.log(wanted)
    if target <= values[0] or target >= values[-1]:
        i = 0 if target <= values[0] else len(values) - 2
        slope = max((values[i + 1] - values[i]) / (sizes[i + 1] - sizes[i]), 0.5)
        end = 0 if i == 0 else -1
        return float(np.exp(sizes[end] + (target - values[end]) / slope))
    return float(np.exp(np.interp(target, values, sizes)))
