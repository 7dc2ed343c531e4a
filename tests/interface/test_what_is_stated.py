"""What a measurement.yaml states of single records and channels acts on `identify`, in whichever record it stands."""

import numpy as np
import pytest

import gear_damping as gd

RATE, FREQUENCY, N = 100.0, 3.0, 400
OMEGA = 2 * np.pi * FREQUENCY


def decay(ratio, seed, noise=0.01, tone=0.0):
    """Displacement and velocity of a free decay at 100 Hz; a tone where the model is to be wrong."""
    time, random = np.arange(N) / RATE, np.random.default_rng(seed)
    turning = OMEGA * np.sqrt(1 - ratio**2)
    phasor = np.exp((-ratio * OMEGA + 1j * turning) * time)
    shown = phasor.real + tone * np.sin(7.3 * time)
    speed = ((-ratio * OMEGA + 1j * turning) * phasor).real
    return time, shown + noise * random.normal(size=N), speed + 50 * noise * random.normal(size=N)


def write(folder, records, parameters=""):
    """A measurement.yaml of (name, ratio, what stands beside the file, what stands in the channels, tone)."""
    text = f"system: oscillator\n{parameters}records:\n"
    for seed, (name, ratio, beside, channels, tone) in enumerate(records):
        columns = np.column_stack(decay(ratio, seed, tone=tone))
        np.savetxt(folder / f"{name}.csv", columns, "%.9g", ",", header="t,x,v", comments="")
        text += (
            f"- {{name: {name}, file: {name}.csv, {beside}channels: {{time: {{column: t, unit: s}}, {channels}}}}}\n"
        )
    (folder / "measurement.yaml").write_text(text)
    return gd.load(folder / "measurement.yaml")


SHOWN = "displacement: {column: x, unit: V}"


def ratio_of(found):
    ratio = found.damping_ratio_percent
    return ratio["value"], ratio["interval95"]


@pytest.mark.parametrize("name", ["damping_ratio: 0", "damping_coefficient: {value: 0, unit: 1/s}"])
def test_a_damping_cannot_begin_at_none(name, tmp_path):
    with pytest.raises(gd.InputError, match="must be positive"):
        write(tmp_path, [("a", 0.03, "", SHOWN, 0)], f"parameters: {{{name}}}\n")


def test_a_record_without_a_role_is_fitted_beside_one_with(tmp_path):
    records = [("a", 0.03, "role: fit, ", SHOWN, 0), ("b", 0.06, "", SHOWN, 0)]
    value, _ = ratio_of(gd.identify(write(tmp_path, records)))
    assert value == pytest.approx(3.9, abs=0.4)  # between the two: a alone has 3.0


def test_the_noise_of_a_record_is_its_own(tmp_path):
    loud = "displacement: {column: x, unit: V, noise: {value: 0.3, unit: V}}"
    quiet = "displacement: {column: x, unit: V, noise: {value: 0.01, unit: V}}"
    values = {}
    for name, channels in (("even", (quiet, quiet)), ("second", (quiet, loud)), ("first", (loud, quiet))):
        (tmp_path / name).mkdir()
        records = [("a", 0.03, "role: fit, ", channels[0], 0), ("b", 0.06, "role: fit, ", channels[1], 0)]
        values[name], _ = ratio_of(gd.identify(write(tmp_path / name, records)))
    assert values["second"] < values["even"] < values["first"]
    assert values["second"] == pytest.approx(3.0, abs=0.15)
    assert values["first"] == pytest.approx(6.0, abs=0.3)


def test_a_noise_that_a_held_out_record_states_is_not_that_of_the_others(tmp_path):
    loud = "displacement: {column: x, unit: V, noise: {value: 0.3, unit: V}}"
    records = [("a", 0.03, "role: fit, ", SHOWN, 0), ("b", 0.03, "role: holdout, ", loud, 0)]
    levels = gd.identify(write(tmp_path, records)).fitted.noise.by_record
    assert levels["a"] == pytest.approx(0.01, rel=0.2)
    assert levels["b"] == 0.3


def test_a_second_sensor_makes_the_interval_no_wider(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for folder, channels in ((one, SHOWN), (two, f"{SHOWN}, velocity: {{column: v, unit: V/s}}")):
        folder.mkdir()
        write(folder, [("a", 0.03, "role: fit, ", channels, 0)])
    widths = []
    for folder in (one, two):
        value, (low, high) = ratio_of(gd.identify(gd.load(folder / "measurement.yaml")))
        assert low < 3.0 < high
        assert value == pytest.approx(3.0, rel=0.03)
        widths.append(high - low)
    assert widths[1] < 1.05 * widths[0]


def test_records_too_short_for_their_noise_still_give_figures(tmp_path):
    channels = f"{SHOWN}, velocity: {{column: v, unit: V/s}}"
    write(tmp_path, [("a", 0.03, "role: fit, ", channels, 0), ("b", 0.03, "role: fit, slice: [0, 8], ", channels, 0)])
    text = (tmp_path / "measurement.yaml").read_text()
    (tmp_path / "short.yaml").write_text(text.replace("name: a, ", "name: a, slice: [0, 9], "))
    found = gd.identify(gd.load(tmp_path / "short.yaml"))
    assert all(np.isfinite(one["value"]) for one in found.parameters.values())


def test_a_force_that_stays_tells_no_gain(tmp_path):
    write(tmp_path, [("a", 0.03, "role: fit, ", SHOWN, 0)])
    path = tmp_path / "measurement.yaml"
    path.write_text(path.read_text().replace(SHOWN, f"{SHOWN}, force: {{column: f, unit: N}}"))
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    for level in (0.0, 70.3):
        np.savetxt(tmp_path / "a.csv", np.c_[rows, np.full(N, level)], "%.9g", ",", header="t,x,v,f", comments="")
        value, (low, high) = ratio_of(gd.identify(gd.load(path)))
        assert value == pytest.approx(3.0, rel=0.1)
        assert low < 3.0 < high


@pytest.mark.parametrize(
    ("key", "stated"),
    [
        ("damping_ratio", "{value: 15, unit: '1', uncertainty: 0.1}"),
        ("damping_coefficient", "{value: 60, unit: 1/s, uncertainty: 0.01}"),
    ],
)
def test_a_damping_that_is_contradicted_goes_by_its_own_name(tmp_path, key, stated):
    record = write(tmp_path, [("a", 0.02, "", SHOWN, 0.0)], f"parameters: {{{key}: {stated}}}\n")
    said = gd.identify(record).content["contradicted"]
    assert said.startswith(f"{key} lies ")
    assert "of its stated uncertainties away: correct its value" in said
