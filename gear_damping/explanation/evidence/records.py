"""Step 1: what was measured, as the fits see it: records to fit, records held out, what is known of the rig."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import floor, log10, pi
from typing import Any

from gear_damping.explanation.evidence.release import released_at
from gear_damping.explanation.evidence.silent_end import audible_samples
from gear_damping.explanation.evidence.slow_rotation import gear_ratio, with_slow_rotation
from gear_damping.explanation.evidence.speed_of_gear import with_speed_of_gear
from gear_damping.explanation.settings import SearchSettings
from gear_damping.identification.observation import (
    MESH_PHASE,
    Known,
    fit_record,
    has_spring,
    known_of,
    require_alike,
    require_fitted,
    response_names,
)
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import WHOLE, Segments, covered, part, shortened, stretch
from gear_damping.measurement.record import Channel, Measurement
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.known import system_class
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Effect

HELD_OUT = 4  # every so many operating conditions one is held out where the file does not say
FEWEST_CONDITIONS = 3  # of the fitted records, for each to be left out in turn
FEWEST_DECAYS = 3  # of one condition, for one of them to be held out whole
SPLIT = 2 / 3  # of a single record are fitted, the rest held out


def never() -> bool:
    """Where no time runs out."""
    return False


@dataclass(frozen=True)
class Evidence:
    """Records in the roles that the explanation gives them.

    Args:
        system: The name of what was measured.
        fit: Records to fit.
        holdout: Records that are held out; none while they are sealed and not yet opened.
        known: What the file states of the rig, by its names.
        channel: The first response channel of the first record, for units.
        one_record: Whether there was but one record, cut in two.
        gear_torque_mode: What holds the gear.
        noise: Standard deviation of the noise over all records, once it is known, in the unit of the first channel.
        library: Effects that may be causes, by name.
        segments: How records are cut, because they cannot be predicted from their start for longer.
        stated_segments: How the file says that they are cut; `WHOLE` where it does not.
        has_index: Whether the angle of all records counts from one mark.
        mesh_index: Whether the file says that it counts from the zero of the mesh.
        silent_s: Seconds at the ends of records that were left out, because the motion had died away.
        waited_s: Seconds before the motion was free at the beginnings of records, left out too.
        settings: Thresholds of the search.
        is_over: Whether the time for fits is over.
        input_noise: Whether the noise of measured loads was taken out.
        sealed: Whether held-out records take no part in any choice.
        base: The declaration of the system; that of the package's own one of this name where absent.
    """

    system: str
    fit: tuple[FitRecord, ...]
    holdout: tuple[FitRecord, ...]
    known: Known
    channel: Channel | None
    one_record: bool
    gear_torque_mode: str = "balanced"
    noise: float = 0.0
    library: Mapping[str, type[Effect]] = field(default_factory=builtin_effects)
    segments: Segments = WHOLE
    stated_segments: Segments = WHOLE
    has_index: bool = True
    mesh_index: bool = False
    silent_s: float = 0.0
    waited_s: float = 0.0
    settings: SearchSettings = field(default_factory=SearchSettings)
    is_over: Callable[[], bool] = never
    input_noise: bool = False
    sealed: bool = False
    base: type[System] | None = None

    def __post_init__(self) -> None:
        if self.base is None:
            object.__setattr__(self, "base", system_class(self.system))

    def __getstate__(self) -> dict[str, Any]:
        """What is kept in a file: a clock goes on in its own process alone, and there no time runs out."""
        return vars(self) | {"is_over": never}

    def has(self, trait: Trait) -> bool:
        """Whether the system has a trait."""
        return self.base.has(trait)

    @property
    def has_rates(self) -> bool:
        """Whether a channel of a fitted record is a speed or an acceleration; of a gear pair, of one of its shafts."""
        return any(channel.derivatives for record in self.fit for channel in record.channels)

    @property
    def has_spring(self) -> bool:
        """Whether something pulls the rig back: the file does not state a stiffness of 0."""
        return has_spring(self.known, self.base)

    @property
    def parameters(self) -> Mapping[str, float]:
        """Nominal values of the rig that the file states, by the file's names."""
        return self.known.values

    @property
    def records(self) -> tuple[FitRecord, ...]:
        """Every record."""
        return (*self.fit, *self.holdout)

    @property
    def sampling_rate(self) -> float:
        """Hz, the highest of the records."""
        return max(record.sampling_rate for record in self.records)

    @property
    def duration(self) -> float:
        """Length of the longest record in s."""
        return max(record.duration for record in self.records)

    @property
    def held(self) -> list[FitRecord]:
        """Held-out records as far as segments cover them."""
        return covered(self.holdout, self.segments)

    @property
    def judged(self) -> list[FitRecord]:
        """Records by which models are compared: those held out, or where these are sealed the fitted ones in turn."""
        return self.fitted if self.sealed else self.held

    @property
    def can_be_sealed(self) -> bool:
        """Whether the fitted records hold conditions enough for models to be compared on each by the others.

        Stretches of one record, and records of one free decay, tell a law too little from another that bends to it.
        """
        conditions = {condition_of(record) for record in self.fit}
        return self.has(Trait.SHAFTS) and len(conditions) >= FEWEST_CONDITIONS

    @property
    def fitted(self) -> list[FitRecord]:
        """Fitted records as far as segments cover them."""
        return covered(self.fit, self.segments)

    @property
    def conditions(self) -> int:
        """How many operating conditions the records hold."""
        return len({condition_of(record) for record in self.records})

    @property
    def tells_turns(self) -> bool:
        """Whether angles that count from one mark of the pinion tell its turns apart, so that the gear's follow.

        They do within one record. From one record to the next a counter may have been set back, or only its turns kept.
        """
        return self.one_record or not self.base.has(Trait.TEETH)


def is_begun_anew(evidence: Evidence) -> bool:
    """Whether records with a spring are predicted in segments that nobody asked for: the nominal model loses one."""
    return bool(evidence.segments) and not evidence.stated_segments and evidence.has_spring


def evidence_of(measurement: Measurement, *, holds_out: bool = True) -> Evidence:
    """The records of a measurement in their roles.

    Args:
        measurement: What was loaded.
        holds_out: Whether a part is held out where the file says of no record that it is; else all is fitted.

    Raises:
        InputError: a record lacks a response that can be fitted, or some have an input that others lack.
    """
    require_fitted(measurement)
    base, known = measurement.base, known_of(measurement)
    spring = has_spring(known, base)
    used = [record for record in measurement.records if record.role != "reference"]
    seen = [fit_record(record, base, spring) for record in used]
    seen = with_speed_of_gear(seen, used, gear_ratio(known.values)) if base.has(Trait.SHAFTS) else seen
    dies_away = base.has(Trait.REST) or all_stand(seen)
    free = [_released(record) for record in seen] if dies_away else seen
    waited_s = sum(whole.duration - left.duration for whole, left in zip(seen, free, strict=True))
    records = [(one, record.role) for one, record in zip(free, used, strict=True)]
    modes = {record.gear_torque_mode for record in used} - {None}
    mode = "held" if any("gear_torque" in r.conditions for r, _ in records) else next(iter(modes), "balanced")
    if base.has(Trait.REST):
        require_alike([record for record, _ in records], str(measurement.source))
    else:
        swaying = with_slow_rotation([record for record, _ in records], gear_ratio(known.values))
        records = [(record, role) for record, (_, role) in zip(swaying, records, strict=True)]
    declared = records if holds_out else [(record, role or "fit") for record, role in records]
    fit, holdout = _roles(declared, dies_away)
    one, silent = not holdout, 0.0
    if one:
        fit, silent = _audible(fit) if dies_away else (fit, 0.0)
    if one and holds_out:
        fit, holdout = _cut(fit, dies_away, spring)
    return Evidence(
        system=measurement.system,
        base=base,
        fit=tuple(fit),
        holdout=tuple(holdout),
        known=known,
        channel=used[0].channels[response_names(used[0], base)[0]],
        one_record=one and holds_out and len(used) == 1,
        gear_torque_mode=mode,
        stated_segments=Segments(measurement.segment_s, exact=True) if measurement.segment_s else WHOLE,
        has_index=all("pinion_angle" in record.inputs for record, _ in records) or not base.has(Trait.SHAFTS),
        mesh_index=all(record.mesh_index for record in used),
        silent_s=silent,
        waited_s=waited_s,
    )


def with_own_angles(evidence: Evidence) -> Evidence:
    """The same where every record has a mesh phase of its own."""
    return replace(with_own(evidence, lambda record: (MESH_PHASE, *record.own)), has_index=False)


def with_own(evidence: Evidence, own_of: Callable[[FitRecord], tuple[FreeParameter, ...]]) -> Evidence:
    """The same where every record has these parameters of its own."""
    fit, holdout = (
        tuple(replace(record, own=own_of(record)) for record in records) for records in (evidence.fit, evidence.holdout)
    )
    return replace(evidence, fit=fit, holdout=holdout)


def _roles(records: Sequence[tuple[FitRecord, str | None]], dies_away: bool) -> tuple[list[FitRecord], list[FitRecord]]:
    """Roles as the file says; where it says none, whole operating conditions are held out.

    Of several decays of one condition whole ones are, of middling size: their ends show no law that grows with it.
    """
    said = [role for _, role in records if role]
    if said:
        return [r for r, role in records if role != "holdout"], [r for r, role in records if role == "holdout"]
    found = sorted({condition_of(record) for record, _ in records})
    if dies_away and len(found) == 1 and len(records) >= FEWEST_DECAYS and not any(r.inputs for r, _ in records):
        by_size = sorted((record for record, _ in records), key=lambda record: float(record.response.std()))
        apart = {record.name for record in by_size[1:-1][::HELD_OUT]}
        return [r for r, _ in records if r.name not in apart], [r for r, _ in records if r.name in apart]
    held = set(found[HELD_OUT // 2 :: HELD_OUT]) if len(found) > 1 else set()
    fit = [record for record, _ in records if condition_of(record) not in held]
    return fit, [record for record, _ in records if condition_of(record) in held]


def all_stand(records: Sequence[FitRecord]) -> bool:
    """Whether the shafts stand in all records, so that the teeth that carry never change."""
    return all(record.conditions.get("pinion_speed") == 0 for record in records)


def condition_of(record: FitRecord) -> tuple[float, float]:
    """Speed and torque of a record, rounded so that repetitions fall together."""
    speed, torque = record.conditions.get("pinion_speed", 0.0), record.conditions.get("pinion_torque", 0.0)
    digits = -floor(log10(max(abs(torque), 1e-9))) + 1
    return round(speed * 30 / pi, -1), round(torque, digits)


def _released(record: FitRecord) -> FitRecord:
    """A record from where its motion is free, under its name."""
    first = released_at(record)
    return stretch(record, slice(first, None)) if first else record


def _audible(records: Sequence[FitRecord]) -> tuple[list[FitRecord], float]:
    """Records without the ends at which nothing moves any more, and how many seconds these last together."""
    kept = [shortened(record, audible_samples(record)) for record in records]
    return kept, sum(whole.duration - left.duration for whole, left in zip(records, kept, strict=True))


def _cut(records: Sequence[FitRecord], dies_away: bool, spring: bool) -> tuple[list[FitRecord], list[FitRecord]]:
    """A third of every record held out: its end; of a motion that dies away half of that, and an early part as long.

    The end of a decay shows no law that grows with the amplitude, and its beginning no friction, neither that it is
    there nor that it is not. What is fitted of one record has one offset and one level.
    """
    fit, holdout = [], []
    for record in records:
        ends = _ends(record, dies_away, spring)
        count = len(ends) - 1
        for number, (begin, end) in enumerate(pairwise(ends), start=1):
            piece = part(record, slice(begin, end), f" (part {number} of {count})")
            if number % 2:
                fit.append(replace(piece, group=record.record))
            else:
                holdout.append(piece)
    return fit, holdout


def _ends(record: FitRecord, dies_away: bool, spring: bool) -> list[int]:
    """Samples between which parts of a record are fitted and held out in turn.

    The first part that is held out begins where a third of the energy is still to come; of a motion that goes on that
    is its last third. A place that no spring holds is where it came to: its rate dies away.
    """
    total = len(record.response)
    last = round(SPLIT * total)
    if not dies_away:
        return [0, last, total]
    half = (total - last) // 2
    moves = record.response if spring or record.observed.derivatives else record.response.diff()
    energy = (moves - moves[last:].mean()).square().cumsum(0)
    first = max(int((energy < SPLIT * energy[-1]).sum()), half // 2)
    if first + half + half // 2 > total - half:  # what is fitted between both is half as long as either at least
        return [0, last, total]
    return [0, first, first + half, total - half, total]
