"""The unit that the name of a column ends in, of a channel (`speed_rpm`, `posMm`, `v_mm_s`) or of time (`t_min`)."""

import re
from collections.abc import Iterable, Mapping, Sequence

from gear_damping.units import is_of_kind

NAMED_UNITS = {  # by the last word of a name in lower case; neither `in` nor `m` nor `g`, which may be another word
    "mm": "mm", "um": "um", "cm": "cm", "deg": "deg", "mrad": "mrad", "rad": "rad", "rpm": "rpm", "nm": "N*m",
    "mv": "mV", "volt": "V", "volts": "V", "degrees": "deg", "radians": "rad", "mps2": "m/s^2",
    "urad": "urad", "arcsec": "arcsec", "arcmin": "arcmin", "degree": "deg", "radian": "rad",
    "inch": "inch", "inches": "inch", "mil": "mil", "mils": "mil", "micron": "um", "microns": "um",
    "micrometer": "um", "micrometers": "um", "micrometre": "um", "micrometres": "um",
    "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm",
    "centimeter": "cm", "centimeters": "cm", "centimetre": "cm", "centimetres": "cm",
    "mps": "m/s", "mmps": "mm/s", "kmh": "km/h", "kmph": "km/h", "kph": "km/h", "ips": "in/s",
    "dps": "deg/s", "rps": "rev/s", "mg": "mg", "ms2": "m/s^2", "ms-2": "m/s^2", "ms^-2": "m/s^2",
    "mmps2": "mm/s^2", "knm": "kN*m", "ncm": "N*cm", "nmm": "N*mm", "millivolt": "mV", "millivolts": "mV",
    "lbf": "lbf", "kgf": "kgf", "krpm": "krpm", "radps": "rad/s", "mph": "mph", "knots": "knot", "turns": "rev",
    "feet": "ft", "meters": "m", "metres": "m",
    "gfx": "g", "gfy": "g", "gfz": "g", "tgf": "g", "gforce": "g",
}  # fmt: skip
_CASED = {"kN": "kN", "daN": "daN", "mNm": "mN*m", "MNm": "MN*m"}  # whose capitals tell a prefix
_TIMES = {  # the same of time, in six languages, without what also names any clock: `time of day`, `time tag`, `hora`
    "s": "s sec secs second seconds sek sekunde sekunden seconde secondes segundo segundos secondi",
    "ms": "ms msec msecs msek millis millisec millisecond milliseconds millisekunde millisekunden milliseconde "
    "millisecondes",
    "us": "us µs μs usec usecs micros microsec microsecond microseconds mikrosekunde mikrosekunden microseconde "
    "microsecondes",
    "ns": "ns nsec nsecs nanos nanosec nanosecond nanoseconds nanosekunden nanosecondes",
    "min": "min mins minute minutes minuten minutos minuti",
    "h": "h hr hrs hour hours stunden heures horas",
    "day": "days tage jours dias",
}
TIME_UNITS = {word: unit for unit, words in _TIMES.items() for word in words.split()}
_OVER = {"s": "s", "s2": "s^2", "s^2": "s^2", "sec": "s", "sec2": "s^2"}  # the last word of a rate, `deg_s`
_MOVED = ("mm", "um", "cm", "m", "deg", "rad", "mrad", "rev")  # the word before it
_PAIRS = {
    ("N", "m"): "N*m", ("N", "mm"): "N*mm", ("N", "cm"): "N*cm", ("mN", "m"): "mN*m",
    ("kN", "m"): "kN*m", ("km", "h"): "km/h", ("rev", "min"): "rpm",
}  # fmt: skip
_WEIGHTS = {"lbf": "lbf", "lb": "lbf", "lbs": "lbf", "ozf": "ozf", "oz": "ozf"}  # times a lever: a torque
_LEVERS = ("in", "ft")
_WEIGHT_OF_LEVER = re.compile(r"^(?:(lbf|lbs?|ozf?)(in|ft)|(in|ft)(lbf|lbs?|ozf?))$")  # in one word, `inlb`
_COMPOUND = re.compile(r"(?:^|[\s_.\-])(?P<unit>1/min|(?:[^\W\d_]|°)+[/*·][^\s_]+)\s*$")  # `acc_m/s^2`, `n 1/min`
_OF_CHANNELS = ("m/s", "m/s^2", "rad/s", "rad/s^2", "N*m")  # others may be a symbol over its unit: `F_t/N` in tonnes
_BETWEEN = re.compile(r"[_\s/.\[\](]+")
_BETWEEN_OF_TIME = re.compile(r"[_\s/.\-]+")
_BEHIND = re.compile(r"^(\d+|x|y|z|filt|filtered|raw|smooth|smoothed|corrected)$", re.I)  # what may follow a unit
_CAPITAL = re.compile(r"(?<=[a-zäöüµ])(?=[A-Z][A-Za-z]+\d?$)")  # where the last word of `posMm` begins
_WHEEL = re.compile(r"winkel|drehzahl|drehmoment|moment|beschl|weg|ritzel", re.I)  # German names, where a `Rad` is one
_SINGLE = re.compile(r"[_ \-]\w$|^[^/.]+/\s*\w$")  # one letter that is a unit: behind a stroke, and no part of a path


def unit_of_name(reference: str | int) -> str | None:
    """The unit that the name of a column ends in, or that it is, as in `V1`."""
    is_voltage = re.search(r"(^|[_\s/.\[\](])[UV]\d+$", str(reference).strip(")] "))  # a small v may be a velocity
    return unit_at_end(reference) or ("V" if is_voltage else None)


def unit_at_end(reference: str | int) -> str | None:
    """The unit that the name of a column ends in or is, as in `speed_rpm`, `gyro_deg_s`, `x_mm_filtered` or `mm`."""
    name = str(reference)
    if compound := compound_at_end(name):
        return compound
    words = _words(name)
    if not words or (words[-1].endswith("Rad") and (words == ["Rad"] or _WHEEL.search(name))):
        return None
    return _of_two_words(words) or _torque(words) or _CASED.get(words[-1]) or _unit_in(words[-1], NAMED_UNITS)


def gravity_at_end(reference: str | int) -> bool:
    """Whether a name ends in a `g` of its own, which may be that of an accelerometer, or stand for gear or ground."""
    return _words(str(reference))[-1:] in (["g"], ["G"])


def _words(name: str) -> list[str]:
    """The words of a name, without those that may stand behind its unit."""
    words = [word for word in _BETWEEN.split(name.strip(")] ")) if word]
    while len(words) > 1 and _BEHIND.match(words[-1]):
        words.pop()
    return words


def _of_two_words(words: Sequence[str]) -> str | None:
    """The unit of a name that ends in two of its factors: `v_mm_s`, `gyro_deg_per_s`, `T_N_m`."""
    kept = [word for word in words if word.lower() != "per"]
    if len(kept) < 2:
        return None
    above, below = kept[-2:]
    if pair := _PAIRS.get((above, below)):
        return pair
    is_symbol = len(above) == 1 and len(words) == 2  # `m_s` alone, a mass
    return f"{above.lower()}/{_OVER[below]}" if above.lower() in _MOVED and below in _OVER and not is_symbol else None


def _torque(words: Sequence[str]) -> str | None:
    """The torque of a name that ends in a weight and a lever, in either order: `T_lbf_in`, `torque_ftlb`."""
    joined = _WEIGHT_OF_LEVER.match(words[-1].lower())
    last = [part for part in joined.groups() if part] if joined else [word.lower() for word in words[-2:]]
    orders = (last, last[::-1]) if len(last) == 2 else ()
    return next((f"{_WEIGHTS[a]}*{b}" for a, b in orders if a in _WEIGHTS and b in _LEVERS), None)


def _unit_in(word: str, units: Mapping[str, str]) -> str | None:
    """The unit that a word is, or that it ends in behind a small letter, as in `posMm`."""
    return units.get(word.lower()) or units.get(_CAPITAL.split(word)[-1].lower())


def compound_at_end(name: str) -> str | None:
    """The unit of several factors that a name ends in or is, as in `acc_m/s^2`; None of any other name."""
    found = _COMPOUND.search(name)
    unit = found["unit"] if found else None
    return unit if unit == "1/min" or any(is_of_kind(unit, kind) for kind in _OF_CHANNELS) else None


def time_at_end(reference: str | int, others: Iterable[str] = ()) -> str | None:
    """The unit of time that the name of a column ends in or is: `t_ms`, `Zeit in Minuten`, `TimeMs`, `hours`.

    Args:
        reference: The name.
        others: Those of the other columns: `t_min` is the least of something beside `t_max`.
    """
    name = re.sub(r"[(\[].*$", "", str(reference)).strip()
    words = [word for word in _BETWEEN_OF_TIME.split(name) if word]
    while len(words) > 1 and words[-1].isdecimal():
        words.pop()
    if not words:
        return None
    word = words[-1]
    if len(word) == 1 and not (len(words) > 1 and _SINGLE.search(name)):
        return None  # a symbol, or the member of a structure
    if word.lower().endswith("min"):
        most = name.lower().replace("min", "max")
        return None if word.lower() != "min" or most in [one.lower() for one in others] else "min"  # not of `tMin`
    return _unit_in(word, TIME_UNITS)
