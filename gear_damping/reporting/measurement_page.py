"""`python -m gear_damping.reporting.measurement_page`: write the reference part of docs/measurement.md.

The reference comes from the declarations that also check the file; what stands outside the two markers is kept.
"""

import argparse
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from gear_damping.measurement import channels as c
from gear_damping.measurement import layout, rig
from gear_damping.measurement.vocabulary import CHANNEL_MODELS
from gear_damping.schema.mappings import Declared, kind_of, names
from gear_damping.units import unit_names

BEGIN = "<!-- reference: begin; written by `make docs` from the declarations, do not edit -->"
END = "<!-- reference: end -->"
_NEW = "# measurement.yaml\n\n"
_SYSTEM = {"gear_pair": "gear pair", "oscillator": "oscillator"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m gear_damping.reporting.measurement_page", description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where measurement.md is written")
    path = parser.parse_args(arguments).folder / "measurement.md"
    before = path.read_text(encoding="utf-8") if path.exists() else _NEW
    path.write_text(with_reference(before), encoding="utf-8")
    print(f"wrote the reference of {path}")
    return 0


def with_reference(text: str) -> str:
    """The page with its reference as the declarations have it; it is put at the end where there is none yet."""
    if BEGIN not in text:
        return f"{text.rstrip()}\n\n{BEGIN}\n{reference()}{END}\n"
    head, rest = text.split(BEGIN)
    return f"{head}{BEGIN}\n{reference()}{END}{rest.split(END)[1]}"


def reference() -> str:
    """Every key that a measurement.yaml may hold: meaning, value, default, what acts on it, and where it is refused."""
    return "\n".join(_lines())


def _lines() -> Iterator[str]:
    yield "## Every key\n"
    yield "A key acts as its row says, or is refused with the reason. `{value, unit}` stands for a value in a unit of"
    yield "the kind that is named, which may also be written as it is said: `3 kHz`, `80um`, `4600rpm`. A relative"
    yield "`uncertainty` beside them is a Gaussian prior.\n"
    named = ", ".join(f"`{name}`" for name in unit_names())
    yield f"Units are {named}, and products and quotients of them with powers, such as `km/h`, `N*m`, `m/s^2` or"
    yield "`kg*m^2`; `g` by itself is standard gravity, `mg` a thousandth of it. A response of an oscillator may be in"
    yield "any of them, volts and degrees too: its parameters are then in that one. Counts of a converter, pixels and"
    yield "arbitrary units are `1`.\n"
    yield from _keys("The file", layout.GearFile)
    yield from _keys("A record", layout.AnyRecord)
    yield from _keys("A record of a gear pair also has", layout.GearRecord, layout.AnyRecord)
    yield from _channel_tables()
    yield from _sensor_table()
    yield from _refusals()
    yield from _keys("Time", c.Stamps)
    yield from _keys("`window`", layout.Window)
    yield from _keys("Encoders", layout.Encoders)
    yield from _keys("Encoder (`encoders.pinion`, `encoders.gear`)", layout.Encoder)
    yield from _keys("Tacho (`encoders.tacho`)", layout.Tacho)
    yield from _keys("Conditions of a gear pair", rig.GearConditions)
    yield from _keys("Conditions of an oscillator", rig.OscillatorConditions)
    yield from _keys("Parameters of a gear pair", rig.GearParameters)
    yield from _keys("Parameters of an oscillator", rig.OscillatorParameters)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield f"| {' | '.join(head)} |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield f"| {' | '.join(row)} |"
    yield ""


def _keys(title: str, model: type[Declared], without: type[Declared] | None = None) -> Iterator[str]:
    left_out = set(names(without)) - {"channels"} if without else set()
    yield f"### {title}\n"
    yield from _table(
        ("key", "value", "where absent", "meaning", "acts on"),
        ((f"`{name}`", *_cells(info)) for name, info in names(model).items() if name not in left_out),
    )


def _cells(info: object) -> tuple[str, str, str, str]:
    kind = kind_of(info)
    absent = "**must be there**" if info.is_required() else f"`{info.default}`" if info.default is not None else "–"
    extra = info.json_schema_extra
    return _value(kind), absent.replace("False", "false"), info.description, extra["acts"]


def _value(kind: object) -> str:
    if kind is None:
        return "mapping"
    keys = f"`{{{', '.join(kind.keys())}}}`, " if kind.keys() else ""
    return keys + kind.says()


def _channel_tables() -> Iterator[str]:
    for system, model in (("gear_pair", layout.GearChannels), ("oscillator", layout.OscillatorChannels)):
        yield f"### Channels of a {_SYSTEM[system]}\n".replace("a oscillator", "an oscillator")
        rows = []
        for name, info in names(model).items():
            kind = CHANNEL_MODELS[system].get(name)
            unit = "time" if kind is None else kind.si or "any"
            rows.append((f"`{name}`", unit if unit in ("any", "time") else f"`{unit}`", *_cells(info)[2:]))
        yield from _table(("channel", "unit of the kind", "meaning", "acts as"), rows)


def _sensor_keys() -> Mapping[tuple[str, str], tuple[object, dict[str, list[str]]]]:
    """Each key of a channel in each of its meanings: its declaration, and by system the channels that take it."""
    found: dict[tuple[str, str], tuple[object, dict[str, list[str]]]] = {}
    for system, models in CHANNEL_MODELS.items():
        for channel, model in models.items():
            for name, info in names(model).items():
                found.setdefault((name, info.description), (info, {}))[1].setdefault(system, []).append(channel)
    return found


def _sensor_table() -> Iterator[str]:
    yield "### Keys of a channel\n"
    rows = []
    for (name, _), (info, taken) in _sensor_keys().items():
        by = "; ".join(
            f"{_SYSTEM[system]}: " + ("every" if len(found) == len(CHANNEL_MODELS[system]) else ", ".join(found))
            for system, found in taken.items()
        )
        rows.append((f"`{name}`", *_cells(info), "every" if by.count("every") == 2 else by))
    yield from _table(("key", "value", "where absent", "meaning", "acts on", "channels"), rows)


def _refusals() -> Iterator[str]:
    """Why a key that other channels take is refused."""
    yield "### Refused\n"
    because: dict[tuple[str, str, str], list[str]] = {}
    for system, models in CHANNEL_MODELS.items():
        for channel, model in models.items():
            for name, (reason, remedy) in model.refused.items():
                because.setdefault((name, reason, remedy), []).append(f"{channel} ({_SYSTEM[system]})")
    casing = ", ".join(f"`{name}`" for name in c.OF_A_SHAFT)
    rows = [(f"`{name}`", ", ".join(where), reason, remedy) for (name, reason, remedy), where in because.items()]
    rows.append(("`datum: absolute`", "pinion_speed, gear_speed", "what is compared is a fluctuation", "leave it out"))
    rows.append(("`coupling: AC`", "gear_speed", "what is compared is a fluctuation", "state its highpass"))
    rows.append((casing, "acceleration on a casing (gear pair)", c.CASING, "write mounting: tangential where it is"))
    for name, (reason, remedy) in layout.OscillatorRecord.refused.items():
        rows.append((f"`{name}`", "records of an oscillator", reason, remedy))
    yield from _table(("key", "of", "because", "instead"), rows)


if __name__ == "__main__":
    raise SystemExit(main())
