"""What is asked: the strata of blind cases, how many of each, and which hidden cases they are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import log10

from hidden import EFFECTS, OSCILLATOR_EFFECTS

# Effects that no excess can be had from: they are one class with the load's calibration, or plain noise, or (an
# unbalance) move so little beside the bearing that lets them show that the excess is the bearing's.
UNSIZED = ("sensor_gain", "inertia_error", "load_noise", "sensor_quantisation", "unbalance")
NAMEABLE = tuple(name for name in EFFECTS if name not in UNSIZED)
COMMON = tuple(
    name for name in NAMEABLE if name not in ("backlash", "squeeze_film_damping", "tooth_friction")
)  # of the full plan

# effects that speed and acceleration show as well as the transmission error does: a runout or a slow torque,
# for all its micrometres, hardly accelerates anything
CHANNEL_GEARS = (
    "pinion_stiffness_modulation", "gear_stiffness_modulation", "profile_error", "pitch_error", "tooth_crack",
    "coulomb_friction", "power_law_damping", "hunt_crossley_damping", "hysteretic_damping", "cubic_stiffness",
    "hertz_stiffness", "load_dependent_contact",
)  # fmt: skip
CHANNEL_OSCILLATORS = tuple(OSCILLATOR_EFFECTS)
GEAR_CHANNELS = ("full", "mean_free", "pinion_speed", "acceleration")  # plans of sensors; the first is the yardstick
OSCILLATOR_CHANNELS = ("displacement", "velocity", "acceleration")
CHANNEL_ROWS = (
    *((name, channel) for name in CHANNEL_GEARS for channel in GEAR_CHANNELS),
    *((name, channel) for name in CHANNEL_OSCILLATORS for channel in OSCILLATOR_CHANNELS),
)  # fmt: skip

NOISES = ("coloured_noise", "random_load", "coarse_angle", "noisy_torque", "noisy_force")
LARGEST_LOAD_NOISE, FORCE_SNR = 0.05, 20.0  # of the mean torque; dB

CLASSES = (
    frozenset({"encoder_error", "pinion_eccentricity", "gear_eccentricity", "pitch_error"}),
    frozenset({"sensor_gain", "inertia_error"}),
    frozenset({"coulomb_friction", "asymmetric_friction"}),
)  # the same signal by other words, or one law within the other


@dataclass(frozen=True)
class Question:
    """One case to be explained.

    stratum: the row of the table. drawn: the stratum of the hidden case. removed: taken out of the catalogue.
    added: explain a second time with the records that were added later. rig, sensors: `drawn`, or by name; the
    usual ones where None. system: gear_pair or oscillator. channel: of an oscillator; drawn where None. draw: the
    seed that the case is drawn from, where several questions look at the same one. chosen: parameters of the effect.
    kind, force_snr_db: excitation of an oscillator, and noise of the measured force.
    """

    stratum: str
    seed: int
    drawn: str
    target_excess: float | None = None
    snr_db: float | None = None
    removed: str | None = None
    added: bool = False
    rig: str | None = None
    sensors: str | None = None
    system: str = "gear_pair"
    channel: str | None = None
    draw: int | None = None
    chosen: tuple[tuple[str, float], ...] = ()
    kind: str | None = None
    force_snr_db: float | None = None

    @property
    def key(self) -> tuple[str, int]:
        """What makes it the same question."""
        return self.stratum, self.seed


# stratum -> cases in a full run
COUNTS = {
    "null": 60, "single": 3 * len(NAMEABLE), "faint": len(NAMEABLE), "pairs": 24, "outside": 25, "one_record": 20,
    "removed": 2 * len(COMMON), "tacho_error": 10, "below": 10, "unidentifiable": 5, "data_fault": 24,
    "rigs": 60, "channels": len(CHANNEL_ROWS), "oscillators": 52, "noises": 100 * len(NOISES),
}  # fmt: skip
MEANING = {
    "null": "nothing is hidden, the stiffness has another shape",
    "single": "one effect, 0.5 to 20 % of the variance beyond calibration",
    "faint": "one effect of 0.1 to 0.5 %",
    "below": "one effect below the information limit: a hundredth of a per cent at 20 dB",
    "pairs": "two effects at once",
    "outside": "an effect that the catalogue does not have",
    "removed": "the true effect is taken out of the catalogue",
    "one_record": "one record, then the records that the experiment adds",
    "tacho_error": "a wrong shaft angle, alone or with one effect",
    "unidentifiable": "a gain or an inertia without a stated uncertainty, an unbalance, or noise",
    "data_fault": "a damaged file",
    "rigs": "another rig, other sensors, units, rate and length: nothing or one effect hidden, or a wrong inertia",
    "channels": "one effect sized for one channel: gear pairs and oscillators, the usual channel and the others",
    "noises": "nothing is hidden in noise of another kind: coloured, of the load, of an encoder or of a measured load",
    "oscillators": "an oscillator of any frequency, unit, datum, excitation and channel: nothing or one effect",
}


def question(stratum: str, seed: int) -> Question:
    """The question of a seed; the effect follows from the seed, so that every effect comes up equally often."""
    if stratum == "single":
        name = NAMEABLE[seed % len(NAMEABLE)]
        return Question(stratum, seed, name, target_excess=(0.7, 2.0, 8.0)[seed // len(NAMEABLE) % 3])
    if stratum == "faint":
        return Question(stratum, seed, NAMEABLE[seed % len(NAMEABLE)], target_excess=0.25)
    if stratum == "below":
        return Question(stratum, seed, COMMON[7 * seed % len(COMMON)], target_excess=0.01, snr_db=20.0)
    if stratum == "removed":
        name = COMMON[seed % len(COMMON)]
        return Question(stratum, seed, name, target_excess=3.0, removed=name)
    if stratum == "unidentifiable":
        return Question(stratum, seed, UNSIZED[seed % len(UNSIZED)])
    if stratum == "one_record":
        return Question(stratum, seed, stratum, target_excess=3.0, added=True)
    if stratum in ANY_LAB:
        return ANY_LAB[stratum](seed)
    if stratum not in COUNTS:
        raise ValueError(f"no stratum {stratum!r}; choose one of {', '.join(COUNTS)}")
    return Question(stratum, seed, stratum)


def _of_rigs(seed: int) -> Question:
    """In turn a null, an effect, an effect, and now and then an inertia that is stated 10 % wrong."""
    if seed % 12 == 11:
        return Question("rigs", seed, "null", rig="drawn", sensors="inertia_wrong", snr_db=30.0)
    if seed % 3 == 0:
        return Question("rigs", seed, "null", rig="drawn", sensors="drawn")
    turn = seed - seed // 3
    size = (2.0, 8.0)[turn // len(COMMON) % 2]
    return Question("rigs", seed, COMMON[turn % len(COMMON)], target_excess=size, rig="drawn", sensors="drawn")


def _of_channels(seed: int) -> Question:
    """Every effect through every channel in turn: one draw of the rig, sized anew for each channel."""
    place = seed % len(CHANNEL_ROWS)
    gears = len(CHANNEL_GEARS) * len(GEAR_CHANNELS)
    name, channel = CHANNEL_ROWS[place]
    asked = {"target_excess": 2.0, "snr_db": 30.0}
    if place < gears:
        return Question("channels", seed, name, **asked, sensors=channel, draw=seed - place % len(GEAR_CHANNELS))
    first = seed - (place - gears) % len(OSCILLATOR_CHANNELS)
    return Question("channels", seed, name, **asked, system="oscillator", channel=channel, draw=first)


def _of_oscillators(seed: int) -> Question:
    """In turn a null and three effects."""
    name = "null" if seed % 4 == 0 else CHANNEL_OSCILLATORS[(seed - seed // 4 - 1) % len(CHANNEL_OSCILLATORS)]
    return Question("oscillators", seed, name, target_excess=None if name == "null" else 3.0, system="oscillator")


def _of_noises(seed: int) -> Question:
    """Every kind in turn; a random load of up to 5 % of the mean one."""
    kind = NOISES[seed % len(NOISES)]
    if kind == "noisy_force":
        excitation = ("multisine", "random", "sweep")[seed // len(NOISES) % 3]
        asked = {"system": "oscillator", "kind": excitation, "force_snr_db": FORCE_SNR}
        return Question("noises", seed, "null", snr_db=30.0, **asked)
    if kind == "random_load":
        share = LARGEST_LOAD_NOISE * (1 + seed // len(NOISES) % 10) / 10
        return Question("noises", seed, "load_noise", snr_db=30.0, chosen=(("snr_db", -20 * log10(share)),))
    return Question("noises", seed, "null", snr_db=30.0, sensors=kind)


ANY_LAB = {"rigs": _of_rigs, "channels": _of_channels, "oscillators": _of_oscillators, "noises": _of_noises}


def questions(strata: tuple[str, ...], cases: int | None, first_seed: int) -> list[Question]:
    """Questions of the strata, `cases` of each (all where None), in an order that is balanced wherever it stops."""
    listed = [list(_of(stratum, cases, first_seed)) for stratum in strata]
    share = {q.key: (i + 0.5) / len(of) for of in listed for i, q in enumerate(of)}
    return sorted((q for of in listed for q in of), key=lambda q: share[q.key])


def _of(stratum: str, cases: int | None, first_seed: int) -> Iterator[Question]:
    count = COUNTS[stratum] if cases is None else cases
    return (question(stratum, first_seed + i) for i in range(count))


def same_class(name: str, other: str) -> bool:
    """Whether data cannot separate the two."""
    return name == other or any(name in group and other in group for group in CLASSES)
