"""`task=explain` of a casing: findings in explanation.json, figures in the report, no extended simulator."""

import json
import re

import pytest
from casing import draw_case, write_case

from gear_damping.explanation.casing.report_fields import explain_casing
from gear_damping.explanation.report_schema import Explanation
from gear_damping.measurement.load import load_measurement
from gear_damping.tasks.command import main


@pytest.fixture(scope="module")
def explained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("casing")
    cases = [
        (draw_case(2020, "healthy", seconds=1.0), "reference"),
        (draw_case(2020, "pinion", seconds=1.0, run=1), None),
    ]
    path = write_case(cases, folder / "rig")
    run = [f"measurement.path={path}", f"hydra.run.dir={folder / 'run'}", "progress=false"]
    assert main(["task=explain", *run]) == 0
    return folder / "run"


def test_findings_stand_under_casing(explained):
    content = json.loads((explained / "explanation.json").read_text())
    Explanation.model_validate(content)
    assert content["verdict"] == "unexplained"
    assert content["causes"] == []
    assert content["casing"]["families"][0]["flagged"]
    for entry in content["casing"]["findings"]:
        assert {"record", "family", "shaft", "order", "statistic", "value", "p", "limit", "flagged", "sentence"} <= set(
            entry
        )
    lines = {line["what"]: line for line in content["casing"]["records"]["run_2"]["lines"]}
    assert lines["mesh 1"]["amplitude"] > lines["mesh 1"]["floor"]
    assert lines["mesh 1"]["unit"] == "m/s^2"
    assert not (explained / "extended_simulator.yaml").exists()


def test_the_report_shows_orders_turns_and_kurtosis_beside_the_reference(explained):
    page = (explained / "report.html").read_text()
    assert "What the casing shows" in page
    assert "What changed from the reference" in page
    assert "Unexplained: the casing shows something" in page
    assert "encoder on each shaft" in page
    assert page.count("<img") == 3
    assert page.count("Grey: the reference, run_1.") == 3  # the caption of each
    assert not re.findall(r"(?:src|href)=\"(?!data:|#)", page)


def test_what_says_nothing_of_a_casing_is_named(tmp_path):
    path = write_case([(draw_case(2020, "healthy", seconds=1.0), "holdout")], tmp_path / "rig")
    text = path.read_text() + "segments: {value: 0.1, unit: s}\n"
    path.write_text(text.replace("parameters:\n", "parameters:\n  module: {value: 9, unit: mm}\n"))
    content = explain_casing(load_measurement(path), print)[0]
    assert any(s.endswith("declared and not used: module, segments, role: holdout.") for s in content["sentences"])
