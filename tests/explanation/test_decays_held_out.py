"""Of several free decays whose roles nobody says whole ones are held out: the end of one shows no law that grows."""

import numpy as np
import pytest
import yaml

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.measurement.load import load_measurement

TIME = np.arange(600) / 100.0


def evidence(folder, sizes, role=None, force=False):
    records, random = [], np.random.default_rng(2)
    for number, size in enumerate(sizes):
        swing = size * np.exp(-0.2 * TIME) * np.cos(2 * np.pi * 2 * TIME) + 1e-3 * random.normal(size=TIME.size)
        np.savez(folder / f"{number}.npz", t=TIME, x=swing, f=np.sin(TIME))
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
        channels |= {"force": {"column": "f", "unit": "N"}} if force else {}
        records.append({"name": f"size {size}", "file": f"{number}.npz", "channels": channels})
    if role:
        records[0]["role"] = role
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return evidence_of(load_measurement(folder / "measurement.yaml"))


def test_one_of_middling_size_is_held_out_whole(tmp_path):
    found = evidence(tmp_path, (4.0, 1.0, 2.0))
    assert [record.name for record in found.holdout] == ["size 2.0"]
    found = evidence(tmp_path, (4.0, 1.0, 3.0, 2.0))
    assert [record.name for record in found.holdout] == ["size 2.0"]
    assert [record.name for record in found.fit] == ["size 4.0", "size 1.0", "size 3.0"]
    assert not found.one_record


@pytest.mark.parametrize("more", [{"sizes": (4.0, 1.0)}, {"sizes": (4.0, 1.0, 2.0), "force": True}])
def test_of_two_or_of_driven_ones_the_ends_are(tmp_path, more):
    found = evidence(tmp_path, **more)
    assert all(record.name.endswith("(last part)") for record in found.holdout)
    assert len(found.holdout) == len(more["sizes"])


def test_roles_that_are_said_count(tmp_path):
    found = evidence(tmp_path, (4.0, 1.0, 2.0), role="holdout")
    assert [record.name for record in found.holdout] == ["size 4.0"]
