"""Drawn oscillators that once ended in a traceback: each is answered, or refused with a message."""

import json
import random

import pytest

import gear_damping as gd
from tests.fuzz.rigs import drawn

REFUSED = {"4 identify 116": "repeated time stamp"}


@pytest.mark.parametrize("number", ["3 identify 4", "4 identify 116"])
def test_it_is_identified_or_refused(number, tmp_path):
    measured = drawn(random.Random(number), tmp_path)
    if number in REFUSED:
        with pytest.raises(gd.InputError, match=REFUSED[number]):
            gd.load(measured)
        return
    found = gd.identify(gd.load(measured))
    assert json.dumps(found.content)
    assert found.table()


@pytest.mark.parametrize("number", ["6 explain 15", "6 explain 35"])
def test_it_is_explained(number, tmp_path):
    answer = gd.explain(gd.load(drawn(random.Random(number), tmp_path)), minutes=0.05)
    assert answer.verdict
    assert answer.report(tmp_path / "report.html").exists()
