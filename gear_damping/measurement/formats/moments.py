"""Dates and clocks that tables have for their time, as texts: seconds from the first, and when that was."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date, datetime, timedelta

import numpy as np
from numpy.typing import NDArray

DAY, HOUR = 86400.0, 3600.0  # s in a day of a clock, which knows no leap seconds
_ZERO = datetime(2000, 1, 1)  # from which dates are counted: near, so that floats hold a part of a microsecond
_DIGITS = 9  # of a second: a difference of floats of a day's seconds is true to 1e-11 of one
_DATE = r"(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4}|\d{1,2}[-/. ][A-Za-z]{3}[-/. ]\d{4})"
_CLOCK = (
    r"(?P<hours>\d{1,3}):(?P<minutes>\d{2})(:(?P<seconds>\d{2})((?P<sign>[.,:])(?P<part>\d+))?)?"
    r"\s*(?P<half>[ap]\.?\s?m\.?)?"
)
_ZONE = r"\s*(?P<zone>Z|UTC|[+-]\d{2}(:?\d{2})?)?"
_ELAPSED = r"(?P<elapsed>\d{1,5})(\.|\s*days?,?\s+)"  # whole days before a clock, as .NET and Python write them
_MOMENT = re.compile(rf"({_DATE}(?:[T ,;_]+|-(?=\d{{2}}:))|{_ELAPSED})?{_CLOCK}{_ZONE}", re.I)
_MINUTES = re.compile(r"(?P<minutes>\d{1,4}):(?P<seconds>\d{2})[.,](?P<part>\d+)")  # and seconds since a start
_COMPACT = re.compile(r"(\d{4})(\d{2})(\d{2})T(\d{2})(\d{2})(\d{2})(?=\D|$)")  # of ISO 8601, without signs
_FILE_NAME = re.compile(  # of clocks that may stand in the name of a file
    r"(\d{4}[-/._]\d{1,2}[-/._]\d{1,2})[T ,;_-]+(\d{2})[-_.](\d{2})[-_.](\d{2})(?:[-_.,](\d+))?"
)
_OF_YEAR = re.compile(r"((?:19|20)\d{2})[-/](\d{3})(?=[T ,;_]+\d{1,2}:)")  # the day of a year
_IDEOGRAPHS = str.maketrans({"年": "-", "月": "-", "日": " "})  # behind the parts of a date
_ENGLISH = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_MONTHS = {name: k for k, name in enumerate(_ENGLISH, start=1)}
MINUTES = 60  # in an hour: a clock that shows fewer may begin again with the next one
_FRAME_RATES = (24, 25, 30, 50, 60)  # frames a second of time codes hh:mm:ss:ff (SMPTE ST 12-1)
_TOLD = re.compile(r"\d{4}-\d{3}[T ]|\d{1,2}:\d{2}|\d{4}-\d{2}-\d{2}|\d{1,2}[./]\d{1,2}[./]\d{2,4}")


def is_told(cell: str) -> bool:
    """Whether a date or a clock stands in a text, in any form."""
    return _TOLD.search(cell) is not None


def is_moment(cell: str) -> bool:
    """Whether a text is a clock that is read, with a date or without one."""
    text = _with_signs(cell)
    return _MINUTES.fullmatch(text) is not None or _MOMENT.fullmatch(text) is not None


@dataclass(frozen=True, eq=False)
class Moments:
    """Clocks as numbers.

    Args:
        seconds: (n,) s from the first.
        begins: The first, in s of its day or since 2000; by these two columns of one file are brought together.
    """

    seconds: NDArray[np.float64]
    begins: float

    @classmethod
    def of(cls, whole: NDArray[np.float64], begins: float = 0.0) -> "Moments":
        """Of (n,) s from a day that began at `begins`."""
        return cls(np.round(whole - whole[0], _DIGITS), begins + float(whole[0]))


def moments_of(cells: Sequence[str]) -> Moments | None:
    """The moments of n clocks; None where one of them is none.

    Without dates a clock that falls back by more than half a day has passed midnight, one of minutes the full hour.
    """
    texts = [_with_signs(cell) for cell in cells]
    elapsed = [_MINUTES.fullmatch(text) for text in texts]
    if all(elapsed):
        times = [60 * int(one["minutes"]) + int(one["seconds"]) + _part(one["part"]) for one in elapsed]
        in_hours = all(int(one["minutes"]) < MINUTES for one in elapsed)
        return Moments.of(_going_on(np.array(times), HOUR) if in_hours else np.array(times))
    found = [_MOMENT.fullmatch(text) for text in texts]
    if not found or not all(found):
        return None
    clock = np.array([_of_day(one) - _ahead(one["zone"]) for one in found])
    if frames := _frames(found):
        clock = np.floor(clock) + np.array([int(one["part"]) for one in found]) / frames
    days = _days([one["date"] for one in found])
    return (
        Moments.of(past_midnight(clock)) if days is None else Moments.of(clock + DAY * (days - days[0]), DAY * days[0])
    )


def _with_signs(cell: str) -> str:
    text = _COMPACT.sub(r"\1-\2-\3T\4:\5:\6", cell.strip().translate(_IDEOGRAPHS))
    if found := _FILE_NAME.fullmatch(text):
        day, hours, minutes, seconds, part = found.groups()
        return f"{day.replace('_', '-')} {hours}:{minutes}:{seconds}.{part or 0}"
    return _OF_YEAR.sub(lambda found: _day_of_year(int(found[1]), int(found[2])), text)


def _day_of_year(year: int, day: int) -> str:
    return (date(year, 1, 1) + timedelta(days=day - 1)).isoformat()


def _frames(moments: Sequence[re.Match[str]]) -> int:
    """Frames in a second where clocks are time codes, by the highest number of one; 0 where they are none."""
    if not all(one["sign"] == ":" and len(one["part"]) == 2 for one in moments):
        return 0
    count = 1 + max(int(one["part"]) for one in moments)
    return count if count in _FRAME_RATES and len({one["seconds"] for one in moments}) > 1 else 0


def past_midnight(clock: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,) s of the day that go on where a day ends."""
    return _going_on(clock, DAY)


def moment_since(moment: datetime) -> float:
    """A moment as columns of a file are brought together by."""
    return (moment.replace(tzinfo=None) - _ZERO).total_seconds()


def _going_on(clock: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """(n,) s of a clock that begins again after a period."""
    return clock + period * np.r_[0, np.cumsum(np.diff(clock) < -period / 2)]


def _of_day(moment: re.Match[str]) -> float:
    hours = int(moment["hours"])
    if moment["half"]:
        hours = hours % 12 + 12 * (moment["half"][0] in "pP")
    hours += 24 * int(moment["elapsed"] or 0)
    return 3600 * hours + 60 * int(moment["minutes"]) + int(moment["seconds"] or 0) + _part(moment["part"])


def _ahead(zone: str | None) -> float:
    """By how many s the clock of a zone is ahead of UTC, which it is not all the year."""
    if zone is None or zone[0] not in "+-":
        return 0.0
    digits = zone[1:].replace(":", "")
    return (1 if zone[0] == "+" else -1) * float(3600 * int(digits[:2]) + 60 * int(digits[2:] or 0))


def _part(digits: str | None) -> float:
    return float(f"0.{digits}") if digits else 0.0


def _number(part: str) -> int:
    """A part of a date; a month by its English name too, 0 for what is none."""
    return int(part) if part.isdigit() else _MONTHS.get(part.lower(), 0)


def _days(texts: Sequence[str | None]) -> NDArray[np.float64] | None:
    """(n,) days since 2000; None without dates, or where a date cannot be."""
    if None in texts:
        return None
    numbers = {text: [_number(part) for part in re.split(r"[-/. ]", text)] for text in dict.fromkeys(texts)}
    for order in ((0, 1, 2), (2, 1, 0), (2, 0, 1)):  # year, month, day; day first; month first
        try:
            ordinals = {text: date(*(one[k] for k in order)).toordinal() for text, one in numbers.items()}
        except ValueError:
            continue
        steps = np.diff([ordinals[text] for text in numbers])
        if np.all((steps >= 0) & (steps <= 1)):  # one day follows the next
            return np.array([ordinals[text] for text in texts], dtype=np.float64) - _ZERO.toordinal()
    return None
