"""The damping of every record by estimators that learn nothing, side by side."""

from collections.abc import Mapping, Sequence, Sized
from dataclasses import replace
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.errors import InputError, Problem, with_article
from gear_damping.identification.catalogue import builtin_estimators
from gear_damping.identification.damping_estimate import DampingCurve
from gear_damping.identification.estimators.base import RecordEstimator
from gear_damping.interface import identified_gears
from gear_damping.interface.arguments import names
from gear_damping.interface.damping_law import damping_law
from gear_damping.interface.estimator import Prediction, all_recorded, made
from gear_damping.interface.identified import Identification, refuse_faults
from gear_damping.measurement.record import Channel, Measurement, Record
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting import figures
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.numbers import pretty_unit, with_interval
from gear_damping.reporting.page.render import words
from gear_damping.reporting.tables import damping_table

Settings = Mapping[str, float | int | bool]
Found = Mapping[str, Mapping[str, Prediction]]  # estimator -> record -> what it says


class Damping:
    """What estimators say of records: `content`, as in damping.json, a `table()` and a `plot()` of it."""

    def __init__(
        self, measurement: Measurement, found: Found, channels: Mapping[str, str], laws: Found | None = None
    ) -> None:
        """Hold predictions by estimator and record, and what fitted simulations have over the same amplitudes.

        Args:
            measurement: The records.
            found: Of the estimators.
            channels: The channel of each record, whose amplitudes they speak of.
            laws: Of fitted simulations.
        """
        self.measurement, self.found, self.channels, self.laws = measurement, found, channels, laws or {}

    @property
    def content(self) -> dict[str, Any]:
        """Ratio with interval, frequency, amplitudes and curve, or the reason, by record and estimator."""
        return {
            "system": self.measurement.system,
            "channels": {
                record.name: {"channel": self.channels[record.name], "unit": self._declared(record).declared_unit}
                for record in self.measurement.records
            },
            "records": {
                record.name: {name: self._plain(found[record.name], record) for name, found in self.found.items()}
                for record in self.measurement.records
            },
            "laws": {
                record.name: {name: self._plain(one, record) for name, one in self._laws_of(record.name).items()}
                for record in self.measurement.records
            },
            "not_used": self.not_used,
        }

    @property
    def not_used(self) -> list[str]:
        """What the file declares and these estimators, which take each record by itself and whole, leave aside."""
        records, rests = self.measurement.records, self.measurement.base.has(Trait.REST)
        found = [f"parameters.{name}" for name in self.measurement.parameters if rests]
        found += ["segments"] if self.measurement.segment_s else []
        found += ["role"] if any(record.role for record in records) else []
        channels = [record.channels[self.channels[record.name]] for record in records]
        return found + [key for key in ("noise", "lowpass") if any(getattr(c, key) for c in channels)]

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
        rows, reasons, doubts = [], {}, []
        for record in self.measurement.records:
            for name, found in self.found.items():
                one = found[record.name]
                if one.damping_ratio_percent is None:
                    rows.append((record.name, name, "-", "", "", ""))
                    reasons.setdefault((name, one.unsuited), []).append(record.name)
                    continue
                doubts += [f"{name} of {record.name} is in doubt: {one.doubt}"] if one.doubt else []
                ratio, interval = with_interval(one.damping_ratio_percent, one.interval95)
                declared = self._declared(record)
                large, small = (f"{size / declared.declared_factor:.3g}" for size in one.amplitudes)
                amplitudes = f"{large} … {small} {pretty_unit(declared.declared_unit)}"
                rows.append((record.name, name, ratio, interval, f"{one.frequency_hz:.5g}", amplitudes))
        said = [f"{name} says nothing of {', '.join(of)}: {why}" for (name, why), of in reasons.items()]
        why = "estimators take each record by itself and whole"
        unused = f"declared and not used here: {', '.join(self.not_used)} ({why})"
        return "\n".join([damping_table(rows).rstrip(), *said, *doubts, *([unused] if self.not_used else [])]) + "\n"

    def plot(self) -> Figure:
        """The damping ratio against amplitude, record by record, with bands."""
        panels, shown = [], []
        for record in self.measurement.records:
            declared = self._declared(record)
            factor, said = declared.declared_factor, axis(words(declared.name), pretty_unit(declared.declared_unit))
            bands = {name: _drawn(found[record.name], factor) for name, found in self.found.items()}
            laws = {name: _drawn(one, factor) for name, one in self._laws_of(record.name).items()}
            panels.append(figures.DampingPanel(record.name, bands, laws))
            shown.append(said)
        if len(set(shown)) > 1:
            panels = [replace(one, record=f"{one.record}: {said}") for one, said in zip(panels, shown, strict=True)]
        return figures.damping_figure(panels, f"of {shown[0]}" if len(set(shown)) == 1 else "of each record's channel")

    def __repr__(self) -> str:
        return self.table()

    def _repr_html_(self) -> str:
        return f"<pre>{self.table()}</pre>"

    def _declared(self, record: Record) -> Channel:
        return record.channels[self.channels[record.name]]

    def _laws_of(self, record: str) -> dict[str, Prediction]:
        return {name: found[record] for name, found in self.laws.items() if record in found}

    def _plain(self, one: Prediction, record: Record) -> dict[str, Any]:
        if one.damping_ratio_percent is None:
            return {"damping_ratio_percent": None, "unsuited": one.unsuited}
        factor = self._declared(record).declared_factor
        return {
            "damping_ratio_percent": one.damping_ratio_percent,
            "interval95": list(one.interval95),
            "frequency_hz": one.frequency_hz,
            "amplitudes": [size / factor for size in one.amplitudes],
            "curve": one.curve and _plain_curve(one.curve, factor),
            "doubt": one.doubt or None,
        }


def damping(
    measurement: Measurement,
    estimators: Mapping[str, Settings] | Sequence[str] = (),
    *,
    channel: str | None = None,
    plugins: str | Path | Sequence[Path | str] = (),
    laws: Mapping[str, Identification] | None = None,
) -> Damping:
    """The damping of every record by several estimators that take a record by itself.

    Args:
        measurement: As `load` gives it.
        estimators: Their names, or their settings by name; all for ring-downs that come with the package where absent.
        channel: Which channel of the records; the first response of the system where absent.
        plugins: Files of one's own that declare estimators.
        laws: Fitted simulations of an oscillator, by what they are called, whose damping is worked out over the
            amplitudes of every record: `{"explained": gd.identify(record, answer.model)}`.

    Raises:
        InputError: the data are damaged, an estimator or a channel is unknown, or a setting is out of range.
    """
    refuse_faults(measurement)
    kinds = builtin_estimators()
    for_decays = [n for n, kind in kinds.items() if issubclass(kind, RecordEstimator) and kind.of_ring_downs]
    fits = _by_name(laws)
    is_empty = estimators is None or (isinstance(estimators, Sized) and not len(estimators))
    asked = for_decays if is_empty else estimators
    settings = asked if isinstance(asked, Mapping) else {name: {} for name in names("estimators", asked)}
    chosen = {name: made(name, _settings_of(name, given), plugins) for name, given in settings.items()}
    records = all_recorded(measurement, channel)
    found = {name: {record: one.tell(seen) for record, seen in records.items()} for name, one in chosen.items()}
    channels = {record: seen.record.observed.name for record, seen in records.items()}
    swings = _swings(found)
    fitted = {name: _of_law(one, swings, channels) for name, one in fits.items()}
    return Damping(measurement, found, channels, fitted)


def _by_name(laws: Any) -> Mapping[str, Any]:
    """Fitted simulations by what they are called.

    Raises:
        InputError: they have no names.
    """
    if laws is None or isinstance(laws, Mapping):
        return laws or {}
    remedy = "write laws={'explained': what gd.identify(record, model) found}"
    raise InputError(Problem("laws", f"must be named, and is {with_article(type(laws).__name__)}", remedy=remedy))


def _settings_of(name: str, given: Any) -> Settings:
    """The settings of one estimator; None stands for what is usual.

    Raises:
        InputError: they have no names.
    """
    if given is None or isinstance(given, Mapping):
        return given or {}
    remedy = f"write {{'{name}': {{}}}}, or its settings by name"
    raise InputError(Problem(f"estimators.{name}", "must be settings by name", given, remedy))


def _swings(found: Found) -> dict[str, tuple[float, float]]:
    """Largest and smallest amplitude of every record that any estimator tells something of."""
    swings: dict[str, tuple[float, float]] = {}
    for one, record in ((p, record) for by_record in found.values() for record, p in by_record.items()):
        if one.amplitudes is not None:
            large, small = swings.get(record, one.amplitudes)
            swings[record] = (max(large, one.amplitudes[0]), min(small, one.amplitudes[1]))
    return swings


def _of_law(
    fit: Identification, swings: Mapping[str, tuple[float, float]], channels: Mapping[str, str]
) -> dict[str, Prediction]:
    """The damping of a fitted simulation over the amplitudes of every record; its mean is that over their logarithm."""
    is_fit = isinstance(fit, Identification) and isinstance(fit.fitted, identified_gears.Fitted)
    if not is_fit or not fit.fitted.evidence.has(Trait.REST):
        rule, remedy = "is no fitted simulation of an oscillator", "give what gd.identify(record, model) found"
        raise InputError(Problem("laws", rule, remedy=remedy))
    found, first = {}, fit.fitted.evidence.fit[0].observed.name
    for record, ends in swings.items():
        if channels[record] != first:
            why = f"the simulation was fitted to a {first}, and these amplitudes are those of the {channels[record]}"
            found[record] = Prediction(None, unsuited=why)
            continue
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
