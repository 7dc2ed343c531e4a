"""Files that vibration recorders wrote: UFF 58 and TDMS."""

import numpy as np
import pytest
import pyuff
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.formats.uff_file import rounded_rate
from gear_damping.measurement.load import load_measurement
from tests.measurement.stored import TIME, WAVE, shapes_of, values_of

# UFF


def _set58(values, rate=10240.0, **changes):
    time = np.arange(len(values)) / rate
    numbers = {"func_type": 1, "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
    kinds = {"abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0}
    described = {"id1": "NONE", "binary": 0, "abscissa_spacing": 1, "data": values, "x": time}
    return pyuff.prepare_58(**{**numbers, **kinds, **described, **changes})


def _write_uff(path, *sets):
    pyuff.UFF(str(path)).write_sets(list(sets), mode="add")
    return path


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves its file open
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("suffix", ["uff", "unv", "UFF58"])
def test_uff_58_gives_the_abscissa_and_the_sets_in_order(tmp_path, binary, suffix):
    first = _set58(WAVE, id1="bearing", ordinate_axis_units_lab="m/s^2", binary=binary, abscissa_axis_units_lab="s")
    second = _set58(-WAVE, binary=binary, abscissa_axis_units_lab="s")
    table = read_table(_write_uff(tmp_path / f"a.{suffix}", first, second))
    assert table.names == ("abscissa", "bearing", "")
    assert [table.unit(k) for k in range(3)] == ["s", "m/s^2", None]
    assert table.sampling_rate == 10240  # the increment in the file says 10240.02
    np.testing.assert_allclose(table.values(0), np.arange(60) / 10240, rtol=1e-15)
    np.testing.assert_allclose(table.values(1), WAVE, atol=1e-11)
    np.testing.assert_allclose(values_of(table, 2), -WAVE, atol=1e-11)


@pytest.mark.parametrize("rate", [10240.0, 51200.0, 25600.0, 65536.0, 44100.0, 12800.0, 4096.0, 1706.67, 0.2])
def test_a_rate_is_what_its_written_increment_rounds(rate):
    assert rounded_rate(1 / float(f"{1 / rate:.5e}")) == rate


def test_uff_with_an_uneven_abscissa_keeps_it(tmp_path):
    time = np.array([0.0, 0.1, 0.3, 0.4, 0.9])
    one = _set58(time**2, x=time, abscissa_spacing=0)
    table = read_table(_write_uff(tmp_path / "a.uff", one))
    assert table.sampling_rate is None
    np.testing.assert_allclose(table.values(0), time, rtol=1e-5)
    np.testing.assert_allclose(table.values(1), time**2, atol=1e-10)


def test_complex_uff_sets_are_left_out(tmp_path):
    response = _set58(WAVE + 1j, func_type=4, abscissa_spec_data_type=18, id1="FRF")
    table = read_table(_write_uff(tmp_path / "a.uff", response, _set58(WAVE)))
    assert table.names == ("abscissa", "")
    assert table.left_out == ("FRF (complex or empty)",)


@pytest.mark.parametrize("content", [b"garbage\n" * 20, bytes(range(256)) * 3, b"    -1\n    58\nbroken\n    -1\n"])
def test_uff_without_a_readable_set_is_one_message(tmp_path, content):
    (tmp_path / "a.uff").write_bytes(content)
    with pytest.raises(InputError, match=r"a\.uff'?: (holds no set 58|not a readable UFF file)"):
        read_table(tmp_path / "a.uff")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("binary", [0, 1])
def test_uff_that_was_cut_off_is_refused_instead_of_losing_a_set(tmp_path, binary):
    path = _write_uff(tmp_path / "a.uff", _set58(WAVE, binary=binary), _set58(np.tile(WAVE, 30), binary=binary))
    whole = path.read_bytes()
    path.write_bytes(whole[:-200])
    with pytest.raises(InputError, match="holds no set 58 or 58b that can be read to its end"):
        read_table(path)
    path.write_bytes(whole[:-3000] + whole[-8:])
    with pytest.raises(InputError, match=r"set 1 holds \d+ of the 1800 values that it announces"):
        read_table(path)


# TDMS


def _channel(group, name, values, **properties):
    return ChannelObject(group, name, values, properties=properties)


@pytest.fixture
def tdms(tmp_path):
    path = tmp_path / "run.tdms"
    start = np.datetime64("2026-01-05T08:00:00")
    wave = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "wf_samples": 60}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([
            RootObject(properties={"Name": "rig"}),
            GroupObject("Vibration"),
            _channel("Vibration", "DE", WAVE, unit_string="m/s^2", **wave),
            _channel("Vibration", "NDE", (1000 * WAVE).astype(np.int16), **wave),
            _channel("Torque", "T1", 5 + WAVE[:30], unit_string="N*m", **{**wave, "wf_increment": 2e-3}),
            _channel("Log", "when", start + (1e6 * TIME).astype("timedelta64[us]")),
            _channel("Log", "remark", ["on"] * 60),
        ])  # fmt: skip
    return path


def test_tdms_channels_are_group_and_channel_with_unit_and_rate(tdms):
    table = read_table(tdms)
    assert shapes_of(table) == {"Vibration/DE": (60,), "Vibration/NDE": (60,), "Torque/T1": (30,), "Log/when": (60,)}
    places = [table.index(name, "") for name in ("Vibration/DE", "Vibration/NDE", "Torque/T1", "Log/when")]
    assert [table.unit(k) for k in places] == ["m/s^2", None, "N*m", "s"]
    assert [table.clock(k) for k in places] == [(0, 1000), (0, 1000), (0, 500), None]
    assert table.sampling_rate is None
    np.testing.assert_array_equal(values_of(table, "/Vibration/DE"), WAVE)
    np.testing.assert_array_equal(values_of(table, "Vibration/NDE"), np.trunc(1000 * WAVE))
    np.testing.assert_allclose(values_of(table, "Log/when"), TIME, atol=1e-6)
    assert table.left_out[0].startswith("Log/remark")


def test_a_tdms_file_that_was_cut_off_says_so(tdms, tmp_path, capsys):
    path = tmp_path / "a.tdms"
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([_channel("g", "x", WAVE), _channel("g", "y", WAVE)])
    path.write_bytes(path.read_bytes()[:-100])
    table = read_table(path)
    np.testing.assert_array_equal(values_of(table, "g/x")[:30], WAVE[:30])
    assert any("Last segment of file has less data than expected" in note for note in table.notes)
    tdms.write_bytes(tdms.read_bytes()[:-600])
    with pytest.raises(InputError, match=r"not a readable TDMS file \(Last segment of file has less data"):
        read_table(tdms)
    assert "segment" not in capsys.readouterr().err


@pytest.mark.parametrize("step", [0.0, -1e-3, 5e-324, float("inf"), float("nan"), True, "fast"])
def test_a_tdms_channel_whose_properties_say_nothing_has_neither_unit_nor_rate(step, tmp_path):
    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([_channel("g", "x", WAVE, unit_string=True, wf_increment=step)])
    table = read_table(tmp_path / "a.tdms")
    place = table.index("g/x", "")
    assert (table.unit(place), table.clock(place)) == (None, None)


def test_a_damaged_tdms_file_is_one_message(tdms, tmp_path):
    content = bytearray(tdms.read_bytes())
    content[28:60] = b"\xff" * 32
    (tmp_path / "b.tdms").write_bytes(content)
    with pytest.raises(InputError, match="not a readable TDMS file"):
        read_table(tmp_path / "b.tdms")
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tdms, max_bytes=1700)


def test_channels_of_two_rates_follow_the_clocks_of_the_file(bench):
    time = np.arange(400) / 20000
    torque = 150 + np.sin(40 * np.arange(200) / 10000)
    with TdmsWriter(str(bench.folder / "run.tdms")) as writer:
        writer.write_segment([
            _channel("fast", "dte", bench.columns["dte"], unit_string="um", wf_increment=5e-5),
            _channel("fast", "theta", bench.columns["theta1"], unit_string="rad", wf_increment=5e-5),
            _channel("slow", "T1", torque, unit_string="N*m", wf_increment=1e-4),
        ])  # fmt: skip
    bench.record["file"] = "run.tdms"
    del bench.channels["time"]
    paths = {"transmission_error": "fast/dte", "pinion_torque": "slow/T1", "pinion_angle": "fast/theta"}
    bench.channels.update({name: {"column": path} for name, path in paths.items()})
    bench.record["slice"] = [20, 380]
    record = bench.load_as_it_is().records[0]
    assert record.sampling_rate == 20000
    np.testing.assert_allclose(record.time, time[20:380])
    np.testing.assert_allclose(record.channels["pinion_torque"].values, 150 + np.sin(40 * record.time), atol=1e-9)


@pytest.mark.parametrize(
    "said", [{"Sampling rate": 250.0}, {"Sampling rate": "250 Hz"}, {"SampleRate": 0.25, "SampleRate_unit": "kHz"}]
)
@pytest.mark.parametrize("owner", [RootObject, lambda properties: GroupObject("Rig", properties), None])
def test_a_property_of_a_tdms_file_states_its_rate(tmp_path, said, owner):
    above = [owner(said)] if owner else []
    own = {} if owner else said
    with TdmsWriter(tmp_path / "a.tdms") as writer:
        writer.write_segment([*above, ChannelObject("Rig", "x", WAVE, own)])
    table = read_table(tmp_path / "a.tdms")
    assert table.sampling_rate is None
    assert table.stated_rate[1] == pytest.approx(250.0)


def test_an_abscissa_of_another_set_of_a_uff_file_contradicts_the_clock_of_a_channel(tmp_path):
    _write_uff(tmp_path / "a.uff", _set58(WAVE, 500.0), _set58(WAVE, 1000.0))
    for column, kinds in ((1, []), (2, ["rate_conflict"])):
        (tmp_path / "m.yaml").write_text(
            "system: oscillator\nrecords:\n- file: a.uff\n"
            f"  channels: {{time: {{column: abscissa}}, displacement: {{column: {column}, unit: mm}}}}\n"
        )
        (record,) = load_measurement(tmp_path / "m.yaml").records
        assert [one.kind for one in record.findings if one.kind == "rate_conflict"] == kinds
