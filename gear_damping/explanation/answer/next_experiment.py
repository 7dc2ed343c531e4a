"""What could not be told apart or not be seen, and which measurement would change that."""

from collections.abc import Sequence

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.trials.score import Score, collinearity
from gear_damping.physics.systems.traits import Trait

ALIKE = 0.9  # collinearity from which two effects count as confusable beforehand
SEPARATES = {
    "torque": "repeat the records at another torque (half and twice): forces that depend on the load scale with it, "
    "geometric errors do not",
    "speed": "repeat the records at another speed: inertia, windage and delays change with it, stiffness does not",
    "torque_channel": "record the pinion torque: a ripple of the torque shows there, an eccentricity does not",
    "bearing": "add an accelerometer or displacement sensor at the bearing",
    "remount": "remount the encoder turned by 180 degrees: its own error turns with it, that of the gear does not",
    "ring_down": "record a ring-down from a larger amplitude: laws of damping and stiffness "
    "differ in how they change with it",
    "amplitude": "excite at half and at twice the level: nonlinear forces change their share, linear ones do not",
    "reversal": "reverse the torque slowly: the mean deflection steps by the gap, and offsets separate from friction",
}


def confusable_beforehand(scores: Sequence[Score], name: str) -> list[str]:
    """Effects whose projected sensitivity in these data is nearly that of `name`."""
    own = [score for score in scores if score.candidate.name == name and score.gain > 0]
    if not own:
        return []
    others = {score.candidate.name for score in scores if score.candidate.name != name}
    found = {
        other: max(collinearity(own[0], s) for s in scores if s.candidate.name == other and s.gain >= 0)
        for other in others
    }
    return [other for other, alike in sorted(found.items(), key=lambda item: -item[1]) if alike > ALIKE]


def next_experiment(names: Sequence[str], evidence: Evidence) -> dict[str, object]:
    """The measurement that would separate these effects.

    Args:
        names: Effects that the data do not tell apart, or the one cause that was named.
        evidence: The records, which say what has been varied already.
    """
    wanted = [evidence.library[name].cause.separated_by for name in names if name in evidence.library]
    wishes = [_for_system(kind, evidence) for kind in wanted or ["torque"]]
    chosen = max(dict.fromkeys(wishes), key=wishes.count)
    known = {"separates": list(names), "conditions_so_far": evidence.conditions}
    return {"kind": chosen, "what": f"{SEPARATES[chosen][0].upper()}{SEPARATES[chosen][1:]}."} | known


def _for_system(kind: str, evidence: Evidence) -> str:
    if evidence.has(Trait.REST):
        drive = next(iter(evidence.base.inputs))
        return "amplitude" if drive in evidence.fit[0].inputs else "ring_down"
    return kind
