"""CITATION.cff says what pyproject.toml says."""

import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
REQUIRED = {"cff-version", "message", "title", "authors"}  # by the schema of CFF 1.2.0
NOBODY = {"family-names", "given-names"}  # the authors are named together


def test_the_citation_is_of_this_version_and_licence():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert set(cited) >= REQUIRED
    assert cited["cff-version"] == "1.2.0"
    assert str(cited["version"]) == project["version"]
    assert cited["license"] == project["license"]
    assert not any(NOBODY & set(author) for author in cited["authors"])
