"""`make second-rig`: have the measurements of another generator explained, and judge. Resumes where it was stopped."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..blind.command import ROOT, STOPPED, at_least_one, log, see_oracles, shown, stop_by_signals

PAGE, DRAWN_PAGE = (ROOT / "docs" / name for name in ("second_rig.md", "second_rig_drawn.md"))


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """The options of the command line."""
    from second_rig import CASES, SETS

    parser = argparse.ArgumentParser(prog="make second-rig ARGS=...", description=__doc__)
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("--set", choices=tuple(SETS), help="only this one; both where absent")
    chosen.add_argument("--case", nargs="+", choices=tuple(CASES), metavar="NAME", help="only these, such as c03 d10")
    chosen.add_argument("--drawn", nargs=2, type=int, metavar=("FIRST", "N"), help="N cases that are drawn by number")
    parser.add_argument("--processes", type=at_least_one, default=2, help="side by side, each on one core")
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.relative_to(ROOT)} or its drawn one too")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "second_rig", help="folder of the answers")
    return parser.parse_args(given)


def main(given: list[str] | None = None) -> int:
    """Run; 0 when done, 130 when stopped by Ctrl-C."""
    see_oracles()
    options = arguments(given)
    stop_by_signals()
    from second_rig import CASES, DRAWN, SETS

    from .page import drawn_page, page
    from .run import ask

    if options.drawn:
        first, count = options.drawn
        names = [f"{DRAWN}{number}" for number in range(first, first + count)]
    else:
        names = options.case or list(SETS[options.set] if options.set else CASES)
    try:
        cases = ask(names, options.out, options.processes, log)
    except KeyboardInterrupt:
        log(STOPPED)
        return 130
    log(f"{sum(case['right'] for case in cases)} of {len(cases)} right: {options.out}")
    if options.page and cases:
        path, write = (DRAWN_PAGE, drawn_page) if options.drawn else (PAGE, page)
        path.write_text(write(cases, shown("make second-rig", given)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
