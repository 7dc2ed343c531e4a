"""The `simulator` and `family` nodes: checked against the declarations of systems and effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from gear_damping.config.decided import decided_in_one_file
from gear_damping.config.extended import with_extended
from gear_damping.config.keys import without_group
from gear_damping.config.prior import OTHER_FAMILY, read_prior
from gear_damping.config.quantities import split_suffix
from gear_damping.config.reader import Reader
from gear_damping.config.source import COMMAND_LINE, Origin
from gear_damping.errors import InputError, Problem, nearest, with_article
from gear_damping.physics.catalogue import catalogue, system_catalogue
from gear_damping.physics.model import Model
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.known import SYSTEMS
from gear_damping.physics.terms import DampingLaw, Effect, MeshStiffness
from gear_damping.schema.values import Given, Number, OneOf, Text
from gear_damping.simulation.prior import Prior
from gear_damping.simulation.sampling import N_SAMPLES, SAMPLING_RATE
from gear_damping.simulation.solver_settings import Engine, Solver

PLAIN = {
    "system": OneOf(tuple(SYSTEMS)),
    "n_runs": Number(1, 10_000_000, whole=True),
    "n_samples": N_SAMPLES,
    "damping_law": Given(Text(), optional=True),
    "damping_ratio_percent": Given(Number(0, 50), optional=True),
    "diverged_share": Number(0, 1, unit="1"),
    "extended": Given(Text(), optional=True),
}
SOLVER = {
    "accuracy": Number(1e-10, 0.1),
    "substeps": Given(Number(1, 10_000, whole=True), optional=True),
    "engine": OneOf(get_args(Engine)),
    "chunk": Number(1, 10_000_000, whole=True),
}
OTHER_GROUP = "choose the group that brings its own: simulator=oscillator family=none, or simulator=gear_pair"
_LONG = "write simulator.n_samples, the duration times simulator.sampling_rate"
_NOISE = "write simulator.sensor_noise.snr_db=30, or simulator.load_noise.snr_db=30"
MEANT = {  # what people write in the place of a key, and no key is like it
    **dict.fromkeys(("duration", "length", "time", "t_end", "seconds"), _LONG),
    **dict.fromkeys(("fs", "rate", "sample_rate"), "write simulator.sampling_rate=40kHz"),
    **dict.fromkeys(("dt", "time_step"), "write simulator.sampling_rate=40kHz, one over it"),
    **dict.fromkeys(("noise", "snr", "snr_db"), _NOISE),
    **dict.fromkeys(("runs", "batch"), "write simulator.n_runs"),
}
HOW = (*(name for name in PLAIN if name != "system"), "solver", "plugins")  # keys that say how to simulate
SENSOR_NOISE, UNIT = "sensor_noise", "unit"  # an effect; the option of a rig that says what it is measured in


@dataclass(frozen=True)
class SimulatorSettings:
    """What the simulator is told, in SI.

    Args:
        model: Base system and effects.
        given: Parameters that were given, by flat name.
        family: What varies between runs.
        sampling_rate: Hz.
        n_samples: Samples of a run.
        n_runs: Runs of a data set.
        damping_law: The effect that carries the damping ratio, or None.
        damping_ratio_percent: The ratio of the test runs, or None where it is drawn.
        diverged_share: Tolerated share of diverged runs.
        solver: Settings of the solver.
        plugins: The user's own files of effects and systems.
        extended: The file of an extended simulator that the model came from, or None.
    """

    model: Model
    given: dict[str, float | tuple[float, ...]]
    family: Prior
    sampling_rate: float
    n_samples: int
    n_runs: int
    damping_law: str | None
    damping_ratio_percent: float | None
    diverged_share: float
    solver: Solver
    plugins: tuple[str, ...]
    extended: str | None

    @property
    def sensor_noise_db(self) -> float | None:
        """The signal-to-noise ratio of the sensor in dB, or None without sensor noise."""
        declared = self.model.parameters().get(f"{SENSOR_NOISE}.snr_db")
        return None if declared is None else float(self.given.get(f"{SENSOR_NOISE}.snr_db", declared.default))

    @property
    def files(self) -> list[Path]:
        """The user's files that decide what is simulated."""
        return [Path(path) for path in (*self.plugins, *([self.extended] if self.extended else []))]


def read_simulator(node: Mapping[str, Any], family: Mapping[str, Any], origin: Origin) -> SimulatorSettings:
    """The settings of the two nodes.

    Raises:
        InputError: everything that is wrong with them.
    """
    reader = Reader(origin)
    merged = reader.collect(lambda: with_extended(node, origin, HOW))
    node, reader.origin = merged or (dict(node), origin)
    systems = _systems(node.get("plugins"))
    choices = {"system": OneOf(tuple(systems))}
    plain = reader.plain(node, PLAIN | choices, "simulator.")
    solver = _solver(reader, node.get("solver"))
    plugins = _plugins(reader, node.get("plugins") or [])
    known = catalogue(plugins or ())
    system_class = systems.get(plain["system"])
    if system_class is None:
        raise InputError(reader.problems)
    if group := _of_another_system(plain["system"], origin):
        reader.refuse(
            "simulator.system", f"stands beside the parameters of {with_article(group)}", plain["system"], OTHER_GROUP
        )
        raise InputError(reader.problems)
    options = {option.name for option in system_class.options}
    chosen = _unit_unknown(node, options) | {key: value for key, value in node.items() if key in options}
    system = reader.collect(lambda: system_class(**chosen), "simulator") or system_class()
    declared = {p.name: p for p in _in_units_of(system, system_class.parameters)}
    given = reader.parameters(node, declared, "simulator.")
    sampled = {SAMPLING_RATE.name: SAMPLING_RATE}
    rate = reader.parameters(node, sampled, "simulator.").get(SAMPLING_RATE.name, SAMPLING_RATE.default)
    _refuse_unknown(reader, node, known, declared | sampled, options if plugins is not None else None)
    effects = [_effect(reader, known[key], value, given, system) for key, value in node.items() if key in known]
    effects = [effect for effect in effects if effect is not None]
    if plugins is None:  # model, family and damping law may need the effects of a file that cannot be used
        raise InputError(reader.problems)
    model = _model(reader, system, effects, given)
    for key, decided in ({} if model is None else decided_in_one_file(model, reader.origin)).items():
        reader.refuse(key, decided.rule, node.get(key.partition(".")[2]), decided.remedy)
    own = {effect.name: _in_units_of(system, effect.parameters) for effect in effects}
    flat = declared | {f"{name}.{p.name}": p for name, listed in own.items() for p in listed}
    drawn = read_prior(reader, family, flat, given)
    plain["damping_law"] = _damping_law(reader, plain["damping_law"], effects)
    if reader.problems:
        raise InputError(reader.problems)
    del plain["system"]
    return SimulatorSettings(
        model=model, given=given, family=drawn, sampling_rate=rate, solver=Solver(**solver), plugins=plugins, **plain
    )


def _of_another_system(system: str, origin: Origin) -> str:
    """The system whose parameters the chosen group brings, where another one of the package was typed; else empty.

    A system of one's own may have the parameters of one of the package's.
    """
    of_group = origin.given_by("simulator").get("simulator.system", system)
    is_other = system in SYSTEMS and system != of_group and origin.place("simulator.system") == COMMAND_LINE
    return of_group if is_other else ""


def _solver(reader: Reader, node: Any) -> dict[str, Any]:
    if not isinstance(node, Mapping):
        reader.refuse("simulator.solver", "is a group of keys", node, "give simulator.solver.accuracy")
        return {}
    for key in set(node) - set(SOLVER):
        reader.refuse_unknown(f"simulator.solver.{key}", SOLVER)
    return reader.plain(node, SOLVER, "simulator.solver.")


def _systems(plugins: Any) -> dict[str, type[System]]:
    """The systems that can be simulated; where a user's file cannot be used, which is said later, the package's own."""
    try:
        return system_catalogue(plugins if isinstance(plugins, list) else ())
    except InputError:
        return dict(SYSTEMS)


def _plugins(reader: Reader, node: Any) -> tuple[str, ...] | None:
    """The user's effect files; None where one of them cannot be used."""
    key, before = "simulator.plugins", len(reader.problems)
    if not isinstance(node, list) or not all(isinstance(path, str) for path in node):
        reader.refuse(key, "must be a list of paths", node, "write [path/to/my_effect.py]")
        return None
    for path in node:
        reader.collect(lambda path=path: (catalogue((path,)), system_catalogue((path,))))
    if len(reader.problems) == before:
        reader.collect(lambda: (catalogue(node), system_catalogue(node)))
    return tuple(node) if len(reader.problems) == before else None


def _refuse_unknown(
    reader: Reader,
    node: Mapping[str, Any],
    known: Mapping[str, type[Effect]],
    numbers: Mapping[str, Parameter],
    options: set[str] | None,
) -> None:
    """Note effects that are no mapping, and keys that are neither settings, parameters nor effects.

    Args:
        reader: Collects the problems.
        node: The configuration.
        known: The effects by name.
        numbers: The parameters of the system.
        options: Those of the system; None: not all effects are known, and no name is judged.
    """
    for key, value in node.items():
        full = f"simulator.{key}"
        if key in known:
            if value is not None and not isinstance(value, Mapping):
                remedy = f"write {full}={{}} for its defaults, or {full}=null"
                reader.refuse(full, "must be null (off) or hold parameters", value, remedy)
        elif options is not None:
            ours = {*HOW, "system", *options}
            if key not in ours and split_suffix(key, numbers)[0] not in numbers:
                remedy = without_group(full) or MEANT.get(key) or nearest(key, [*known, *numbers, *ours])
                remedy += (
                    "; an effect of your own needs simulator.plugins=[its file]" if isinstance(value, Mapping) else ""
                )
                of_a_family = reader.origin.place(full) == "family"  # which is one for another system
                reader.refuse(full, "no such effect or parameter", remedy=OTHER_FAMILY if of_a_family else remedy)


def _unit_unknown(node: Mapping[str, Any], options: set[str]) -> dict[str, None]:
    """What the unit of a rig is that comes from a file which does not say it."""
    return {UNIT: None} if node.get("extended") and UNIT in options else {}


def _in_units_of(system: System, declared: Sequence[Parameter]) -> list[Parameter]:
    """Parameters in the units that the values of a system are in."""
    return [replace(one, unit=system.unit_of(one.unit)) for one in declared]


def _effect(reader: Reader, kind: type[Effect], node: Any, given: dict[str, Any], system: System) -> Effect | None:
    """The effect where it is on; its parameters go into `given` by flat name."""
    if not isinstance(node, Mapping):
        return None
    declared = {p.name: p for p in _in_units_of(system, kind.parameters)}
    options = {option.name for option in kind.options}
    prefix = f"simulator.{kind.name}."
    for key in node:
        if split_suffix(key, declared)[0] not in declared and key not in options:
            reader.refuse_unknown(prefix + key, [*declared, *options], "no such parameter")
    found = reader.parameters(node, declared, prefix)
    given |= {f"{kind.name}.{name}": value for name, value in found.items()}
    chosen = {key: value for key, value in node.items() if key in options}
    return reader.collect(lambda: kind(**chosen), "simulator") or kind()


def _model(reader: Reader, system: System, effects: list[Effect], given: Mapping[str, Any]) -> Model | None:
    """The model, tried once with its values: lists of unequal length and missing values show there."""
    meshes = [effect.name for effect in effects if isinstance(effect, MeshStiffness)]
    if len(meshes) > 1:
        places = "; ".join(f"{name}: {reader.origin.of(f'simulator.{name}')}" for name in meshes)
        off = min(meshes, key=lambda name: reader.origin.rank(f"simulator.{name}"))
        rule, remedy = f"there are {len(meshes)} mesh stiffnesses, {' and '.join(meshes)}", f"add simulator.{off}=null"
        reader.problems.append(Problem("simulator", rule, None, remedy, places))
        return None
    model = reader.collect(lambda: Model(system, effects), "simulator")
    if model is not None and not reader.problems:
        reader.collect(lambda: model.prepare(model.values(1, **given)), "simulator")
    return model


def _damping_law(reader: Reader, law: str | None, effects: list[Effect]) -> str | None:
    """The effect that carries the damping ratio; where an extended model has only another one, that one."""
    key = "simulator.damping_law"
    laws = [effect.name for effect in effects if isinstance(effect, DampingLaw)]
    if law is None or law in laws:
        return law
    if reader.origin.extended and reader.origin.place(key) != COMMAND_LINE and len(laws) == 1:
        return laws[0]
    remedy = f"on are: {', '.join(laws)}" if laws else "switch one on, for example simulator.viscous_damping={}"
    reader.refuse(key, "must be a damping effect that is switched on", law, remedy)
    return law
