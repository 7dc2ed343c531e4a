"""Drawn oscillators that once ended in a traceback: each is answered, or refused with a message."""

import json
import random

import pytest

import gear_damping as gd
from tests.fuzz.rigs import drawn


@pytest.mark.parametrize("number", ["3 identify 4", "4 identify 116"])
def test_it_is_identified(number, tmp_path):
    found = gd.identify(gd.load(drawn(random.Random(number), tmp_path)))
    assert json.dumps(found.content)
    assert found.table()


@pytest.mark.parametrize("number", ["6 explain 15", "6 explain 35"])
def test_it_is_explained(number, tmp_path):
    answer = gd.explain(gd.load(drawn(random.Random(number), tmp_path)), minutes=0.05)
    assert answer.verdict
    assert answer.report(tmp_path / "report.html").exists()
