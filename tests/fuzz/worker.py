"""A process that asks one case after another within limits, and says what came of each: `python -m tests.fuzz.worker`.

A case that kills the process, hangs or eats the memory ends it; whoever started it notes that and begins behind it.
"""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

SECONDS = 60  # of a case; a reader that does not end is given up after half of it
RIG_SECONDS = 180  # of a rig that is fitted
MEMORY = 4 * 1024**3  # bytes of address space beyond what is mapped before the first case


class TooSlow(BaseException):
    """Past its time; no `except Exception` of a library may swallow it."""


def main() -> None:
    """Arguments: target, first case, number of cases, seed."""
    name, first, count, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    from .targets import RIGS, target

    seconds = RIG_SECONDS if name in RIGS else SECONDS

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        sound = Path(folder) / "sound"
        sound.mkdir()
        asked = target(name, sound)
        _limit()
        signal.signal(signal.SIGALRM, _late)
        os.chdir(folder)
        for number in range(first, first + count):
            place = Path(folder) / f"case_{number}"
            place.mkdir()
            before = set(os.listdir(folder))
            said = _answer(asked, random.Random(f"{seed} {name} {number}"), place, seconds)
            written = set(os.listdir(folder)) - before
            if written:
                said = {"escape": f"wrote {', '.join(sorted(written))}", "trace": ""}
            print(json.dumps({"case": number, **said}), flush=True)
            for file in place.iterdir():
                file.unlink()
            place.rmdir()


def _answer(asked, source: random.Random, place: Path, seconds: int) -> dict[str, str]:
    signal.alarm(seconds)
    try:
        return {"said": asked(source, place)}
    except TooSlow:
        return {"escape": f"not answered within {seconds} s", "trace": ""}
    except BaseException as error:
        trace = "".join(traceback.format_tb(error.__traceback__)[-3:])
        return {"escape": f"{type(error).__name__}: {error}"[:300], "trace": trace}
    finally:
        signal.alarm(0)


def _late(number: int, frame: object) -> None:
    raise TooSlow


def _limit() -> None:
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + MEMORY, mapped + MEMORY))


if __name__ == "__main__":
    main()
