"""What an estimator was trained on, and so which records it may be asked about."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from torch import Tensor

from gear_damping.errors import Problem
from gear_damping.identification.noise import ac_rms_of_runs
from gear_damping.identification.runs import RunSet

ROUNDING = 0.01  # of a range's end: a stated speed or torque is rounded
LABEL, MEAN, SIZE = "damping_ratio_percent", "mean", "ac_rms"
Range = tuple[float, float]


@dataclass(frozen=True)
class TrainedOn:
    """The kind of record, and the ranges that the training runs covered.

    Args:
        system: `gear_pair` or `oscillator`; "" where a checkpoint does not say.
        channel: The response that it has seen.
        unit: Of that response.
        ranges: Lowest and highest value by name: `damping_ratio_percent`, `mean` and `ac_rms` of the response in its
            unit, and operating conditions in SI.
    """

    system: str = ""
    channel: str = ""
    unit: str = ""
    ranges: Mapping[str, Range] = field(default_factory=dict)

    @classmethod
    def of(cls, runs: RunSet, rows: Tensor) -> "TrainedOn":
        """What the runs numbered by `rows` cover."""
        numbers = rows.unique()
        signals = runs.signals[numbers]
        values = {
            LABEL: runs.damping_ratio_percent[numbers],
            MEAN: signals.double().mean(1),
            SIZE: ac_rms_of_runs(signals),
            **{name: series[numbers] for name, series in runs.quantities.items()},
        }
        ranges = {name: (float(found.min()), float(found.max())) for name, found in values.items()}
        return cls(runs.system, runs.channel, runs.unit, ranges)

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any] | None) -> "TrainedOn":
        """As a checkpoint holds it; one that holds nothing of it says nothing."""
        if plain is None:
            return cls()
        ranges = {name: (float(low), float(high)) for name, (low, high) in plain["ranges"].items()}
        return cls(plain["system"], plain["channel"], plain["unit"], ranges)

    def plain(self) -> dict[str, Any]:
        """As plain values."""
        ranges = {name: list(ends) for name, ends in self.ranges.items()}
        return {"system": self.system, "channel": self.channel, "unit": self.unit, "ranges": ranges}

    def problems(self, system: str, channel: str, unit: str) -> list[Problem]:
        """Why records of another kind cannot be asked about; empty where they can."""
        asked = {"system": (system, self.system), "channel": (channel, self.channel), "unit": (unit, self.unit)}
        return [
            Problem(name, f"the estimator was trained on {trained}, not on {found}", found, REMEDY[name])
            for name, (found, trained) in asked.items()
            if trained and found != trained
        ]

    def outside(self, values: Tensor, predicted: float, conditions: Mapping[str, float]) -> tuple[str, ...]:
        """Sentences about what lies outside the ranges that it was trained on.

        Args:
            values: Samples of the record, (time,).
            predicted: The damping ratio in % that it says.
            conditions: Operating conditions of the record, in SI.
        """
        values = values.double()
        sizes = {MEAN: float(values.mean()), SIZE: float(ac_rms_of_runs(values.unsqueeze(0))), LABEL: predicted}
        found = {**conditions, **sizes}
        return tuple(
            f"{name} is {found[name]:.4g} and was {low:.4g} to {high:.4g} in training"
            for name, (low, high) in self.ranges.items()
            if name in found and not _is_within(found[name], low, high)
        )


REMEDY = {
    "system": "train one on that system",
    "channel": "choose that channel as measurement.channel, or train on this one",
    "unit": "declare the channel in the unit that the simulator has",
}


def _is_within(value: float, low: float, high: float) -> bool:
    slack = ROUNDING * max(abs(low), abs(high))
    return low - slack <= value <= high + slack  # nan is not
