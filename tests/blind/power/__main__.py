"""`make power`: hide every effect at multiples of its limit, count what is seen and named. Resumes where it stopped."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from ..command import ROOT, STOPPED, at_least_one, log, see_oracles, stop_by_signals

DOCS = ROOT / "docs"
KEPT = "power_cases.jsonl"  # beside the page: what its figures are worked out from, and where a fresh clone goes on


def main(given: list[str] | None = None) -> int:
    """Run; 0 when done or time is up, 130 when stopped by Ctrl-C."""
    see_oracles()
    from ..run import CASES, ask, begin_from, done_cases
    from .cases import EFFECTS, answered, keep, power_questions
    from .page import FIGURE, draw, markdown, summary

    parser = argparse.ArgumentParser(prog="make power ARGS=...", description=__doc__)
    parser.add_argument("--effect", action="append", choices=EFFECTS, help="only this one; may be repeated")
    parser.add_argument("--cases", type=int, default=20, help="of each effect")
    parser.add_argument("--seed", type=int, default=40000, help="the first; seeds below 20000 are for tuning")
    parser.add_argument("--minutes", type=float, default=85.0, help="begin no case after so many; call again to go on")
    parser.add_argument("--processes", type=at_least_one, default=2, help="side by side, each on one core")
    parser.add_argument("--page", action="store_true", help="write docs/power.md, docs/power.json and the figure too")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "power", help="folder of cases and power.json")
    options = parser.parse_args(given)
    stop_by_signals()
    begin_from(DOCS / KEPT, options.out / CASES)
    asked = power_questions(options.effect or EFFECTS, options.cases, options.seed)
    stopped = False
    try:
        rows = ask(asked, options.out, options.processes, log, options.minutes, solve=answered)
    except KeyboardInterrupt:
        stopped, rows = True, done_cases(options.out / CASES)
        log(STOPPED)
    if not rows:
        return 130 if stopped else 0
    found = summary(rows, options.seed)
    for folder in (options.out, DOCS) if options.page else (options.out,):
        (folder / "power.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        (folder / "power.md").write_text(markdown(found), encoding="utf-8")
        draw(found, folder / FIGURE)
        log(f"wrote {folder / 'power.json'}, power.md and {FIGURE}")
    if options.page:
        keep(rows, DOCS / KEPT)
    return 130 if stopped else 0


if __name__ == "__main__":
    sys.exit(main())
