"""Tables for the terminal, for Markdown and for spreadsheets."""

import csv

import pytest

from gear_damping.reporting.tables import (
    COLUMNS,
    identification_table,
    parameter_table,
    results_markdown,
    results_table,
    write_csv,
)


def score(mean, std=0.0, skill=0.5, epochs=12.0):
    return {
        "rmse_percent": {"mean": mean, "std": std}, "rmse_paper": mean * 7, "median_relative_error": 0.123,
        "skill": skill, "epochs": epochs,
    }  # fmt: skip


@pytest.fixture
def results():
    return {
        "experiment": "backlash", "protocol": "by_run", "family": "bench", "seeds": [0, 1],
        "models": {"raw_lstm": score(0.05, 0.002), "cwt_lstm": score(0.031, 0.001)},
        "controls": {"mean": score(0.14, skill=None, epochs=None)},
    }  # fmt: skip


def test_results_have_a_row_for_each_estimator_and_say_what_was_compared(results):
    text = results_table(results)
    lines = text.splitlines()
    assert lines[0].strip() == "backlash: protocol by_run, family bench, seeds 0, 1"
    assert all(column in text for column in COLUMNS)
    cells = {line.split("  ")[1].strip() if line.startswith("  ") else "": line for line in lines}
    assert cells["raw_lstm"].split()[1:] == ["0.05", "±", "0.0020", "0.35", "12.3", "%", "0.500", "12"]
    assert cells["mean (control)"].split()[-3:] == ["%", "–", "–"]
    assert max(map(len, lines)) <= 100


def test_one_seed_has_no_standard_deviation(results):
    text = results_table(results | {"seeds": [3]})
    assert "±" not in text
    assert "seeds 3" in text


def test_markdown_is_one_table_of_equal_rows(results):
    lines = results_markdown(results).splitlines()
    assert len(lines) == 2 + 3
    assert {line.count("|") for line in lines} == {len(COLUMNS) + 1}
    assert lines[2].startswith("| raw_lstm | 0.05 ± 0.0020 |")


def test_cells_are_text_and_no_markup():
    text = parameter_table("found [here]", [("[red]mass[/red]", "1", "", "kg")])
    assert "found [here]" in text
    assert "[red]mass[/red]" in text


def test_identification_shows_what_was_found_and_leaves_out_what_was_not():
    found = {
        "damping_ratio_percent": {"value": 2.0, "interval95": [1.9, 2.1]}, "natural_frequency_hz": None,
        "parameters": {"damping_coefficient": {"value": 1.25, "unit": "1/s", "interval95": None}},
        "residual": {"fit": {"rmse": 1e-4, "unit": "um"}, "holdout": None},
    }  # fmt: skip
    text = identification_table(found)
    assert "1.9 … 2.1" in text
    assert "% of critical" in text
    assert "damping coefficient" in text
    assert "residual where fitted" in text
    assert "µm" in text
    assert "natural frequency" not in text
    assert "held-out" not in text


def test_csv_has_every_column_and_leaves_gaps(tmp_path):
    path = write_csv([{"job": 0, "error": 0.1}, {"job": 1, "note": "a, b"}], tmp_path / "sweep.csv")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows == [{"job": "0", "error": "0.1", "note": ""}, {"job": "1", "error": "", "note": "a, b"}]
