"""The text of the page; what was measured stands between marks, the rest follows from the declarations."""

import re
from collections.abc import Mapping, Sequence

from gear_damping.physics.systems.known import systems_of
from gear_damping.physics.terms import Effect
from gear_damping.reporting.effects_page import cases
from gear_damping.reporting.effects_page.declarations import acts_on, declaration
from gear_damping.reporting.effects_page.signatures import Signature, strongest
from gear_damping.reporting.numbers import number

FIGURES = "figures/effects"
BEGIN, END = "<!-- measured -->", "<!-- /measured -->"
Kinds = Mapping[str, type[Effect]]
INTRODUCTION = f"""# Effects

<!-- Made by `make docs` from the declarations in gear_damping/physics/effects; do not edit. -->

Every effect that the simulator knows. An effect is off unless it is named:

    python -m gear_damping task=simulate simulator.backlash={{}}                  # with its defaults
    python -m gear_damping task=simulate simulator.backlash.gap_um=80           # with one value of your own
    python -m gear_damping task=simulate simulator.tooth_crack.shaft=gear       # with another form

Any number of them go together. An [effect of your own](your_own_effect.md) is one file.

In the equations x is the dynamic transmission error (of an oscillator its displacement), e the geometric error
that the flanks impose, delta = x − e, delta' its rate, N the elastic force between the flanks, F_d the damping
force, k the mesh stiffness, c a damping coefficient, theta the angle of a shaft. Units are SI; a key also takes
`{{value: 80, unit: um}}` or its unit as a suffix (`gap_um`). For an oscillator, which is normalised by its mass,
forces, stiffnesses and damping coefficients are per unit of mass.

## How to read the signatures

Every signature is the difference of two runs, with and without the effect. Unless a sentence says otherwise they
are of the default gear pair (20 and 40 teeth, 150 N·m) at {cases.SPEED_RPM:g} rpm with 1 % viscous damping and the
effect at its defaults, after {cases.SETTLING} turns of settling. Left: the responses where the difference is largest.
Middle: the difference (residual) on its own scale, over {cases.TURNS} turns of the pinion, or over the same mesh
periods as on the left where it repeats with the mesh. Right: the spectra of residual and response, on one scale for
all figures, with the shafts of pinion (s1, green) and gear (s2, purple), the mesh M = 20·s1 with its harmonics
(orange) and the natural frequency f₀ (dotted). RMS is that of the residual without its mean. Effects that only an
oscillator has are shown in its free decay from 1 rad, with f₀ at 5 Hz."""
HEAD = ("| effect | acts on | systems | dissipates | residual RMS |", "|---|---|---|---|---:|")


def page(kinds: Kinds, measured: Mapping[str, Signature]) -> str:
    """The whole page.

    Args:
        kinds: Effects by name.
        measured: Their signatures; an effect without one has empty marks.
    """
    rows = [_row(name, kind, measured.get(name)) for name, kind in kinds.items()]
    sections = [line for name, kind in kinds.items() for line in section(kind, measured.get(name))]
    lines = [INTRODUCTION, "", _count(len(kinds)), "", *HEAD, *rows, "", *sections]
    return "\n".join(lines).rstrip() + "\n"


def section(kind: type[Effect], found: Signature | None) -> list[str]:
    """The lines of one effect."""
    note = cases.case_of(kind.name).note
    picture = f"![Signature of {kind.name}]({FIGURES}/{kind.name}.png)"
    said = f"{BEGIN}{measurement(found) if found else ''}{END}"
    signature = " ".join(part for part in (said, note) if part)
    return [f"### {kind.name}", "", *declaration(kind), picture, "", signature, ""]


def measurement(found: Signature) -> str:
    """One sentence of numbers."""
    residual, unit = found.residual, found.unit
    text = f"Residual: RMS {_amount(float(residual.std()))} {unit}, mean {_amount(float(residual.mean()))} {unit}"
    lines = strongest(found)
    if not lines:
        return f"{text}; no lines."
    where = "orders" if found.n_teeth else "frequencies"
    listed = ", ".join(f"{place_name(place, found)} ({_amount(size)} {unit})" for place, size in lines)
    return f"{text}; strongest {where}: {listed}."


def place_name(place: float, found: Signature) -> str:
    """An order by the name that gears give it: s1, s2, 3·s1, 2M, M−s1; else its number."""
    if not found.n_teeth:
        return f"{number(place, 3)} Hz"
    harmonic = round(place / found.n_teeth)
    side = place - harmonic * found.n_teeth
    mesh = f"{harmonic if harmonic > 1 else ''}M"
    shafts = {0.0: "", 1.0: "s1", found.gear_order: "s2"}
    if harmonic and abs(side) in shafts:
        return mesh + (f"{'+' if side > 0 else '−'}{shafts[abs(side)]}" if side else "")
    if place in shafts:
        return shafts[place]
    return f"{place:g}·s1"


def without_measurements(text: str) -> str:
    """The page with nothing between the marks: what the declarations alone decide."""
    return re.sub(f"{re.escape(BEGIN)}.*?{re.escape(END)}", BEGIN + END, text, flags=re.DOTALL)


def _row(name: str, kind: type[Effect], found: Signature | None) -> str:
    rms = f"{_amount(float(found.residual.std()))} {found.unit}" if found else ""
    systems = ", ".join(systems_of(kind)).replace("_", " ")
    cells: Sequence[str] = (
        f"[`{name}`](#{name})", acts_on(kind), systems, "yes" if kind.dissipative else "no", f"{BEGIN}{rms}{END}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def _amount(value: float) -> str:
    """Three digits, and nothing below a femtometre: rounding."""
    return number(value if abs(value) >= 1e-9 else 0.0, 3).replace("-", "−", 1)


def _count(effects: int) -> str:
    return f"## The {effects} effects" if effects > 1 else "## The effect"
