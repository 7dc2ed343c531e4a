"""Units in the words of other languages and in spellings that headers have and a measurement.yaml does not take.

A header is read as it was written by a recorder; whoever writes a YAML is told how a unit is spelt.
"""

import re

from gear_damping.units import is_of_kind

_WORDS = {
    "s": "seg segs segundo secondo secondi с сек секунда секунды 秒",
    "ms": "мс мсек 毫秒 mseg milisegundo milisegundos millisecondi "
    "millisecondes milliseconde Millisekunde Millisekunden",
    "us": "мкс 微秒 useg microsegundos microsecondi microsecondes Mikrosekunde Mikrosekunden",
    "min": "мин 分 minuti minutos Minuten",
    "h": "ч Stunden heures horas",
    "m": "м 米 metri mètre mètres metros",
    "mm": "мм 毫米 millimetri millimètre millimètres milímetros milimetros",
    "cm": "см 厘米",
    "um": "мкм 微米 micrometri micromètre micromètres micrómetros micrometros",
    "deg": "град 度 gradi degré degrés grados",
    "rad": "рад 弧度 radianti radianes",
    "N": "Н 牛",
    "kN": "кН",
    "V": "В 伏",
    "mV": "мВ",
    "Hz": "Гц",
    "kHz": "кГц",
    "N*m": "Н·м Н*м Нм 牛米 Newtonmeter newtonmeter newtonmetri newton-mètre newton-mètres",
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
    "об",
    "об.",
    "转",
}
_MINUTES = {"mn": "min", "1'": "min", "min.": "min", "мин.": "min", "分钟": "min"}  # below turns
_POWER = re.compile(r"\^?2$|²$")  # of a unit, `м/с²`
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
    power = _POWER.search(part)
    if power and part[: power.start()].lower() in _OURS:
        return f"{_OURS[part[: power.start()].lower()]}^2"
    torque = next((match for pattern in _TORQUES if (match := pattern.match(part))), None)
    if torque:
        return f"{_POUNDS.get(torque['force'], torque['force'].removesuffix('s'))}*{torque['lever']}"
    bare = part.replace(".", "")  # `r.p.m.`, `Sek.`
    return _OURS.get(bare.lower(), bare) if part.endswith(".") and bare.lower() != "min" else part
