"""What a sweep leaves: one table and one figure over all its jobs, also where some of them failed."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig

from gear_damping.config.command_line import swept_keys
from gear_damping.tasks.run_folder import FINISHED

current: list[tuple[Path, list[str]]] = []  # the sweep of this process: folder and swept keys


class SweepSummary(Callback):
    """Tells where the sweep of this process lies, for the summary at its end."""

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Remember folder and swept keys."""
        current.append((Path(config.hydra.sweep.dir), swept_keys(config.hydra.overrides.task)))


def summarise(folder: Path, keys: Sequence[str]) -> int:
    """Write sweep.csv and sweep.png; returns how many jobs did not finish."""
    from gear_damping.reporting import figures, tables  # here, since every command imports this file

    rows = [_row(path, keys) for path in sorted(folder.glob("*/run.json"), key=_number)]
    if not rows:
        return 0
    tables.write_csv(rows, folder / "sweep.csv")
    finished = [row for row in rows if row["status"] == FINISHED]
    if finished and keys:
        figures.save(figures.sweep_figure(finished, keys[0]), folder / "sweep.png")
    return len(rows) - len(finished)


def _number(path: Path) -> tuple[int, str]:
    name = path.parent.name
    return (int(name) if name.isdigit() else 10**9, name)


def _row(path: Path, keys: Sequence[str]) -> dict[str, Any]:
    record = json.loads(path.read_text())
    row = {"job": path.parent.name, "status": record["status"]}
    choices = record["choices"]
    row |= {key: choices[key] if key in choices else _lookup(record["config"], key) for key in keys}
    results = path.parent / "results.json"
    if record["status"] == FINISHED and results.exists():
        found = json.loads(results.read_text())
        for name, scores in {**found["models"], **found["controls"]}.items():
            row[f"{name}/rmse_percent"] = scores["rmse_percent"]["mean"]
            row[f"{name}/rmse_percent_std"] = scores["rmse_percent"]["std"]
            row[f"{name}/skill"] = scores["skill"]
    row["error"] = record.get("error", "")
    return row


def _lookup(config: Any, key: str) -> Any:
    for part in key.split("."):
        config = config.get(part) if isinstance(config, dict) else None
    return config
