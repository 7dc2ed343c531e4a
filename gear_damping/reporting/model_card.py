"""The card that goes with a shared network: what it is for, how good it is, when it refuses, how to use it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from gear_damping.identification.controls import NO_BETTER
from gear_damping.identification.trained_on import LABEL, MEAN, ROUNDING, SIZE, TrainedOn
from gear_damping.reporting.numbers import NOTHING, number, percent, pretty_unit
from gear_damping.reporting.tables import markdown

_RANGES = {LABEL: ("damping ratio", "% of critical"), MEAN: ("mean of the record", ""),
           SIZE: ("root mean square about the mean", ""), "pinion_speed": ("pinion speed", "rad/s"),
           "pinion_torque": ("pinion torque", "N*m")}  # fmt: skip
_HEAD = """---
license: mit
library_name: gear_damping
tags: [vibration, damping, gears, system-identification]
---
"""
_USE = """```python
import gear_damping as gd

estimator = gd.load_estimator("FOLDER")  # with model.safetensors and model.json
print(estimator.predict(gd.load("measurement.yaml")))
```
or `python -m gear_damping task=identify measurement.path=measurement.yaml checkpoint=FOLDER`"""


@dataclass(frozen=True)
class Scored:
    """One row of the figures.

    Args:
        name: Of the estimator.
        rmse: Root mean square error in % of critical.
        interval95: Of it, over runs; None for one run.
        median_relative_error: A share.
        skill: 1 - MSE / MSE of the mean predictor; None where there is none.
    """

    name: str
    rmse: float
    interval95: Sequence[float] | None
    median_relative_error: float | None
    skill: float | None


@dataclass(frozen=True)
class CardFacts:
    """What the run says of a network that its files do not hold.

    Args:
        trained: Rows of the table of the training: what, and how much.
        tested: Which runs the figures are of, as a sentence.
        is_unseen: Whether these runs were not trained on.
        scored: The network, then its controls; the last one heard white noise.
        origin: Rows of the table of the origin: command, revision, versions.
    """

    trained: Mapping[str, str] = field(default_factory=dict)
    tested: str = ""
    is_unseen: bool = True
    scored: Sequence[Scored] = ()
    origin: Mapping[str, str] = field(default_factory=dict)


def model_card(description: Mapping[str, Any], states_interval: bool, facts: CardFacts = CardFacts()) -> str:
    """The card as Markdown.

    Args:
        description: The content of model.json.
        states_interval: Whether the network says how sure it is.
        facts: Of the run that trained it; without them the card says that there are none.
    """
    seen = TrainedOn.from_plain(description["data"]["trained_on"])
    parts = {
        "What it was trained on": _trained(description, seen, facts),
        "How good it is": _figures(facts),
        "When it refuses and when it warns": _refusals(description, seen),
        "How to use it": _USE,
        "Limits": _limits(states_interval),
        "Where it comes from": markdown(("", ""), facts.origin.items()) if facts.origin else "Not noted.",
        "Licence": "MIT, as that of gear_damping, whose simulated runs are all that it has seen.",
    }
    system = f" of a {seen.system.replace('_', ' ')}" if seen.system else ""
    title = f"# {description['estimator']}: damping ratio{system}"
    what = f"A network that reads {_read(description, seen)} and says the damping ratio in % of critical."
    return f"{_HEAD}\n{title}\n\n{what}\n" + "".join(f"\n## {name}\n\n{text}\n" for name, text in parts.items())


def _read(description: Mapping[str, Any], seen: TrainedOn) -> str:
    """What it looks at."""
    data = description["data"]
    window, rate = data["window"], data["sampling_rate"]
    length = f"{window} samples ({number(1e3 * window / rate)} ms)"
    return f"{length} of `{seen.channel or 'one channel'}` at {rate:g} Hz"


def _trained(description: Mapping[str, Any], seen: TrainedOn, facts: CardFacts) -> str:
    data, wavelet = description["data"], description["wavelet"]
    rows = {
        "system": f"`{seen.system}`",
        "channel": f"`{seen.channel}` in {pretty_unit(seen.unit)}",
        "sampling rate": f"{data['sampling_rate']:g} Hz",
        "sees at once": f"{data['window']} samples",
        **({"wavelet": _said(wavelet)} if wavelet else {}),
        "settings": _said(description["settings"] or {}),
        **facts.trained,
    }
    ranges = [_range(name, low, high, seen.unit) for name, (low, high) in seen.ranges.items()]
    inside = "It has seen these ranges, and simulated runs only:"
    return f"{markdown(('', ''), rows.items())}\n\n{inside}\n\n{markdown(('quantity', 'from', 'to', 'unit'), ranges)}"


def _said(settings: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} {value:g}" if isinstance(value, float) else f"{name} {value}"
                     for name, value in settings.items()) or NOTHING  # fmt: skip


def _range(name: str, low: float, high: float, unit: str) -> tuple[str, ...]:
    words, own = _RANGES.get(name, (name.replace("_", " "), "SI"))
    return words, number(low), number(high), pretty_unit(own or unit)


def _figures(facts: CardFacts) -> str:
    if not facts.scored:
        return "Not known here: `task=evaluate` asks it about fresh runs, beside the bound and the controls."
    head = ("estimator", "RMSE / % of critical", "95 % interval", "median rel. error", "skill")
    table = markdown(head, [_row(one) for one in facts.scored])
    return f"{facts.tested}\n\n{table}\n\n{_verdict(facts)}"


def _row(one: Scored) -> tuple[str, ...]:
    interval = NOTHING if one.interval95 is None else " … ".join(map(number, one.interval95))
    skill = NOTHING if one.skill is None else f"{round(one.skill, 3) + 0.0:.3f}"
    return one.name, number(one.rmse), interval, percent(one.median_relative_error), skill


def _verdict(facts: CardFacts) -> str:
    """What the controls say of it."""
    own, blind = facts.scored[0], facts.scored[-1]
    if not facts.is_unseen:
        return "**These figures say how well runs are remembered, not how well damping is identified.**"
    if own.rmse > NO_BETTER * blind.rmse:
        return "**It is no better than a network that was fed white noise: its answers say nothing about damping.**"
    return (
        f"Its error is {number(own.rmse / blind.rmse, 3)} of that of the same network fed white noise. Intervals are "
        "of the error over runs, by the bootstrap; skill is 1 - MSE / MSE of always saying the mean label."
    )


def _refusals(description: Mapping[str, Any], seen: TrainedOn) -> str:
    data = description["data"]
    return (
        f"Refused with a message: another system than `{seen.system}`, another channel than `{seen.channel}`, another "
        f"unit than {pretty_unit(seen.unit)}, another rate than {data['sampling_rate']:g} Hz (by more than 0.1 %), "
        f"fewer than {data['window']} samples, samples that are not finite.\n\n"
        "Answered with a warning (`outside` of a prediction, `outside_training` in `identification.json`): a mean, "
        "size, stated speed or torque, or a predicted ratio outside the ranges above (by more than "
        f"{percent(ROUNDING)} of the larger end). Then it is a guess.\n\n"
        "Refused too: files that are damaged, or of two networks (the SHA-256 of the weights is in `model.json`)."
    )


def _limits(states_interval: bool) -> str:
    sure = (
        "Its 95 % interval has the width that held the validation runs: on other rigs it may hold fewer."
        if states_interval
        else "The deviation over windows is no interval of confidence."
    )
    return (
        "It holds for gears like those that it was trained on, as the simulator has them, and was held against no "
        "measured record in its training. What a rig does that the simulator does not, it takes for damping. "
        f"{sure}"
    )
