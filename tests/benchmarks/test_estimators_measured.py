"""`make estimators` asks every estimator of free decays."""

from benchmarks.record_estimators import of_ring_downs, rows_linear


def test_every_estimator_of_free_decays_has_a_row():
    kinds, rows = of_ring_downs(), rows_linear(1, of_ring_downs())
    first = [next(rows) for _ in kinds]
    assert "ambient_spectrum" not in kinds
    assert [row.split("|")[3].strip(" `") for row in first] == list(kinds)
    told = {name for name, row in zip(kinds, first, strict=True) if "1 of 1" in row}
    assert told == set(kinds) - {"half_power"}  # whose line is as narrow as the first record, of little damping, allows
