"""One question answered: draw, write, load, explain, and keep what came of it as plain values."""

from __future__ import annotations

import os
import tempfile
import traceback
import warnings
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from time import process_time
from typing import Any

from hidden import HiddenCase, OscillatorCase, draw_case, draw_oscillator, write_case

from gear_damping.errors import InputError
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.terms import Effect

from .strata import Question

DURATION = 0.05  # s of each record
MINUTES = 5.0  # of a search, as in conf/explain; of the worker's own time, so that its neighbours change no answer
REFUSED = "refused"  # the data could not be read: one error that names file, channel and remedy
KEPT = (
    "verdict", "causes", "misfit", "residual", "not_observable", "next_experiment", "noise", "sentences", "findings",
    "visible",
)  # fmt: skip


def answer(question: Question, duration: float = DURATION) -> dict[str, Any]:
    """What was hidden and what was said about it; an error of the program is an answer too."""
    case = drawn(question, duration)
    found = asdict(question) | {"truth": _truth(case), "answer": explained(case, question.removed)}
    if question.added:
        found["answer_with_more"] = explained(case, question.removed, everything=True)
    return found | {"seconds": found["answer"]["seconds"]}


def drawn(question: Question, duration: float = DURATION) -> HiddenCase | OscillatorCase:
    """The hidden case of a question."""
    size = {"target_excess": question.target_excess, "snr_db": question.snr_db}
    seed = question.seed if question.draw is None else question.draw
    if question.system == "oscillator":
        asked = {"channel": question.channel, "kind": question.kind, "force_snr_db": question.force_snr_db}
        return draw_oscillator(question.drawn, seed, **size, **asked)
    asked = {"rig": question.rig, "sensors": question.sensors, "chosen": dict(question.chosen)}
    return draw_case(question.drawn, seed, duration=duration, **size, **asked)


def explained(
    case: HiddenCase | OscillatorCase, removed: str | None = None, everything: bool = False
) -> dict[str, Any]:
    """The explanation of a case, and the seconds of one core it took; without an effect that is `removed`."""
    begun = process_time()
    said = _said(case, removed, everything)
    return said | {"seconds": round(process_time() - begun, 2)}


def _said(case: HiddenCase | OscillatorCase, removed: str | None, everything: bool) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        path = write_case(case, Path(folder) / "measured", case.records if everything else case.first)
        library = {name: kind for name, kind in builtin_effects().items() if name != removed}
        return said_of(path, library)


def said_of(path: Path, library: Mapping[str, type[Effect]]) -> dict[str, Any]:
    """What is kept of the explanation of a measurement.yaml that lies two folders deep in one of its own."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            content = explain(load_measurement(path), library=library, budget=Budget(MINUTES, process_time)).content
        except InputError as error:
            said = str(error).replace(str(path.parents[1]), "")
            return {"verdict": REFUSED, "causes": [], "sentences": [said]}
        except Exception as error:  # the run goes on, the case counts as failed
            place = "".join(traceback.format_tb(error.__traceback__)[-2:])
            return {"verdict": "crashed", "causes": [], "sentences": [f"{type(error).__name__}: {error}", place]}
    kept = {name: content[name] for name in KEPT}
    damping = (content.get("gain") or {}).get("damping_ratio_percent") or {}
    kept["damping_ratio_percent"] = damping.get("after")
    return kept | {"converged": (content["calibration"] or {}).get("converged")}


def _truth(case: HiddenCase | OscillatorCase) -> dict[str, Any]:
    truth = {name: value for name, value in case.truth.items() if name not in ("rig", "records")}
    return truth if isinstance(case, OscillatorCase) else truth | {"gear_torque": case.gear_torque}


def quiet_worker() -> None:
    """A worker leaves Ctrl-C to its parent and keeps to one thread."""
    import signal

    import torch

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(5)
    torch.set_num_threads(1)
