"""Step 0: damaged data end the explanation before any physics is blamed."""

from collections.abc import Sequence

import numpy as np

from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.unexplained import shaft_of
from gear_damping.measurement.record import Finding, Measurement

HARMONICS = 4  # of a comb
FAINT = 0.1  # share of the strongest comb's energy below which the mesh order is absent
LEAST_ORDER = 0.6  # of the tooth count, from which other combs are compared with the mesh


def data_faults(measurement: Measurement) -> list[Finding]:
    """Findings of the measurement that forbid naming a cause."""
    return [finding for finding in measurement.findings if finding.severity == "data_problem"]


def mesh_order_faults(evidence: Evidence) -> list[Finding]:
    """A finding where the tooth meshing order is absent and another comb stands out instead."""
    if evidence.system != "gear_pair":
        return []
    if evidence.channel.name != "transmission_error":
        return []
    records = evidence.records
    teeth = round(evidence.parameters.get("n_teeth_pinion", 20))
    orders = [n for n in range(max(5, round(LEAST_ORDER * teeth)), 2 * teeth) if n == teeth or n % teeth]
    energy = np.zeros(len(orders))
    for record in records:
        shaft = shaft_of(record, evidence)
        values = record.response.numpy() - float(record.response.mean())
        energy += np.array([_comb(values, shaft.angle, order) for order in orders]) / max(values @ values, 1e-300)
    own, best = float(energy[orders.index(teeth)]), orders[int(energy.argmax())]
    if own >= FAINT * float(energy.max()):
        return []
    message = (
        f"the mesh order {teeth} is absent, while order {best} stands out: check n_teeth_pinion, the shaft that "
        "pinion_angle belongs to, and its unit"
    )
    return [Finding("mesh_order_absent", message, channel="transmission_error")]


def _comb(values: np.ndarray, angle: np.ndarray, order: int) -> float:
    """Energy at the first harmonics of an order."""
    waves = np.stack([f(h * order * angle) for h in range(1, HARMONICS + 1) for f in (np.cos, np.sin)], 1)
    fitted = waves @ np.linalg.lstsq(waves, values, rcond=1e-8)[0]
    return float(fitted @ fitted)


def sentences(findings: Sequence[Finding]) -> list[str]:
    """One line for each finding."""
    return [f"{' '.join(filter(None, (f.record, f.channel)))}: {f.message}" for f in findings]
