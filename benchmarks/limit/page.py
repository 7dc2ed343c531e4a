"""The table of `make limit`, and its place in docs/limit.md."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[2] / "docs" / "limit.md"
BEFORE, AFTER = "<!-- measured by `make limit` -->", "<!-- end -->"
COLUMNS = (
    "SNR / dB", "bound / %", "estimator", "RMSE / %", "ratio to bound", "typical ratio", "skill",
    "90 % interval holds", "ms a record",
)  # fmt: skip


def table(content: Mapping[str, Any]) -> str:
    """A row for every level of noise and estimator."""
    rows = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"]
    for snr, level in content["snr_db"].items():
        for name, found in level["estimators"].items():
            covered = "" if found["coverage90"] is None else f"{100 * found['coverage90']:.1f} %"
            cells = (
                snr, f"{level['bound_percent']:.4f}", f"`{name}`", f"{found['rmse_percent']:.4f}",
                f"{found['ratio_to_bound']:.2f}", f"{found['typical_ratio']:.2f}", f"{found['skill']:.3f}", covered,
                f"{1e3 * found['seconds_per_record']:.2g}",
            )  # fmt: skip
            rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def write(content: Mapping[str, Any]) -> None:
    """Put the table into its place on the page."""
    text = PAGE.read_text()
    head, tail = text.split(BEFORE)[0], text.split(AFTER)[1]
    seeds = ", ".join(map(str, content["seeds"]))
    said = (
        f"Family `{content['family']}` with backlash, {content['test_runs']} unseen runs of 2000 samples, of which "
        f"{content['irregular_runs']} are irregular and left out; networks trained on {content['training_runs']} runs "
        f"(those of windows on 4000), seeds {seeds}, means over the seeds."
    )
    PAGE.write_text(f"{head}{BEFORE}\n\n{said}\n\n{table(content)}\n\n{AFTER}{tail}")
