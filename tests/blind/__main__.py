"""`make blind`: hide effects in measurements, have them explained, count. Resumes where it was stopped."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .command import ROOT, STOPPED, at_least_one, log, see_oracles, shown, stop_by_signals

PAGES = ROOT / "docs"


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """The options of the command line."""
    from .strata import COUNTS

    parser = argparse.ArgumentParser(prog="make blind ARGS=...", description=__doc__)
    parser.add_argument("--stratum", action="append", choices=tuple(COUNTS), help="only this one; may be repeated")
    parser.add_argument("--cases", type=int, help="of each stratum; the counts of a full run where absent")
    parser.add_argument("--seed", type=int, default=1000, help="the first; seeds below 1000 are for tuning")
    parser.add_argument("--minutes", type=float, default=85.0, help="begin no case after so many; call again to go on")
    parser.add_argument("--processes", type=at_least_one, default=2, help="side by side, each on one core")
    parser.add_argument("--redo", action="store_true", help="ask again what another version of the package answered")
    parser.add_argument("--page", action="store_true", help="write docs/NAME.md too, and the cases beside it")
    parser.add_argument("--name", default="blind", help="of the page; a fresh clone goes on from its cases")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "blind", help="folder of cases and rates")
    return parser.parse_args(given)


def main(given: list[str] | None = None) -> int:
    """Run; 0 when done, 130 when stopped by Ctrl-C."""
    see_oracles()
    options = arguments(given)
    stop_by_signals()
    from .run import CASES, ask, begin_from, done_cases, keep, write
    from .strata import COUNTS, questions

    page, kept = PAGES / f"{options.name}.md", PAGES / f"{options.name}_cases.jsonl"
    asked = questions(tuple(options.stratum or COUNTS), options.cases, options.seed)
    begin_from(kept, options.out / CASES)
    stopped = False
    try:
        cases = ask(asked, options.out, options.processes, log, options.minutes, redo=options.redo)
    except KeyboardInterrupt:
        stopped, cases = True, done_cases(options.out / CASES)
        log(STOPPED)
    if not cases:
        return 130 if stopped else 0
    found = write(cases, options.out, page if options.page else None, shown("make blind", given))
    if options.page:
        keep(cases, kept)
    for claim, row in found["rates"].items():
        log(f"{claim}: {row['count']} of {row['n']} ({row['target']}: {row['met']})")
    log(f"rates and table: {options.out}")
    return 130 if stopped else 0


if __name__ == "__main__":
    sys.exit(main())
