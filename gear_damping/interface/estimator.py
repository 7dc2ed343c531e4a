"""A trained network that tells the damping of records."""

from collections.abc import Mapping
from pathlib import Path

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.identification.lightning_module import DampingModule, RecordPrediction
from gear_damping.identification.lightning_module import load_estimator as load_module
from gear_damping.measurement.record import Measurement, Record
from gear_damping.physics.catalogue import SYSTEMS


class Estimator:
    """A checkpoint that `task=train` left; it holds only for gears like those it was trained on."""

    def __init__(self, module: DampingModule) -> None:
        """Hold a trained network."""
        self.module = module

    def predict(self, measurement: Measurement, channel: str | None = None) -> Mapping[str, RecordPrediction]:
        """The damping ratio of every record in %, by name, with its spread over windows, which is no interval.

        Args:
            measurement: As `load` gives it.
            channel: Which channel of the records; the response of the system where absent.

        Raises:
            InputError: a record has no such channel, another rate than the network was trained at, or is too short.
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
        if problems:
            raise InputError(problems)
        return {record.name: self._of_record(record, wanted) for record in measurement.records}

    def _of_record(self, record: Record, channel: str) -> RecordPrediction:
        return self.module.predict_record(torch.as_tensor(record.channels[channel].values), record.sampling_rate)


def load_estimator(path: Path | str) -> Estimator:
    """The estimator of a checkpoint.

    Raises:
        InputError: the file is missing, or is no checkpoint of such a network.
    """
    return Estimator(load_module(path))
