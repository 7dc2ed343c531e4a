"""Power: the questions, the curve, and what is written of the answers."""

import json

import numpy as np
import pytest

from tests.blind.power.__main__ import KEPT, main
from tests.blind.power.cases import EFFECTS, MULTIPLES, is_established, is_visible, is_wrong, keep, power_questions
from tests.blind.power.curve import size_at_power


def cause(name, *others, status="established"):
    return {"name": name, "status": status, "confusable_with": list(others)}


def test_questions_take_turns_and_no_seed_twice():
    asked = power_questions(EFFECTS, 8, 40000)
    assert [q.stratum for q in asked[: len(EFFECTS)]] == list(EFFECTS)
    assert len({q.seed for q in asked}) == len(asked) == 8 * len(EFFECTS)
    assert {q.multiple for q in asked if q.stratum == EFFECTS[3]} == set(MULTIPLES)
    assert power_questions(EFFECTS[3:4], 1, 40000)[0] == asked[3]


def test_the_curve_finds_where_nine_of_ten_succeed():
    source, middle, width = np.random.default_rng(2), 2.0, 0.3
    true = middle * np.exp(width * np.log(9))
    held = 0
    for _ in range(60):
        sizes = np.repeat(MULTIPLES, 25)
        chance = 1 / (1 + np.exp(-(np.log(sizes / middle)) / width))
        _, low, high = size_at_power(sizes, source.random(len(sizes)) < chance)
        held += low < true < high
    assert held >= 52


def test_a_curve_of_nothing_but_successes_or_failures_says_on_which_side_it_lies():
    sizes = np.repeat(MULTIPLES, 5)
    assert size_at_power(sizes, [True] * 20)[2] < 2.0
    assert size_at_power(sizes, [False] * 20)[1] > 5.0
    value, low, high = size_at_power(sizes, sizes > 1.5)
    assert 1.0 < low < value < high < 3.5


def test_an_answer_counts_alone_or_in_a_small_set():
    assert is_established({"causes": [cause("coulomb_friction")]}, "coulomb_friction")
    assert is_established({"causes": [cause("a", "b", "coulomb_friction")]}, "coulomb_friction")
    assert not is_established({"causes": [cause("a", "b", "c", "coulomb_friction")]}, "coulomb_friction")
    assert not is_established({"causes": [cause("coulomb_friction", status="suggested")]}, "coulomb_friction")
    assert is_wrong({"causes": [cause("backlash")]}, "coulomb_friction")
    assert not is_wrong({"causes": [cause("backlash", status="suggested")]}, "coulomb_friction")
    assert is_visible({"visible": {"p": {"before": 0.001}, "level": 0.01}})
    assert not is_visible({"visible": {"p": {"before": 0.02}, "level": 0.01}})
    assert not is_visible({"visible": None})


def made_up(name, seed, multiple):
    return {
        "stratum": name, "seed": seed, "multiple": multiple, "engine": "1234abcd", "size": 0.01 * multiple,
        "limit": {"seen": 0.004, "named": 0.01, "nearest": "hertz_stiffness", "cosine": 0.9, "degrees": 1},
        "largest": 200.0, "unit": "N", "power": 1.0, "visible": True, "established": multiple > 1.5, "wrong": False,
        "answer": {"verdict": "explained", "causes": [cause("coulomb_friction") | {"parameters": {"force": 1.0}}]},
    }  # fmt: skip


def test_what_is_written_follows_the_cases(tmp_path):
    rows = [made_up(EFFECTS[0], 40000 + i, MULTIPLES[i % 4]) for i in range(20)]
    (tmp_path / "cases.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert main(["--effect", EFFECTS[0], "--cases", "20", "--out", str(tmp_path)]) == 0  # all are done: nothing runs
    own = json.loads((tmp_path / "power.json").read_text())["effects"][EFFECTS[0]]
    assert own["oracle"] == pytest.approx(0.8)  # 200 N at .004
    assert own["oracle_name"] == pytest.approx(2.0)
    sizes, found = [row["multiple"] for row in rows], [row["established"] for row in rows]
    assert own["ratio"] == pytest.approx(size_at_power(sizes, found)[0])
    assert own["established90"] == pytest.approx(own["ratio"] * 2.0)
    assert own["visible_interval95"][1] < 5.0
    assert own["cases"] == 20
    page = (tmp_path / "power.md").read_text()
    assert f"| `{EFFECTS[0]}` | N | 0.8 | 2 | `hertz_stiffness` |" in page
    assert (tmp_path / "figures" / "power.png").stat().st_size > 5000


def test_a_fresh_clone_goes_on_from_the_cases_that_are_kept(tmp_path, monkeypatch):
    rows = [made_up(EFFECTS[0], 40000 + i, MULTIPLES[i % 4]) for i in range(4)]
    keep(rows, tmp_path / KEPT)
    assert "parameters" not in (tmp_path / KEPT).read_text()
    monkeypatch.setattr("tests.blind.power.__main__.DOCS", tmp_path)
    for folder in ("fresh", "again"):
        asked = ["--effect", EFFECTS[0], "--cases", "4", "--page", "--out", str(tmp_path / folder)]
        assert main(asked) == 0  # all are done: nothing runs
        assert json.loads((tmp_path / "power.json").read_text())["effects"][EFFECTS[0]]["cases"] == 4
    assert [json.loads(line)["seed"] for line in (tmp_path / KEPT).read_text().splitlines()] == [
        40000 + i for i in range(4)
    ]
