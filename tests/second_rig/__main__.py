"""`make second-rig`: have the measurements of another generator explained, and judge. Resumes where it was stopped."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "second_rig.md"


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """The options of the command line."""
    from second_rig import CASES, SETS

    parser = argparse.ArgumentParser(prog="make second-rig ARGS=...", description=__doc__)
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("--set", choices=tuple(SETS), help="only this one; both where absent")
    chosen.add_argument("--case", nargs="+", choices=tuple(CASES), metavar="NAME", help="only these, such as c03 d10")
    parser.add_argument("--processes", type=int, default=2, choices=(1, 2))
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.relative_to(ROOT)} too")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "second_rig", help="folder of the answers")
    return parser.parse_args(given)


def main(given: list[str] | None = None) -> int:
    """Run; 0 when done, 130 when stopped by Ctrl-C."""
    os.environ["OMP_NUM_THREADS"] = "1"
    sys.path.insert(0, str(ROOT / "tests" / "oracles"))
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT / "tests" / "oracles"), str(ROOT)])  # of the workers
    options = arguments(given)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    from second_rig import CASES, SETS

    from .page import page
    from .run import ask

    names = options.case or list(SETS[options.set] if options.set else CASES)
    try:
        cases = ask(names, options.out, options.processes, _log)
    except KeyboardInterrupt:
        _log("stopped; the cases done so far are kept, and the same command goes on from here")
        return 130
    _log(f"{sum(case['right'] for case in cases)} of {len(cases)} right: {options.out}")
    if options.page and cases:
        PAGE.write_text(page(cases, " ".join(["make second-rig", *_shown(given)])), encoding="utf-8")
    return 0


def _shown(given: list[str] | None) -> list[str]:
    words = sys.argv[1:] if given is None else given
    return [f'ARGS="{" ".join(words)}"'] if words else []


def _log(text: str) -> None:
    print(text, flush=True)


if __name__ == "__main__":
    sys.exit(main())
