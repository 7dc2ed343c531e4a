"""`make fuzz`: damage files, declarations and commands, and see that each is read or refused with a message."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .targets import RIGS, TARGETS

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "reliability.md"
CASES, RIG_CASES = 10_000, 200
PATIENCE = 300.0  # s without a word, after which a worker hangs where no alarm reaches it
HEAD = """# Reliability

Files, declarations and commands that were valid are damaged at random: bytes flipped, cut, doubled, fields set to
extreme numbers; nodes of a `measurement.yaml` removed, renamed or replaced; words of a command cut or replaced. Under
`identify` and `explain` oscillators are drawn (any channels, units, roles, clocks, loads and lengths in any mixture,
among them rigs that run away) and identified, or explained in a search of three seconds with its report. Each case must
be read, or refused with one message that names key or file. A crash, a hang (60 s; 3 minutes of a rig), more than 4 GiB
of memory, a killed process and a file written outside of the case's folder are escapes. Each case follows from its
number and the seed.
"""


def cases(name: str, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """What was said of each case; a worker that dies is replaced behind the case that killed it."""
    number = 0
    while number < count:
        words = [sys.executable, "-m", "tests.fuzz.worker", name, str(number), str(count - number), str(seed)]
        alone = os.environ | {"OMP_NUM_THREADS": "1"}
        with subprocess.Popen(words, cwd=ROOT, env=alone, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            watch = threading.Timer(PATIENCE, running.kill)
            watch.start()
            for line in running.stdout:
                watch.cancel()
                said = json.loads(line)
                number = said["case"] + 1
                yield said
                watch = threading.Timer(PATIENCE, running.kill)
                watch.start()
            watch.cancel()
            error = running.stderr.read().decode(errors="replace")[-300:]
        if number < count:
            yield {"case": number, "escape": f"the process ended with {running.returncode}", "trace": error}
            number += 1


def asked(name: str, count: int, seed: int, out: Path) -> dict[str, Any]:
    """The row of one target; escapes are written to a file."""
    counts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    begun, said_at = time.monotonic(), time.monotonic()
    with (out / f"{name.replace(' ', '_')}.jsonl").open("w") as file:
        for said in cases(name, count, seed):
            counts[said.get("said", "escape")] += 1
            if "escape" in said:
                kinds[said["escape"]] += 1
                file.write(json.dumps(said) + "\n")
                file.flush()
            if time.monotonic() - said_at > 20:
                said_at = time.monotonic()
                print(f"{name}: {sum(counts.values())} of {count}, {counts['escape']} escapes", flush=True)
    row = {"target": name, "cases": sum(counts.values()), **{key: counts[key] for key in ("read", "refused", "escape")}}
    print(f"{row} ({time.monotonic() - begun:.0f} s)", flush=True)
    for kind, many in kinds.most_common(8):
        print(f"    {many} x {kind}")
    return row


def page(rows: list[dict[str, Any]], seed: int) -> str:
    """The page of the documentation."""
    lines = [HEAD, f"Written by `make fuzz`, seed {seed}.", "", "| what | cases | read | refused | escapes |",
             "|---|---|---|---|---|"]  # fmt: skip
    lines += [f"| {r['target']} | {r['cases']} | {r['read']} | {r['refused']} | {r['escape']} |" for r in rows]
    return "\n".join(lines) + "\n"


def main() -> int:
    """0 where nothing escaped."""
    parser = argparse.ArgumentParser(prog="make fuzz ARGS=...", description=__doc__)
    parser.add_argument("--target", action="append", choices=TARGETS, help="only this one; may be repeated")
    parser.add_argument("--cases", type=int, help=f"of each; {CASES} where absent, of {' and '.join(RIGS)} {RIG_CASES}")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.relative_to(ROOT)} too")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "fuzz")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    counts = {name: options.cases or (RIG_CASES if name in RIGS else CASES) for name in TARGETS}
    rows = [asked(name, counts[name], options.seed, options.out) for name in options.target or TARGETS]
    (options.out / "reliability.md").write_text(page(rows, options.seed))
    if options.page:
        PAGE.write_text(page(rows, options.seed))
    return 1 if any(row["escape"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
