"""What could not be told apart or not be seen, and which measurement would change that."""

from collections.abc import Sequence

from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.ranking import Score, collinearity

ALIKE = 0.9  # collinearity from which two effects count as confusable beforehand
LARGEST_SET = 4  # names in a set
SEPARATES = {
    "torque": "repeat the records at another torque (half and twice): forces that hang on the load scale with it, "
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
WANTED = {
    "power_law_damping": "ring_down", "coulomb_friction": "ring_down", "hysteretic_damping": "speed",
    "asymmetric_friction": "reversal", "hunt_crossley_damping": "torque", "squeeze_film_damping": "torque",
    "cubic_stiffness": "torque", "quadratic_stiffness": "torque", "hertz_stiffness": "torque",
    "tooth_friction": "torque", "backlash": "reversal", "pinion_eccentricity": "torque_channel",
    "gear_eccentricity": "torque_channel", "encoder_error": "remount", "pinion_stiffness_modulation": "torque",
    "gear_stiffness_modulation": "torque", "profile_error": "torque", "pitch_error": "torque", "tooth_crack": "torque",
    "torque_variation": "torque_channel", "torque_ripple": "torque_channel",
    "bearing_flexibility": "bearing", "shaft_torsion": "bearing",
    "load_dependent_contact": "torque", "windage_drag": "speed", "sensor_gain": "torque", "sensor_offset": "torque",
    "sensor_drift": "torque", "sensor_delay": "speed", "sensor_lowpass": "speed", "shaft_angle_error": "torque",
}  # fmt: skip


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
    wishes = [_for_system(WANTED.get(name, "torque"), evidence) for name in names] or [
        _for_system("torque", evidence)
    ]
    chosen = max(dict.fromkeys(wishes), key=wishes.count)
    known = {"separates": list(names), "conditions_so_far": evidence.conditions}
    return {"kind": chosen, "what": f"{SEPARATES[chosen][0].upper()}{SEPARATES[chosen][1:]}."} | known


def _for_system(kind: str, evidence: Evidence) -> str:
    if evidence.system == "oscillator":
        return "ring_down" if "force" not in evidence.fit[0].inputs else "amplitude"
    return kind
