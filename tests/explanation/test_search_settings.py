"""Thresholds of the search: declared once, mirrored by the configuration, and each of them read somewhere."""

import ast
from dataclasses import fields
from pathlib import Path

import pytest
import yaml

import gear_damping
from gear_damping.config.keys import SCHEMA, problem_with
from gear_damping.config.source import Origin
from gear_damping.explanation.settings import SearchSettings

PACKAGE = Path(gear_damping.__file__).parent
CONFIGURED = PACKAGE.parent / "conf" / "explain" / "default.yaml"
NAMES = [one.name for one in fields(SearchSettings)]


def test_the_configuration_says_the_defaults():
    said = yaml.safe_load(CONFIGURED.read_text())
    assert said.pop("minutes") > 0
    assert said == {one.name: one.default for one in fields(SearchSettings)}


def test_every_threshold_is_explained():
    listed = SearchSettings.__doc__.partition("Args:")[2]
    assert [name for name in NAMES if f"        {name}: " not in listed] == []


@pytest.mark.parametrize("name", NAMES)
def test_a_threshold_is_read_by_the_search(name):
    read = set()
    for path in (PACKAGE / "explanation").rglob("*.py"):
        read |= {node.attr for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)}
    assert name in read


@pytest.mark.parametrize("one", fields(SearchSettings), ids=NAMES)
def test_a_threshold_outside_its_range_is_refused(one):
    rule, key, origin = SCHEMA["explain"][one.name], f"explain.{one.name}", Origin({})
    assert problem_with(one.default, rule, key, origin) is None
    assert problem_with(one.metadata["upper"] * 2 + 1, rule, key, origin) is not None
    assert problem_with("much", rule, key, origin) is not None
