"""What the paper prints, what follows from it, and that the page says what its numbers say."""

import json
import re
from math import cos, pi, radians, sqrt
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from gear_damping.reporting.paper import effect, printed
from gear_damping.reporting.paper.cells import as_fraction
from gear_damping.reporting.paper.page import MARKED, with_tables
from gear_damping.reporting.paper.physics import Response
from gear_damping.reporting.paper.study import MeanAndStd
from gear_damping.reporting.smaller import smaller_png

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAPER = ROOT.parent / "shared" / "seed" / "paper.txt"
# Typed from the PDF, sections 3.2 to 4.1: LSTM, CWT–LSTM.
TYPED = {
    "figure_07": "6.37 × 10−4, 3.19 × 10−4",
    "figure_08": "3.99 × 10−4, 1.034 × 10−4",
    "figure_12": "2.38 × 10−4, 8.33 × 10−4",
    "figure_13": "3.92 × 10−4, 1.93 × 10−4",
    "figure_14": "0.0534, 0.0083",
    "figure_15": "0.062, 0.003",
}


def typed(text):
    mantissa, _, power = text.strip().partition(" × 10−")
    return float(mantissa) * 10 ** -int(power or 0)


@pytest.mark.parametrize("name", TYPED)
def test_printed_errors_are_those_of_the_paper(name):
    raw, cwt = map(typed, TYPED[name].split(","))
    assert printed.RMSE[name].of("raw_lstm") == pytest.approx(raw)
    assert printed.RMSE[name].of("cwt_lstm") == pytest.approx(cwt)
    assert printed.RMSE[name].of("white_noise") is None


def test_printed_errors_stand_in_the_text_of_the_paper():
    if not PAPER.is_file():
        pytest.skip("the text of the paper is not beside this checkout")
    text = PAPER.read_text(encoding="utf-8")
    powers = {float(m) * 10 ** -int(p) for m, p in re.findall(r"([\d.]+)\s*(?:×|\\times)\s*10\^\{-(\d)\}", text)}
    row = next(line for line in text.splitlines() if line.startswith("| 0.0083"))
    numbers = powers | {float(cell) for cell in row.strip("| ").split("|")}
    for errors in printed.RMSE.values():
        for value in (errors.raw_lstm, errors.cwt_lstm):
            assert any(value == pytest.approx(found) for found in numbers), value
    assert len(powers) == 8
    assert "E = 0.001" in text
    assert "converged after the fifth iteration" in text
    assert "LSTM training convergence was reached at epoch 10" in text
    converged = {name: (one["cwt_lstm"], one["raw_lstm"]) for name, one in printed.CONVERGED_AT.items()}
    assert converged == {"figure_06": (2, 5), "figure_11": (2, 10)}


@pytest.fixture(scope="module")
def found():
    return json.loads((DOCS / "paper.json").read_text(encoding="utf-8"))


def test_table_1_follows_from_closed_forms(found):
    r1, r2 = (3e-3 * z * cos(radians(20)) / 2 for z in (20, 40))
    mass = 2.6e-4 * 4.5e-3 / (2.6e-4 * r2**2 + 4.5e-3 * r1**2)
    stiffness = 2e8 + 0.6 * 2e8
    right, wrong = found["physics"]["derived"]["right"], found["physics"]["derived"]["as_printed"]
    assert right["base_radius_pinion_m"] == pytest.approx(r1)
    assert right["base_radius_gear_m"] == pytest.approx(r2)
    assert right["equivalent_mass_kg"] == pytest.approx(mass)
    assert right["natural_frequency_hz"] == pytest.approx(sqrt(stiffness / mass) / (2 * pi))
    assert right["static_deflection_m"] == pytest.approx(150 / r1 / stiffness)
    assert right["damping_per_percent_ns_per_m"] == pytest.approx(2 * 0.01 * sqrt(stiffness * mass))
    speed = right["static_deflection_m"] * sqrt(stiffness / mass)  # at which the ratio is stated
    gamma = 8 / (3 * pi)  # of n = 2: (2/sqrt(pi)) Γ(2) / Γ(5/2)
    assert right["alpha_per_percent"] * speed * gamma == pytest.approx(right["damping_per_percent_ns_per_m"])
    assert wrong["natural_frequency_hz"] == pytest.approx(sqrt(stiffness) / (2 * pi))
    assert wrong["equivalent_mass_kg"] == 1


def test_the_page_says_what_its_numbers_say(found):
    text = (DOCS / "paper.md").read_text(encoding="utf-8")
    assert with_tables(text, found) == text
    marked = {mark[1] for mark in MARKED.findall(text)}
    assert marked >= {*printed.EFFECTS, "settings", "overview", "leads"}


def test_every_figure_stands_on_the_page_and_is_small():
    text = (DOCS / "paper.md").read_text(encoding="utf-8")
    for name in printed.EFFECTS:
        if name.startswith("figure"):
            assert f"](figures/paper/{name}.png)" in text
            assert (DOCS / "figures" / "paper" / f"{name}.png").stat().st_size < 150_000


def test_the_numbers_are_of_three_seeds_and_of_every_effect(found):
    assert len(found["settings"]["seeds"]) >= 3
    noises = {f"noise_{snr}_db" for snr in (1, 10, 20, 30, 40, 50)}
    under_both = {effect for effect, protocols in found["learned"].items() if {"paper", "by_run"} <= set(protocols)}
    assert {"baseline", "eccentricity", "backlash", "torque"} | noises <= under_both


def test_mean_and_std_are_those_of_its_values():
    one = MeanAndStd.over([1.0, 2.0, 6.0])
    assert (one.mean, one.std) == (3.0, pytest.approx(sqrt(7)))
    assert MeanAndStd.over([2.0]).std == 0
    assert as_fraction({"mean": 0.0819, "std": 0.0012, "values": (0, 1)}) == "(8.19 ± 0.12)·10⁻⁴"


def test_ridges_are_the_maxima_with_their_half_power_width():
    frequencies = np.geomspace(100, 10_000, 201)
    size = np.exp(-((np.log(frequencies / 1000) / 0.2) ** 2)) + 0.5 * np.exp(-((np.log(frequencies / 5000) / 0.2) ** 2))
    none = np.zeros((2, 2))
    one = Response(none, none, none, none, none, frequencies, np.stack([size, size]), 5500.0, 1000.0)
    low, high = one.ridges
    assert (low.frequency_hz, high.frequency_hz) == (pytest.approx(1000, rel=0.02), pytest.approx(5000, rel=0.02))
    assert high.share == pytest.approx(0.5, rel=0.02)
    half = 0.2 * sqrt(np.log(sqrt(2)))
    assert np.log(low.high_hz / low.low_hz) == pytest.approx(2 * half, rel=0.2)


@pytest.mark.parametrize(("error", "end"), [(0.1, 10.0), (60.0, 90.0)])
def test_no_error_lies_beyond_the_axis(error, end):
    """Networks that were trained for an epoch or two miss by more than the paper's do."""
    study = SimpleNamespace(of=lambda effect, protocol: [1], score=lambda *_: MeanAndStd.over([error]))
    axes = Figure().subplots()
    effect._errors(axes, study, "figure_12", "eccentricity")
    assert axes.get_xlim()[1] == pytest.approx(end)


def test_a_large_picture_becomes_small(tmp_path):
    from PIL import Image

    source = tmp_path / "large.png"
    Image.effect_noise((600, 600), 80).convert("RGB").save(source)
    assert smaller_png(source, tmp_path / "small.png").stat().st_size < source.stat().st_size
