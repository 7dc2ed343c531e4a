"""docs/effects.md says what the declarations say, and its numbers are those of real runs."""

import re
from pathlib import Path

import numpy as np
import pytest

from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.reporting.effects_page import cases
from gear_damping.reporting.effects_page.declarations import declaration, option_row, parameter_row
from gear_damping.reporting.effects_page.page import BEGIN, END, FIGURES, measurement, page, without_measurements
from gear_damping.reporting.effects_page.picture import write_signature
from gear_damping.reporting.effects_page.signatures import Signature, signature, strongest

DOCS = Path(__file__).resolve().parents[2] / "docs"
REMEDY = "docs/effects.md is not what the declarations say: run 'make docs'"
LARGEST, LARGEST_TOGETHER = 40_000, 2_000_000  # bytes


@pytest.fixture(scope="module")
def written():
    return (DOCS / "effects.md").read_text(encoding="utf-8")


def test_the_page_is_up_to_date_with_the_declarations(written):
    assert without_measurements(written) == page(builtin_effects(), {}), REMEDY


def test_every_effect_has_numbers_and_a_small_figure(written):
    measured = re.findall(f"{BEGIN}(.*?){END}", written)
    assert len(measured) == 2 * len(builtin_effects()), REMEDY
    assert all(re.search(r"\d", text) for text in measured), REMEDY
    figures = {path.stem: path.stat().st_size for path in (DOCS / FIGURES).iterdir()}
    assert set(figures) == set(builtin_effects()), REMEDY
    assert max(figures.values()) <= LARGEST
    assert sum(figures.values()) <= LARGEST_TOGETHER


def test_a_new_effect_without_the_page_fails(written):
    kinds = builtin_effects()
    kind = type("Extra", (kinds["viscous_damping"],), {"name": "extra_damping"})
    assert without_measurements(written) != page({**kinds, "extra_damping": kind}, {})


def test_links_lead_to_sections_and_files(written):
    sections = set(re.findall(r"^### (\w+)$", written, re.MULTILINE))
    assert set(re.findall(r"\]\(#(\w+)\)", written)) == sections == set(builtin_effects())
    for target in re.findall(r"\]\(([^#)]+)\)", written):
        assert (DOCS / target).is_file(), target


@pytest.mark.parametrize("name", ["sensor_offset", "pinion_eccentricity", "offset_force"])
def test_the_numbers_are_those_of_a_run(name, written):
    kinds = builtin_effects()
    section = written.partition(f"### {name}\n")[2]
    shown = _numbers(re.search(f"{BEGIN}(.*?){END}", section).group(1))
    assert shown == pytest.approx(_numbers(measurement(signature(kinds[name], kinds))), rel=0.02), REMEDY


def _numbers(text):
    return [float(found) for found in re.findall(r"[-\d.]+(?:e-?\d+)?(?= (?:µm|rad|Hz))", text.replace("−", "-"))]


def test_signatures_are_what_physics_says():
    """An eccentricity is one line at its shaft's order with its amplitude, an offset has no line at all."""
    kinds = builtin_effects()
    found = signature(kinds["gear_eccentricity"], kinds)
    (order, size), *others = strongest(found)
    assert order == 0.5
    assert size == pytest.approx(20, rel=1e-3)
    assert not others
    assert found.residual.mean() == pytest.approx(0, abs=1e-6)
    offset = signature(kinds["sensor_offset"], kinds)
    np.testing.assert_allclose(offset.residual, 2.0, atol=1e-9)
    assert strongest(offset) == []
    assert "no lines" in measurement(offset)


def test_conditions_name_effects_and_parameters_that_there_are():
    kinds = builtin_effects()
    for name, case in cases.CASES.items():
        declared = {other: {p.name for p in kinds[other].parameters} for other in (name, *case.also, *case.without)}
        given = {name: case.values, **case.also, **case.without}
        for other, values in given.items():
            assert set(values) <= declared[other]


def test_names_of_orders():
    place = np.arange(4.0)
    amplitudes = np.zeros(1601)
    orders = np.arange(1601) / 16
    for order, size in ((0.5, 5.0), (1.0, 4.0), (19.5, 3.0), (41.0, 2.0), (60.0, 1.0), (7.0, 0.9)):
        amplitudes[int(order * 16)] = size
    found = Signature(place, place, place * 0, "µm", orders, amplitudes, amplitudes, 20.0, 0.5, 110.0)
    assert [order for order, _ in strongest(found, 6)] == [0.5, 1.0, 19.5, 41.0, 60.0, 7.0]
    text = measurement(found)
    assert "orders: s2 (5 µm), s1 (4 µm), M−s2 (3 µm), 2M+s1 (2 µm)." in text


def test_rows_of_a_declaration():
    row = parameter_row(Parameter("gap", "m", 1e-4, "clearance a|b", 0.0, 0.01))
    assert row == "| `gap` | clearance a\\|b | m | 100 µm | 0 … 0.01 |"
    assert "must be given" in parameter_row(Parameter("x", "1", None, "x"))
    assert parameter_row(Parameter("x", "1", None, "x")).endswith("| – |")
    many = parameter_row(Parameter("v", "m", tuple(1e-6 * i for i in range(1, 21)), "v", vector=True))
    assert "1 µm, 2 µm, 3 µm, 4 µm, 5 µm, 6 µm, … (20 values)" in many
    assert option_row(Option("on", (False, True), False, "it")) == "| `on` | it | false, true | false |"
    assert "1 … 32" in option_row(Option("n", tuple(range(1, 33)), 8, "harmonics"))
    lines = declaration(builtin_effects()["squeeze_film_damping"])
    assert "- needs: `backlash`" in lines
    assert "- dissipates energy: yes" in lines


def test_a_figure_is_the_same_file_each_time(tmp_path):
    kinds = builtin_effects()
    found = signature(kinds["sine_restoring"], kinds)
    first, second = (write_signature(found, tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert first == second
    assert first.startswith(b"\x89PNG")
