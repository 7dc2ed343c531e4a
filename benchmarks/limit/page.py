"""The place of the table and the figure of `make limit` in docs/limit.md."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.marked import put
from gear_damping.reporting.evaluation import evaluation_figure, evaluation_table
from gear_damping.reporting.figures import save

FIGURE = Path(__file__).parents[2] / "docs" / "figures" / "limit.png"
PAGE = Path(__file__).parents[2] / "docs" / "limit.md"
KEPT = PAGE.with_suffix(".json")  # what table and figure follow from
BEFORE, AFTER = "<!-- measured by `make limit` -->", "<!-- end -->"


def write(content: Mapping[str, Any]) -> None:
    """Put the table into its place on the page."""
    seeds = ", ".join(map(str, content["seeds"]))
    said = (
        f"Family `{content['family']}` with backlash, {content['test_runs']} unseen runs of 2000 samples, of which "
        f"{content['irregular_runs']} are irregular and left out; networks trained on {content['training_runs']} runs "
        f"(those of windows on 4000), seeds {seeds}, means over the seeds."
    )
    KEPT.write_text(json.dumps(content, indent=1) + "\n")
    save(evaluation_figure(content), FIGURE)
    put(f"{said}\n\n{evaluation_table(content)}", PAGE, BEFORE, AFTER)


def kept() -> dict[str, Any]:
    """What the page says now."""
    return json.loads(KEPT.read_text())
