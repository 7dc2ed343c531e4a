"""A training that is gone on with has the keys that it was begun with, or the difference is said."""

import json

import pytest

from gear_damping.config.by_task import _begun, _differing

BEGUN = {"simulator": {"n_runs": 60, "backlash": {"gap": 1e-4}}, "model": {"names": ["raw_lstm"], "hidden_size": 60}}


@pytest.mark.parametrize(
    ("key", "now", "found"),
    [
        ("simulator", {"n_runs": 60, "backlash": {"gap": 1e-4}}, []),
        ("simulator", {"n_runs": 61, "backlash": {"gap": 1e-4}}, ["simulator.n_runs"]),
        ("simulator", {"n_runs": 60, "backlash": {"gap": 2e-4}}, ["simulator.backlash.gap"]),
        ("simulator", {"n_runs": 60}, ["simulator.backlash"]),
        ("simulator", {"n_runs": 60, "backlash": {"gap": 1e-4}, "new_key": False}, []),  # of a later version
        ("model", {"names": ["cwt_lstm"], "hidden_size": 60}, []),
        ("model", {"names": ["raw_lstm"], "hidden_size": 80}, ["model.hidden_size"]),
    ],
)
def test_keys_that_decide_what_is_learnt_are_compared(key, now, found):
    assert [name for name, _, _ in _differing(key, BEGUN[key], now)] == found


@pytest.mark.parametrize("text", [None, "no JSON", "[]", "{}", json.dumps({"config": [], "command": "x"})])
def test_a_run_that_does_not_say_how_it_began_is_asked_nothing(tmp_path, text):
    if text is not None:
        (tmp_path / "run.json").write_text(text)
    assert _begun(tmp_path) is None
