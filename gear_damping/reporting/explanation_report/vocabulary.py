"""Effects in words, taken from their declarations."""

from collections.abc import Mapping, Sequence
from typing import Any

from gear_damping.physics.catalogue import builtin_effects
from gear_damping.reporting.numbers import number
from gear_damping.reporting.page.render import words


def description(name: str, own: Mapping[str, str]) -> str:
    """One sentence about an effect: from `own`, else from its declaration; empty for an unknown one."""
    if name in own:
        return own[name]
    effect = builtin_effects().get(name)
    return (effect.__doc__ or "").strip().partition("\n")[0] if effect else ""


def equation(name: str) -> str:
    """The term that an effect adds; empty for an unknown one."""
    effect = builtin_effects().get(name)
    return effect.equation if effect else ""


def meaning(name: str, parameter: str) -> str:
    """What a parameter of an effect means; an element of a list (`values[3]`) means what the list does."""
    effect = builtin_effects().get(name)
    plain = parameter.partition("[")[0].removeprefix(f"{name}.")
    declared = (*effect.parameters, *effect.options) if effect else ()
    return next((one.meaning for one in declared if one.name == plain), "")


def form_of(cause: Mapping[str, Any]) -> dict[str, str]:
    """What was tried of a cause and not fitted, as text by name: its form (whose tooth), and values but for zeros."""
    form = {name: value for name, value in (cause.get("options") or {}).items() if isinstance(value, str)}
    return form | {name: number(value) for name, value in (cause.get("fixed") or {}).items() if value}


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names as they stand in a sentence: a, b and c."""
    names = [words(name) for name in names]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}" if names else ""
