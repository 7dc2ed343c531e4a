"""A trained network that tells the damping of records."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.lightning_module import load_estimator as load_module
from gear_damping.measurement.record import Measurement, Record
from gear_damping.physics.catalogue import SYSTEMS


@dataclass(frozen=True)
class Prediction:
    """What a network says of a record.

    Args:
        damping_ratio_percent: In % of critical, the mean over its windows.
        spread_percent: Standard deviation over its windows, which is no interval of confidence.
        outside: Sentences about what lies outside the ranges that it was trained on; then it is a guess.
    """

    damping_ratio_percent: float
    spread_percent: float
    outside: tuple[str, ...]


class Estimator:
    """A checkpoint that `task=train` left; it holds only for gears like those it was trained on."""

    def __init__(self, module: DampingModule) -> None:
        """Hold a trained network."""
        self.module, self.trained_on = module, module.trained_on

    def predict(self, measurement: Measurement, channel: str | None = None) -> Mapping[str, Prediction]:
        """The damping ratio of every record in %, by name, with its spread over windows, which is no interval.

        Args:
            measurement: As `load` gives it.
            channel: Which channel of the records; the response of the system where absent.

        Raises:
            InputError: the records are of another system, channel, unit or rate than the network was trained on, a
                record has no such channel, or is too short.
        """
        wanted = channel or SYSTEMS[measurement.system].response
        problems = [
            Problem(
                f"{record.name}.{wanted}",
                "no such channel",
                remedy=f"choose measurement.channel from {', '.join(record.channels)}",
                source=str(record.file),
            )
            for record in measurement.records
            if wanted not in record.channels
        ]
        problems = problems or self._unlike(measurement, wanted)
        if problems:
            raise InputError(problems)
        return {record.name: self._of_record(record, wanted) for record in measurement.records}

    def _unlike(self, measurement: Measurement, channel: str) -> list[Problem]:
        """Why these are no records for this network."""
        units = dict.fromkeys(record.channels[channel].unit for record in measurement.records)
        found = [problem for unit in units for problem in self.trained_on.problems(measurement.system, channel, unit)]
        return [replace(problem, source=str(measurement.source)) for problem in dict.fromkeys(found)]

    def _of_record(self, record: Record, channel: str) -> Prediction:
        values = torch.as_tensor(record.channels[channel].values)
        found = self.module.predict_record(values, record.sampling_rate)
        conditions = {name: quantity.value for name, quantity in record.conditions.items()}
        return Prediction(*found[:2], self.trained_on.outside(values, found.damping_ratio_percent, conditions))


def load_estimator(path: Path | str, plugins: Sequence[str] = ()) -> Estimator:
    """The estimator of a checkpoint.

    Args:
        path: The checkpoint.
        plugins: Files of one's own that declare estimators: a checkpoint holds numbers and runs no code.

    Raises:
        InputError: the file is missing, is no checkpoint of such a network, or of one that no file declares.
    """
    return Estimator(load_module(path, plugins))
