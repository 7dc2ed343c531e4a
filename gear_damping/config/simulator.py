"""The `simulator` and `family` nodes: checked against the declarations of systems and effects."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from gear_damping.config.quantities import parameter_value, quantity, split_suffix
from gear_damping.config.schema import Key, problem_with
from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.catalogue import SYSTEMS, catalogue
from gear_damping.physics.model import Model
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingLaw, Effect
from gear_damping.simulation.families import DAMPING_RATIO, Family, Spread
from gear_damping.simulation.solver_settings import Solver

PLAIN = {
    "system": Key("text", choices=tuple(SYSTEMS)),
    "n_runs": Key("int", 1, 10_000_000),
    "n_samples": Key("int", 2, 100_000_000),
    "damping_law": Key("text", optional=True),
    "damping_ratio_percent": Key("float", 0, 50, optional=True),
    "diverged_share": Key("float", 0, 1),
    "extended": Key("text", optional=True),
}
SOLVER = {
    "accuracy": Key("float", 1e-10, 0.1),
    "substeps": Key("int", 1, 10_000, optional=True),
    "engine": Key("text", choices=("auto", "native", "fused", "eager")),
    "chunk": Key("int", 1, 10_000_000),
}
SENSOR_NOISE = "sensor_noise"


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
        plugins: The user's own effect files.
    """

    model: Model
    given: dict[str, float | tuple[float, ...]]
    family: Family
    sampling_rate: float
    n_samples: int
    n_runs: int
    damping_law: str | None
    damping_ratio_percent: float | None
    diverged_share: float
    solver: Solver
    plugins: tuple[str, ...]

    @property
    def sensor_noise_db(self) -> float | None:
        """The signal-to-noise ratio of the sensor in dB, or None without sensor noise."""
        declared = self.model.parameters().get(f"{SENSOR_NOISE}.snr_db")
        return None if declared is None else float(self.given.get(f"{SENSOR_NOISE}.snr_db", declared.default))


class _Reader:
    """Reads the two nodes and collects every problem on the way."""

    def __init__(self, node: Mapping[str, Any], origin: Origin) -> None:
        self.node, self.origin = dict(node), origin
        self.problems: list[Problem] = []

    def source(self, key: str) -> str:
        return self.origin.of(key)

    def collect(self, work: Callable[[], Any]) -> Any:
        """The result of `work`; None where it raised an InputError, which is kept."""
        try:
            return work()
        except InputError as error:
            self.problems += error.problems
            return None

    def plain(self, node: Mapping[str, Any], rules: Mapping[str, Key], prefix: str) -> dict[str, Any]:
        found = {}
        for name, rule in rules.items():
            value = node.get(name)
            problem = problem_with(value, rule, prefix + name, self.origin)
            self.problems += [problem] if problem else []
            found[name] = None if problem else value
        return found

    def parameters(self, node: Mapping[str, Any], declared: Mapping[str, Parameter], prefix: str) -> dict[str, Any]:
        """Values in SI by parameter name; keys that are not declared are left to the caller."""
        found: dict[str, Any] = {}
        for key, value in node.items():
            name, unit = split_suffix(key, declared)
            if name not in declared:
                continue
            full = prefix + key
            if name in found:
                self.problems.append(Problem(full, f"'{name}' is given twice", value, "keep one", self.source(full)))
            found[name] = self.collect(
                lambda name=name, unit=unit, value=value, full=full: parameter_value(
                    value, declared[name], full, self.source(full), unit
                )
            )
        return {name: value for name, value in found.items() if value is not None}


def read_simulator(node: Mapping[str, Any], family: Mapping[str, Any], origin: Origin) -> SimulatorSettings:
    """The settings of the two nodes.

    Raises:
        InputError: everything that is wrong with them.
    """
    reader = _Reader(node, origin)
    plain = reader.plain(reader.node, PLAIN, "simulator.")
    solver = _solver(reader)
    plugins = _plugins(reader)
    known = reader.collect(lambda: catalogue(plugins)) or {}
    system_class = SYSTEMS.get(plain["system"])
    if system_class is None or not known:
        raise InputError(reader.problems)
    declared = {p.name: p for p in system_class.parameters}
    options = {option.name for option in system_class.options}
    own = {k: v for k, v in reader.node.items() if k in options}
    system = reader.collect(lambda: system_class(**own))
    given = reader.parameters(reader.node, declared, "simulator.")
    rate = _sampling_rate(reader)
    effects = _effects(reader, known, declared, options, given)
    model = None
    if not reader.problems:
        model = reader.collect(lambda: Model(system, effects))
    spreads = _family(reader, family, model)
    _check_law(reader, model, plain, effects)
    if reader.problems:
        raise InputError(reader.problems)
    del plain["system"], plain["extended"]
    return SimulatorSettings(
        model=model, given=given, family=spreads, sampling_rate=rate, solver=Solver(**solver), plugins=plugins, **plain
    )


def _solver(reader: _Reader) -> dict[str, Any]:
    node = reader.node.get("solver")
    if not isinstance(node, Mapping):
        reader.problems.append(
            Problem("simulator.solver", "is a group of keys", node, "give simulator.solver.accuracy")
        )
        return {}
    for key in set(node) - set(SOLVER):
        full = f"simulator.solver.{key}"
        reader.problems.append(
            Problem(full, "no such key", remedy=nearest(key, list(SOLVER)), source=reader.source(full))
        )
    return reader.plain(node, SOLVER, "simulator.solver.")


def _plugins(reader: _Reader) -> tuple[str, ...]:
    node = reader.node.get("plugins") or []
    if not isinstance(node, list) or not all(isinstance(path, str) for path in node):
        rule, source = "must be a list of paths", reader.source("simulator.plugins")
        reader.problems.append(Problem("simulator.plugins", rule, node, "write [path/to/my_effect.py]", source))
        return ()
    return tuple(node)


def _sampling_rate(reader: _Reader) -> float:
    key = "simulator.sampling_rate"
    rate = reader.collect(lambda: quantity(reader.node.get("sampling_rate"), "Hz", key, reader.source(key)))
    if rate is not None and not 0 < rate <= 1e9:
        rule = "must lie above 0 and up to 1e9 Hz"
        reader.problems.append(Problem(key, rule, rate, "for example {value: 40, unit: kHz}", reader.source(key)))
    return rate or 1.0


def _effects(
    reader: _Reader,
    known: Mapping[str, type[Effect]],
    declared: Mapping[str, Parameter],
    options: set[str],
    given: dict[str, Any],
) -> list[Effect]:
    """The effects that are on; their parameters go into `given` by flat name."""
    ours = {*PLAIN, *options, "solver", "plugins", "sampling_rate"}
    effects = []
    for key, value in reader.node.items():
        full = f"simulator.{key}"
        if key in ours or split_suffix(key, declared)[0] in declared:
            continue
        if key not in known:
            choices = [*known, *declared, *ours]
            problem = Problem(
                full, "no such effect or parameter", remedy=nearest(key, choices), source=reader.source(full)
            )
            reader.problems.append(problem)
        elif isinstance(value, Mapping):
            effects += _effect(reader, known[key], value, given)
        elif value is not None:
            rule = "must be null (off) or hold parameters"
            remedy = f"write {full}={{}} for its defaults, or {full}=null"
            reader.problems.append(Problem(full, rule, value, remedy, reader.source(full)))
    return effects


def _effect(reader: _Reader, kind: type[Effect], node: Mapping[str, Any], given: dict[str, Any]) -> list[Effect]:
    declared = {p.name: p for p in kind.parameters}
    options = {option.name for option in kind.options}
    prefix = f"simulator.{kind.name}."
    for key in node:
        if split_suffix(key, declared)[0] not in declared and key not in options:
            remedy = nearest(key, [*declared, *options]) if declared or options else "it takes none"
            full = prefix + key
            reader.problems.append(Problem(full, "no such parameter", remedy=remedy, source=reader.source(full)))
    found = reader.parameters(node, declared, prefix)
    given |= {f"{kind.name}.{name}": value for name, value in found.items()}
    effect = reader.collect(lambda: kind(**{k: v for k, v in node.items() if k in options}))
    return [effect] if effect is not None else []


def _family(reader: _Reader, node: Mapping[str, Any], model: Model | None) -> Family | None:
    rules = {
        "name": Key("text"),
        "start": Key("text", choices=("static", "rest")),
        "perturbation": Key("float", 0, 100),
    }
    for key in set(node) - set(rules) - {"spreads"}:
        full = f"family.{key}"
        remedy = nearest(key, [*rules, "spreads"])
        reader.problems.append(Problem(full, "no such key", remedy=remedy, source=reader.source(full)))
    plain = reader.plain(node, rules, "family.")
    if model is None:
        return None
    declared = model.parameters()
    spreads = {}
    for name, spread in (node.get("spreads") or {}).items():
        if spread is not None:
            found = reader.collect(lambda name=name, spread=spread: _spread(reader, name, spread, declared))
            spreads |= {name: found} if found else {}
    return Family(spreads=spreads, **plain)


def _spread(reader: _Reader, name: str, node: Any, declared: Mapping[str, Parameter]) -> Spread:
    key = f"family.spreads.{name}"
    source = reader.source(key)
    if name not in declared and name != DAMPING_RATIO:
        remedy = nearest(name, [*declared, DAMPING_RATIO])
        raise InputError(Problem(key, "the model has no such parameter", remedy=remedy, source=source))
    kinds = [kind for kind in ("uniform", "factor") if isinstance(node, Mapping) and kind in node]
    if len(kinds) != 1 or not isinstance(node[kinds[0]], list) or len(node[kinds[0]]) != 2:
        rule = "must be {uniform: [low, high], unit: …} or {factor: [low, high]}"
        raise InputError(Problem(key, rule, node, "for example {factor: [0.8, 1.2]}", source))
    unit = "1" if kinds[0] == "factor" or name == DAMPING_RATIO else declared[name].unit
    low, high = (quantity(value, unit, key, source, node.get("unit")) for value in node[kinds[0]])
    if low > high:
        raise InputError(Problem(key, "the lower end must not lie above the upper", node, "swap them", source))
    return Spread(low, high, relative=kinds[0] == "factor")


def _check_law(reader: _Reader, model: Model | None, plain: Mapping[str, Any], effects: list[Effect]) -> None:
    law = plain["damping_law"]
    laws = [effect.name for effect in effects if isinstance(effect, DampingLaw)]
    if model is None or law is None or law in laws:
        return
    remedy = f"on are: {', '.join(laws)}" if laws else "switch one on, for example simulator.viscous_damping={}"
    rule, key = "must be a damping effect that is switched on", "simulator.damping_law"
    reader.problems.append(Problem(key, rule, law, remedy, reader.source(key)))
