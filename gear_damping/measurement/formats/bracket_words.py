"""Which of the words in the brackets of a header is its unit: `mm, LP 1kHz`, `g pk`, `in mm`, `filtered, mm`.

Two kinds of words are told apart. Those that are a unit and hardly anything else say it whatever they stand beside.
Others may as well be a side, a channel or a number of it, and count where a unit of their kind is declared.
"""

import re

from gear_damping.measurement.formats.unit_words import as_ours
from gear_damping.units import is_of_kind, multiple_of_a_unit, scaled_unit

_MEASURE = (
    r"(?:rms|eff|pk-pk|pkpk|pk|p-p|p2p|ptp|(?<!A)pp|0-pk|0-p|peak-to-peak|peak-peak|peak)"  # how a level is taken
)
_IS_MEASURE = re.compile(rf"{_MEASURE}\b", re.I)
_WITH_MEASURE = re.compile(rf"^(?P<unit>.*?[^\W_])[_\-]?{_MEASURE}$", re.I)  # `grms`, `mm-pp`, `V_rms`
_FIRST = re.compile(r"^\s*(?P<word>[^\s,;:|]+)(?P<sign>\s*[,;:|]|\s+[-–—]+(?=\s))?\s*(?P<behind>.*)$")
_IN = re.compile(r"(?:^|\s)in\s+(\S+)\s*$")  # `in mm`, `Weg in mm`
_LAST = re.compile(r"[,;:|]\s*(\S+)\s*$|\s[-–—]+\s+(\S+)\s*$")  # `filtered, mm`
_PREFIXES = {"nano": "n", "micro": "u", "milli": "m", "centi": "c", "kilo": "k", "mega": "M"}
_PREFIXED = re.compile(rf"^({'|'.join(_PREFIXES)})[- ]?([A-Za-z]\S*)$", re.I)
_OWN = {  # of a length, or of an angle
    "mG": ("mg",), **dict.fromkeys(('"', "''", "″"), ("in", "arcsec")), **dict.fromkeys(("'", "′"), ("ft", "arcmin")),
}  # fmt: skip
_LEVEL = re.compile(r"dB[A-Za-zµμ]+$")  # over a volt, a milliwatt
_COUNTS = re.compile(r"(adc[ _-]?)?(counts?|cts?|lsbs?|digits?|pixels?|px|pulses?|ticks?|increments?)", re.I)
_BETWEEN = re.compile(r"[\s,;:|]+")
# Units of more than one letter that are words too: of place, of number, of the one that is meant.
_WORDS = {
    "in", "min", "rev", "day", "days", "hour", "turn", "second", "minute", "meter", "amp", "pm", "Second", "Meter",
    "Rad", "RAD", "step",
}  # fmt: skip
_PARTS = {"rad", "bar", "mil"}  # `rad direction`, `bar 3`: of a unit of their kind they are hardly one


def unit_said(text: str) -> str | None:
    """The unit that a text in brackets says beyond doubt, a step or a factor of one too; None of any other text."""
    text = as_ours(text.strip())
    if is_known(text) or multiple_of_a_unit(text) or scaled_unit(text):
        return text
    if (said := _IN.search(text)) and is_known(said[1]):
        return said[1]
    first = _FIRST.match(text)
    unit, is_measured = _parted(first["word"]) if first else ("", False)
    if not unit:
        return None
    if is_measured or _IS_MEASURE.match(first["behind"]):
        return unit
    return None if len(unit) == 1 or unit in _WORDS | _PARTS else unit


def unit_of_its_kind(text: str, plain: str) -> str | None:
    """The first word of a text in brackets that is a unit of the kind of another one; None where none is.

    One letter, and what is a word too, counts in front of a sign or behind the last one (`A, left`, `left, g`). What
    stands behind a number is no unit of the column: `probe of 3 mm`.
    """
    first, last = _FIRST.match(text), _LAST.search(text)
    apart = [first["word"]] if first and first["sign"] else []
    apart += [one for one in last.groups() if one] if last else []
    words = [word for word in _BETWEEN.split(text) if word]
    for before, word in zip(["", *words], words, strict=False):
        unit, is_measured = _parted(word)
        is_plain = len(unit) > 1 and unit not in _WORDS
        counts = is_plain or is_measured or word in apart
        if counts and not re.search(r"\d", before) and is_of_kind(unit, plain):
            return unit
    return None


def spelt_out(text: str, plain: str) -> str | None:
    """The unit of the kind of another one that a text spells in a way of its own, `milli g`, `mG` or `"`; else None."""
    text = text.strip()
    prefixed = _PREFIXED.match(text)
    said = (_PREFIXES[prefixed[1].lower()] + prefixed[2],) if prefixed else _OWN.get(text, ())
    return next((unit for unit in said if is_of_kind(unit, plain)), None)


def is_level(text: str) -> bool:
    """Whether a text is the unit of a level, `dBV`, which is a logarithm."""
    return bool(_LEVEL.match(text.strip()))


def is_count(text: str) -> bool:
    """Whether a text says that a column counts something, `LSB` of a converter or `px` of a video."""
    return bool(_COUNTS.fullmatch(text.strip()))


def is_known(word: str) -> bool:
    """Whether a word is a unit, and no number."""
    return bool(re.search(r"[^\W\d]|[%°]", word)) and is_of_kind(word, word)


def _parted(word: str) -> tuple[str, bool]:
    """The unit that a word is, without what says how a level of it was taken, and whether that stands there."""
    if is_known(word):
        return word, False
    found = _WITH_MEASURE.match(word)
    return (found["unit"], True) if found and is_known(found["unit"]) else ("", False)
