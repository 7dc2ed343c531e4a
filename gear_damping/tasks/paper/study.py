"""The study: trains what its figures rest on, keeps every finished part, writes figures, tables and numbers."""

import logging
from collections.abc import Mapping
from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.identification.compare import MEAN
from gear_damping.reporting import figures
from gear_damping.reporting.paper import drawn
from gear_damping.reporting.paper.page import NUMBERS, report
from gear_damping.reporting.paper.printed import EFFECTS
from gear_damping.reporting.paper.study import Study
from gear_damping.reporting.paper.tables import TABLES
from gear_damping.tasks.paper.cases import cases
from gear_damping.tasks.paper.kept import KeptParts, Part
from gear_damping.tasks.paper.learned import learn
from gear_damping.tasks.paper.physics import physics_of
from gear_damping.tasks.paper.prepared import Prepared, prepared
from gear_damping.tasks.progress import progress_bar
from gear_damping.tasks.run_folder import RunFolder

OF_THE_MACHINE = ("hydra.run.dir=", "data_folder=", "resume=", "progress=")  # how words begin that decide no number
log = logging.getLogger("gear_damping").info


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Repeat the figures and tables that are asked for; returns the metrics for run.json."""
    wanted = settings.figures or tuple(EFFECTS)
    ready = [prepared(case, settings) for case in cases(wanted)]
    _log_budget(settings, ready)
    kept = KeptParts(folder.path, settings.resume)
    physics = physics_of(settings)
    parts = _parts(ready, settings, kept)
    study = Study(parts, physics, _said(settings, folder))
    plain = study.plain()
    folder.write_json(NUMBERS, plain)
    for name in wanted:
        if name.startswith("figure"):
            figures.save(drawn.figure(name, study), folder.path / f"{name}.png")
        else:
            folder.write_text(f"{name}.md", TABLES[name](plain) + "\n")
    folder.write_text("paper.md", report(plain, wanted))
    return _metrics(plain)


def _parts(ready: list[Prepared], settings: Settings, kept: KeptParts) -> list[Part]:
    """Every training, made or found."""
    wanted = [(one, seed) for seed in settings.all_seeds for one in ready]
    parts = []
    with progress_bar("paper", settings.progress) as progress:
        for number, (one, seed) in enumerate(wanted, start=1):
            name = one.case.part(seed)
            part, old = kept.get(name, one.decided_by(seed), lambda fit, one=one, seed=seed: learn(one, seed, fit))
            parts.append(part)
            errors = ", ".join(f"{n} {s['rmse_percent']:.4g}" for n, s in part["scores"].items() if n != MEAN)
            log(f"{number} of {len(wanted)}: {name}{' (kept)' if old else ''}: RMSE / %: {errors}")
            progress(number, len(wanted))
    return parts


def _log_budget(settings: Settings, ready: list[Prepared]) -> None:
    """What the study is about to spend."""
    s, t = settings.simulator, settings.training
    log(
        f"{settings.name}: {len(ready)} trainings of two networks and a control, seeds {settings.all_seeds}, at most "
        f"{t['max_epochs']} epochs each; many runs: {s.n_runs} of {s.n_samples} samples, batch {t['batch_size']}, "
        f"patience {t['patience']}, {settings.protocol['windows_per_epoch']} windows an epoch; one run: batch and "
        "patience of the paper"
    )


def _said(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """What the numbers rest on, for the page."""
    s = settings.simulator
    return {
        "command": _command(folder.record["command"]),
        "git": folder.record["git"],
        "versions": folder.record["versions"],
        "seeds": settings.all_seeds,
        "training": settings.training,
        "windows_per_epoch": settings.protocol["windows_per_epoch"],
        "evaluation_stride": settings.protocol["evaluation_stride"],
        "n_runs": s.n_runs,
        "n_samples": s.n_samples,
    }


def _command(typed: str) -> str:
    """The command without the places of this machine."""
    words = (word.replace("++", "") for word in typed.split())
    return " ".join(word for word in words if not word.startswith(OF_THE_MACHINE))


def _metrics(found: Mapping[str, Any]) -> dict[str, Any]:
    """RMSE in % by effect, protocol and estimator."""
    return {
        f"{effect}/{protocol}/{name}": scores["rmse_percent"]["mean"]
        for effect, protocols in found["learned"].items()
        for protocol, each in protocols.items()
        for name, scores in each["scores"].items()
    }
