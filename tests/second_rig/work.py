"""One case of the second rig: written, explained from its folder alone, and judged beside the truth."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import process_time
from typing import Any

from second_rig import write_case

from gear_damping.physics.catalogue import builtin_effects

from ..blind.judge import damping_held, established
from ..blind.work import said_of

SILENT = ("unexplained", "partly_explained")  # verdicts that admit to an effect without a name
Case = dict[str, Any]


def answer(name: str) -> Case:
    """The truth about a case, what was said of it, the seconds of one core that took, and whether it is right."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "measured"
        truth = write_case(name, place)
        begun = process_time()
        said = said_of(place / "measurement.yaml", builtin_effects())
        seconds = round(process_time() - begun, 2)
    case = {"case": name, "truth": truth, "answer": said, "seconds": seconds}
    return case | {"right": is_right(case)}


def is_right(case: Case) -> bool:
    """By what there was to find.

    Nothing: consistent, and the damping ratio in its interval. An effect: established and named first. A constant
    declared wrong: consistent once it is calibrated. An effect that the catalogue lacks: unexplained or partly
    explained, and no name established.
    """
    truth, said = case["truth"], case["answer"]
    if truth["to_find"] == "effect":
        return established(said)[:1] == [truth["hidden"]]
    if truth["to_find"] == "outside":
        return said["verdict"] in SILENT and not established(said)
    sound = said["verdict"] == "consistent"
    return sound and (truth["to_find"] == "constant" or damping_held(case, said) is True)
