"""All that a study found: its trainings by effect and protocol, with mean and standard deviation over seeds."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import fmean, stdev
from typing import Any

from gear_damping.reporting.paper.physics import Physics
from gear_damping.reporting.paper.printed import CWT, RAW, RMSE

NETWORKS = (RAW, CWT)
BLIND, MEAN = "white_noise", "mean"  # the controls
PROTOCOLS = ("paper", "paper_many_runs", "by_run")
SCORES = ("rmse_percent", "rmse_paper", "rmse_percent_per_run", "median_relative_error", "skill", "epochs")

Part = Mapping[str, Any]


@dataclass(frozen=True)
class MeanAndStd:
    """A score over seeds: mean, standard deviation (0 of one seed) and the values."""

    mean: float
    std: float
    values: tuple[float, ...]

    @classmethod
    def over(cls, values: Sequence[float]) -> "MeanAndStd":
        """Of these values, at least one."""
        return cls(fmean(values), stdev(values) if len(values) > 1 else 0.0, tuple(values))


@dataclass(frozen=True, eq=False)
class Study:
    """What figures, tables and the page are made from.

    Args:
        parts: One a training, as `tasks.paper.learned.learn` returns it; errors in % of critical.
        physics: What needs no network.
        said: Command, seeds, budget and versions.
    """

    parts: Sequence[Part]
    physics: Physics
    said: Mapping[str, Any]

    def of(self, effect: str, protocol: str) -> list[Part]:
        """The trainings of an effect under a protocol, one a seed; none where it was not asked for."""
        found = [part for part in self.parts if part["effect"] == effect and part["protocol"] == protocol]
        return sorted(found, key=lambda part: part["seed"])

    def score(self, effect: str, protocol: str, name: str, which: str = "rmse_percent") -> MeanAndStd | None:
        """A score of a network or control over seeds; None where it is not defined."""
        values = [part["scores"][name].get(which) for part in self.of(effect, protocol)]
        return None if not values or None in values else MeanAndStd.over(values)

    def of_ratio(self, ratio_percent: float, name: str, which: str) -> MeanAndStd | None:
        """A number of networks that were trained by run, on fresh runs of one ratio (%)."""
        parts = [part for part in self.of("baseline", "by_run") if part.get("by_ratio")]
        values = [part["by_ratio"][f"{ratio_percent:g}"][name][which] for part in parts]
        return MeanAndStd.over(values) if values else None

    @property
    def cpu_minutes(self) -> float:
        """Processor time of all trainings, whenever they were made."""
        return sum(part["cpu_s"] for part in self.parts) / 60

    @property
    def revisions(self) -> list[str]:
        """The revisions that the trainings were made with."""
        return sorted({str(part["git"]["revision"]) for part in self.parts})

    def plain(self) -> dict[str, Any]:
        """Everything but the single predictions, for JSON; these stay in the parts."""
        keys = dict.fromkeys((part["effect"], part["protocol"]) for part in self.parts)
        learned: dict[str, dict[str, Any]] = {}
        for effect, protocol in keys:
            learned.setdefault(effect, {})[protocol] = self._plain(effect, protocol)
        printed = {name: {RAW: one.raw_lstm, CWT: one.cwt_lstm} for name, one in RMSE.items()}
        found = {"settings": self.said, "printed": printed, "physics": self.physics.plain(), "learned": learned}
        return found | {"cpu_minutes": self.cpu_minutes, "revisions": self.revisions}

    def _plain(self, effect: str, protocol: str) -> dict[str, Any]:
        parts = self.of(effect, protocol)
        found: dict[str, Any] = {"seeds": [part["seed"] for part in parts], "n_runs": parts[0]["n_runs"], "scores": {}}
        for name in (*NETWORKS, BLIND, MEAN):
            scores = {which: self.score(effect, protocol, name, which) for which in SCORES}
            found["scores"][name] = {which: None if one is None else asdict(one) for which, one in scores.items()}
        if parts[0].get("by_ratio"):
            found["by_ratio"] = [part["by_ratio"] for part in parts]
        return found
