"""Kept answers to real records: those of the code that explains now, and of no other."""

import json

from benchmarks import real_records

ANSWERS = {"seismometer (null)": {"verdict": "consistent"}}


def kept(folder, content):
    path = folder / "answers.json"
    path.write_text(json.dumps(content))
    return path


def test_answers_of_the_same_code_go_on(tmp_path):
    path = kept(tmp_path, {"engine": "now", "answers": ANSWERS})
    assert real_records.of_this_engine(path, "now") == ANSWERS


def test_answers_of_other_code_are_asked_again(tmp_path):
    assert real_records.of_this_engine(kept(tmp_path, {"engine": "0", "answers": ANSWERS}), "now") == {}
    assert real_records.of_this_engine(kept(tmp_path, ANSWERS), "now") == {}  # as they were kept without a word of it
    assert real_records.of_this_engine(tmp_path / "none.json", "now") == {}
