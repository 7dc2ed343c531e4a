"""What users hand over in Python, checked at the door: one message names the argument, the rule and the remedy."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from math import inf, isfinite
from numbers import Number as AnyNumber
from numbers import Real as AnyReal
from os import PathLike
from pathlib import Path
from typing import Any, get_args

import numpy as np
import torch

from gear_damping.at_home import at_home
from gear_damping.errors import InputError, Problem, with_article
from gear_damping.explanation.explain import Listener
from gear_damping.measurement.files import as_a_file
from gear_damping.measurement.record import Measurement
from gear_damping.physics.model import Model
from gear_damping.schema.values import Flag, Given, Number, OneOf, Problems, Value
from gear_damping.simulation.solver_settings import Engine, Solver

COUNT = Number(1, whole=True)  # of what there has to be one at least
SEED = Number(0, 2**63 - 1, whole=True)  # what a generator of 64 bits takes
SOLVER = {
    "accuracy": Number(0, 1, exclusive=True),
    "substeps": Given(COUNT, optional=True),
    "engine": OneOf(get_args(Engine)),
    "acceleration": Flag(),
    **dict.fromkeys(("most_substeps", "chunk", "block"), COUNT),
}


def refuse_other(measurement: object) -> None:
    """Refuse what is no measurement, as the path of one.

    Raises:
        InputError: it is not what `load` gives.
    """
    if not isinstance(measurement, Measurement):
        shown = measurement if isinstance(measurement, str) else type(measurement).__name__
        rule, remedy = "must be a measurement", "give what gd.load('measurement.yaml') returns"
        remedy = "; ".join(filter(None, [remedy, as_a_file(measurement)]))
        raise InputError(Problem("measurement", rule, shown, remedy))


def refuse_other_kind(name: str, value: object, kind: type, example: str) -> None:
    """Refuse an argument of another kind; None stands for what is usual.

    Raises:
        InputError: it is one.
    """
    if value is not None:
        require_kind(name, value, kind, example)


def require_kind(name: str, value: object, kind: type, example: str) -> None:
    """The same, None refused too.

    Raises:
        InputError: it is of another kind.
    """
    if not isinstance(value, kind):
        raise InputError(
            Problem(name, f"must be {with_article(kind.__name__)}", repr(value), f"for example {name}={example}")
        )


def refuse_no_model(model: object, kind: type[Model] = Model) -> None:
    """Refuse what is no model, as a bare system or a list of models.

    Raises:
        InputError: it is none.
    """
    if not isinstance(model, kind):
        remedy = "give a gd.Model, for example gd.Model(gd.Oscillator(), [gd.ViscousDamping()])"
        raise InputError(Problem("model", "is no model: a system with its effects", repr(model), remedy))


def refuse_other_solver(solver: object) -> None:
    """Refuse what is no `Solver`, as the name of a method, and one with settings that nothing can be solved with.

    Raises:
        InputError: it is none.
    """
    refuse_other_kind("solver", solver, Solver, "gd.Solver(substeps=4)")
    problems = Problems()
    for name, kind in SOLVER.items() if isinstance(solver, Solver) else ():
        problems += wrong_values(f"solver.{name}", getattr(solver, name), kind)
    problems.raise_any()
    if isinstance(solver, Solver):
        refuse_other_call("solver.progress", solver.progress)


def wrong_values(key: str, value: object, kind: Value) -> list[Problem]:
    """What a kind of values says of one; nothing where it is of the kind.

    Args:
        key: Its key.
        value: As it was given.
        kind: What it has to be.
    """
    try:
        kind.read(value, key.rpartition(".")[2])
    except InputError as error:
        return [replace(problem, key=key) for problem in error.problems]
    return []


def refuse_other_call(name: str, value: object) -> None:
    """Refuse what cannot be told anything; None stands for nobody.

    Raises:
        InputError: it cannot be called.
    """
    if value is not None and not callable(value):
        raise InputError(Problem(name, "must be a function, which is told", value, f"for example {name}=print"))


def refuse_other_listener(listener: object) -> None:
    """Refuse what is no `Listener`, as a bare function, and one that cannot be told anything.

    Raises:
        InputError: it is none.
    """
    refuse_other_kind("listener", listener, Listener, "gd.Listener(print)")
    for one in fields(Listener) if listener is not None else ():
        refuse_other_call(f"listener.{one.name}", getattr(listener, one.name))


def refuse_other_name(argument: str, given: object, example: str) -> None:
    """Refuse what is no name; None stands for what is usual.

    Raises:
        InputError: it is none.
    """
    if given is not None and not (isinstance(given, str) and given):
        raise InputError(Problem(argument, "must be a name", given, f"for example {argument}='{example}'"))


def refuse_no_flag(name: str, value: object) -> None:
    """Refuse what is neither true nor false, as a text, which Python would take for true.

    Raises:
        InputError: it is none.
    """
    if not isinstance(plain(value), bool):
        raise InputError(Problem(name, "must be True or False", value, f"write {name}=True or {name}=False"))


def refuse_no_level(name: str, value: object) -> None:
    """Refuse what is no single level of a noise.

    Raises:
        InputError: it is several, no number, or no finite one.
    """
    own, remedy = plain(value), f"ask once for each, for example {name}=30"
    if isinstance(own, bool | str) or own is None:
        raise InputError(Problem(name, "must be a number in dB", own, f"for example {name}=30"))
    if not isinstance(own, AnyReal):
        raise InputError(Problem(name, "is one level", repr(own), remedy))
    if not isfinite(own):
        rule = "must be finite, in dB: of no noise, or of one without end, nothing is worked out"
        raise InputError(Problem(name, rule, own, f"for example {name}=30"))


def file_path(argument: str, given: Any, what: str) -> Path:
    """A path that was handed over, with the home that it begins at.

    Args:
        argument: Its name, for messages.
        given: What was handed over.
        what: Of what it is the path, for messages.

    Raises:
        InputError: it is no path.
    """
    if not isinstance(given, str | PathLike) or not str(given):
        raise InputError(Problem(argument, "must be a path", given, f"give the path of {what}"))
    return at_home(given)


def plain(value: Any) -> Any:
    """A number of numpy as one of Python; anything else as it is."""
    return value.item() if isinstance(value, np.generic) else value


def names(argument: str, given: str | Iterable[str] | None) -> tuple[str, ...]:
    """Names as a sequence, empty for None; one that stands alone is one name, not its letters.

    Raises:
        InputError: they are no names, come with values, or one is there twice.
    """
    if isinstance(given, Mapping):
        remedy = f"write {argument}={list(given)}, and give the model the values"
        raise InputError(Problem(argument, "holds names alone, and values of them are not looked at", remedy=remedy))
    given = () if given is None else given
    found = (given,) if isinstance(given, str) or not isinstance(given, Iterable) else tuple(given)
    if wrong := [one for one in found if not isinstance(one, str)]:
        raise InputError(Problem(argument, "must be names", wrong[0], f"write {argument}=[…] with the name of each"))
    if len(set(found)) < len(found):
        raise InputError(Problem(argument, "names one twice", list(found), "name it once"))
    return found


def numbers(name: str, value: Any, unit: str = "SI") -> torch.Tensor:
    """Real numbers as a tensor of 64 bits that nothing else writes to, of the shape of what was given.

    Args:
        name: Of the argument, for messages.
        value: A number, a sequence, an array or a tensor.
        unit: That is expected, for messages.

    Raises:
        InputError: it holds something else, as a text or complex numbers.
    """
    given = value.detach().cpu() if isinstance(value, torch.Tensor) else value
    remedy, shown = f"give real numbers in {unit}", value if isinstance(value, str | AnyNumber) else None
    try:
        array = np.asarray(given)
        real = None if array.dtype.kind == "c" else np.array(array, dtype=float)
        if array.dtype.kind in "USO" and any(isinstance(one, str | bytes | None) for one in array.flat):
            raise TypeError
    except (TypeError, ValueError):
        raise InputError(Problem(name, "must hold numbers alone", shown, remedy)) from None
    if real is None:
        raise InputError(Problem(name, "must be real, and is complex", shown, remedy))
    return torch.from_numpy(real)


def of_every_run(name: str, value: torch.Tensor, batch: int) -> list[Problem]:
    """What is wrong with the shape of one number, or of one for each of `batch` runs."""
    if value.shape in ((), (1,), (batch,)):
        return []
    held = "x".join(str(n) for n in value.shape)
    many = f"one number or {batch}, one for each run" if batch > 1 else "one number"
    return [Problem(name, f"must be {many}, and holds {held}", remedy="batch= says how many runs there are")]


def levels(name: str, given: Any) -> tuple[float, ...]:
    """One level or several, in dB; infinity stands for no noise.

    Raises:
        InputError: it is neither.
    """
    remedy = f"for example {name}=30 or {name}=[30, 20]"
    found = numbers(name, [given] if isinstance(given, str) or not isinstance(given, Sequence) else given, "dB")
    if not found.numel():
        raise InputError(Problem(name, "names no level", given, remedy))
    if bool(found.isnan().any()) or bool((found == -inf).any()):
        raise InputError(Problem(name, "must be levels in dB", given, remedy))
    return tuple(found.flatten().tolist())
