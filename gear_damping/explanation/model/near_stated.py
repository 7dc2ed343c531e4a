"""A mesh that a free fit puts beyond critical damping, and what it is held near then."""

from dataclasses import replace
from math import isfinite

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.model.nominal_gear_pair import FLAT
from gear_damping.physics.systems.traits import Trait

CRITICAL = 1.0  # no mesh comes near it: lubricated steel has a hundredth to a tenth
# relative standard deviations: standards give a mesh stiffness within a tenth, tables a damping within a factor of two
WITHIN = {"mesh_stiffness_max": 0.1, "mesh_stiffness_min": 0.1, "damping_ratio": 0.5}


def mesh_damping_ratio(outcome: Outcome) -> float:
    """Viscous damping ratio of a fitted mesh about its mean stiffness, 1 where critical; 0 where nothing is."""
    mass, damping, stiffness = linear_of(outcome)
    return damping / (2 * (stiffness * mass) ** 0.5) if stiffness > 0 else 0.0


def is_overdamped(outcome: Outcome, evidence: Evidence) -> bool:
    """Whether the fit of a gear pair has gone to where its mesh does not swing."""
    return evidence.has(Trait.TEETH) and mesh_damping_ratio(outcome) > CRITICAL


def near_stated(evidence: Evidence) -> Evidence | None:
    """The evidence with a mesh that is known about as well as tables are; None where nothing is stated to hold it.

    What is stated without an uncertainty is where a fit begins, and does not hold it. Where most of what the records
    hold is not in the model, and slow, a stiff and dead mesh follows them best.
    """
    known = evidence.known
    added = {
        name: within for name, within in WITHIN.items() if known.values.get(name) and name not in known.uncertainty
    }
    if not added:
        return None
    return replace(evidence, known=replace(known, uncertainty=dict(known.uncertainty) | added))


def is_held_near_stated(nominal: Outcome, evidence: Evidence) -> bool:
    """Whether something of the mesh was held so, with no such uncertainty in the file."""
    held = {p.name for p in nominal.problem.free if isfinite(p.deviation)}
    added = {FLAT[name] for name in WITHIN if name not in evidence.known.uncertainty}
    return evidence.has(Trait.TEETH) and bool(added & held)
