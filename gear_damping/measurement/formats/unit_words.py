"""Units in the words of other languages and in spellings that headers have and a measurement.yaml does not take.

A header is read as it was written by a recorder; whoever writes a YAML is told how a unit is spelt.
"""

import re

from gear_damping.units import is_of_kind

_WORDS = {
    "s": "seg segs segundo secondo secondi",
    "ms": "mseg milisegundo milisegundos millisecondi millisecondes milliseconde Millisekunde Millisekunden",
    "us": "useg microsegundos microsecondi microsecondes Mikrosekunde Mikrosekunden",
    "min": "minuti minutos Minuten",
    "h": "Stunden heures horas",
    "m": "metri mètre mètres metros",
    "mm": "millimetri millimètre millimètres milímetros milimetros",
    "um": "micrometri micromètre micromètres micrómetros micrometros",
    "deg": "gradi degré degrés grados",
    "rad": "radianti radianes",
    "N*m": "Newtonmeter newtonmeter newtonmetri newton-mètre newton-mètres",
}
_OURS = {word.lower(): unit for unit, words in _WORDS.items() for word in words.split()}
_TURNS = {  # above a time
    "giri",
    "tours",
    "tour",
    "obr",
    "obr.",
    "vueltas",
    "umdr",
    "umdr.",
    "umdrehungen",
    "u",
    "tr",
    "rev.",
}
_MINUTES = {"mn": "min", "1'": "min", "min.": "min"}  # below turns
_POUNDS = {"lb": "lbf", "lbs": "lbf", "oz": "ozf", "kp": "kgf"}  # a weight times a lever
_FORCE, _LEVER, _BETWEEN = (
    r"(?P<force>kN|mN|daN|MN|N|kgf|kp|lbfs?|lbs?|ozf?)",
    r"(?P<lever>mm|cm|m|in|ft)",
    r"[ .\-·*]?",
)
_TORQUES = (
    re.compile(rf"^{_FORCE}{_BETWEEN}{_LEVER}$"),
    re.compile(rf"^(?P<lever>in|ft){_BETWEEN}(?P<force>lbf?s?|ozf?)$"),
)


def as_ours(text: str) -> str:
    """The unit that a whole text says in a way of its own, as it is spelt here; any other text as it is."""
    said = text.strip()
    if is_of_kind(said, said) or not said:
        return text
    above, *below = [part.strip() for part in said.split("/")]
    turning = "/".join(["rev", *(_MINUTES.get(part.lower(), _plain(part)) for part in below)])
    if below and above.lower() in _TURNS and is_of_kind(turning, "rad/s"):
        return turning
    found = "/".join(map(_plain, (above, *below)))
    return found if found != said and is_of_kind(found, found) else text


def _plain(part: str) -> str:
    """One side of a stroke as it is spelt here."""
    if part.lower() in _OURS:
        return _OURS[part.lower()]
    torque = next((match for pattern in _TORQUES if (match := pattern.match(part))), None)
    if torque:
        return f"{_POUNDS.get(torque['force'], torque['force'].removesuffix('s'))}*{torque['lever']}"
    bare = part.replace(".", "")  # `r.p.m.`, `Sek.`
    return _OURS.get(bare.lower(), bare) if part.endswith(".") and bare.lower() != "min" else part
