"""Held-out records of a gear pair take no part in any choice: their samples are nan until the search is over."""

from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import pytest
import torch
from hidden import draw_case, write_case

from gear_damping.explanation import explain as module
from gear_damping.explanation.evidence.useful_samples import at_useful_rate
from gear_damping.explanation.steps import calibrate
from gear_damping.explanation.steps.confirm import confirmed
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects

FEW = ("pinion_eccentricity", "gear_eccentricity")
# of each kind one or two, as every step of a search asks for
MANY = (*FEW, "power_law_damping", "shaft_torsion", "sensor_gain")
RECORDS, DURATION = (0, 3, 4, 6), 0.02  # of the full plan, the last one held out; s


def of_gears(folder: Path) -> Path:
    case = draw_case("pinion_eccentricity", 4, duration=DURATION, snr_db=25.0, target_excess=5.0)
    return write_case(replace(case, records=tuple(case.records[i] for i in RECORDS)), folder / "gears")


def poisoned(record):
    """A record of nothing but nan."""
    nothing = torch.full_like(record.response, torch.nan)
    inputs = {name: torch.full_like(series, torch.nan) for name, series in record.inputs.items()}
    others = tuple((channel, torch.full_like(values, torch.nan)) for channel, values in record.others)
    return replace(record, response=nothing, inputs=inputs, others=others)


@pytest.mark.parametrize("effects", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_nothing_of_them_is_read_before_the_search_is_over(tmp_path, effects, monkeypatch):
    if effects == FEW:  # nor are there as many starts
        monkeypatch.setattr(calibrate, "EDGES", (0.0,))
        monkeypatch.setattr(calibrate, "STIFFNESSES", (1.0, 0.92))
    measurement = load_measurement(of_gears(tmp_path))
    library = {name: kind for name, kind in builtin_effects().items() if name in effects}
    plain = module.explain(measurement, library=library)
    assert plain.content["causes"][0]["status"] == "established"
    whole = module.evidence_of(measurement)
    assert whole.holdout
    unread = replace(whole, holdout=tuple(poisoned(record) for record in whole.holdout))

    def opened(state, records, measurement):
        assert all(bool(record.response.isnan().all()) for record in records)
        return confirmed(state, at_useful_rate(whole).holdout, measurement)

    with (
        patch.object(module, "evidence_of", lambda _: unread),
        patch.object(module, "confirmed", opened),
        patch.object(module, "mesh_order_faults", lambda _: []),  # it looks whether the data are whole
    ):
        blind = module.explain(measurement, library=library)
    assert blind.content == plain.content
