"""An angle of the pinion does not say where the gear stands, which may be anywhere by whole turns of the pinion."""

import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
from hidden import draw_case, write_case

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement

RECORDS = (0, 3, 4, 6)  # of the full plan: three speeds, two torques, a fourth condition held out
CASES = [
    pytest.param("gear_eccentricity", 1, "17/43", {}, marks=pytest.mark.slow),
    pytest.param("gear_stiffness_modulation", 2, "25/44", {}, marks=pytest.mark.slow),
    pytest.param("tooth_crack", 3, "23/57", {"shaft": "gear"}, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("effect", "seed", "rig", "chosen"), CASES)
def test_an_effect_of_the_gear_is_named_wherever_it_stands(effect, seed, rig, chosen):
    asked = {"duration": 0.04, "snr_db": 30.0, "target_excess": 8.0, "chosen": chosen, "gear_apart": True}
    case = draw_case(effect, seed, rig=rig, sensors="full", **asked)
    case = replace(case, records=tuple(case.records[i] for i in RECORDS))
    with tempfile.TemporaryDirectory() as folder:
        content = explain(load_measurement(write_case(case, Path(folder) / "measured"))).content
    first = content["causes"][0]
    assert (first["name"], first["status"]) == (effect, "established"), content["sentences"]
    phases = [name for name in first["parameters"] if name.startswith("phase@")]
    assert len(phases) > 1, "every record has a position of its own"
    assert content["misfit"]["after"] < 1.5 < content["misfit"]["before"]
