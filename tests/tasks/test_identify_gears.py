"""task=identify of a gear pair without a network: the damping ratio with its interval, through every channel."""

import json
from dataclasses import replace

import pytest
from hidden import draw_case, write_case

from gear_damping.tasks.command import main

RECORDS = (0, 3, 4, 6)  # of the full plan: three speeds, two torques, a fourth condition held out


def identified(sensors: str, rig: str | None, folder):
    """What is identified of a null, and the truth."""
    case = draw_case("null", 4, rig=rig, sensors=sensors, duration=0.02, snr_db=30.0)
    path = write_case(replace(case, records=tuple(case.records[i] for i in RECORDS)), folder / "measured")
    words = ["task=identify", f"measurement.path={path}", f"hydra.run.dir={folder / 'run'}", "progress=false"]
    assert main(words) == 0
    return json.loads((folder / "run" / "identification.json").read_text()), case.truth


@pytest.mark.parametrize(
    ("sensors", "rig", "channel"),
    [
        ("full", None, "transmission_error"),
        pytest.param("mean_free", None, "transmission_error", marks=pytest.mark.slow),
        pytest.param("acceleration", "37/44", "acceleration", marks=pytest.mark.slow),
        pytest.param("gear_speed", None, "gear_speed", marks=pytest.mark.slow),
        pytest.param("pinion_speed", None, "pinion_speed", marks=pytest.mark.slow),
    ],
)
def test_the_damping_ratio_lies_in_its_interval(sensors, rig, channel, tmp_path):
    found, truth = identified(sensors, rig, tmp_path)
    assert found["channels"] == [channel]
    low, high = found["damping_ratio_percent"]["interval95"]
    slack = 0.25 * (high - low)  # one interval in twenty misses by chance; none by much
    assert low - slack < truth["damping_ratio_percent"] < high + slack
    assert not found["lack_of_fit"]["significant"]
    assert found["residual"]["holdout"]["rmse"] < 2 * found["residual"]["fit"]["rmse"]
    assert "damping_ratio_percent" in (tmp_path / "run" / "identification.txt").read_text()
    assert (tmp_path / "run" / "identification.png").is_file()
