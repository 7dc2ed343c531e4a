"""What stands beside the number of a rate, or of the time from one sample to the next: `kHz/ch`, `kS/sec`, `(k)`."""

import re
from dataclasses import dataclass

from gear_damping.measurement.named_units import TIME_UNITS
from gear_damping.units import is_of_kind, to_si

_PER_CHANNEL = re.compile(r"\s*(?:/|\bper\b)\s*(?:ch(?:an(?:nel)?)?s?|kanal|sensor)\.?$", re.I)
_LARGE = {"k": 1e3, "K": 1e3, "kilo": 1e3, "M": 1e6, "mega": 1e6, "G": 1e9}  # an `m` may be milli
_SAMPLES = re.compile(
    rf"(?P<large>{'|'.join(_LARGE)})?[ -]?(?:(?i:sps)|"
    r"(?:[Ss]|(?i:sa|samp(?:le)?s?|scans?|frames?|points?|pts|readings?))\s*(?:/|\bper\b|\ba\b)\s*(?P<over>[a-z]+))"
)
_HERTZ = {"khz": "kHz", "mhz": "MHz", "ghz": "GHz"}  # in other letters; nobody samples at mHz
_OF_SECONDS = re.compile(r"[mnuµμ]S")  # no siemens beside a step
_BRACKETS = re.compile(r"[(\[{]([^()\[\]{}]+)[)\]}]")
_IN, _AT_END = re.compile(r"\bin\s+(\S+)$", re.I), re.compile(r"(?:_(?P<single>[a-z])|[\s_](?P<word>\w\w+))$", re.I)
_TOLERANCE = re.compile(r"^\s*(?:±|\+/?-)\s*[\d.,]+(?:e[+-]?\d+)?\s*", re.I)
_OTHER = re.compile(r"^\s*(?:[;|,#]|$|\w[\w ]*[:=])")  # behind a number, what belongs to something else
# What makes another unit of the word before it, or a rate of all channels together.
_MORE = re.compile(r"^\s*(?:per\b|a\b|[/*·^\d])|\b\d+ ?ch(?:an(?:nel)?)?s?\b", re.I)
_MOST_WORDS = 3  # of a unit, as in `samples per second`
_PARTED = re.compile(r"[1-9]\d{0,2}(?P<sign>[.,])\d{3}(?:(?P=sign)\d{3})*(?P<rest>(?!(?P=sign))[.,]\d*)?")


@dataclass(frozen=True)
class Size:
    """One of a unit in SI; `kind` is Hz or s. Where nothing says the unit, `is_said` is False."""

    factor: float
    kind: str
    is_said: bool = True


def number_said(text: str, decimal: str = ".") -> float | None:
    """The number that a text of digits and signs is; None of no number, and where its sign may as well part thousands.

    Args:
        text: The text, `2000`, `2.000,0` or `1e-3`.
        decimal: The decimal sign of the file.
    """
    text = text.rstrip(",")
    parted = _PARTED.fullmatch(text)
    if parted is not None and (parted["rest"] or text.count(parted["sign"]) > 1):
        text = text.replace(parted["sign"], "")
    elif parted is not None and parted["sign"] != decimal:
        return None
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return None


def size_said(name: str, tail: str, behind: str, is_step: bool) -> Size | None:
    """The unit of a number that is named a rate or a step of time; None where what stands beside it is not read.

    What contradicts itself is not read either. Where nothing that may be a unit stands there it is Hz, or s of a step.

    Args:
        name: What stands before the number.
        tail: The part of it behind the words that name it.
        behind: What stands behind the number.
        is_step: Whether it is named as the time from one sample to the next.
    """
    tail = tail.strip(" \t:=,;")
    named = [*_BRACKETS.findall(name), *(one[1] for one in [_IN.search(tail)] if one)]
    sizes = [*(size_of(one, is_step) for one in named), _at_end(tail, is_step), _leading(_phrase(behind), is_step)]
    read = {size for size in sizes if size is not None}
    if len(read) == 1:
        return read.pop()
    is_said = any(_PER_CHANNEL.sub("", one).strip(" .()[]") for one in (*named, _phrase(behind)))
    return None if is_said or read else Size(1.0, "s" if is_step else "Hz", is_said=False)


def size_of(text: str, is_step: bool = False) -> Size | None:
    """One of the unit that a text is, a rate or a time; None of any other text."""
    plain = _PER_CHANNEL.sub("", text.strip()).strip(" \t()[]{}.:=,;")
    if _OF_SECONDS.fullmatch(plain):
        plain = plain.lower()
    plain = plain if plain == "mHz" else _HERTZ.get(plain.lower(), plain)
    if plain == "GHz":
        return Size(1e9, "Hz")
    for kind, unit in (("Hz", plain), ("s", plain), ("s", TIME_UNITS.get(plain.lower(), ""))):
        if is_of_kind(unit, kind):
            return Size(to_si(1.0, unit, kind), kind)
    if plain in _LARGE and not is_step:
        return Size(_LARGE[plain], "Hz")
    return samples_a_time(plain)


def samples_a_time(text: str) -> Size | None:
    """One of a unit that counts samples, `kSPS`, `samples/min` or `pts per second`; None of any other text."""
    found = _SAMPLES.fullmatch(text.strip(" \t()[]{}.:=,;"))
    if found is None:
        return None
    over = TIME_UNITS.get((found["over"] or "s").lower())
    return Size(_LARGE.get(found["large"], 1.0) / to_si(1.0, over, "s"), "Hz") if over else None


def _phrase(behind: str) -> str:
    """What stands behind a number and may be its unit; "" where nothing does."""
    behind = _TOLERANCE.sub("", behind)
    first, _, others = behind.strip().partition(" ")
    if _OTHER.match(others) and size_of(first) is not None:
        return first  # `kHz mode: fast`
    return "" if _OTHER.match(behind) else re.split(r"[;|#,]", behind)[0].strip()


def _leading(text: str, is_step: bool) -> Size | None:
    """The unit that the first words of a text are, behind which none stands that belongs to it."""
    words = text.split()
    for count in range(min(_MOST_WORDS, len(words)), 0, -1):
        size, rest = size_of(" ".join(words[:count]), is_step), " ".join(words[count:])
        if size is None:
            continue
        is_whole = not _MORE.search(rest) or _PER_CHANNEL.match(f" {' '.join(words[count : count + 2])}")
        is_prefix = words[0] in _LARGE and rest
        return size if is_whole and not is_prefix else None
    return None


def _at_end(tail: str, is_step: bool) -> Size | None:
    """The unit that a name ends in, `dt_s` or `Sample rate kHz`; a letter behind a blank may be a symbol."""
    found = _AT_END.search(f" {tail}" if tail[:1].isalpha() else tail)
    word = (found["single"] or found["word"].split("_")[-1]) if found else ""
    return size_of(word, is_step) if word.lower() not in ("", "min", *(one.lower() for one in _LARGE)) else None
