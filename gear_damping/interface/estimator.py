"""What tells the damping of records: a trained network, or an estimator that takes a record by itself."""

import json
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.release import released_at
from gear_damping.identification.catalogue import record_estimator
from gear_damping.identification.damping_estimate import DampingCurve, UnsuitedRecord
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.familiarity import Familiarity
from gear_damping.identification.free_vibration import Turning
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.observation import fit_record, fitted_names, has_spring, known_of
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import stretch
from gear_damping.identification.saved import FORMAT as NETWORK
from gear_damping.identification.saved import description_of, read_description, write_shared
from gear_damping.identification.saved import load_estimator as load_module
from gear_damping.interface.arguments import file_path, plain, refuse_other, refuse_other_name
from gear_damping.measurement.record import Measurement, Record
from gear_damping.own_files import plugin_paths
from gear_damping.physics.systems.gear_pair import teeth_of
from gear_damping.physics.systems.traits import Trait
from gear_damping.reporting.model_card import model_card

FORMAT = "gear_damping.estimator"  # of a file that holds an estimator without weights
CARD = "model_card.md"


@dataclass(frozen=True, eq=False)
class Prediction:
    """What an estimator says of a record.

    Args:
        damping_ratio_percent: In % of critical; None where the record does not suit it.
        spread_percent: Of a network, the standard deviation over its windows, which is no interval of confidence.
        outside: Sentences about what a network was not trained on: values outside its ranges, and a record that holds
            what no run of its training does; then it is a guess.
        interval95: Of the ratio; None of a network of windows.
        frequency_hz: Of the damped vibration.
        amplitudes: Largest and smallest amplitude that the ratio is a mean over, in the unit of the loaded channel.
        curve: The ratio against amplitude, of estimators that tell it.
        unsuited: Why the record does not suit it, and what would.
        doubt: Why the record is not what the estimator takes it for, though it says something.
        familiarity: How like the runs of a network's training the record is; None where nothing tells it.
    """

    damping_ratio_percent: float | None
    spread_percent: float | None = None
    outside: tuple[str, ...] = ()
    interval95: tuple[float, float] | None = None
    frequency_hz: float | None = None
    amplitudes: tuple[float, float] | None = None
    curve: DampingCurve | None = None
    unsuited: str = ""
    doubt: str = ""
    familiarity: Familiarity | None = None


class Estimator(ABC):
    """An estimator that is ready for records."""

    @abstractmethod
    def predict(self, measurement: Measurement, channel: str | None = None) -> Mapping[str, Prediction]:
        """What it says of every record, by name.

        Args:
            measurement: As `load` gives it.
            channel: Which channel of the records; the first response of the system where absent.

        Raises:
            InputError: the records are not of the kind that it takes, or have no such channel.
        """


class NetworkEstimator(Estimator):
    """A network that `task=train` left; it holds only for gears like those it was trained on."""

    def __init__(self, module: DampingModule) -> None:
        """Hold a trained network."""
        self.module, self.trained_on = module, module.trained_on

    def predict(self, measurement: Measurement, channel: str | None = None) -> Mapping[str, Prediction]:
        """The mean over the windows of every record, with their deviation, which is no interval.

        Of a network of whole records, what it says of the beginning of each, with its 95 % interval.

        Raises:
            InputError: the records are of another system, channel, unit or rate than the network was trained on, a
                record has no such channel, or is too short.
        """
        refuse_other(measurement)
        refuse_other_name("channel", channel, measurement.base.response)
        wanted = channel or measurement.base.response
        problems = _without_channel(measurement, wanted) or self._unlike(measurement, wanted)
        if problems:
            raise InputError(problems)
        return {record.name: self._of_record(record, wanted) for record in measurement.records}

    def save(self, folder: Path | str) -> None:
        """Write `model.safetensors`, `model.json` and a card for sharing; `load_estimator` reads the folder."""
        write_shared(self.module, Path(folder))
        card = model_card(description_of(self.module), self.module.network.is_likelihood)
        (Path(folder) / CARD).write_text(card)

    def _unlike(self, measurement: Measurement, channel: str) -> list[Problem]:
        """Why these are no records for this network."""
        units = dict.fromkeys(record.channels[channel].unit for record in measurement.records)
        found = [problem for unit in units for problem in self.trained_on.problems(measurement.system, channel, unit)]
        return [replace(problem, source=str(measurement.source)) for problem in dict.fromkeys(found)]

    def _of_record(self, record: Record, channel: str) -> Prediction:
        values = torch.as_tensor(record.channels[channel].values)
        found = self.module.predict_record(values, record.sampling_rate)
        conditions = {name: quantity.value for name, quantity in record.conditions.items()}
        outside = self.trained_on.outside(values, found.damping_ratio_percent, conditions)
        like = None if self.module.components is None else self.module.components(values)
        if like is not None and like.is_strange:
            outside = (*outside, like.sentence)
        return Prediction(*found[:2], outside, interval95=found.interval95, familiarity=like)


class ClassicalEstimator(Estimator):
    """An estimator that learns nothing: a record is all it needs, its settings are all it holds."""

    def __init__(self, estimator: RecordEstimator) -> None:
        """Hold an estimator of records."""
        self.estimator = estimator

    @property
    def name(self) -> str:
        """Its key."""
        return self.estimator.name

    def predict(self, measurement: Measurement, channel: str | None = None) -> Mapping[str, Prediction]:
        """The damping of every record with its 95 % interval, or why the record does not suit.

        Raises:
            InputError: a record has no such channel, or no response at all.
        """
        return {name: self.tell(one) for name, one in all_recorded(measurement, channel).items()}

    def save(self, path: Path | str) -> None:
        """Write its name and settings as JSON, for `load_estimator`."""
        content = {"format": FORMAT, "estimator": self.name, "settings": self.estimator.values}
        Path(path).write_text(json.dumps(content, indent=1) + "\n")

    def tell(self, record: Recorded) -> Prediction:
        """What it says of one record."""
        try:
            return Prediction(**vars(self.estimator.estimate(record)))
        except UnsuitedRecord as reason:
            return Prediction(None, unsuited=str(reason))


def all_recorded(measurement: Measurement, channel: str | None = None) -> dict[str, Recorded]:
    """Every record as estimators meet it, by name, through one channel each.

    Raises:
        InputError: a record has no such channel, or no response at all.
    """
    refuse_other(measurement)
    refuse_other_name("channel", channel, measurement.base.response)
    problems = _without_channel(measurement, channel, measurement.base.responses) if channel else []
    if problems:
        raise InputError(problems)
    return {record.name: _recorded(record, measurement, channel) for record in measurement.records}


def _recorded(record: Record, measurement: Measurement, channel: str | None) -> Recorded:
    """Through the channel that is named, else its first response; from where the motion is free, if nothing drives."""
    system, known = measurement.base, known_of(measurement)
    shown = channel or fitted_names(record, system)[0]
    others = [name for name in system.responses if name != shown]
    alone = replace(record, channels={n: c for n, c in record.channels.items() if n not in others})
    found = fit_record(alone, system, has_spring(known, system))
    if system.has(Trait.REST) and (waited := released_at(found)):
        found = stretch(found, slice(waited, None))
    return Recorded(found, system, known, _turning(found, known.values) if system.has(Trait.SHAFTS) else None)


def _turning(record: FitRecord, values: Mapping[str, float]) -> Turning | None:
    """What turns in a gear pair; None where no speed is known."""
    teeth = teeth_of(values)
    if "pinion_angle" in record.inputs:
        return Turning(teeth[0] * record.inputs["pinion_angle"].numpy(), teeth)
    speed, ends = record.conditions.get("pinion_speed"), record.instants[[0, -1]].tolist()
    even = np.linspace(*ends, len(record.response))
    return Turning(teeth[0] * speed / record.sampling_rate * even, teeth) if speed else None


def estimator(
    name: str, *, plugins: str | Path | Sequence[Path | str] = (), **settings: float | bool
) -> ClassicalEstimator:
    """An estimator that takes a record by itself: `gd.estimator("wavelet_ridge", omega0=8)`.

    Args:
        name: Of the estimator.
        plugins: Files of one's own that declare estimators.
        settings: The numbers that it is built by; as usual where absent.

    Raises:
        InputError: there is none, a setting is unknown or out of range, or a file cannot be used.
    """
    return made(name, settings, plugins)


def made(name: str, settings: Mapping[str, Any], plugins: str | Path | Sequence[Path | str]) -> ClassicalEstimator:
    """An estimator of one record with its settings, which may be numbers of numpy.

    Raises:
        InputError: there is none, a setting is unknown or out of range, or a file cannot be used.
    """
    own = {key: plain(value) for key, value in settings.items()}
    return ClassicalEstimator(record_estimator(name, own, plugin_paths(plugins)))


def load_estimator(path: Path | str, plugins: str | Path | Sequence[Path | str] = ()) -> Estimator:
    """The estimator of a checkpoint, of a folder with `model.safetensors`, or of what `save` wrote.

    Args:
        path: The file or the folder.
        plugins: Files of one's own that declare estimators: what is saved holds numbers and runs no code.

    Raises:
        InputError: a file is missing or damaged, is none of these kinds, or of an estimator that no file declares.
    """
    path = file_path("path", path, "a best.ckpt, of a folder with model.safetensors, or of what `save` wrote")
    plugins = plugin_paths(plugins)
    if path.suffix == ".json":
        content = read_description(path)
        if content.get("format") != NETWORK:
            return _classical(content, path, plugins)
    return NetworkEstimator(load_module(path, plugins))


def _classical(content: Mapping[str, Any], path: Path, plugins: Sequence[str]) -> ClassicalEstimator:
    """The estimator whose name and settings were saved."""
    name, settings = content.get("estimator"), content.get("settings")
    if content.get("format") != FORMAT or not isinstance(name, str) or not isinstance(settings, dict):
        rule, remedy = f"is no file of the format {FORMAT}", "give what `save` of an estimator wrote, or a best.ckpt"
        raise InputError(Problem("checkpoint", rule, str(path), remedy))
    return ClassicalEstimator(record_estimator(name, settings, plugins))


def _without_channel(measurement: Measurement, channel: str, known: Sequence[str] | None = None) -> list[Problem]:
    """Which records have no such channel, or have it as something else than one of these responses."""
    found = []
    for record in measurement.records:
        there = [name for name in record.channels if known is None or name in known]
        if channel not in there:
            rule = "no such channel" if channel not in record.channels else "is no response"
            remedy = f"choose measurement.channel from {', '.join(there)}"
            found.append(Problem(f"{record.name}.{channel}", rule, remedy=remedy, source=str(record.file)))
    return found
