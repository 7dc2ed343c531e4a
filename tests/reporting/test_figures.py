"""Figures show what they were given, keep their text inside, and say so where there is nothing to show."""

import warnings
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.text import Text

from gear_damping.reporting import figures, style
from gear_damping.reporting.figures.marks import harmonics, spaced
from gear_damping.reporting.style import new_figure

RATE, SHAFT, TEETH, SAMPLES = 6400.0, 20.0, 20, 3200  # ten turns of the pinion
TIME = np.arange(SAMPLES) / RATE
ANGLE = 2 * np.pi * SHAFT * TEETH * TIME
SIGNAL = 17 + 5 * np.sin(ANGLE) + 2 * np.sin(3 * ANGLE) + 0.5 * np.cos(ANGLE / TEETH)
VELOCITY = np.gradient(SIGNAL, TIME) * 1e-6
GAP = np.where((TIME > 0.1) & (TIME < 0.2), np.nan, SIGNAL)
NOTHING = np.full(SAMPLES, np.nan)
ORDERS = np.arange(0, 200, 0.1)
FREQUENCIES = np.geomspace(100, 5000, 20)
SPECTRUM = 1e-3 + 5 * np.exp(-(((ORDERS - 20) / 0.2) ** 2))
FORCE = np.sin(np.linspace(0, 6, 30))[:, None] * np.cos(np.linspace(0, 6, 20))
FOREST = [
    {"record": "run_1", "value": 1.02, "interval95": [0.8, 1.2]},
    {"record": "run_2", "value": 1.5, "interval95": [1.4, 1.6]},
]
ROWS = [
    {
        "simulator.load_noise.snr_db": snr,
        "a/rmse_percent": 1 / snr,
        "a/rmse_percent_std": 0.01,
        "mean/rmse_percent": 0.14,
    }
    for snr in (1, 10, 20)
]


def simulation(signal, **more):
    shaft = {"shaft_frequency_hz": SHAFT, "n_teeth_pinion": TEETH, "gear_order": 0.5}
    return figures.simulation_figure(figures.ShownRun(TIME, signal, VELOCITY, "µm", RATE, **{**shaft, **more}))


def residual_spectrum(signal, mesh_order=None):
    before = SPECTRUM + 0 * signal[: len(ORDERS)]
    return figures.ResidualSpectrum(ORDERS, before, SPECTRUM / 3, SPECTRUM, None, mesh_order, 0.5, 20.0)


def record(signal, role="fit"):
    return {"name": "run_1", "role": role, "time": TIME, "measured": signal, "simulated": SIGNAL}


def epochs(count):
    return [{"train_loss": 1 / (i + 1), "val_rmse_percent": 2 / (i + 1), "learning_rate": 1e-3} for i in range(count)]


SHOWN = {
    "simulation": lambda s: simulation(s),
    "simulation_without_shaft": lambda s: simulation(s, shaft_frequency_hz=None),
    "response": lambda s: figures.response_figure(TIME, s, "µm"),
    "overlay": lambda s: figures.overlay_figure(figures.Overlay("a", TIME, s, SIGNAL, SIGNAL + 0.1, 0.1), "µm"),
    "identification": lambda s: figures.identification_figure([record(s), record(s, "holdout")], "m", ["ζ = 1 %"]),
    "residual_orders": lambda s: figures.residual_spectrum_figure(residual_spectrum(s, TEETH), "µm"),
    "residual_frequencies": lambda s: figures.residual_spectrum_figure(residual_spectrum(s), "µm"),
    "mesh_stiffness": lambda s: figures.mesh_stiffness_figure(ANGLE, 3e8 + 1e6 * s, contact_ratio=1.6),
    "scalogram": lambda s: figures.scalogram_figure(
        TIME[:300], FREQUENCIES, s[:300] * np.ones((20, 1)), np.zeros((20, 300), bool), mesh_frequency_hz=400
    ),
    "force_map": lambda s: figures.residual_force_map_figure(
        figures.ForceMap(np.linspace(0.02, 0.98, 30), FORCE + s[:20])
    ),
    "force_surface": lambda s: figures.residual_force_surface_figure(
        figures.ForceSurface(np.arange(20.0), np.arange(30.0), FORCE + s[:20])
    ),
    "casing_orders": lambda s: figures.casing_orders_figure(
        ORDERS, SPECTRUM + 0 * s[: len(ORDERS)], SPECTRUM / 3, unit="m/s²", gear_order=0.5, mesh_order=TEETH
    ),
    "casing_turns": lambda s: figures.casing_turns_figure(
        {shaft: figures.Turn(TIME / TIME[-1], s, (0.9, 1.05), TIME / TIME[-1], SIGNAL) for shaft in ("pinion", "gear")},
        unit="m/s²",
    ),
}  # fmt: skip
OTHERS = {
    "sweep": lambda: figures.sweep_figure(ROWS, "simulator.load_noise.snr_db"),
    "no_sweep": lambda: figures.sweep_figure([], "simulator.load_noise.snr_db"),
    "training": lambda: figures.training_figure({"raw_lstm, seed 0": epochs(9), "cwt_lstm, seed 0": epochs(4)}),
    "no_training": lambda: figures.training_figure({}),
    "predicted": lambda: figures.predicted_against_true_figure({"a": ([0.1, 0.5], [0.2, 0.4]), "mean": ([0.1], [0.3])}),
    "no_predictions": lambda: figures.predicted_against_true_figure({}),
    "candidates": lambda: figures.candidates_figure(
        [{"name": "gear_eccentricity", "share": 0.9, "status": "established"}, {"name": "backlash", "share": None}]
    ),
    "no_candidates": lambda: figures.candidates_figure([]),
    "visible": lambda: figures.visible_figure({"tooth_crack": 24.0, "unnamed: bursts": 3.0}, 4.2),
    "nothing_tested": lambda: figures.visible_figure({}, 4.2),
    "forest": lambda: figures.forest_figure(FOREST, {"value": 1.0, "interval95": [0.9, 1.1]}, quantity="depth"),
    "no_forest": lambda: figures.forest_figure([], {"value": 1.0, "interval95": [0.9, 1.1]}, quantity="depth"),
    "misfit": lambda: figures.misfit_figure({"run_1": {"before": 40.0, "after": 1.1}, "run_2": {"before": 9.0}}),
    "kurtosis": lambda: figures.casing_kurtosis_figure([3.1, 4.0, 2.9], 3.3, [3.0, 3.0]),
    "no_kurtosis": lambda: figures.casing_kurtosis_figure([np.nan, np.nan], 3.3),
    "no_misfit": lambda: figures.misfit_figure({}),
}


def texts(figure):
    return [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]


def said(figure):
    return " ".join(text.get_text() for text in texts(figure))


def labels(figure):
    """The words around the axes; ticks are left out, since unused ones lie anywhere."""
    found = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        titles = {axes.get_title(loc=place) for place in ("left", "center", "right")}
        found += [axes.xaxis.label, axes.yaxis.label, *(t for t in axes.findobj(Text) if t.get_text() in titles)]
        found += axes.get_legend().get_texts() if axes.get_legend() else []
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def drawn(figure):
    """Draw it, and check that none of its words are cut off."""
    figure.canvas.draw()
    whole = figure.bbox
    for text in labels(figure):
        box = text.get_window_extent()
        inside = box.x0 > -3 and box.y0 > -3 and box.x1 < whole.x1 + 3 and box.y1 < whole.y1 + 3
        assert inside, f"{text.get_text()!r} is cut off: {box}"
    return figure


@pytest.mark.parametrize("name", SHOWN)
@pytest.mark.parametrize("signal", [SIGNAL, GAP, NOTHING], ids=["whole", "with_a_gap", "nothing"])
def test_it_can_be_drawn(name, signal):
    figure = drawn(SHOWN[name](signal))
    assert " / " in " ".join(text.get_text() for text in labels(figure)), "an axis has its unit"


def test_a_figure_is_saved_as_its_name_says(tmp_path):
    figure = figures.response_figure(TIME, SIGNAL, "µm")
    assert figures.save(figure, tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in figures.save(figure, tmp_path / "a.svg").read_bytes()


@pytest.mark.parametrize("name", OTHERS)
def test_tables_can_be_drawn(name):
    figure = drawn(OTHERS[name]())
    assert ("no " in said(figure)) == name.startswith("no_")


@pytest.mark.parametrize(
    "make",
    [
        lambda: figures.response_figure(TIME, SIGNAL[:-1], "µm"),
        lambda: figures.simulation_figure(figures.ShownRun(TIME, SIGNAL, VELOCITY[1:], "µm", RATE)),
        lambda: figures.overlay_figure(figures.Overlay("a", TIME, SIGNAL, SIGNAL[1:]), "µm"),
        lambda: figures.residual_force_map_figure(figures.ForceMap(np.arange(3.0), FORCE)),
        lambda: figures.candidates_figure([{"name": "x", "share": 1.0, "status": "sure"}]),
        lambda: figures.predicted_against_true_figure({"a": ([0.1], [0.2, 0.3])}),
    ],
)
def test_what_does_not_fit_is_refused(make):
    with pytest.raises(ValueError, match=r"must|choose"):
        make()


def test_a_simulation_shows_time_orders_and_orbit():
    figure = drawn(simulation(SIGNAL, label="transmission error", title="run 1 of 2"))
    over_time, spectrum, phase, low = figure.axes
    assert over_time.get_ylabel() == "transmission error / µm"
    assert over_time.get_title(loc="left") == "run 1 of 2"
    np.testing.assert_allclose(over_time.lines[0].get_xdata(), 1e3 * TIME)
    np.testing.assert_allclose(over_time.lines[0].get_ydata(), SIGNAL)
    orders, amplitudes = spectrum.lines[0].get_data()
    assert orders[np.argmax(amplitudes)] == pytest.approx(TEETH)
    assert np.max(amplitudes) == pytest.approx(5, rel=1e-3)
    assert amplitudes[np.argmin(abs(orders - 3 * TEETH))] == pytest.approx(2, rel=1e-3)
    marks = [line.get_xdata()[0] for line in spectrum.lines[1:]]
    assert marks == [1.0, 0.5, *(h * TEETH for h in range(1, 7))]
    assert low.get_xlim()[1] < 5
    assert [line.get_xdata()[0] for line in low.lines[1:]] == [1.0, 0.5]
    assert phase.get_xlabel() == "transmission error / µm"
    legend = figure.legends[0].get_texts()
    assert [text.get_text() for text in legend] == ["pinion shaft", "gear shaft", "mesh harmonics"]


def test_without_a_shaft_the_spectrum_is_over_the_frequencies_that_have_content():
    figure = drawn(simulation(np.sin(2 * np.pi * 100 * TIME), shaft_frequency_hz=None))
    _, spectrum, _ = figure.axes
    assert spectrum.get_xlabel() == "frequency / Hz"
    frequency, amplitudes = spectrum.lines[0].get_data()
    assert frequency[np.argmax(amplitudes)] == pytest.approx(100)
    assert 100 < spectrum.get_xlim()[1] < RATE / 4
    assert not figure.legends


@pytest.mark.parametrize("length", [8, 31])
def test_a_run_too_short_for_a_spectrum_says_so(length):
    figure = figures.simulation_figure(figures.ShownRun(TIME[:length], SIGNAL[:length], VELOCITY[:length], "µm", RATE))
    assert "no spectrum to show" in said(drawn(figure))
    assert "no orbit" in said(figure)


def test_a_sweep_has_a_line_for_each_model_and_a_dashed_one_for_a_control():
    figure = figures.sweep_figure(ROWS, "simulator.load_noise.snr_db")
    model, control = figure.axes[0].lines
    np.testing.assert_allclose(model.get_ydata(), [1, 0.1, 0.05])
    assert control.get_linestyle() == "--"
    assert "signal-to-noise ratio / dB" in figure.axes[-1].get_xlabel()


def test_candidates_are_ordered_by_what_they_explain():
    rows = [("b", 0.2, "rejected"), ("a", 0.9, "established"), ("c", -0.1, "suggested")]
    figure = figures.candidates_figure([dict(zip(("name", "share", "status"), row, strict=True)) for row in rows])
    axes = figure.axes[0]
    heights = {label.get_text(): place for label, place in zip(axes.get_yticklabels(), axes.get_yticks(), strict=True)}
    down = axes.yaxis_inverted()
    ordered = sorted(heights, key=heights.__getitem__, reverse=not down)
    assert ordered == ["a", "b", "c"]


def test_marks_lie_on_harmonics_and_names_keep_their_distance():
    assert harmonics(20, 65) == [20, 40, 60]
    assert harmonics(None, 65) == []
    assert spaced([0.1, 0.11, 0.5], 0.1) == pytest.approx([0.1, 0.2, 0.5])
    assert spaced([0.98, 0.99], 0.1) == pytest.approx([0.9, 1.0])


def test_the_look_stays_out_of_the_users_own_figures():
    before = dict(mpl.rcParams)
    drawn(new_figure())
    simulation(SIGNAL)
    assert dict(mpl.rcParams) == before


def test_a_record_whose_interval_lies_apart_is_marked():
    axes = figures.forest_figure(FOREST, {"value": 1.0, "interval95": [0.9, 1.1]}, quantity="depth").axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["run_1", "run_2"]
    assert labels == ["all records together, with 95 % interval", "one record, with 95 % interval", "apart from it"]


def test_the_most_visible_stands_on_top_and_its_limit_is_drawn():
    axes = figures.visible_figure({"a": 1.0, "unnamed: b": 9.0}, 4.2).axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["b", "a"]
    assert [line.get_xdata()[0] for line in axes.lines] == [4.2]


@pytest.mark.parametrize(("samples", "panels"), [(len(TIME), 2), (len(TIME) // 2, 3)])
def test_a_stretch_that_is_the_whole_record_is_not_shown_twice(samples, panels):
    shown = figures.Overlay("a", TIME, SIGNAL, SIGNAL, SIGNAL + 0.1, 0.1)
    assert len(figures.overlay_figure(shown, "µm", samples=samples).axes) == panels


@pytest.mark.parametrize(
    ("size", "unit", "label"), [(4e-6, "m", "µm"), (0.05, "m", "mm"), (7.0, "m", "m"), (4e-6, "V", "V")]
)
def test_small_fractions_of_a_metre_are_drawn_in_a_smaller_unit(size, unit, label):
    wave = size * np.sin(np.arange(900) / 9)
    figure = figures.overlay_figure(
        figures.Overlay("a", np.arange(900) / 1e3, wave, 0.9 * wave, noise=0.1 * size), unit
    )
    factor = {"µm": 1e6, "mm": 1e3}.get(label, 1.0)
    upper, middle, _ = figure.axes
    assert upper.get_ylabel() == f"transmission error / {label}"
    assert np.abs(upper.lines[-1].get_ydata()).max() == pytest.approx(factor * size, rel=0.01)
    assert middle.patches[0].get_height() == pytest.approx(factor * 0.4 * size)


@pytest.mark.parametrize(
    ("unit", "label"), [("µm", "residual / µm"), ("m/s²", "residual / (m/s²)"), ("1", "residual"), ("", "residual")]
)
def test_an_axis_has_a_unit_where_there_is_one(unit, label):
    axes = figures.overlay_figure(figures.Overlay("a", TIME, SIGNAL, SIGNAL), unit).axes
    assert axes[1].get_ylabel() == label


def test_letters_that_no_font_has_are_said_in_one_line(tmp_path, caplog):
    style._say_boxes.cache_clear()
    with caplog.at_level("INFO", logger="gear_damping"):
        for name in ("first.png", "second.png"):
            figure = new_figure()
            figure.subplots().set_title("\U00013000 \U00013001")  # of hieroglyphs, which no font here has
            style.save(figure, tmp_path / name)
    assert [record.message for record in caplog.records] == [
        "no font here has all letters of the names: figures show boxes for them"
    ]


def test_other_warnings_of_a_figure_go_on():
    with pytest.warns(UserWarning, match="other"), style.styled():
        warnings.warn("another of other things: other", stacklevel=1)


def test_fonts_of_east_asia_are_used_where_they_are_installed(monkeypatch, caplog):
    style.families.cache_clear()
    installed = [*style.font_manager.fontManager.ttflist, SimpleNamespace(name="Yu Gothic")]
    with monkeypatch.context() as patch:
        patch.setattr(style.font_manager.fontManager, "ttflist", installed)
        assert "Yu Gothic" in style.families()
    style.families.cache_clear()
    assert style.families()[0] == "sans-serif"
    new_figure().subplots().set_title("a")
    assert "findfont" not in caplog.text
