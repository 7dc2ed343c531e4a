"""Whether the angles of all records count from one mark is decided by fits that have the teeth's own shape."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.steps import calibrate

NOISE, SAMPLES = 1.0, 1000  # a fit that leaves only noise costs 1000


def fit(cost):
    return SimpleNamespace(fitted=SimpleNamespace(cost=cost))


@pytest.mark.parametrize(
    ("rough", "own", "is_one", "has_shape"),
    [
        ((20e3, 19.5e3), (1.2e3, 1.1e3), True, True),  # the same misfit of the rough wave
        ((20e3, 19.5e3), (9e3, 8e3), True, True),  # something else is missing
        ((20e3, 19.5e3), (9e3, 1.0e3), False, True),  # marks that are a few degrees apart, beside which it lacks more
        ((25e3, 21e3), (1.2e3, 1.1e3), True, True),  # own phases bend to what the rough wave lacks, and only to that
        ((25e3, 21e3), (1.9e3, 1.0e3), False, True),  # one phase is wrong, though the rough wave hid it
        ((40e3, 21e3), None, False, False),  # wrong by far
        ((1.4e3, 1.1e3), None, True, False),  # nothing is hidden where hardly more than noise is left
    ],
)
def test_one_phase_of_all_records(rough, own, is_one, has_shape, monkeypatch):
    record = SimpleNamespace(stacked=range(SAMPLES))
    evidence = SimpleNamespace(has_index=True, mesh_index=False, fit=(record,) * 2, fitted=(record,), noise=NOISE)
    apart = SimpleNamespace(has_index=False)
    fits = {id(evidence): (fit(rough[0]), own and fit(own[0])), id(apart): (fit(rough[1]), own and fit(own[1]))}
    monkeypatch.setattr(calibrate, "with_own_angles", lambda given: apart)
    monkeypatch.setattr(calibrate, "_rough_gear_pair", lambda given, solver: fits[id(given)][0])
    monkeypatch.setattr(calibrate, "shaped", lambda found, given, rounds, solver: fits[id(given)][1])
    monkeypatch.setattr(calibrate, "_are_in_line", lambda many, given: False)
    chosen, found, shaped = calibrate._angles_counted(evidence)
    assert chosen is (evidence if is_one else apart)
    assert found is fits[id(chosen)][0]
    assert shaped is (fits[id(chosen)][1] if has_shape else None)
