"""docs/explanation.md says what the declarations say, and these refuse what they do not."""

from pathlib import Path

import pytest
from pydantic import ValidationError

import gear_damping
from gear_damping.explanation.report_schema import KEYS, Explanation
from gear_damping.reporting.explanation_page import main, page

DOCS = Path(gear_damping.__file__).parents[1] / "docs"
REFUSED = dict.fromkeys(KEYS) | {
    "schema_version": 1, "system": "oscillator", "verdict": "data_problem", "sentences": ["Cure it."],
    "causes": [], "candidates": [], "not_observable": [], "records": {"a": {"role": "fit"}}, "findings": [],
}  # fmt: skip


def test_the_page_is_that_of_the_declarations(tmp_path):
    assert main(["--folder", str(tmp_path)]) == 0
    assert (tmp_path / "explanation.md").read_text() == (DOCS / "explanation.md").read_text()


def test_every_key_has_its_row_and_every_mapping_its_table():
    text = page()
    assert [key for key in KEYS if f"| `{key}` |" not in text] == []
    for link in ("#cause", "#misfit", "#damping", "#confirmed", "#notobservable"):
        assert link in text
    assert "`None`" not in text


def test_what_is_not_declared_is_refused():
    Explanation.model_validate(REFUSED)
    for wrong in ({"verdict": "perhaps"}, {"note": 1}, {"records": {"a": {"role": "fit", "rms": 1.0}}}):
        with pytest.raises(ValidationError):
            Explanation.model_validate(REFUSED | wrong)
    with pytest.raises(ValidationError):
        Explanation.model_validate({k: v for k, v in REFUSED.items() if k != "gain"})
