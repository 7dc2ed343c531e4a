"""Figures of a sweep: small multiples, bands over seeds, heat maps."""

from statistics import fmean, stdev

import numpy as np
import pytest

from gear_damping.reporting import figures
from gear_damping.reporting.figures.sweep import figures_of_sweep, over_seeds

SNR, ZETA, SEED = "simulator.load_noise.snr_db", "simulator.damping_ratio_percent", "seed"
ERROR = "raw_lstm/rmse_percent"


def rows(levels=(1, 10), ratios=(0.1, 0.2, 0.3), seeds=(0,)):
    return [
        {"job": "0", SNR: level, ZETA: ratio, SEED: seed, ERROR: ratio / level + 0.01 * seed, "mean/rmse_percent": 0.15}
        for level in levels
        for ratio in ratios
        for seed in seeds
    ]


def test_seeds_become_a_mean_and_a_standard_deviation():
    found, keys = over_seeds(rows(seeds=(0, 1, 5)), [SNR, SEED, ZETA])
    assert keys == [SNR, ZETA]
    assert len(found) == 6
    values = [0.2 / 10 + 0.01 * seed for seed in (0, 1, 5)]
    one = next(row for row in found if row[SNR] == 10 and row[ZETA] == 0.2)
    assert one[ERROR] == pytest.approx(fmean(values))
    assert one[f"{ERROR}_std"] == pytest.approx(stdev(values))


def test_a_sweep_over_seeds_alone_keeps_them():
    assert over_seeds(rows(seeds=(0, 1)), [SEED])[1] == [SEED]


def test_each_value_of_a_second_key_has_a_panel_of_one_scale():
    figure = figures.sweep_figure(rows(), SNR, [ZETA])
    panels = figure.axes
    assert [axes.get_title(loc="left") for axes in panels] == [f"damping_ratio_percent = {z}" for z in (0.1, 0.2, 0.3)]
    np.testing.assert_allclose(panels[1].lines[0].get_ydata(), [0.2, 0.02])
    assert len({axes.get_ylim() for axes in panels}) == 1
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["raw_lstm", "mean (control)"]


def test_a_panel_tells_two_keys_that_end_alike_apart():
    sensor = "simulator.sensor_noise.snr_db"
    found = [{SNR: level, sensor: other, ERROR: 0.1} for level in (1, 10) for other in (20, 40)]
    panels = figures.sweep_figure(found, SNR, [sensor]).axes
    assert [axes.get_title(loc="left") for axes in panels] == ["sensor_noise.snr_db = 20", "sensor_noise.snr_db = 40"]


def test_a_map_has_each_error_at_its_place_and_a_gap_where_a_job_is_missing():
    found = [row for row in rows() if (row[SNR], row[ZETA]) != (10, 0.3)]
    figure = figures.sweep_map_figure(found, SNR, ZETA)
    shown = np.asarray(figure.axes[0].images[0].get_array().filled(np.nan))
    np.testing.assert_allclose(shown, [[0.1, 0.01], [0.2, 0.02], [0.3, np.nan]])
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["0.1", "0.2", "0.3"]
    assert figure.axes[0].images[0].get_clim() == figure.axes[1].images[0].get_clim()


def test_only_a_sweep_over_two_numbers_has_a_map():
    names = ("lines.png", "map.png")
    assert set(figures.sweep_figures(rows(), [SNR, ZETA], names)) == {*names}
    assert set(figures.sweep_figures(rows(ratios=(0.1,)), [SNR, ZETA], names)) == {"lines.png"}
    assert set(figures.sweep_figures(rows(seeds=(0, 1)), [SNR, ZETA, SEED], names)) == {*names}
    words = [row | {ZETA: str(row[ZETA])} for row in rows()]
    assert set(figures.sweep_figures(words, [SNR, ZETA], names)) == {"lines.png"}
    assert figures.sweep_figures([], [SNR], names) == {}


def test_a_task_without_errors_shows_every_number_that_it_states():
    found = [{"job": str(i), "path": f"{i}.csv", "verdict": "consistent", "misfit_after": 1.0 + i, "ok": True,
              "rmse_fit": 0.1} for i in range(3)]  # fmt: skip
    figure = figures_of_sweep(found, "path", [])
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["misfit_after", "rmse_fit"]
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), [1, 2, 3])
    assert figures_of_sweep([{"path": "a", "verdict": "x"}], "path", []) is None
