"""Step 0: damaged data end the explanation before any physics is blamed."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import shaft_of
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Finding, Measurement
from gear_damping.physics.systems.traits import Trait

HARMONICS = 4  # of a comb, that stand for all of it: the higher ones are smaller
FAINT = 0.1  # share of the strongest comb's energy below which the mesh order is absent
STANDS_OUT = 5.0  # times the energy of the middle comb; a mesh order that does is there, however weak
STRONG = 0.2  # share of a signal's variance that a comb must have to be another mesh
HARMONIC = 0.01  # share of a comb's energy that a second harmonic must have
OTHER_SPEED = 0.05  # relative; speeds that differ by this tell an order from a line of the structure
FEWEST_TEETH = 4  # that pass in every record: over fewer, every comb of four harmonics fits as well as the next
LEAST_ORDER = 0.6  # of the tooth count, from which other combs are compared with the mesh
DECODED = 4  # counts that an encoder gives for a line of it at most; 1 and 2 are usual too
BETWEEN = 0.05  # share of a signal's variance between the harmonics of a mesh, where no shaft's own orders lie
BESIDE = 2  # teeth more and fewer, whose mesh lies where nothing of this one or of a shaft does
UNITS = {  # by which a speed or an angle is wrong whose number is of the second unit, and was declared in the first
    np.pi / 30: ("rad/s", "rpm"), 30 / np.pi: ("rpm", "rad/s"), 1 / 60: ("Hz", "rpm"), 60.0: ("rpm", "Hz"),
    2 * np.pi: ("rad/s", "Hz"), 0.5 / np.pi: ("Hz", "rad/s"), np.pi / 180: ("rad", "deg"), 180 / np.pi: ("deg", "rad"),
}  # fmt: skip
TURNS_APART = 2.0  # turns of a shaft over a record by which an order differs from a whole one: two lines are told apart
COUNTED = (  # what was wrong where the turns of an angle are not those of the mesh, and what to look at,
    "the angle that is given",
    "check counts_per_revolution (lines, or the two or four counts of each) and the unit of the angle",
)
STATED = "the speed that is given", "check sampling_rate, and pinion_speed with its unit"  # and those of a speed
RATES = {"pinion_speed": 1, "gear_speed": 1, "acceleration": 2}  # of shafts, derivatives of their angles by this order
LACKING = 0.01  # of the energy: of a wave of two stiffnesses the first harmonic is never smaller than the second


def data_faults(measurement: Measurement) -> list[Finding]:
    """Findings of the measurement that forbid naming a cause."""
    return [finding for finding in measurement.findings if finding.severity == "data_problem"]


def mesh_order_faults(evidence: Evidence) -> list[Finding]:
    """A finding where the tooth meshing order is absent and another comb stands in its place.

    A comb that follows the shaft and holds much of every record is a mesh, unless the declared order stands out of the
    combs about it too: orders of the load, of the other shaft and lines of the structure then lie beside a mesh.
    """
    name = evidence.channel.name
    is_error = name == evidence.base.response
    if not evidence.has(Trait.TEETH) or not (is_error or name in RATES):
        return []
    records = evidence.records
    counts = shaft_of(records[0], evidence).teeth
    teeth, shafts = counts[0], [shaft_of(record, evidence).angle for record in records]
    if teeth * min(float(np.ptp(angle)) for angle in shafts) < FEWEST_TEETH * 2 * np.pi:
        return []
    series = [record.response.numpy() - float(record.response.mean()) for record in records]
    if _at_other_speeds(records, shafts) and (factor := _miscounted(series, shafts, counts, RATES.get(name, 0))):
        counted = all("pinion_angle" in record.inputs for record in records)
        given, remedy = COUNTED if counted else STATED
        message = f"the teeth mesh {factor * teeth:g} times a turn of {given}, and the pinion has {teeth}: {remedy}"
        return [Finding("turns_miscounted", message, channel=evidence.channel.name)]
    if not is_error:  # its high harmonics are the large ones, and those of another comb too
        return []
    if units := _other_unit(series, shafts, counts):
        message = (
            f"the mesh order {teeth} is absent, and stands where it would with a pinion that turns as if the number of "
            f"its {'angle' if units[0] in ('rad', 'deg') else 'speed'} were in {units[1]} and not in {units[0]}: check "
            "its unit"
        )
        return [Finding("other_unit", message, channel=evidence.channel.name)]
    orders = [n for n in range(max(5, round(LEAST_ORDER * teeth)), 2 * teeth) if n == teeth or n % teeth]
    shares = _shares(series, shafts, orders)
    combs = shares.sum(2)  # (records, orders)
    energy, own = combs.sum(0), orders.index(teeth)
    at = int(energy.argmax())
    if energy[own] >= FAINT * energy[at] or combs[:, at].min() < STRONG:
        return []
    left = [values - _waves(values, angle, orders[at]).sum(1) for values, angle in zip(series, shafts, strict=True)]
    combs_left = _shares(left, shafts, orders).sum((0, 2))
    if combs_left[own] >= STANDS_OUT * np.median(combs_left):
        return []
    if not (_at_other_speeds(records, shafts) or np.sort(shares[:, at].sum(0))[-2] >= HARMONIC * energy[at]):
        return []
    message = (
        f"the mesh order {teeth} is absent, while order {orders[at]} stands out: check n_teeth_pinion, the shaft that "
        "pinion_angle belongs to, and its unit"
    )
    return [Finding("mesh_order_absent", message, channel=evidence.channel.name)]


def _miscounted(series: Sequence[NDArray], shafts: Sequence[NDArray], counts: tuple[int, int], order: int = 0) -> float:
    """By what the order of the mesh is off where turns were counted by another number of counts; 0 where by none.

    Of all harmonics of a quarter of the tooth count, those of the mesh that is there hold the energy of every record.
    Those between the harmonics of the declared mesh may be another machine's on the shaft, beside the mesh, if they go
    round a whole number of times in a turn of a shaft; if they do in none, the mesh alone makes them. Records that are
    too short for the lowest, or too coarse for the highest, tell nothing. What is lacking of a rate, a derivative of
    this order in time, is so of the motion.
    """
    teeth, _ = counts
    passed = [teeth * float(np.ptp(angle)) / (2 * np.pi) for angle in shafts]
    highest = min(len(angle) * DECODED / max(2 * one, 1e-300) for one, angle in zip(passed, shafts, strict=True))
    if min(passed) < DECODED * FEWEST_TEETH or highest < 2 * DECODED:
        return 0.0
    most = min(int(highest), 2 * DECODED**2)
    shares = _shares(series, shafts, [teeth / DECODED], most)[:, 0]  # (records, harmonics)
    number = np.arange(1, most + 1)
    own = number % DECODED == 0
    for step in (1, 2):
        between = number % (2 * step) == step
        of_no_shaft = all(count * step % DECODED for count in counts)
        if not of_no_shaft or (there := shares[:, between].sum(1)).min() < BETWEEN:
            continue
        beside = _shares(series, shafts, [(teeth - BESIDE) / DECODED, (teeth + BESIDE) / DECODED], most)
        if (there >= STANDS_OUT * beside[..., between].sum(2).max(1)).all():
            return step / DECODED
    if most < DECODED**2:
        return 0.0
    for step in (2, 1):
        others = (number % step == 0) & ~own
        is_there = shares[:, others].sum(1).min() >= STRONG
        if is_there and (shares[:, own].sum(1) < FAINT * shares[:, others].sum(1)).all():
            return step / DECODED
    moved = shares / number.astype(float) ** (2 * order)
    for factor in (DECODED, 2):
        there = number % (factor * DECODED) == 0
        lacking = moved[:, own & ~there].sum(1) < LACKING * moved[:, there].sum(1)
        if shares[:, there].sum(1).min() >= STRONG and lacking.all():
            return float(factor)
    return 0.0


def _other_unit(
    series: Sequence[NDArray], shafts: Sequence[NDArray], counts: tuple[int, int]
) -> tuple[str, str] | None:
    """The declared unit of the turning and the one in which its number gives the mesh that is there; None of none.

    Harmonics of that mesh hold much of every record, far more than combs of two teeth more and fewer, and the declared
    mesh next to nothing. What a shaft makes, at whole orders of its own, is none.
    """
    teeth, turns = counts[0], [float(np.ptp(angle)) / (2 * np.pi) for angle in shafts]
    for factor, units in UNITS.items():
        order = factor * teeth
        seen = [(order * one, len(angle) / 4) for one, angle in zip(turns, shafts, strict=True)]
        if not all(FEWEST_TEETH <= passed <= most for passed, most in seen):
            continue
        own_orders = ((order * n / teeth, min(turns) * teeth / n) for n in counts)  # of each shaft, and its turns
        if factor < 1 and any(abs(one - round(one)) * count < TURNS_APART for one, count in own_orders):
            continue
        shares = _shares(series, shafts, [order, teeth, order - BESIDE * factor, order + BESIDE * factor])
        there, own, *beside = shares.sum(2).T  # (orders, records)
        if there.min() >= STRONG and (own < FAINT * there).all() and (there >= STANDS_OUT * np.max(beside, 0)).all():
            return units
    return None


def _shares(
    series: Sequence[NDArray], shafts: Sequence[NDArray], orders: Sequence[float], count: int = HARMONICS
) -> NDArray:
    """Share of each record's variance at the first harmonics of each order, (records, orders, harmonics)."""
    energies = [
        [(_waves(values, angle, order, count) ** 2).sum(0) / max(values @ values, 1e-300) for order in orders]
        for values, angle in zip(series, shafts, strict=True)
    ]
    return np.array(energies)


def _waves(values: NDArray, angle: NDArray, order: float, count: int = HARMONICS) -> NDArray:
    """The first harmonics of an order in a record, fitted together, (samples, harmonics)."""
    phase = np.arange(1, count + 1) * order * angle[:, None]
    waves = np.stack([np.cos(phase), np.sin(phase)], 2)  # (samples, harmonics, 2)
    found = np.linalg.lstsq(waves.reshape(len(values), -1), values, rcond=1e-8)[0].reshape(count, 2)
    return np.einsum("thp,hp->th", waves, found)


def _at_other_speeds(records: Sequence[FitRecord], shafts: Sequence[NDArray]) -> bool:
    """Whether the shaft turned at different speeds."""
    speeds = [
        abs(float(angle[-1] - angle[0])) * record.sampling_rate / max(1, len(angle) - 1)
        for record, angle in zip(records, shafts, strict=True)
    ]
    return max(speeds) > (1 + OTHER_SPEED) * min(speeds)


def sentences(findings: Sequence[Finding]) -> list[str]:
    """One line for each finding."""
    return [f"{' '.join(filter(None, (f.record, f.channel)))}: {f.message}" for f in findings]
