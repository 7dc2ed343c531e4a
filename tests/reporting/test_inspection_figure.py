"""The figure of an inspection: every channel with its spectrum, peaks of long channels, gaps, records together."""

import numpy as np

from gear_damping.reporting.inspection import MOST_PANELS, Curve, Panel, drawn, inspection_figure
from gear_damping.reporting.style import save

TIME = np.arange(500) / 100
WAVE = np.sin(9 * TIME)
LINES = np.linspace(0, 50, 40)


def curve(name="a"):
    return Curve(name, TIME, WAVE, LINES, 1e-3 + np.exp(-LINES), 1e-3)


def test_a_peak_of_a_long_channel_is_drawn():
    values = np.zeros(100_000)
    values[54_321], values[77_777], values[10:5000] = 7.0, -3.0, np.nan
    time, shown = drawn(np.arange(100_000.0), values)
    assert shown.size < 5000
    assert (np.nanmax(shown), np.nanmin(shown)) == (7.0, -3.0)
    assert abs(time[np.nanargmax(shown)] - 54_321) < 200
    assert np.isnan(shown[time < 4000][2:]).all()


def test_every_channel_has_a_row_with_its_spectrum_and_floor(tmp_path):
    panels = [Panel("x", "mm", (curve(),)), Panel("f", "", (Curve("f", TIME, WAVE),))]
    figure = inspection_figure(panels)
    left, right = figure.axes[0], figure.axes[1]
    assert (left.get_title(loc="left"), left.get_ylabel(), right.get_ylabel()) == ("x", "mm", "mm/√Hz")
    assert right.lines[-1].get_ydata()[0] == 1e-3**0.5
    assert [text.get_text() for text in figure.axes[3].texts] == ["no spectrum"]
    assert save(figure, tmp_path / "a.png").stat().st_size > 10_000


def test_records_with_the_same_channel_share_its_row():
    figure = inspection_figure([Panel("x", "mm", (curve("early"), curve("late")))])
    assert len(figure.axes) == 2
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["early", "late"]
    many = inspection_figure([Panel("x", "mm", tuple(curve(str(k)) for k in range(11)))])
    assert many.axes[0].get_title(loc="left") == "x of 11 records in their order"


def test_what_is_not_drawn_is_said():
    figure = inspection_figure([Panel(str(k), "", (curve(),)) for k in range(MOST_PANELS + 3)], in_seconds=False)
    assert figure.axes[-1].get_title(loc="left") == "3 more channels are not drawn"
    assert figure.axes[-2].get_xlabel() == "sample"
    assert inspection_figure([]).axes[0].texts[0].get_text() == "no channel to show"
