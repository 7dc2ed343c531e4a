"""Faults of measured files, none of them physics: each spoils what a user would hand over."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

OVERSAMPLED = 30  # times


@dataclass
class Sheet:
    """A record about to be written: columns by header, and its entry in measurement.yaml."""

    columns: dict[str, np.ndarray]
    declared: dict[str, object]

    def change(self, name: str, values: np.ndarray) -> None:
        """Put other values into a column; the sheet's own arrays are left alone."""
        self.columns = {**self.columns, name: values}

    def resample(self, rows) -> None:
        """Keep some rows."""
        self.columns = {name: values[rows] for name, values in self.columns.items()}


def spoilt(fault: str, sheets: list[Sheet], content: dict, rng: np.random.Generator) -> None:
    """Spoil the sheets or the content in place."""
    for sheet in sheets:
        sheet.declared = copy.deepcopy(sheet.declared)
    one = sheets[int(rng.integers(len(sheets)))]
    SPOILERS[fault](one, sheets, content, rng)


def _nan_run(one, sheets, content, rng) -> None:
    values = one.columns["dte"].copy()
    first = int(rng.integers(values.size - 40))
    values[first : first + 30] = np.nan
    one.change("dte", values)


def _dropped_samples(one, sheets, content, rng) -> None:
    """The logger lost a block; the stamps tell."""
    count = one.columns["t"].size
    first = int(rng.integers(count // 4, count // 2))
    one.resample(np.r_[0:first, first + 60 : count])


def _repeated_stamps(one, sheets, content, rng) -> None:
    t = one.columns["t"].copy()
    first = int(rng.integers(t.size // 4, t.size // 2))
    t[first : first + 5] = t[first]
    one.change("t", t)


def _mm_for_m(one, sheets, content, rng) -> None:
    """Values in mm under a heading that says m."""
    for sheet in sheets:
        sheet.change("dte", sheet.columns["dte"] * 1e-3)
        sheet.declared["channels"]["transmission_error"]["unit"] = "m"


def _rpm_for_rad_s(one, sheets, content, rng) -> None:
    """A speed in rpm stated as rad/s, beside an angle that is right."""
    for sheet in sheets:
        angle, t = np.unwrap(sheet.columns["theta1"]), sheet.columns["t"]
        rpm = (angle[-1] - angle[0]) / (t[-1] - t[0]) * 30.0 / np.pi
        sheet.declared["conditions"] = {"pinion_speed": {"value": float(rpm), "unit": "rad/s"}}


def _swapped_channels(one, sheets, content, rng) -> None:
    """Torque and angle exchanged."""
    for sheet in sheets:
        channels = sheet.declared["channels"]
        channels["pinion_torque"]["column"], channels["pinion_angle"]["column"] = "theta1", "T1"


def _wrong_tooth_count(one, sheets, content, rng) -> None:
    content["parameters"]["n_teeth_pinion"]["value"] = float(rng.choice([17.0, 19.0, 23.0]))


def _clipped_sensor(one, sheets, content, rng) -> None:
    low, high = np.quantile(one.columns["dte"], [0.0, 0.85])
    one.change("dte", np.clip(one.columns["dte"], low, high))


def _uneven_stamps(one, sheets, content, rng) -> None:
    """Stamps that jump about by far more than a clock does, around instants that were even."""
    t = one.columns["t"].copy()
    t[1:-1] += (t[1] - t[0]) * rng.uniform(-0.4, 0.4, t.size - 2)
    one.change("t", t)


def _oversampled(one, sheets, content, rng) -> None:
    """A file exported on a grid 30 times finer than anything in it: straight lines between the samples."""
    del sheets[2:]
    sheets[1].declared["role"] = "holdout"
    for sheet in sheets:
        sheet.change("theta1", np.unwrap(sheet.columns["theta1"]))
        sheet.resample(slice(0, sheet.columns["t"].size // 5))
        t = sheet.columns["t"]
        fine = np.linspace(t[0], t[-1], (t.size - 1) * OVERSAMPLED + 1)
        sheet.columns = {name: np.interp(fine, t, values) for name, values in sheet.columns.items()}


def _empty_file(one, sheets, content, rng) -> None:
    one.columns = {}


def _mixed_rates(one, sheets, content, rng) -> None:
    one.resample(slice(None, None, 2))


SPOILERS: dict[str, Callable[..., None]] = {
    "nan_run": _nan_run, "dropped_samples": _dropped_samples, "repeated_stamps": _repeated_stamps,
    "mm_for_m": _mm_for_m, "rpm_for_rad_s": _rpm_for_rad_s, "swapped_channels": _swapped_channels,
    "wrong_tooth_count": _wrong_tooth_count, "clipped_sensor": _clipped_sensor, "uneven_stamps": _uneven_stamps,
    "oversampled": _oversampled, "empty_file": _empty_file, "mixed_rates": _mixed_rates,
}  # fmt: skip
