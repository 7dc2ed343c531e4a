"""Noise in the place of residuals: what is drawn, what is counted, and that nothing is seen in it."""

import numpy as np
import pytest

from tests.blind.p_values import KINDS, MODE, RATE, drawn_p, main, page, rejections


@pytest.mark.parametrize("kind", KINDS)
def test_noise_has_the_spectrum_of_its_kind(kind):
    drawn = KINDS[kind](np.random.default_rng(1), (1, 2, 20000))
    assert drawn.shape == (1, 2, 20000)
    power = np.abs(np.fft.rfft(drawn[0])) ** 2
    frequency = np.fft.rfftfreq(20000, 1 / RATE)
    at, low, high = (
        power[:, (frequency > a) & (frequency < b)].mean()
        for a, b in ((0.97 * MODE, 1.03 * MODE), (50, 500), (20e3, 24e3))
    )
    ratios = {"white": (at / high, 1.0), "coloured": (low / high, 300.0), "random_load": (at / high, 1000.0)}
    found, expected = ratios[kind]
    assert expected / 3 < found < 3 * expected


def test_rejections_are_counted_with_their_interval():
    found = rejections([0.005] * 3 + [0.2] * 97)["0.01"]
    assert found["rate"] == pytest.approx(0.03)
    assert found["interval95"] == pytest.approx([0.00623, 0.08518], abs=1e-4)


def test_what_was_drawn_is_kept_and_written(tmp_path, monkeypatch):
    monkeypatch.setattr("tests.blind.p_values.drawn_p", lambda kind, seed, count: [0.5] * count)
    assert main(["--draws", "7", "--nulls", "2", "--out", str(tmp_path)]) == 0
    monkeypatch.setattr("tests.blind.p_values.drawn_p", None)  # nothing is drawn anew
    assert main(["--draws", "7", "--nulls", "2", "--out", str(tmp_path)]) == 0
    assert "| random load | 14 | 2 | 0.00 % (" in (tmp_path / "p_values.md").read_text()
    assert (tmp_path / "figures" / "p_values.png").stat().st_size > 5000
    assert page({"white": [0.5]}, {"white": [1]}).startswith("# Is p a p value?")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["coloured", "random_load"])
def test_nothing_is_seen_in_noise_of_any_colour(kind):
    p = np.array(list(drawn_p(kind, 3, 60)))
    assert (p < 0.01).sum() <= 3
    assert (p < 0.1).sum() <= 18
