"""A file format from outside: one file is inspected, loaded and identified like any other."""

import json
from pathlib import Path

import numpy as np
import pytest

import gear_damping as gd
from gear_damping.tasks.command import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "my_format.py"
RATE, OMEGA, DECREMENT = 500.0, 40.0, 1.5
HELD = """import numpy as np
from gear_damping.measurement.formats.table import ArrayTable, Held
SUFFIXES, a = (".rig",), np.zeros(4)
def read(path, max_bytes):
    return ArrayTable(path, [Held({})])
"""
OWN = f"measurement.plugins=[{EXAMPLE}]"


@pytest.fixture
def recorded(tmp_path):
    """A decay in the recorder's own format, and the YAML that declares it."""
    time = np.arange(600) / RATE
    decay = np.exp(-DECREMENT * time) * np.cos(OMEGA * time) + 1e-3 * np.random.default_rng(2).standard_normal(600)
    head = f"deflection [mm];bolt [V]\n{RATE}\n".encode()
    (tmp_path / "run.rig").write_bytes(head + np.concatenate([decay, 0 * decay]).astype("<f4").tobytes())
    channels = "{displacement: {column: deflection}}"
    text = f"system: oscillator\nrecords:\n- {{file: run.rig, channels: {channels}}}\n"
    (tmp_path / "measurement.yaml").write_text(text)
    return tmp_path


def test_it_is_inspected(recorded, tmp_path):
    asked = ["task=inspect", f"measurement.path={recorded / 'run.rig'}", f"hydra.run.dir={tmp_path / 'seen'}"]
    assert main([*asked, OWN]) == 0
    started = (tmp_path / "seen" / "measurement.yaml").read_text()
    assert "deflection" in started
    assert "500" in started


def test_it_is_identified_with_the_units_and_the_rate_of_the_file(recorded, tmp_path):
    asked = ["task=identify", f"measurement.path={recorded / 'measurement.yaml'}", "progress=false"]
    assert main([*asked, OWN, f"hydra.run.dir={tmp_path / 'found'}"]) == 0
    found = json.loads((tmp_path / "found" / "identification.json").read_text())
    assert found["damping_ratio_percent"]["value"] == pytest.approx(100 * DECREMENT / OMEGA, rel=0.02)
    record = gd.load(recorded / "measurement.yaml", plugins=[EXAMPLE]).records[0]
    assert record.channels["displacement"].declared_unit == "mm"
    assert record.sampling_rate == RATE


def test_without_its_file_it_is_asked_for(recorded):
    with pytest.raises(gd.InputError, match=r"unknown format '\.rig'.*measurement\.plugins=\[its file\]"):
        gd.load(recorded / "measurement.yaml")


def test_a_damaged_file_ends_in_a_message(recorded):
    (recorded / "run.rig").write_bytes(b"deflection [mm]\n500\nabc")
    with pytest.raises(gd.InputError, match="not a readable file of the recorder"):
        gd.load(recorded / "measurement.yaml", plugins=[EXAMPLE])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("SUFFIXES = ('.rig',)", r"lacks read\(path, max_bytes\)"),
        ("def read(path, max_bytes): ...", "lacks SUFFIXES"),
        ("SUFFIXES = ('rig',)\ndef read(path, max_bytes): ...", "lacks SUFFIXES"),
        ("SUFFIXES = ('.rig',)\ndef read(path): ...", r"read is called as read\(path, max_bytes\), .*too many"),
        ("SUFFIXES = ('.rig',)\ndef read(path, size): return {}", r"odd\.py.*: read gives a dict; .*ArrayTable"),
        (
            "SUFFIXES = ('.rig',)\ndef read(path, size):\n  x = []\n  x[3]",
            "odd.py.*: line 4, in read, fails with IndexError",
        ),
        (HELD.format("3, (4,), a.copy"), "line 5, in read, fails with ValueError: the name of an array is a text"),
        (HELD.format("'deflection', (4,), a"), "ValueError: read of 'deflection' gives the array when it is called"),
        (HELD.format("'deflection', (4,), a.copy, 'm', 3.0"), r"ValueError: the clock of 'deflection' is \(first"),
        (HELD.format("'deflection', (4,), a.copy, 'm', (0, 0)"), r"rate in Hz\), and not \(0, 0\)"),
        (HELD.format("'deflection', (4,), lambda: a + 1j, 'm', (0, 9.)"), "'deflection' cannot be read .it is complex"),
        (HELD.format("'deflection', (4,), a.copy, 5"), "ValueError: the unit of 'deflection' is a text or None"),
        (HELD.format("'deflection', (4,), lambda: a.astype(str) + 'a', 'm', (0, 9.)"), "'deflection' cannot be read"),
        ("import nothing_of_the_kind", "cannot be loaded: line 1: ModuleNotFoundError"),
    ],
)
def test_a_file_that_is_no_reader_is_refused(recorded, text, said):
    (recorded / "odd.py").write_text(text)
    with pytest.raises(gd.InputError, match=said):
        gd.load(recorded / "measurement.yaml", plugins=[recorded / "odd.py"])


def test_the_page_shows_the_file_as_it_is():
    page = (ROOT / "docs" / "your_own_format.md").read_text()
    assert page.split("```python\n")[1].split("```")[0] in EXAMPLE.read_text()
