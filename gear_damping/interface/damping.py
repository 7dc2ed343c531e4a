"""The damping of every record by estimators that learn nothing, side by side."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.errors import InputError, Problem
from gear_damping.identification.catalogue import builtin_estimators, record_estimator
from gear_damping.identification.damping_estimate import DampingCurve
from gear_damping.identification.estimators.base import RecordEstimator
from gear_damping.identification.observation import response_names
from gear_damping.interface import identified_gears
from gear_damping.interface.damping_law import damping_law
from gear_damping.interface.estimator import ClassicalEstimator, Prediction
from gear_damping.interface.identified import Identification, refuse_faults
from gear_damping.measurement.record import Channel, Measurement
from gear_damping.reporting import figures
from gear_damping.reporting.tables import damping_table

Settings = Mapping[str, float | int | bool]
Found = Mapping[str, Mapping[str, Prediction]]  # estimator -> record -> what it says


class Damping:
    """What estimators say of records: `content`, as in damping.json, a `table()` and a `plot()` of it."""

    def __init__(self, measurement: Measurement, found: Found, channel: str, laws: Found | None = None) -> None:
        """Hold predictions by estimator and record, and what fitted simulations have over the same amplitudes."""
        self.measurement, self.found, self.channel, self.laws = measurement, found, channel, laws or {}

    @property
    def content(self) -> dict[str, Any]:
        """Ratio with interval, frequency, amplitudes and curve, or the reason, by record and estimator."""
        return {
            "system": self.measurement.system,
            "channel": self.channel,
            "unit": self._declared.declared_unit,
            "records": {
                record.name: {name: self._plain(found[record.name]) for name, found in self.found.items()}
                for record in self.measurement.records
            },
            "laws": {
                record.name: {name: self._plain(one) for name, one in self._laws_of(record.name).items()}
                for record in self.measurement.records
            },
        }

    @property
    def mean_percent(self) -> dict[str, float]:
        """The mean over the records that suit it, by estimator."""
        told = {
            name: [p.damping_ratio_percent for p in found.values() if p.damping_ratio_percent is not None]
            for name, found in self.found.items()
        }
        return {name: fmean(values) for name, values in told.items() if values}

    def table(self) -> str:
        """A row for each record and estimator, as text."""
        rows, reasons = [], {}
        for record in self.measurement.records:
            for name, found in self.found.items():
                one = found[record.name]
                if one.damping_ratio_percent is None:
                    rows.append((record.name, name, "-", "", "", ""))
                    reasons.setdefault((name, one.unsuited), []).append(record.name)
                    continue
                low, high = one.interval95
                ratio, interval = f"{one.damping_ratio_percent:.4g}", f"{low:.4g} … {high:.4g}"
                large, small = (self._shown(size) for size in one.amplitudes)
                rows.append((record.name, name, ratio, interval, f"{one.frequency_hz:.5g}", f"{large} … {small}"))
        said = [f"{name} says nothing of {', '.join(of)}: {why}" for (name, why), of in reasons.items()]
        return "\n".join([damping_table(rows, self._declared.declared_unit).rstrip(), *said]) + "\n"

    def plot(self) -> Figure:
        """The damping ratio against amplitude, record by record, with bands."""
        factor = self._declared.declared_factor
        panels = [
            figures.DampingPanel(
                record.name,
                {name: _drawn(found[record.name], factor) for name, found in self.found.items()},
                {name: _drawn(one, factor) for name, one in self._laws_of(record.name).items()},
            )
            for record in self.measurement.records
        ]
        return figures.damping_figure(panels, self.channel, self._declared.declared_unit)

    def __repr__(self) -> str:
        return self.table()

    def _repr_html_(self) -> str:
        return f"<pre>{self.table()}</pre>"

    @property
    def _declared(self) -> Channel:
        return next(r.channels[self.channel] for r in self.measurement.records if self.channel in r.channels)

    def _laws_of(self, record: str) -> dict[str, Prediction]:
        return {name: found[record] for name, found in self.laws.items() if record in found}

    def _shown(self, size: float) -> str:
        return f"{size / self._declared.declared_factor:.3g}"

    def _plain(self, one: Prediction) -> dict[str, Any]:
        if one.damping_ratio_percent is None:
            return {"damping_ratio_percent": None, "unsuited": one.unsuited}
        factor = self._declared.declared_factor
        return {
            "damping_ratio_percent": one.damping_ratio_percent,
            "interval95": list(one.interval95),
            "frequency_hz": one.frequency_hz,
            "amplitudes": [size / factor for size in one.amplitudes],
            "curve": one.curve and _plain_curve(one.curve, factor),
        }


def damping(
    measurement: Measurement,
    estimators: Mapping[str, Settings] | Sequence[str] = (),
    *,
    channel: str | None = None,
    plugins: Sequence[Path | str] = (),
    laws: Mapping[str, Identification] | None = None,
) -> Damping:
    """The damping of every record by several estimators that take a record by itself.

    Args:
        measurement: As `load` gives it.
        estimators: Their names, or their settings by name; all that come with the package where absent.
        channel: Which channel of the records; the first response of the system where absent.
        plugins: Files of one's own that declare estimators.
        laws: Fitted simulations of an oscillator, by what they are called, whose damping is worked out over the
            amplitudes of every record: `{"explained": gd.identify(record, answer.model)}`.

    Raises:
        InputError: the data are damaged, an estimator or a channel is unknown, or a setting is out of range.
    """
    refuse_faults(measurement)
    kinds = builtin_estimators()
    chosen = estimators or [name for name, kind in kinds.items() if issubclass(kind, RecordEstimator)]
    settings = chosen if isinstance(chosen, Mapping) else {name: {} for name in chosen}
    made = {name: ClassicalEstimator(record_estimator(name, given, plugins)) for name, given in settings.items()}
    found = {name: one.predict(measurement, channel) for name, one in made.items()}
    record = measurement.records[0]
    swings = _swings(found)
    fitted = {name: _of_law(one, swings) for name, one in (laws or {}).items()}
    return Damping(measurement, found, channel or response_names(record, measurement.system)[0], fitted)


def _swings(found: Found) -> dict[str, tuple[float, float]]:
    """Largest and smallest amplitude of every record that any estimator tells something of."""
    swings: dict[str, tuple[float, float]] = {}
    for one, record in ((p, record) for by_record in found.values() for record, p in by_record.items()):
        if one.amplitudes is not None:
            large, small = swings.get(record, one.amplitudes)
            swings[record] = (max(large, one.amplitudes[0]), min(small, one.amplitudes[1]))
    return swings


def _of_law(fit: Identification, swings: Mapping[str, tuple[float, float]]) -> dict[str, Prediction]:
    """The damping of a fitted simulation over the amplitudes of every record; its mean is that over their logarithm."""
    if not isinstance(fit.fitted, identified_gears.Fitted) or fit.fitted.evidence.system != "oscillator":
        rule, remedy = "is no fitted simulation of an oscillator", "give what gd.identify(record, model) found"
        raise InputError(Problem("laws", rule, remedy=remedy))
    found = {}
    for record, ends in swings.items():
        curve = damping_law(fit.fitted.outcome, fit.fitted.evidence, ends)
        if curve is None:
            found[record] = Prediction(None, unsuited="the simulation does not fall over these amplitudes")
            continue
        low, high = curve.interval95.mean(0)
        mean, frequency = float(curve.damping_ratio_percent.mean()), float(curve.frequency_hz.mean())
        found[record] = Prediction(mean, None, (), (float(low), float(high)), frequency, ends, curve)
    return found


def _drawn(one: Prediction, factor: float) -> figures.DampingBand | None:
    """A curve with its band, or one ratio over the amplitudes that it is a mean of; None where nothing is told."""
    if one.damping_ratio_percent is None:
        return None
    if one.curve is not None:
        return figures.DampingBand(one.curve.amplitude / factor, one.curve.damping_ratio_percent, one.curve.interval95)
    ends = np.array(one.amplitudes) / factor
    return figures.DampingBand(ends, np.full(2, one.damping_ratio_percent), np.array([one.interval95] * 2))


def _plain_curve(curve: DampingCurve, factor: float) -> dict[str, list[Any]]:
    return {
        "amplitude": (curve.amplitude / factor).tolist(),
        "damping_ratio_percent": curve.damping_ratio_percent.tolist(),
        "interval95": curve.interval95.tolist(),
        "frequency_hz": curve.frequency_hz.tolist(),
    }
