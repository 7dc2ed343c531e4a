"""A channel that counts the other way round than its load is named before any physics is."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import yaml
from scipy.signal import lsim

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.explain import explain
from gear_damping.explanation.steps import polarity
from gear_damping.measurement.load import load_measurement

RATE, COUNT, STIFFNESS, DAMPING = 200.0, 600, 900.0, 1.8


def base_excited(folder, sign=1.0, inputs=True):
    """Records of a mass on a shaken base, by scipy's response to an input that is straight between its samples."""
    rng, time = np.random.default_rng(4), np.arange(COUNT) / RATE
    rig = ([[0, 1], [-STIFFNESS, -DAMPING]], [[0], [-1]], [[1, 0]], [[0]])
    records = []
    for k in range(3):
        smooth = np.convolve(rng.normal(0, 1, COUNT + 7), np.hanning(9)[1:-1], "same")[:COUNT]
        moved = lsim(rig, smooth, time)[1]
        rows = np.c_[sign * smooth, 1e3 * moved + rng.normal(0, 0.02, COUNT)]
        np.savetxt(folder / f"r{k}.csv", rows, delimiter=",", header="a,x", comments="")
        channels = {"sampling_rate": f"{RATE} Hz", "displacement": {"column": "x", "unit": "mm"}}
        if inputs:
            channels["base_acceleration"] = {"column": "a", "unit": "m/s^2"}
        records.append({"file": f"r{k}.csv", "role": "holdout" if k == 2 else "fit", "channels": channels})
    stated = {"stiffness": "850 1/s^2", "damping_coefficient": "2 1/s"}
    content = {"system": "oscillator", "parameters": stated, "records": records}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return load_measurement(folder / "measurement.yaml")


@pytest.fixture
def evidence(tmp_path):
    return evidence_of(base_excited(tmp_path))


def outcome(evidence, share):
    """A fit that leaves a share of the records' variance."""
    energy = [polarity.ac_energy(record) for record in evidence.fitted]
    return SimpleNamespace(fit_residuals=[torch.tensor([(share * one) ** 0.5]) for one in energy])


def found(evidence, as_declared, turned):
    def fitted(tried):
        if isinstance(turned, Exception):
            raise turned
        same = torch.equal(tried.fit[0].response, -evidence.fit[0].response)
        return outcome(tried, turned if same else 1.0)

    nominal = None if as_declared is None else outcome(evidence, as_declared)
    return polarity.polarity_fault(evidence, nominal, fitted)


@pytest.mark.parametrize(
    ("as_declared", "turned", "is_named"),
    [
        (2.0, 0.01, True),
        (None, 0.01, True),
        (2.0, 0.3, False),
        (0.7, 0.1, False),
        (30.0, 0.7, False),
        (2.0, InputError(Problem("parameters", "do not stay finite")), False),
    ],
    ids=[
        "turned",
        "not simulable as declared",
        "little better",
        "worth a parameter",
        "lost either way",
        "not simulable",
    ],
)
def test_a_channel_is_named_where_its_other_sign_follows_the_records(evidence, as_declared, turned, is_named):
    fault = found(evidence, as_declared, turned)
    assert (fault is not None) == is_named
    if is_named:
        assert (fault.kind, fault.channel, fault.severity) == ("reversed", "displacement", "data_problem")
        assert "leaves 1 % of the signal's variance" in fault.message
        assert "`polarity: -1`" in fault.message


def test_no_sign_is_tried_where_one_record_is_followed_as_it_is_declared(evidence):
    """Another record may be lost by the gap between the flanks, which a fit of any sign takes minutes to show."""
    energy = [polarity.ac_energy(record) for record in evidence.fitted]
    shares = [0.05, *[3.0] * (len(energy) - 1)]
    left = [torch.tensor([(share * one) ** 0.5]) for share, one in zip(shares, energy, strict=True)]
    nominal = SimpleNamespace(fit_residuals=left)
    assert polarity.polarity_fault(evidence, nominal, lambda _: pytest.fail("a fit was made")) is None


@pytest.mark.parametrize(("share", "asked"), [(0.01, [2, 4]), (0.7, [2])])
def test_all_records_are_fitted_only_where_those_that_move_most_are_followed(evidence, share, asked):
    small = [replace(one, response=0.1 * one.response, name=f"small {one.name}") for one in evidence.fit]
    many, sizes = replace(evidence, fit=(small[0], *evidence.fit, small[1])), []

    def fitted(tried):
        sizes.append(len(tried.fit))
        assert not any(one.name.startswith("small") for one in tried.fit) or len(tried.fit) == len(many.fit)
        return outcome(tried, share)

    assert (polarity.polarity_fault(many, outcome(many, 2.0), fitted) is not None) == (len(asked) == 2)
    assert sizes == asked


def test_a_free_decay_has_no_sign_to_be_wrong(tmp_path):
    free = evidence_of(base_excited(tmp_path, inputs=False))
    assert found(free, 2.0, 0.01) is None


def test_only_the_channel_of_that_place_is_turned(evidence):
    record = replace(evidence.fit[0], others=((evidence.fit[0].observed, evidence.fit[0].response + 1),))
    first, second = (polarity._with_sign(record, place) for place in (0, 1))
    assert torch.equal(first.response, -record.response)
    assert torch.equal(first.others[0][1], record.others[0][1])
    assert torch.equal(second.response, record.response)
    assert torch.equal(second.others[0][1], -record.others[0][1])


@pytest.mark.slow
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_base_that_counts_the_other_way_round_is_a_data_problem(tmp_path, sign):
    content = explain(base_excited(tmp_path, sign)).content
    assert content["verdict"] == ("consistent" if sign > 0 else "data_problem")
    assert any("other way round" in said for said in content["sentences"]) == (sign < 0)
