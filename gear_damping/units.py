"""Units cross the door here, once: everything inside is SI, or the solver's natural units.

A unit is a factor to SI and the exponents of (mass, length, time, angle, voltage, current). Angle, voltage
and current are kept apart at the door only, so that an angle cannot be read as a pure number.
Unknown units are refused: a guess would be worse.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from math import pi
from unicodedata import normalize

from gear_damping.errors import InputError, Problem


@dataclass(frozen=True)
class Dimension:
    """Exponents of the base quantities."""

    mass: float = 0
    length: float = 0
    time: float = 0
    angle: float = 0
    voltage: float = 0
    current: float = 0

    def __mul__(self, other: "Dimension") -> "Dimension":
        return Dimension(*(a + b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __pow__(self, power: float) -> "Dimension":
        return Dimension(*(power * a for a in self.exponents))

    @property
    def exponents(self) -> tuple[float, ...]:
        """The exponents in the order of the fields."""
        return (self.mass, self.length, self.time, self.angle, self.voltage, self.current)


@dataclass(frozen=True)
class Unit:
    """A unit: `value * factor` is the value in SI."""

    factor: float
    dimension: Dimension


# Exponents of the base quantities; their names are those of the units.
_KG, _M, _S = Dimension(mass=1), Dimension(length=1), Dimension(time=1)
# Exponents again, of what is kept apart at the door only.
_RAD, _V, _A, _ONE = Dimension(angle=1), Dimension(voltage=1), Dimension(current=1), Dimension()
_N = Dimension(1, 1, -2)  # mass times length over time squared
_PA = Dimension(1, -1, -2)  # a force over an area

_ATOMS: dict[str, Unit] = {
    "1": Unit(1.0, _ONE), "%": Unit(1e-2, _ONE), "dB": Unit(1.0, _ONE),
    "kg": Unit(1.0, _KG), "gram": Unit(1e-3, _KG), "t": Unit(1e3, _KG),
    "km": Unit(1e3, _M), "m": Unit(1.0, _M),
    "in": Unit(0.0254, _M), "ft": Unit(0.3048, _M), "lbf": Unit(4.4482216152605, _N), "kgf": Unit(9.80665, _N),
    "cm": Unit(1e-2, _M), "mm": Unit(1e-3, _M), "um": Unit(1e-6, _M), "nm": Unit(1e-9, _M),
    "dm": Unit(0.1, _M), "pm": Unit(1e-12, _M),
    "s": Unit(1.0, _S), "ms": Unit(1e-3, _S), "us": Unit(1e-6, _S), "ns": Unit(1e-9, _S), "min": Unit(60.0, _S),
    "h": Unit(3600.0, _S), "day": Unit(86400.0, _S),
    "Hz": Unit(1.0, _S**-1), "mHz": Unit(1e-3, _S**-1), "kHz": Unit(1e3, _S**-1), "MHz": Unit(1e6, _S**-1),
    "N": Unit(1.0, _N), "kN": Unit(1e3, _N), "mN": Unit(1e-3, _N),
    "MN": Unit(1e6, _N), "daN": Unit(10.0, _N), "uN": Unit(1e-6, _N),
    "Nm": Unit(1.0, _N * _M), "rad": Unit(1.0, _RAD), "mrad": Unit(1e-3, _RAD), "urad": Unit(1e-6, _RAD),
    "deg": Unit(pi / 180, _RAD), "arcmin": Unit(pi / 10800, _RAD), "arcsec": Unit(pi / 648000, _RAD),
    "rev": Unit(2 * pi, _RAD), "rpm": Unit(2 * pi / 60, _RAD * _S**-1), "gon": Unit(pi / 200, _RAD),
    "krpm": Unit(2e3 * pi / 60, _RAD * _S**-1),
    "V": Unit(1.0, _V), "kV": Unit(1e3, _V), "mV": Unit(1e-3, _V), "uV": Unit(1e-6, _V),
    "A": Unit(1.0, _A), "mA": Unit(1e-3, _A),
    "gn": Unit(9.80665, _M * _S**-2), "mgn": Unit(9.80665e-3, _M * _S**-2),
    "kNm": Unit(1e3, _N * _M), "mNm": Unit(1e-3, _N * _M),
    "Pa": Unit(1.0, _PA), "hPa": Unit(100.0, _PA), "kPa": Unit(1e3, _PA), "MPa": Unit(1e6, _PA),
    "bar": Unit(1e5, _PA), "mbar": Unit(100.0, _PA), "Gal": Unit(1e-2, _M * _S**-2), "mGal": Unit(1e-5, _M * _S**-2),
    "mil": Unit(2.54e-5, _M), "ips": Unit(0.0254, _M * _S**-1), "mph": Unit(0.44704, _M * _S**-1),
    "knot": Unit(1852 / 3600, _M * _S**-1), "ozf": Unit(4.4482216152605 / 16, _N),
    "Ns": Unit(1.0, _N * _S), "Nms": Unit(1.0, _N * _M * _S),
}  # fmt: skip

# What an accelerometer counts in. By itself it is no mass: a mass here is `gram` or `kg`.
_OF_GRAVITY = {
    "g": "gn", "G": "gn", "gs": "gn", "g's": "gn", "g_n": "gn", "mg": "mgn", "milli-g": "mgn", "milli-G": "mgn",
}  # fmt: skip
# What people write where a value is a plain number.
_COUNTED = (
    "count", "counts", "ct", "cts", "pixel", "pixels", "pix", "px", "tick", "ticks", "step", "steps", "lsb", "lsbs",
    "digit", "digits", "bit", "bits", "increment", "increments", "incr", "inc", "pulse", "pulses", "pls", "a.u.",
    "a.u", "au", "arb", "arb.", "arbitrary", "adc", "raw", "unitless", "dimensionless", "none",
)  # fmt: skip
_ALIKE = 0.6  # share of the letters that a unit must have in common with a word to be meant by it
_SELDOM = ("krpm", "Nms")  # what nobody means by a word that is nearly alike: `kpm`, `Nms2`
_POUND = "write 'lbf' for a force, or give a mass in kg"
_MEANT = {
    "g": "write 'gram' or 'gn' (9.80665 m/s^2)", "mg": "write 'mgn' (9.80665e-3 m/s^2), or a mass in 'gram'",
    "degc": "a temperature is not read", "ft-lb": "write 'ft*lbf'", "ft-lbs": "write 'ft*lbf'",
    "grad": "write 'deg', or 'gon' where 400 make a turn", "oz": "write 'ozf' for a force, or give a mass in kg",
    "oz-in": "write 'ozf*in'", "ozin": "write 'ozf*in'", "ozf-in": "write 'ozf*in'", "in-oz": "write 'ozf*in'",
    **dict.fromkeys(("in-lb", "in-lbs", "lb-in", "lbs-in", "inlb", "lbin"), "write 'lbf*in'"),
    **dict.fromkeys(("ustrain", "microstrain", "ue", "uε", "ppm"), "write 'um/m'"), "strain": "write 'm/m'",
    **dict.fromkeys(("-", "", "n/a", "--"), "write '1' where it has none"), "mkp": "write 'kgf*m'",
    "kgfcm": "write 'kgf*cm'", "cps": "write 'Hz'",
    **dict.fromkeys(('"', "″", "'", "′"), "write 'arcsec' or 'arcmin' of an angle, 'in' or 'ft' of a length"),
    **dict.fromkeys(
        ("r.p.m.", "r.p.m", "giri/min", "umdr/min", "umdr./min", "tours/min", "rot/min", "tr/mn"), "write 'rpm'"
    ),
    "psi": "write 'lbf/in^2'", "d": "write 'day'", "lb": _POUND, "lbs": _POUND, "pound": _POUND, "pounds": _POUND,
}  # fmt: skip

_LEVEL_OF = re.compile(  # how a level of a signal was taken, before or behind its unit
    r"^(?P<before>(?:rms|pk-pk|p-p|pp|pk|peak)\s)?(?P<unit>.*?)(?P<behind>[\s_\-]+(?:rms|eff|pk-pk|p-p|pp|0-p|pk|peak))?$",
    re.I,
)
_WEIGHT_OF_LEVER = re.compile(
    r"^(?:(?P<weight>lbs?f?|ozf?)[\s.*·-]*(?P<lever>in|ft)|(?P<first>in|ft)[\s.*·-]*(?P<second>lbs?f?|ozf?))$", re.I
)
_SPELLINGS = {"⁻¹": "^-1", "⁻²": "^-2", "µ": "u", "μ": "u", "·": "*", "²": "^2", "³": "^3", "°": "deg", "**": "^"}
_SPELLINGS |= {"º": "deg", "㎜": "mm", "㎝": "cm", "㎳": "ms", "㎲": "us", "㎐": "Hz", "秒": "s"}
_SPELLINGS |= {"N.m": "N*m", "N m": "N*m"}
_ALSO = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "usec": "us", "minutes": "min",
    "milliseconds": "ms", "microseconds": "us", "nanoseconds": "ns", "minute": "min", "hour": "h", "hours": "h",
    "micron": "um", "microns": "um", "mils": "mil", "thou": "mil", "inch": "in", "inches": "in", "Inch": "in",
    "RPM": "rpm", "U/min": "rpm", "Upm": "rpm", "UPM": "rpm", "knots": "knot", "gons": "gon",
    "Volt": "V", "Volts": "V", "volt": "V", "volts": "V",
    "Newton": "N", "newton": "N", "newtons": "N",
    "amp": "A", "amps": "A", "ampere": "A", "Ampere": "A", "hz": "Hz",
    "HZ": "Hz", "Deg": "deg", "DEG": "deg", "Grad": "deg", "degree": "deg", "degrees": "deg",
    "radian": "rad", "radians": "rad", "RAD": "rad", "Rad": "rad",
    "sek": "s", "Sek": "s", "Sekunde": "s", "Sekunden": "s", "seconde": "s", "secondes": "s", "segundos": "s",
    "turn": "rev", "turns": "rev", "revs": "rev", "nsec": "ns", "days": "day", "kp": "kgf",
    "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm", "Millimeter": "mm",
    "micrometer": "um", "micrometers": "um", "micrometre": "um", "micrometres": "um", "Mikrometer": "um",
    "centimeter": "cm", "centimeters": "cm", "centimetre": "cm", "centimetres": "cm", "Zentimeter": "cm",
    "nanometer": "nm", "nanometers": "nm", "nanometre": "nm", "nanometres": "nm", "Nanometer": "nm",
    "millivolt": "mV", "millivolts": "mV", "Millivolt": "mV", "kilonewton": "kN", "Kilonewton": "kN",
    "dps": "deg/s", "rps": "rev/s", "Meter": "m", "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "min-1": "1/min", "/min": "1/min", "r/min": "rpm", "tr/min": "rpm",
    "hertz": "Hz", "Hertz": "Hz", "kilohertz": "kHz", "S/s": "Hz", "kS/s": "kHz", "MS/s": "MHz",
    "Sa/s": "Hz", "kSa/s": "kHz", "samples/s": "Hz", "ks/s": "kHz",
    "samples/sec": "Hz", "sps": "Hz", "fps": "Hz", "Second": "s", "Seconds": "s",
    "percent": "%", "m/sec^2": "m/s^2", "m/sec2": "m/s^2",
    "millis": "ms", "millisecond": "ms", "millisec": "ms", "msecs": "ms", "micros": "us", "microsecond": "us",
    "microsec": "us", "usecs": "us", "mins": "min", "hr": "h", "hrs": "h", "ksps": "kHz", "kSPS": "kHz",
    "MSa/s": "MHz", "Msps": "MHz", "IPS": "ips", "CPM": "1/min",
    "cpm": "1/min", "pct": "%",
    "ms^-2": "m/s^2", "ms^-1": "m/s", "ms-2": "m/s^2", "ms-1": "m/s",  # no milliseconds: their powers are no motion
}  # fmt: skip
_DIGITS = r"\s*(?P<number>[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)\s*"
_NUMBER, _SPOKEN = re.compile(f"^{_DIGITS}$"), re.compile(rf"^{_DIGITS}(?P<unit>([A-Za-zµμ°%]|(?<=\s)1/).*?)\s*$")
_STEP = re.compile(
    r"^(?:[x×*·]\s*(?=10?[\^e]|10+\b))?(?P<number>\d+[.,]?\d*(e[+-]?\d+|\^[+-]?\d+)?)(/(?P<over>\d+))?\s*[*x·]?\s*(?P<unit>[A-Za-zµμ°].*)$"
)
_SUPERSCRIPT = re.compile(r"(?<=10)⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")  # the power in `10⁻³ m`
_SCALED = re.compile(
    r"^(?P<unit>[A-Za-zµμ°][^*x×·]*?)\s*[*x×·/]\s*\d+[.,]?\d*(e[+-]?\d+|\^?[+\-−]\d+|\^\d+|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?$"
)
_PER_TIME = re.compile(r"^(?P<above>[A-Za-z]+)[ .*]s(ec)?\^?-(?P<power>[12])$")  # `m s-2`, `mm.s^-1`
# a power may stand without its sign: m/s2
_GAP = re.compile(r"(?<=[A-Za-z\d])[ .\-](?=[A-Za-z])")  # what people write between the factors of a product
_JOINED = re.compile(r"(?<![A-Za-z])(kg|kN|daN|N|lbf)(?=(mm|cm|m|in|ft)([\^\d/]|$))")  # or nothing
_FACTOR = re.compile(r"^(?P<atom>[A-Za-z%]+|1)((\^(?P<power>-?\d+(\.\d+)?))|(?P<raised>[23]))?$")


LEVEL = "dB"  # a logarithm, which is no number of anything
# Of a sensor, what it gives for one unit, `100 mV/g` or `16384 LSB/g`, or how much one volt is, `125 mm/s/V`.
_SENSITIVITY = re.compile(
    rf"(?:\d[\d.,]*\s*)?(?:(?:mV|V|pC|{'|'.join(one for one in _COUNTED if one.isalpha())})\s*/\s*(?P<below>\D.*)"
    r"|(?P<above>[^\W\d].*?)\s*/\s*(?:mV|V))", re.I,
)  # fmt: skip
DIGITS = 12  # of a converted number: 0.12 mm are 120 um, not 120.00000000000001
# What a key may end in, and the unit that its plain number is in.
SUFFIXES = {"rpm": "rpm", "deg": "deg", "um": "um", "mm": "mm", "ms": "ms", "khz": "kHz", "hz": "Hz", "percent": "%"}


def unit_names() -> tuple[str, ...]:
    """Every unit that may stand in a product or a quotient."""
    return tuple(_ATOMS)


@cache
def parse_unit(text: str, key: str = "unit", source: str = "") -> Unit:
    """The unit that `text` names, for example `um`, `N*m`, `m/s^2` or `kg*m^2`.

    Raises:
        InputError: the unit is unknown; `g` and `mg` within a product are refused because they mean gram to some and
            standard gravity to others. By themselves they are units of an accelerometer.
    """
    plain = text.strip()
    for spelling, ours in _SPELLINGS.items():
        plain = plain.replace(spelling, ours)
    plain = _OF_GRAVITY.get(plain) or _ALSO.get(plain, plain)
    plain = _PER_TIME.sub(r"\g<above>/s^\g<power>", plain)
    plain = plain.replace("(", "").replace(")", "") if "/" not in plain else plain
    unit = Unit(1.0, _ONE)
    for index, part in enumerate(plain.split("/")):
        sign = -1 if index else 1
        for piece in part.strip("() ").split("*"):
            atom, power = _parse_factor(piece.strip(), text, key, source)
            exponent = sign * power
            unit = Unit(unit.factor * atom.factor**exponent, unit.dimension * atom.dimension**exponent)
    return unit


def behind(unit: str) -> str:
    """A unit as it stands behind a number: nothing for what has none."""
    return "" if unit == "1" else f" {unit}"


def is_of_kind(text: str | None, plain: str) -> bool:
    """Whether a text names a unit of the kind of another one."""
    try:
        return bool(text) and parse_unit(text).dimension == parse_unit(plain).dimension
    except InputError:
        return False


def multiple_of_a_unit(text: str) -> tuple[float, Unit] | None:
    """The number and the unit of a step that a header counts in: `0.1 mm`, `1/100 mm`, `x10^-3 mm`; None of others."""
    match = _STEP.match(
        _SUPERSCRIPT.sub(lambda power: "^" + normalize("NFKC", power[0]).replace("−", "-"), text.strip())
    )
    if match is None:
        return None
    number, over = match["number"].replace(",", "."), float(match["over"] or 1)
    base, _, power = number.partition("^")
    try:
        return (float(base) ** float(power) if power else float(base)) / over, parse_unit(match["unit"])
    except (InputError, ValueError):
        return None


def scaled_unit(text: str) -> str | None:
    """The unit in a header that has a factor behind it, `mm*10` or `mm/10`, of which nobody knows which way it goes."""
    match = _SCALED.match(text.strip())
    return match["unit"] if match and is_of_kind(match["unit"], match["unit"]) else None


def spoken(value: object) -> tuple[float, str] | None:
    """The number and the unit of a text such as `80 um` or `4600rpm`; None for anything else, as a bare number."""
    match = _SPOKEN.match(value) if isinstance(value, str) and not _NUMBER.match(value) else None
    return (float(match["number"]), match["unit"]) if match else None


def said_as(value: object) -> tuple[float, str] | None:
    """The number and the unit of `80 um` or of {value: 80, unit: um}; None for anything else."""
    if isinstance(value, Mapping):
        is_whole = set(value) == {"value", "unit"} and type(value["value"]) in (int, float)
        return (value["value"], str(value["unit"])) if is_whole else None
    return spoken(value)


def number_in(value: object, unit: str, key: str = "") -> object:
    """The number in `unit` of a quantity, `80 um` or {value, unit}; what is no quantity as it is.

    Args:
        value: As it was given.
        unit: What a plain number would be in; any unit of its kind may be said.
        key: Its key, for messages.

    Raises:
        InputError: its unit is unknown, or of another kind.
    """
    said = said_as(value)
    if said is None:
        return value
    return float(f"{to_si(said[0], said[1], unit, key) / parse_unit(unit).factor:.{DIGITS}g}")


def per_mass(declared: str, length: str | None) -> str:
    """A unit that is declared in SI, where masses are 1 and lengths are in another unit, as N/m is 1/s^2.

    Args:
        declared: What holds in SI.
        length: The unit of lengths; None: nobody knows it.

    Returns:
        "" where it follows from a length that nobody knows.
    """
    found = parse_unit(declared).dimension
    if not found.length and not found.mass:
        return declared
    if found.length and length is None:
        return ""
    powers = ((length or "", found.length), ("rad", found.angle), ("s", found.time))
    above = [_raised(name, power) for name, power in powers if power > 0]
    return "/".join(["*".join(above) or "1", *(_raised(name, -power) for name, power in powers if power < 0)])


def _raised(name: str, power: float) -> str:
    name = f"({name})" if power != 1 and {"/", "*", "^"} & {*name} else name
    return name if power == 1 else f"{name}^{power:g}"


def _parse_factor(piece: str, text: str, key: str, source: str) -> tuple[Unit, float]:
    match = _FACTOR.match(piece)
    name = match["atom"] if match else piece
    name = _ALSO.get(name, name)
    alone = match and match["raised"] and "/" not in text and "*" not in text  # `V2` may be the name of a channel
    if not match or name not in _ATOMS or alone:
        raise InputError(_unknown(piece, name, text, key, source))
    return _ATOMS[name], float(match["power"] or match["raised"] or 1)


def _unknown(piece: str, name: str, text: str, key: str, source: str) -> Problem:
    """What is said of a factor `piece` of a text, whose letters are `name`, that is no unit."""
    sensor = _SENSITIVITY.fullmatch(text.strip())
    if sensor and not is_of_kind(sensor["below"], "s"):  # counts by the second are a rate
        of = (sensor["below"] or sensor["above"]).strip("() ")
        remedy = f"write unit: {of}, and gain: what the column holds for one {of}, by which values are divided"
        return Problem(key, f"'{text}' is the sensitivity of a sensor, and no unit of its signal", None, remedy, source)
    if piece.lower() in _COUNTED:
        remedy = f"write '{text.strip().replace(piece, '1')}'"
        return Problem(key, f"'{piece}' has no unit here: it is a plain number", remedy=remedy, source=source)
    remedy = _MEANT.get(text.strip().lower()) or _of_a_level(text) or _of_a_lever(text) or _MEANT.get(name.lower())
    remedy = remedy or _as_product(text) or _in_other_capitals(piece, name, text) or _alike(name)
    return Problem(key, f"unknown unit '{text}'", remedy=remedy, source=source)


def _of_a_level(text: str) -> str:
    """The remedy for a unit beside which stands how a level was taken, `mm pk-pk` or `g rms`; "" for any other."""
    found = _LEVEL_OF.match(text.strip())
    unit = found["unit"] if found and (found["before"] or found["behind"]) else ""
    if not unit or not is_of_kind(unit, unit):
        return ""
    return f"write '{unit}' where the values are the signal itself; a level of it, as rms or peak to peak, is no signal"


def _of_a_lever(text: str) -> str:
    """The remedy for a weight times a lever without its sign, `lb-ft` or `ozin`; "" for any other text."""
    found = _WEIGHT_OF_LEVER.match(text.strip())
    if not found:
        return ""
    weight = "ozf" if (found["weight"] or found["second"]).lower().startswith("oz") else "lbf"
    lever = (found["lever"] or found["first"]).lower()
    return f"write '{weight}*{lever}'" if found["weight"] else f"write '{lever}*{weight}'"


def _in_other_capitals(piece: str, name: str, text: str) -> str:
    """The remedy for a factor in other capitals, `KHz` or `m/S2`; "" where it is none, or several are written so."""
    alike = [atom for atom in _ATOMS if atom.lower() == name.lower()]
    if len(alike) > 1:
        return f"write {' or '.join(repr(one) for one in alike)}, whichever it is"
    right = text.strip().replace(piece, piece.replace(name, alike[0])) if alike else ""
    return f"did you mean '{right}'?" if right not in ("", text.strip()) and is_of_kind(right, right) else ""


def _alike(name: str) -> str:
    """The remedy for a unit that is nearly written like one that is known, else the list of them."""
    plain = name.replace(" ", "")
    if (other := _ALSO.get(plain.lower())) or plain.lower() in _ATOMS:
        return f"did you mean '{other or plain.lower()}'?"
    found = get_close_matches(plain, [one for one in _ATOMS if one not in _SELDOM], n=1, cutoff=_ALIKE)
    if found and len(plain) > len(found[0]) and not plain.lower().startswith(found[0].lower()):
        found = []  # what is longer and begins otherwise is another unit: no kilometre in `kgm`
    return f"did you mean '{found[0]}'?" if found else f"choose one of {', '.join(sorted(_ATOMS))}"


def _as_product(text: str) -> str:
    """The remedy for a product without its sign, `kgm2` or `kg m^2`; "" where it is none."""
    for spelling, ours in _SPELLINGS.items():
        text = text.replace(spelling, ours)
    product = _JOINED.sub(r"\1*", _GAP.sub("*", text))
    try:
        known = product != text and parse_unit(product)
    except InputError:
        return ""
    if not known:
        return ""
    of_force = re.fullmatch(r"kg\*([a-z]+)", product)  # as data sheets of motors say a torque
    return f"write 'kgf*{of_force[1]}'" if of_force else f"write '{product}'"


def to_si(value: float, unit: str, expected: str, key: str = "value", source: str = "") -> float:
    """`value` in `unit`, converted to SI; `expected` is any unit of the right dimension.

    Raises:
        InputError: the unit is unknown or has another dimension than `expected`.
    """
    wanted = parse_unit(expected)
    if (unit.strip() == LEVEL) != (expected == LEVEL):
        rule = f"the unit '{unit}' is not one of the kind of '{expected}'"
        remedy = "give a level in dB" if expected == LEVEL else "give the ratio itself, 10^(level/20) of amplitudes"
        raise InputError(Problem(key, rule, value, remedy, source))
    found = of_a_shaft(parse_unit(unit, key, source), wanted)
    if remedy := _turns_or_radians(value, unit, found, expected):
        raise InputError(
            Problem(key, f"the unit '{unit}' is not one of the kind of '{expected}'", value, remedy, source)
        )
    if found.dimension != wanted.dimension and _is_in_radians(unit, found, wanted):
        return value * found.factor
    if found.dimension != wanted.dimension:
        rule = f"the unit '{unit}' is not one of the kind of '{expected}'"
        raise InputError(Problem(key, rule, value, other_kind(found, expected), source))
    return value * found.factor


def _turns_or_radians(value: float, unit: str, found: Unit, expected: str) -> str:
    """What helps where a frequency is said in radians, or a rate of radians or its square in Hz; "" elsewhere.

    Between the two lies 2 pi for every turn, which a dimension does not see.
    """
    power = -found.dimension.time
    wanted = {"1/s": 1, "1/s^2": 2}.get(expected, 0)
    if expected.endswith("Hz") and "rad" in unit:
        ours = value * found.factor / (2 * pi) ** power / parse_unit(expected).factor
    elif wanted and "Hz" in unit and power in (1, wanted):
        ours = (value * found.factor * (2 * pi) ** power) ** (wanted / power)
    else:
        return ""
    return f"give it in '{expected}'; {value:g} {unit} are {ours:.6g} {expected}, with 2 pi a turn"


def _is_in_radians(unit: str, found: Unit, wanted: Unit) -> bool:
    """Whether a rate or its square is said in radians, as `rad^2/s^2` for 1/s^2."""
    angle = found.dimension.angle
    of_rates = wanted.dimension in (_S**-1, _S**-2)
    return of_rates and "rad" in unit and found.dimension * _RAD**-angle == wanted.dimension


def of_a_shaft(unit: Unit, wanted: Unit) -> Unit:
    """A unit where one of the speed of a shaft is wanted: what counts by the minute, `1/min`, is turns (DIN 1301)."""
    is_by_minute = unit == parse_unit("1/min") and wanted.dimension == parse_unit("rpm").dimension
    return parse_unit("rpm") if is_by_minute else unit


def other_kind(found: Unit, expected: str) -> str:
    """What helps where a unit is of another kind than the one that is expected."""
    wanted = parse_unit(expected)
    if found.dimension * _RAD == wanted.dimension == _RAD * _S**-1:
        return "say what it counts: 'rpm', 'rev/s' or 'rad/s'"
    if found.dimension in (_V, _A):
        return f"write unit: {expected} (or another of its kind) and gain: what the file holds for one {expected}"
    if wanted.dimension == _ONE:
        return "give it as a share, 0.005 or '0.5 %'"
    return f"give it in '{expected}'"
