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
    """By what there was to find: where that is nothing, the damping ratio is in its interval, too."""
    return names_right(case) and (case["truth"]["to_find"] != "null" or damping_held(case, case["answer"]) is True)


def names_right(case: Case) -> bool:
    """By what there was to find.

    Nothing: consistent. An effect: established and named first. A constant declared wrong: consistent once it is
    calibrated. An effect that the catalogue lacks: unexplained or partly explained, and no name established.
    """
    truth, said = case["truth"], case["answer"]
    if truth["to_find"] == "effect":
        return established(said)[:1] == [truth["hidden"]]
    if truth["to_find"] == "outside":
        return said["verdict"] in SILENT and not established(said)
    return said["verdict"] == "consistent"


def names_wrongly(case: Case) -> bool:
    """Whether a name is established that is not there."""
    return any(name != case["truth"]["hidden"] for name in established(case["answer"]))
