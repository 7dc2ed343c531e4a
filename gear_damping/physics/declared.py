"""What systems and effects have in common: options and parameters that are declared, and chosen by name."""

from collections.abc import Mapping, Sequence
from inspect import Parameter as Argument
from inspect import Signature
from math import isfinite
from typing import Any, ClassVar

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.parameter import Option, Parameter

Given = dict[str, float | tuple[float, ...]]


class Declared:
    """Something with a name, options and parameters; two of them are equal where all of that is.

    `chosen` holds every option, `given` those parameters that were given, in SI. They are fixed once it is made.
    """

    chosen: dict[str, Any]
    given: Given

    name: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    options: ClassVar[tuple[Option, ...]] = ()
    meant: ClassVar[Mapping[str, str]] = {}  # remedies for what people write instead of a parameter, by that name

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Give every final class the signature of its options and parameters."""
        super().__init_subclass__(**kwargs)
        known = [*getattr(cls, "parameters", ()), *cls.options]
        own = [Argument(one.name, Argument.KEYWORD_ONLY, default=one.default) for one in known]
        cls.__signature__ = Signature(own)

    def __init__(self, *by_place: Any, **given: Any) -> None:
        """Choose options and parameters by name.

        Args:
            by_place: Values without a name, which are refused.
            given: Options, and parameters in SI: numbers, or sequences of numbers for a list.

        Raises:
            InputError: everything that is wrong: values without a name, unknown names, values out of range.
        """
        options = {option.name: option for option in self.options}
        declared = {parameter.name: parameter for parameter in self.parameters}
        known = [*options, *declared]
        if by_place:
            named = ", ".join(f"{name}=…" for name in (*declared, *options)) or "nothing"
            rule, remedy = "takes its values by name", f"write {type(self).__name__}(…) with some of {named}"
            raise InputError(Problem(self.name, rule, by_place[0], remedy))
        problems = [
            Problem(self._key(name), "no such parameter or option", remedy=self._remedy(name, known))
            for name in given
            if name not in known
        ]
        chosen = {name: given.get(name, option.default) for name, option in options.items()}
        problems += [p for name, value in chosen.items() if (p := options[name].problem(value, self._key(name)))]
        vars(self).update(chosen=chosen)
        told = declared if problems else {name: self._told(one) for name, one in declared.items() if name in given}
        values: Given = {}
        for name in (name for name in declared if name in given):
            found = _numbers(given[name], told[name], self._key(name))
            problems += [found] if isinstance(found, Problem) else []
            values[name] = found
        vars(self).update(given=values)
        if problems:
            raise InputError(problems)

    def _told(self, parameter: Parameter) -> Parameter:
        """A parameter with the unit in which messages tell it; its options are chosen by then."""
        return parameter

    def _key(self, name: str) -> str:
        return f"{self.name}.{name}"

    def _remedy(self, name: str, known: Sequence[str]) -> str:
        """What helps where there is nothing of this name."""
        return self.meant.get(name) or (nearest(name, known) if known else "")

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse a new value, which models that hold this would not follow.

        A class of one's own may hold more: what its own __init__ makes, and what begins with _.

        Raises:
            InputError: says how another one is made.
        """
        known = [one.name for one in (*self.options, *self.parameters)]
        is_own = name.startswith("_") or type(self).__init__ is not Declared.__init__
        if is_own and name not in (*known, "chosen", "given"):
            super().__setattr__(name, value)
            return
        if name in known:
            rule = "cannot be set: its values are fixed once it is made"
            remedy = f"make another one, {self._written(self.given | self.chosen | {name: value})}, and a model of it"
        else:
            rule, how = "no such parameter or option", f"values are given where it is made, {type(self).__name__}(…)"
            remedy = f"{nearest(name, known)}; {how}" if known else how
        raise InputError(Problem(f"{self.name}.{name}", rule, value, remedy))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Declared):
            return NotImplemented
        return type(self) is type(other) and (self.chosen, self.given) == (other.chosen, other.given)

    def __hash__(self) -> int:
        return hash((type(self), tuple(sorted(self.chosen.items())), tuple(sorted(self.given.items()))))

    def __repr__(self) -> str:
        return self._written(self.given | self.chosen)

    def _written(self, values: Mapping[str, Any]) -> str:
        """How it is made with these values; options that are as usual are left out."""
        usual = {option.name: option.default for option in self.options}
        other = {name: value for name, value in values.items() if name not in usual or value != usual[name]}
        return f"{type(self).__name__}({', '.join(f'{name}={_plain(value)}' for name, value in other.items())})"


def _numbers(value: Any, parameter: Parameter, key: str) -> float | tuple[float, ...] | Problem:
    """The value of a parameter, or what is wrong with it."""
    listed = list(value) if parameter.vector and hasattr(value, "__iter__") and not isinstance(value, str) else [value]
    try:
        numbers = [float(one) for one in listed if not isinstance(one, bool | str)]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) < len(listed) or not numbers or not all(map(isfinite, numbers)):
        what = "numbers" if parameter.vector else "number"
        rule = f"must be {'finite' if parameter.vector else 'a finite'} {what} in {parameter.unit}"
        is_lost = bool(numbers) and not all(map(isfinite, numbers))
        return Problem(key, rule, value, "leave it out where it is not known" if is_lost else "give it in SI")
    wrong = (parameter.problem(number, key) for number in numbers)
    problem = next((one for one in wrong if one), None)
    return problem or (tuple(numbers) if parameter.vector else numbers[0])


def _plain(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else repr(value)
