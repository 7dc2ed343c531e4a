"""Small valid files of every kind that is read, and declarations that name them: what is mutated."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import yaml

TIME = np.arange(120) / 1000
WAVE = np.exp(-9 * TIME) * np.sin(2 * np.pi * 20 * TIME)
ANGLE = 30 * TIME
TEXTS = (
    "t (s),Acc DE (m/s^2),force (N)\n{rows}",
    "# made by a logger\n# rate: 1000 Hz\ntime;x;f\ns;mm;N\n{decimal}",
    "t\tx\tf\n{tabs}",
    "{rows}",
)


def _text(pattern: str) -> str:
    rows = [f"{t:.4f},{x:.6g},{2 * x:.6g}" for t, x in zip(TIME, WAVE, strict=True)]
    return pattern.format(
        rows="\n".join(rows),
        decimal="\n".join(row.replace(",", ";").replace(".", ",") for row in rows),
        tabs="\n".join(row.replace(",", "\t") for row in rows),
    )


def csv(folder: Path) -> list[Path]:
    paths = []
    for number, pattern in enumerate(TEXTS):
        paths.append(folder / f"{number}.csv")
        paths[-1].write_text(_text(pattern))
    return paths


def gz(folder: Path) -> list[Path]:
    path = folder / "run.csv.gz"
    path.write_bytes(gzip.compress(_text(TEXTS[0]).encode()))
    return [path]


def mat(folder: Path) -> list[Path]:
    from scipy.io import savemat

    path, other = folder / "run.mat", folder / "structures.mat"
    savemat(path, {"t": TIME, "x": WAVE, "name": "a text"})
    savemat(other, {"rig": {"t": TIME, "daq": {"x": np.column_stack([WAVE, WAVE])}}}, do_compression=True)
    return [path, other]


def npz(folder: Path) -> list[Path]:
    path, other = folder / "run.npz", folder / "small.npz"
    np.savez(path, t=TIME, x=WAVE, label=np.array(["a", "b"]))
    np.savez_compressed(other, x=WAVE.astype(np.float32))
    return [path, other]


def wav(folder: Path) -> list[Path]:
    from scipy.io import wavfile

    paths = []
    for number, kind in enumerate((np.int16, np.float32, np.int32)):
        paths.append(folder / f"{number}.wav")
        scale = 1 if kind is np.float32 else np.iinfo(kind).max / 2
        wavfile.write(paths[-1], 1000, np.column_stack([WAVE, WAVE] * (number + 1) if number else [WAVE]).astype(kind)
                      if kind is np.float32 else (np.column_stack([WAVE, WAVE]) * scale).astype(kind))  # fmt: skip
    return paths


def hdf5(folder: Path) -> list[Path]:
    import h5py

    path = folder / "run.h5"
    with h5py.File(path, "w") as file:
        file["t"] = TIME
        file["t"].attrs["units"] = "s"
        file.create_group("rig/daq").create_dataset("x", data=WAVE, compression="gzip", chunks=True)
        pairs = np.zeros(60, dtype=[("y", "<f8"), ("label", "S4")])
        file["table"] = pairs
    return [path]


def mat73(folder: Path) -> list[Path]:
    import h5py

    path = folder / "new.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("t", TIME), ("x", WAVE)):
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + b" " * 8 + b"\x00\x02IM"
    path.write_bytes(head.ljust(512, b"\x00") + path.read_bytes()[512:])
    return [path]


def uff(folder: Path) -> list[Path]:
    import pyuff

    path = folder / "run.uff"
    pyuff.UFF(str(path)).write_sets(
        {"type": 58, "func_type": 1, "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1, "data": WAVE,
         "x": TIME, "id1": "run", "rsp_ent_name": "a", "ref_ent_name": "b", "abscissa_spacing": 1,
         "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0,
         "abscissa_inc": 0.001, "abscissa_min": 0.0}, "overwrite")  # fmt: skip
    return [path]


def tdms(folder: Path) -> list[Path]:
    from nptdms import ChannelObject, RootObject, TdmsWriter

    path = folder / "run.tdms"
    with TdmsWriter(str(path)) as writer:
        wave = ChannelObject("daq", "x", WAVE, properties={"wf_increment": 0.001, "unit_string": "V"})
        writer.write_segment([RootObject(properties={"name": "run"}), wave])
    return [path]


def xlsx(folder: Path) -> list[Path]:
    import openpyxl

    path = folder / "run.xlsx"
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["t (s)", "x (mm)"])
    for row in zip(TIME[:40].tolist(), WAVE[:40].tolist(), strict=True):
        sheet.append(row)
    book.save(path)
    return [path]


def json_files(folder: Path) -> list[Path]:
    rows = [{"t": t, "rig": {"x": x}} for t, x in zip(TIME.tolist(), WAVE.tolist(), strict=True)]
    contents = {
        "columns": {"fs": 1000, "t": TIME.tolist(), "x": {"unit": "mm", "values": WAVE.tolist()}},
        "rows": rows,
        "apart": {"columns": ["t", "x"], "data": [[row["t"], row["rig"]["x"]] for row in rows]},
    }
    paths = []
    for name, content in contents.items():
        paths.append(folder / f"{name}.json")
        paths[-1].write_text(json.dumps(content))
    return paths


def declarations(folder: Path) -> list[Path]:
    """Oscillators and gear pairs, with most of what their files may say."""
    np.savez(folder / "data.npz", t=TIME, x=WAVE, f=WAVE, pulses=np.arange(40) / 40, a=ANGLE)
    oscillator = {
        "system": "oscillator",
        "parameters": {"stiffness": {"value": 15000, "unit": "1/s^2"}, "force_gain": {"value": 1, "unit": "m/s^2/N"}},
        "segments": {"value": 50, "unit": "ms"},
        "records": [
            {
                "file": "data.npz", "name": name, "role": role, "slice": rows,
                "channels": {
                    "time": {"column": "t", "unit": "s"},
                    "displacement": {
                        "column": "x", "unit": "mm", "lowpass": {"value": 400, "unit": "Hz"}, "coupling": "DC",
                        "delay": {"value": 1, "unit": "ms"}, "range": {"value": 2, "unit": "mm"}, "polarity": -1,
                        "noise": {"value": 1, "unit": "um"}, "datum": "arbitrary",
                    },
                    "force": {"column": "f", "unit": "N"},
                },
            }
            for name, role, rows in (("one", "fit", [0, 70]), ("two", "holdout", [70, 120]))
        ],
    }  # fmt: skip
    gears = {
        "system": "gear_pair",
        "parameters": {
            "n_teeth_pinion": 17, "n_teeth_gear": 43, "module": {"value": 3, "unit": "mm"},
            "inertia_pinion": {"value": 2.6e-4, "unit": "kg*m^2"}, "torque_gain": {"value": 1.0, "uncertainty": 0.05},
        },
        "records": [
            {
                "file": "data.npz",
                "channels": {
                    "time": {"column": "t", "unit": "s"},
                    "transmission_error": {"column": "x", "unit": "um"},
                    "pinion_torque": {"column": "f", "unit": "N*m"},
                    "pinion_angle": {"column": "a", "unit": "rad"},
                },
                "conditions": {"pinion_speed": {"value": 1800, "unit": "rpm"}, "gear_torque": "balanced"},
            }
        ],
    }  # fmt: skip
    paths = []
    for name, content in (("oscillator", oscillator), ("gears", gears)):
        paths.append(folder / f"{name}.yaml")
        paths[-1].write_text(yaml.safe_dump(content, sort_keys=False))
    return paths


OVERRIDES = (
    ("experiment=backlash", "simulator.backlash.gap_um=80", "seeds=2", "training.patience=3", "family=field"),
    ("task=simulate", "simulator.pinion_torque=150", "simulator.solver.accuracy=1e-4", "simulator.n_runs=3"),
    ("task=explain", "measurement=silverbox", "explain.minutes=2", "ruled_out=[backlash]", "progress=false"),
    ("task=plan", "plan.wanted_percent=5", "simulator.damping_ratio_percent=0.3"),
    ("model=raw_lstm", "wavelet.n_scales=8", "protocol.window=30", "family.spreads.pinion_torque={factor:[1,2]}"),
)
FILES: dict[str, Callable[[Path], list[Path]]] = {
    "csv": csv, "csv.gz": gz, "mat": mat, "mat 7.3": mat73, "npz": npz, "wav": wav, "hdf5": hdf5, "uff": uff,
    "tdms": tdms, "xlsx": xlsx, "json": json_files,
}  # fmt: skip
