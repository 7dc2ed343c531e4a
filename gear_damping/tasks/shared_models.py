"""The trained networks of a run as files for sharing, each with its card."""

from collections.abc import Iterator, Mapping
from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.identification.network_files import CHECKPOINT
from gear_damping.identification.saved import description_of, load_estimator, write_shared
from gear_damping.reporting.model_card import CardFacts, Scored, model_card
from gear_damping.tasks.run_folder import RunFolder

CARD = "model_card.md"


def share_models(settings: Settings, results: Mapping[str, Any], folder: RunFolder) -> None:
    """Write `model.safetensors`, `model.json` and the card beside the best checkpoint of every network.

    Args:
        settings: Of the run.
        results: The content of results.json.
        folder: Of the run.
    """
    for name in results["models"]:
        for row, seed in enumerate(results["seeds"]):
            place = f"{name}/seed_{seed}"
            module = load_estimator(folder.path / place / CHECKPOINT, settings.model.plugins)
            write_shared(module, folder.path / place)
            facts = CardFacts(
                trained=_trained(settings, results, seed),
                tested=_tested(settings),
                is_unseen=settings.protocol["name"] == "by_run",
                scored=tuple(_scored(results, name, row)),
                origin=_origin(folder.record),
            )
            card = model_card(description_of(module), module.network.is_likelihood, facts)
            folder.write_text(f"{place}/{CARD}", card)


def _trained(settings: Settings, results: Mapping[str, Any], seed: int) -> dict[str, str]:
    """What the network learned from."""
    simulator, training = settings.simulator, settings.training
    noise = training["noise_snr_db"] or simulator.sensor_noise_db
    levels = noise if isinstance(noise, (list, tuple)) else [noise]
    return {
        "experiment": settings.name,
        "simulated runs": f"{results['n_runs']} of {simulator.n_samples} samples, before some are kept for tests",
        "effects": ", ".join(effect.name for effect in simulator.model.effects),
        "family": f"{simulator.family.name}: draws {', '.join(simulator.family.distributions) or 'nothing'}",
        "sensor noise": "none" if noise is None else " to ".join(f"{one:g}" for one in levels) + " dB below the signal",
        "seed": str(seed),
    }


def _tested(settings: Settings) -> str:
    """Which runs the figures are of."""
    protocol = settings.protocol["name"]
    if protocol != "by_run":
        return f"The last part by time of the very runs that it was trained on (`protocol={protocol}`):"
    ratio = settings.simulator.damping_ratio_percent
    where = "" if ratio is None else f", all of {ratio:g} % of critical"
    return f"On simulated runs that it never met, of the same family{where}, beside two controls:"


def _scored(results: Mapping[str, Any], name: str, row: int) -> Iterator[Scored]:
    """The network and its controls, of one seed."""
    found = {name: results["models"][name]} | {f"{n} (control)": one for n, one in results["controls"].items()}
    for label, one in found.items():
        own = {key: values[row] for key, values in one["per_seed"].items()}
        scores = own["rmse_percent"], own["rmse_interval95"], own["median_relative_error"], own["skill"]
        yield Scored(label, *scores)


def _origin(record: Mapping[str, Any]) -> dict[str, str]:
    """The command and the program."""
    git, versions = record["git"], record["versions"]
    changed = " with changes" if git["dirty"] else ""
    return {
        "command": f"`{record['command']}`",
        "begun": record["started"],
        "git revision": f"{git['revision']}{changed}" if git["revision"] else "not known: no git checkout",
        "versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
    }
