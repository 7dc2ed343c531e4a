"""The example measurements against the records that they name: identity, shape, rate, plain physics."""

from pathlib import Path

import numpy as np
import pytest

from gear_damping.measurement.files import data_root
from gear_damping.measurement.load import load_measurement

EXAMPLES = Path(__file__).resolve().parents[2] / "conf" / "measurement" / "records"
pytestmark = [
    pytest.mark.real_record,
    pytest.mark.skipif(
        not data_root().is_dir(),
        reason=f"the measured records are not at {data_root()}; set GEAR_DAMPING_DATA to their folder",
    ),
]


@pytest.fixture(scope="module")
def silverbox():
    return load_measurement(EXAMPLES / "silverbox.yaml")


def _ship(run: int):
    return load_measurement(EXAMPLES / f"ship_roll_{run}.yaml")


def _peaks(values: np.ndarray) -> np.ndarray:
    """The heights of the highest samples between upward zero crossings."""
    up = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0)) + 1
    return np.array([part.max() for part in np.split(values, up)[1:-1]])


def _period(values: np.ndarray, rate: float) -> float:
    """The mean time between upward zero crossings, each found between samples."""
    before = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    at = before - values[before] / (values[before + 1] - values[before])
    return float(np.diff(at).mean()) / rate


def test_silverbox_is_the_known_file_at_its_rate(silverbox):
    assert len(silverbox.records) == 11
    for record in silverbox.records:
        assert record.sha256.startswith("ae62d5a9")
        assert record.sampling_rate == 1e7 / 2**14
        assert {name: channel.unit for name, channel in record.channels.items()} == {
            "force": "V",
            "displacement": "V",
        }
    assert [record.time.size for record in silverbox.records] == [8192] * 10 + [40000]
    assert [record.role for record in silverbox.records] == ["fit"] * 5 + ["holdout"] * 6
    assert not [finding for finding in silverbox.findings if finding.severity == "data_problem"]


def test_silverbox_slices_are_whole_periods_of_odd_lines_up_to_200_hz(silverbox):
    """A slice that were not one period would leak into the even lines; multiples of 50 Hz are mains."""
    levels = np.abs(np.fft.rfft([record.channels["force"].values for record in silverbox.records[:10]]))
    lines = np.arange(1, levels.shape[1])
    frequency = lines * 610.3515625 / 8192
    mains = np.abs(frequency - 50 * np.round(frequency / 50)) < 1
    odd = (lines % 2 == 1) & (frequency < 200) & ~mains
    rest = ~odd & ~mains
    excited = levels[:, lines[odd]]
    assert excited.min() > 0.5 * excited.max()
    assert np.ptp(excited, axis=0).max() < 0.03 * excited.max()  # all realisations alike
    assert levels[:, lines[rest]].max() < 0.05 * excited.min()
    phases = np.angle(np.fft.rfft([r.channels["force"].values for r in silverbox.records[:10]]))[:, lines[odd]]
    assert np.abs(np.exp(1j * phases).mean(axis=0)).mean() < 0.5  # but for their phases


def test_silverbox_resonates_near_69_hz(silverbox):
    force = np.fft.rfft([record.channels["force"].values for record in silverbox.records[:10]])
    motion = np.fft.rfft([record.channels["displacement"].values for record in silverbox.records[:10]])
    lines = np.arange(1, 2685, 2)
    response = (motion * force.conj()).mean(axis=0)[lines] / (np.abs(force) ** 2).mean(axis=0)[lines]
    peak = lines[np.argmax(np.abs(response))] * 610.3515625 / 8192
    assert 66 < peak < 73


def test_silverbox_arrow_grows_beyond_the_multisine(silverbox):
    *multisines, arrow = silverbox.records
    parts = arrow.channels["displacement"].values.reshape(8, -1).std(axis=1)
    assert np.all(np.diff(parts) > 0)
    largest = max(np.abs(record.channels["displacement"].values).max() for record in multisines)
    assert np.abs(arrow.channels["displacement"].values).max() > 1.2 * largest


@pytest.mark.parametrize(
    ("run", "digest", "samples", "start", "peak_degrees"),
    [
        (21337, "ae63c904", 6546, 26.2, 9.2),
        (21338, "ba59c852", 18528, 9.36, 10.0),
        (21340, "031dddff", 3300, 24.4, 9.3),
    ],
)
def test_ship_roll_is_a_free_decay_from_its_first_peak(run, digest, samples, start, peak_degrees):
    record = _ship(run).records[0]
    roll = record.channels["displacement"]
    assert record.sha256.startswith(digest)
    assert (record.time.size, roll.unit) == (samples, "rad")
    assert record.sampling_rate == pytest.approx(100, rel=1e-6)
    assert record.time[0] == pytest.approx(start, abs=1e-3)
    assert any("resampled" in note for note in record.notes)
    assert np.degrees(roll.values[0]) == pytest.approx(peak_degrees, abs=0.1)
    assert roll.values.max() == pytest.approx(roll.values[0], rel=2e-3)
    assert np.all(np.diff(_peaks(roll.values)) < 0)
    assert _period(roll.values, 100) == pytest.approx(2.53, abs=0.02)


def test_ship_roll_is_damped_more_at_speed_and_at_large_angles():
    decrement = {}
    for run in (21337, 21338, 21340):
        peaks = _peaks(_ship(run).records[0].channels["displacement"].values)
        decrement[run] = np.log(peaks[:-1] / peaks[1:])
    assert decrement[21340].mean() > 2 * decrement[21337].mean()
    assert decrement[21338][:8].mean() > 1.3 * decrement[21338][-20:-10].mean()


def test_ship_roll_holds_the_other_run_against_the_fitted_one():
    for run, other in ((21337, 21338), (21338, 21337)):
        records = _ship(run).records
        assert [(record.name, record.role) for record in records] == [
            (f"roll_{run}", "fit"), (f"roll_{other}", "holdout"),
        ]  # fmt: skip
