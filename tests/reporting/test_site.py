"""The site: every page stands in its navigation, and what its reference names is there."""

import re
from importlib import import_module
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"


def pages(node):
    """The pages of a navigation."""
    if isinstance(node, str):
        return [node]
    return [page for part in (node.values() if isinstance(node, dict) else node) for page in pages(part)]


def test_every_page_is_in_the_navigation_and_exists():
    listed = pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"])
    assert sorted(listed) == sorted(path.name for path in DOCS.glob("*.md"))


def test_everything_in_the_reference_is_there_with_a_docstring():
    named = re.findall(r"^::: (\S+)$", (DOCS / "reference.md").read_text(), re.MULTILINE)
    assert len(named) > 15
    for name in named:
        place, _, attribute = name.rpartition(".")
        assert getattr(import_module(place), attribute).__doc__
