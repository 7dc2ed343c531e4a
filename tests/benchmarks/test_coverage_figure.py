"""The picture of intervals shows each case that has one, and which of them miss the truth."""

from benchmarks.coverage import KINDS, figure


def case(kind, low, high):
    after = {
        "true": 2.0,
        "interval90": [low, high],
        "error_percent": 25 * (low + high) - 100,
        "holds": low <= 2.0 <= high,
    }
    return {"kind": kind, "after": after}


def test_a_line_for_each_interval_and_those_that_miss_are_counted():
    first = next(iter(KINDS))
    shown = figure([case(first, 1.98, 2.04), case(first, 2.01, 2.05), {"kind": first, "after": None}])
    panel = shown.axes[0]
    assert panel.get_title(loc="left") == f"{first}: 1 of 2 hold it"
    lines = {tuple(line.get_ydata()): line.get_color() for line in panel.lines[:2]}
    assert [round(low, 9) for low, _ in lines] == [-1.0, 0.5]
    assert len(set(lines.values())) == 2
