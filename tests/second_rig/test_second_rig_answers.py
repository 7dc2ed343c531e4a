"""The judging and the page of the second rig, and that it goes on where it was stopped."""

import json
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.second_rig.__main__ import arguments
from tests.second_rig.page import drawn_page, page
from tests.second_rig.run import NOTES, ask, done_cases, engine
from tests.second_rig.work import is_right


def case(to_find, hidden=None, verdict="consistent", causes=(), interval=(1.9, 2.1), parameters=None):
    """A case whose true damping ratio is 2 %; causes: (name, status, parameters)."""
    truth = {"hidden": hidden, "parameters": parameters or {}, "to_find": to_find, "damping_ratio_percent": 2.0}
    truth |= {"teeth": [20, 41], "sensor": "pinion_speed", "noise": {"kind": "white", "snr_db": 30}}
    keys = ("name", "status", "parameters")
    said = {"verdict": verdict, "causes": [dict(zip(keys, cause, strict=True)) for cause in causes]}
    said["damping_ratio_percent"] = {"value": 2.05, "unit": "%", "interval95": list(interval)}
    found = {"case": "c01", "truth": truth, "answer": said, "seconds": 12.3, "engine": "a"}
    return found | {"right": is_right(found)}


GAP = {"gap": {"value": 6.1e-5, "unit": "m", "interval95": [5.9e-5, 6.3e-5]}}
BACKLASH = ("backlash", "established", GAP)
OTHER = ("sensor_delay", "established", {})


@pytest.mark.parametrize(
    ("one", "right"),
    [
        (case("null"), True),
        (case("null", interval=(2.01, 2.1)), False),
        (case("null", verdict="unexplained"), False),
        (case("effect", "backlash", "explained", [BACKLASH, OTHER]), True),
        (case("effect", "backlash", "explained", [OTHER, BACKLASH]), False),
        (case("effect", "backlash", "explained", [("backlash", "suggested", GAP)]), False),
        (case("effect", "backlash", "consistent"), False),
        (case("constant", "damping_ratio", interval=(2.01, 2.1)), True),
        (case("constant", "damping_ratio", "explained", [OTHER]), False),
        (case("outside", "sensor_mount_resonance", "partly_explained"), True),
        (case("outside", "sensor_mount_resonance", "unexplained", [OTHER]), False),
        (case("outside", "sensor_mount_resonance", "explained"), False),
    ],
)
def test_what_is_right_follows_from_what_there_was_to_find(one, right):
    assert one["right"] is right


def test_the_page_lays_each_answer_beside_the_truth():
    found = case("effect", "backlash", "explained", [BACKLASH], parameters={"gap": 6e-5})
    teeth = {f"values[{i}]": {"value": v, "unit": "m"} for i, v in enumerate((1e-7, -4e-6, 2e-7))}
    pitch = case("effect", "pitch_error", "explained", [("pitch_error", "established", teeth)],
                 parameters={"amplitude": 4e-6})  # fmt: skip
    text = page([found, pitch, case("null", verdict="unexplained")], "make second-rig")
    assert "Written by `make second-rig` from 3 of the 30 cases: 2 right." in text
    assert "`backlash`; gap 6.1e-05 [5.9e-05, 6.3e-05] m (6e-05) | 2.05 [1.9, 2.1] (2)" in text
    assert "`pitch_error`; largest tooth -4e-06 m (3.8e-06)" in text
    assert "| c01 | 20/41 | pinion speed | white, 30 dB | nothing | unexplained | – |" in text


def test_what_is_answered_is_not_asked_again(tmp_path):
    line = json.dumps(case("null") | {"engine": engine()})
    (tmp_path / NOTES).write_text(line + "\n" + line[:40])
    told = []
    assert [one["case"] for one in ask(["c01"], tmp_path, 1, told.append)] == ["c01"]
    assert told == ["1 of 1 cases are done already, 0 to do"]
    assert set(done_cases(tmp_path / NOTES)) == {"c01"}


def test_a_set_or_some_cases_are_chosen():
    assert arguments(["--case", "c03", "d10"]).case == ["c03", "d10"]
    assert arguments(["--set", "second"]).set == "second"
    with pytest.raises(SystemExit):
        arguments(["--set", "first", "--case", "c03"])


def test_the_page_of_drawn_cases_counts_what_is_right_and_what_is_named_wrongly():
    found = case("effect", "backlash", "explained", [BACKLASH], parameters={"gap": 6e-5})
    other = case("effect", "backlash", "explained", [OTHER], parameters={"gap": 6e-5}, interval=(2.01, 2.1))
    text = drawn_page([found, other, case("null")], "make second-rig")
    assert "from 3 cases, explained by the version a of the package: **2 right (67 % [9, 99]), 1 with a name" in text
    assert "2 of 3 intervals of the damping ratio hold it" in text
    assert "| `backlash` | 2 | 1 | 1 |" in text
    assert "| nothing | 1 | 1 | 0 |" in text


def test_drawn_cases_are_chosen_by_their_numbers():
    assert arguments(["--drawn", "600", "40"]).drawn == [600, 40]
    with pytest.raises(SystemExit):
        arguments(["--set", "first", "--drawn", "600", "40"])
