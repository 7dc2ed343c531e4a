"""Small measurements with something hidden in them, explained once and looked at by several tests."""

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hidden import draw_case, write_case

from gear_damping.explanation.explain import explain
from gear_damping.explanation.report_schema import Explanation
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects

RECORDS = (0, 3, 4, 6)  # of the full plan: three speeds, two torques, a fourth condition held out
ONE = (3,)
DURATION = 0.02  # s


@cache
def _explained(
    stratum: str,
    seed: int,
    snr_db: float | None,
    removed: str | None,
    records: tuple[int, ...],
    duration: float,
    target_excess: float | None,
) -> dict[str, Any]:
    case = draw_case(stratum, seed, duration=duration, snr_db=snr_db, target_excess=target_excess)
    case = replace(case, records=tuple(case.records[i] for i in records))
    library = {name: kind for name, kind in builtin_effects().items() if name != removed}
    with tempfile.TemporaryDirectory() as folder:
        content = explain(load_measurement(write_case(case, Path(folder) / "measured")), library=library).content
    Explanation.model_validate(content)
    return content | {"truth": case.truth}


@pytest.fixture(scope="session")
def explained():
    """Explain a case of (stratum, seed): the content of explanation.json, and the truth beside it."""

    def run(
        stratum: str,
        seed: int,
        snr_db: float | None = 25.0,
        removed: str | None = None,
        records=RECORDS,
        duration: float | None = None,
        target_excess: float | None = 5.0,
    ):
        records = tuple(records)
        duration = duration or (0.03 if len(records) == 1 else DURATION)
        return _explained(stratum, seed, snr_db, removed, records, duration, target_excess)

    return run
