"""The cases: every effect hidden at multiples of the larger of its two limits."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hidden import amplitude_of, draw_case, limits, power_of_size

from ..strata import NAMEABLE, same_class
from ..work import explained

MULTIPLES = (1.0, 2.0, 3.0, 5.0)
EFFECTS = tuple(name for name in NAMEABLE if name != "backlash")  # of a gap there is no size: teeth part or do not
DURATION, SNR_DB = 0.05, 30.0  # s of each record; of the channel
LARGEST_SET = 3  # names in a set that still counts as an answer
SEEDS_EACH = 1000  # seeds between two effects
PLAN = (
    "The usual rig (20 and 40 teeth), three speeds by two torques and two conditions held out, 0.05 s of each at "
    "50 kHz, transmission error, pinion angle and torques, white noise 30 dB below the signal; torque reversed for "
    "tooth_friction, light loads for squeeze_film_damping"
)


@dataclass(frozen=True)
class PowerQuestion:
    """One case. stratum: the hidden effect. multiple: of the larger limit."""

    stratum: str
    seed: int
    multiple: float

    @property
    def key(self) -> tuple[str, int]:
        """What makes it the same question."""
        return self.stratum, self.seed


def power_questions(effects: Sequence[str], cases: int, seed0: int) -> list[PowerQuestion]:
    """The questions of some effects, in turns, so that all of them are equally far wherever it stops."""
    first = {name: seed0 + SEEDS_EACH * place for place, name in enumerate(EFFECTS)}
    return [PowerQuestion(name, first[name] + i, MULTIPLES[i % len(MULTIPLES)])
            for i in range(cases) for name in effects]  # fmt: skip


def answered(question: PowerQuestion) -> dict[str, Any]:
    """The limits of the case, its size, and what was said about it."""
    begun = time.perf_counter()
    name, seed = question.stratum, question.seed
    limit = limits(name, seed, duration=DURATION, snr_db=SNR_DB, rivals=NAMEABLE, same=same_class)
    unit = max(limit.seen, limit.named)
    size = min(question.multiple * unit, 1.0)
    case = draw_case(name, seed, duration=DURATION, snr_db=SNR_DB, size=size)
    said = explained(case)
    largest = draw_case(name, seed, duration=0.002, snr_db=SNR_DB, size=1.0).truth["effects"][0]["parameters"]
    amplitude, unit_name = amplitude_of(name, largest, case.origin.conditions[0].torque)
    return {
        "stratum": name, "seed": seed, "multiple": size / unit, "limit": asdict(limit), "size": size,
        "largest": amplitude, "unit": unit_name, "power": power_of_size(name), "truth": {
            "effects": case.truth["effects"], "fault": None, "excess_percent": case.truth["excess_percent"]},
        "answer": said, "visible": is_visible(said), "established": is_established(said, name),
        "wrong": is_wrong(said, name), "seconds": round(time.perf_counter() - begun, 2),
    }  # fmt: skip


def is_visible(said: dict[str, Any]) -> bool:
    """Whether anything was called visible at first sight."""
    seen = said.get("visible")
    return bool(seen) and seen["p"]["before"] < seen["level"]


def is_established(said: dict[str, Any], name: str) -> bool:
    """Whether an established cause is the effect, or a set of at most three names with it."""
    sets = ([c["name"], *c["confusable_with"]] for c in said["causes"] if c["status"] == "established")
    return any(len(one) <= LARGEST_SET and any(same_class(name, other) for other in one) for one in sets)


def is_wrong(said: dict[str, Any], name: str) -> bool:
    """Whether something is established that is not the effect, nor confused with it."""
    sets = ([c["name"], *c["confusable_with"]] for c in said["causes"] if c["status"] == "established")
    return any(not any(same_class(name, other) for other in one) for one in sets)


def keep(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Write all that the figures are worked out from, a case a line, and of the answer its word and its names."""
    kept, named = [], ("name", "status", "confusable_with")
    for row in sorted(rows, key=lambda row: (row["seed"], row["stratum"])):
        causes = [{key: cause[key] for key in named} for cause in row["answer"]["causes"]]
        said = {key: row["answer"][key] for key in ("verdict", "seconds") if key in row["answer"]}
        kept.append(row | {"answer": said | {"causes": causes}})
    path.write_text("".join(json.dumps(row) + "\n" for row in kept), encoding="utf-8")
