"""Damping by estimators that learn nothing: from Python, and beside the law of a fitted simulation."""

import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gear_damping as gd
from gear_damping.interface.damping import Damping
from gear_damping.interface.damping_law import damping_law
from gear_damping.interface.estimator import Prediction

RATE, OMEGA, LINEAR, QUADRATIC = 400.0, 2 * math.pi * 8, 0.4, 3.0
SAMPLES = 6000
TEXT = """system: oscillator
records:
- {file: a.csv, name: first, sampling_rate: 400 Hz, channels: {displacement: {column: x, unit: mm}}}
- {file: b.csv, name: second, sampling_rate: 400 Hz, channels: {displacement: {column: x, unit: mm}}}
"""


def expected(amplitude):
    """Of c x' + q x'|x'|, in % of critical, by the work of a cycle."""
    return 100 * (LINEAR / (2 * OMEGA) + 4 * QUADRATIC * amplitude / (3 * math.pi))


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("decays")
    time, random = np.arange(SAMPLES) / RATE, np.random.default_rng(3)

    def rates(t, y):
        return y[1], -LINEAR * y[1] - QUADRATIC * y[1] * abs(y[1]) - OMEGA**2 * y[0]

    for name, start in (("a", 0.02), ("b", 0.012)):
        path = solve_ivp(rates, (0, time[-1]), (start, 0.0), t_eval=time, rtol=1e-9, atol=1e-12).y[0]
        values = 1e3 * path + 0.01 * random.normal(size=SAMPLES)
        np.savetxt(folder / f"{name}.csv", values, "%.9g", header="x", comments="")
    (folder / "measurement.yaml").write_text(TEXT)
    return folder / "measurement.yaml"


@pytest.fixture(scope="module")
def record(measured):
    return gd.load(measured)


@pytest.fixture(scope="module")
def fitted(record):
    model = gd.Model(
        gd.Oscillator(stiffness=OMEGA**2, unit="mm"),
        [gd.ViscousDamping(damping_coefficient=0.3), gd.PowerLawDamping(coefficient=2e-3, exponent=2.0)],
    )
    names = ["stiffness", "viscous_damping.damping_coefficient", "power_law_damping.coefficient"]
    return gd.identify(record, model, free=names)


def test_the_table_shows_the_ends_of_an_interval_apart(record):
    told = Prediction(1.1, interval95=(1.09995, 1.10015), frequency_hz=8.0, amplitudes=(0.02, 0.001))
    found = {"mine": {one.name: told for one in record.records}}
    text = Damping(record, found, {one.name: "displacement" for one in record.records}).table()
    assert "1.10000   1.09995 … 1.10015" in text


def test_every_estimator_speaks_of_every_record(record):
    found = gd.damping(record)
    assert set(found.found) == {"log_decrement", "half_power", "hilbert_envelope", "wavelet_ridge", "output_error"}
    plain = json.loads(json.dumps(found.content))
    assert plain["channels"]["first"]["unit"] == "mm"
    ridge = plain["records"]["first"]["wavelet_ridge"]
    assert 10 < ridge["amplitudes"][0] < 21  # mm, as in the file
    curve = ridge["curve"]
    assert np.interp(5.0, curve["amplitude"][::-1], curve["damping_ratio_percent"][::-1]) == pytest.approx(
        expected(5e-3), rel=0.04
    )
    text = found.table()
    assert text.count("wavelet_ridge") == 2
    assert "mm" in text
    assert len(found.plot().axes) >= 2
    assert found.mean_percent["wavelet_ridge"] == pytest.approx(
        np.mean([plain["records"][name]["wavelet_ridge"]["damping_ratio_percent"] for name in ("first", "second")])
    )


def test_one_estimator_with_settings_of_its_own_is_kept_and_found_again(record, tmp_path):
    one = gd.estimator("wavelet_ridge", omega0=9)
    one.save(tmp_path / "ridge.json")
    again = gd.load_estimator(tmp_path / "ridge.json")
    first, second = (e.predict(record)["first"] for e in (one, again))
    assert first.damping_ratio_percent == second.damping_ratio_percent
    assert first.damping_ratio_percent != gd.estimator("wavelet_ridge").predict(record)["first"].damping_ratio_percent
    assert again.estimator.values == {"omega0": 9, "fall": 0.5}


@pytest.mark.parametrize(
    ("content", "said"),
    [("{", "is no JSON"), ("[]", "describes no estimator"), ("{}", "is no file of the format"),
     (None, "cannot be read"),
     ('{"format": "gear_damping.estimator", "estimator": "wave", "settings": {}}', "no such estimator"),
     ('{"format": "gear_damping.estimator", "estimator": "half_power", "settings": {"draws": 1}}', "must lie within")],
)  # fmt: skip
def test_a_file_that_holds_none_is_said(tmp_path, content, said):
    if content is not None:
        (tmp_path / "e.json").write_text(content)
    with pytest.raises(gd.InputError, match=said):
        gd.load_estimator(tmp_path / "e.json")


def test_what_is_wrong_is_said(record):
    with pytest.raises(gd.InputError, match="did you mean 'wavelet_ridge'"):
        gd.estimator("wavelet_rigde")
    with pytest.raises(gd.InputError, match="no such estimator"):
        gd.estimator("raw_lstm")  # a network, which is nothing before it is trained
    with pytest.raises(gd.InputError, match="has no setting"):
        gd.damping(record, {"half_power": {"width": 2}})
    with pytest.raises(gd.InputError, match="no such channel"):
        gd.damping(record, channel="velocity")


def test_the_law_of_a_fitted_simulation_is_that_of_its_work_in_a_cycle(record, fitted):
    """To first order of the ratio; the band is as wide as the parameters are unsure."""
    found = gd.damping(record, ["wavelet_ridge"], laws={"fitted": fitted})
    law = found.laws["fitted"]["first"].curve
    values = fitted.parameters
    linear = values["viscous_damping.damping_coefficient"]["value"]
    quadratic = values["power_law_damping.coefficient"]["value"]
    frequency = math.sqrt(values["stiffness"]["value"])
    exact = 100 * (linear / (2 * frequency) + 4 * quadratic * law.amplitude / (3 * math.pi))
    np.testing.assert_allclose(law.damping_ratio_percent, exact, rtol=5e-3)
    low, high = law.interval95.T
    assert np.all((low < law.damping_ratio_percent) & (law.damping_ratio_percent < high))
    off = np.abs(law.damping_ratio_percent - expected(law.amplitude / 1e3))
    assert np.all((off < high - low)[law.amplitude < 4.0])  # mm; beyond, the second order is larger than the band
    ridge = found.found["wavelet_ridge"]["first"].curve
    there = np.interp(-np.log(ridge.amplitude), -np.log(law.amplitude), law.damping_ratio_percent)
    half = (ridge.interval95[:, 1] - ridge.interval95[:, 0]) / 2
    assert np.mean(np.abs(ridge.damping_ratio_percent - there) < 2 * half) > 0.9
    assert "fitted" in found.content["laws"]["first"]


def test_a_simulation_that_comes_to_rest_has_a_law_as_far_as_it_swings(record):
    model = gd.Model(gd.Oscillator(stiffness=OMEGA**2, unit="mm"), [gd.CoulombFriction(force=100.0)])
    found = gd.identify(record, model, free=["stiffness", "coulomb_friction.force"])
    assert damping_law(found.fitted.outcome, found.fitted.evidence, (20.0, 2.0)) is not None


def test_records_of_several_channels_are_each_seen_through_their_first(tmp_path):
    time = np.arange(2000) / RATE
    fall = np.exp(-0.01 * OMEGA * time) * np.cos(OMEGA * time)
    random = np.random.default_rng(2)
    for name, size in (("x", 5.0), ("a", 12.0)):
        series = size * (fall + 1e-3 * random.normal(size=time.size))
        np.savetxt(tmp_path / f"{name}.csv", series, "%.9g", header=name, comments="")
    first = "{file: x.csv, name: one, sampling_rate: 400 Hz, channels: {displacement: {column: x, unit: mm}}}"
    second = "{file: a.csv, name: two, sampling_rate: 400 Hz, channels: {acceleration: {column: a, unit: m/s^2}}}"
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords:\n- {first}\n- {second}\n")
    found = gd.damping(gd.load(tmp_path / "m.yaml"), "log_decrement")
    assert found.content["channels"]["one"] == {"channel": "displacement", "unit": "mm"}
    assert found.content["channels"]["two"] == {"channel": "acceleration", "unit": "m/s^2"}
    assert found.content["records"]["two"]["log_decrement"]["amplitudes"][0] == pytest.approx(12.0, rel=0.1)
    assert "mm" in found.table()
    assert found.plot().axes


def test_a_law_belongs_to_the_channel_it_was_fitted_to(tmp_path, fitted):
    time = np.arange(2000) / RATE
    fall = np.exp(-0.01 * OMEGA * time) * np.cos(OMEGA * time) + 1e-3 * np.random.default_rng(1).normal(size=2000)
    np.savetxt(tmp_path / "v.csv", fall, "%.9g", header="v", comments="")
    only = "{file: v.csv, name: one, sampling_rate: 400 Hz, channels: {velocity: {column: v, unit: m/s}}}"
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords:\n- {only}\n")
    found = gd.damping(gd.load(tmp_path / "m.yaml"), ["log_decrement"], laws={"fitted": fitted})
    assert "was fitted to a displacement" in found.laws["fitted"]["one"].unsuited
    assert found.plot().axes


def test_a_law_needs_a_fitted_simulation(record):
    with pytest.raises(gd.InputError, match="is no fitted simulation"):
        gd.damping(record, ["log_decrement"], laws={"linear": gd.identify(record)})


def test_a_model_is_fitted_in_what_it_was_given(record):
    model = gd.Model(gd.Oscillator(stiffness=OMEGA**2), [gd.ViscousDamping(damping_coefficient=0.5)])
    found = gd.identify(record, model)
    assert {"stiffness", "viscous_damping.damping_coefficient"} <= set(found.parameters)


def test_what_is_declared_and_not_used_is_said(measured, tmp_path):
    text = measured.read_text().replace("file: ", f"file: {measured.parent}/")
    assert gd.damping(gd.load(measured), "log_decrement").not_used == (["role"] if "role:" in text else [])
    stated = "segments: {value: 1, unit: s}\nparameters:\n  stiffness: {value: 400, unit: 1/s^2}\n"
    (tmp_path / "measurement.yaml").write_text(f"{text.rstrip()}\n{stated}")
    found = gd.damping(gd.load(tmp_path / "measurement.yaml"), "log_decrement")
    assert found.content["not_used"][:2] == ["parameters.stiffness", "segments"]
    assert "declared and not used here: parameters.stiffness, segments" in found.table()
