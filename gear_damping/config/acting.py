"""Which keys act in which task: one table, by which what would be accepted without any effect is refused.

Nothing is imported here that takes long: task=inspect is checked by it too.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from gear_damping.config.locate import groups
from gear_damping.config.measured import MEASURED
from gear_damping.config.quantities import split_suffix
from gear_damping.config.source import COMMAND_LINE, EXPERIMENT, Origin

Found = Iterator[tuple[str, str, Any, str]]  # key, rule, value, remedy

SIMULATED = ("train", "simulate", "evaluate")  # tasks that simulate runs of the configured rig, drawn from a family
IDENTIFY, EXPLAIN, PLAN, PAPER, COLLECT = "identify", "explain", "plan", "paper", "collect"
RIG = (*SIMULATED, PLAN, IDENTIFY)  # tasks of the configured rig; identify fits it where it is an extended one
FITTED = (*RIG, EXPLAIN)  # those and the task that fits others
ACTS: dict[str, tuple[str, ...]] = {  # a key that is not here is one of the next group around it; others act everywhere
    "seed": (*SIMULATED, PLAN, PAPER),
    "seeds": ("train", PAPER),
    "checkpoint": ("evaluate", IDENTIFY),
    "resume": ("train", PAPER),
    "sweep": (COLLECT,),
    "data_folder": (*SIMULATED, PAPER),
    "ruled_out": (EXPLAIN,),
    "explain": (EXPLAIN,),
    "write_measurement": ("simulate",),
    "figures": (PAPER,),
    "evaluation": ("evaluate",),
    "plan": (PLAN,),
    "measurement": MEASURED,
    "measurement.channel": (IDENTIFY,),
    "protocol": ("train",),
    "protocol.windows_per_epoch": ("train", PAPER),
    "protocol.evaluation_stride": ("train", PAPER),
    "training": ("train", PAPER),
    "training.noise_snr_db": ("train",),
    "model": ("train", IDENTIFY),
    "model.plugins": ("train", "evaluate", IDENTIFY),
    "wavelet": ("train",),
    "family": SIMULATED,
    "simulator": RIG,
    "simulator.n_runs": (*SIMULATED, PAPER),
    "simulator.n_samples": (*SIMULATED, PAPER),
    "simulator.sampling_rate": (*SIMULATED, PLAN),
    "simulator.diverged_share": SIMULATED,
    "simulator.damping_ratio_percent": (*SIMULATED, PLAN),
    "simulator.force_gain": (IDENTIFY,),  # of a recorded force: nothing drives a simulated oscillator
    "simulator.plugins": FITTED,
    "simulator.solver": FITTED,
    "simulator.solver.accuracy": (*FITTED, PAPER),
    "simulator.extended": RIG,
}
OF_ANY_FIT = ("simulator.plugins", "simulator.solver", "simulator.solver.accuracy", "simulator.extended")
OF_A_RIG = (IDENTIFY, EXPLAIN)  # tasks that take simulator=oscillator family=none: which rig it is, and no more
NOTHING_DRAWN = "none"  # the family of one rig, without which no rig goes but the usual one
SET_BY_TESTS = {"pinion_speed": "speeds", "initial_displacement": "amplitudes"}  # of the rig: that key of plan sets it
OFF = {  # what is typed to say that nothing is wanted
    **dict.fromkeys(("checkpoint", "resume", "sweep", "ruled_out", "figures", "simulator.extended"), "null"),
    **dict.fromkeys(("measurement.path", "measurement.channel", "measurement.plugins"), "null"),
    "measurement": "none",
    "write_measurement": "false",
}
IDLE = "has no effect in task"  # how the rule begins that a key does not act
NOMINAL = "of the nominal rig of the measurement.yaml"
REASONS = {  # (task, key of the table): why it has no effect there, and what helps
    (IDENTIFY, "simulator"): (
        f"the fit is one {NOMINAL}",
        "leave it out, or give simulator.extended=… and it comes on top of that file",
    ),
    (EXPLAIN, "simulator"): (
        f"the search begins with a fit {NOMINAL}",
        "leave it out; what is known of the rig is said under parameters there",
    ),
    (EXPLAIN, "simulator.extended"): (
        f"the search begins with a fit {NOMINAL}",
        "leave it out; task=identify fits it to records, task=train, simulate, evaluate and plan simulate it",
    ),
    (PLAN, "family"): ("nothing is drawn, and plan.speeds says how fast the tests run", "leave it out"),
    (IDENTIFY, "wavelet"): (
        "it acts on networks that are trained, in task=train",
        "leave it out; the estimator wavelet_ridge has model.omega0",
    ),
    ("train", "checkpoint"): (
        "networks begin untrained",
        "leave it out; resume=FOLDER goes on with the interrupted training in that folder",
    ),
}
OF_THE_STUDY = "it makes every effect, family and protocol itself"


def idle_keys(config: Mapping[str, Any], origin: Origin) -> Found:
    """What was said and cannot act on the task: what was typed, and what the chosen experiment gives.

    An experiment is held to its task where that is not typed: every key of it has to act. With a typed task
    (`task=simulate experiment=limit`) one of them has to.
    """
    task, is_extended = config["task"], _is_extended(config)
    for key, value in origin.typed():
        if OFF.get(key) == value or key == EXPERIMENT:
            continue
        if not _is_acting(key, value, config, origin):
            yield key, *_said(key, task, value)
        elif by := _set_by_tests(key, config):
            rule = f"has no effect beside plan.{by}: every test has one of these"
            yield key, rule, value, "leave one of them out"
    yield from _of_the_experiment(task, is_extended, origin)


def _is_extended(config: Mapping[str, Any]) -> bool:
    simulator = config.get("simulator")
    return isinstance(simulator, Mapping) and simulator.get("extended") is not None


def _is_acting(key: str, value: str, config: Mapping[str, Any], origin: Origin) -> bool:
    """Whether something typed acts; a choice does where its file gives keys of other groups that do."""
    task, is_extended = config["task"], _is_extended(config)
    if _acts(key, task, is_extended):
        return True
    if key not in groups():
        return False
    if key == "family" and task == PLAN:  # by the speed of the rig that it gives, or that it does not
        return value == NOTHING_DRAWN or not _says(config, "speeds")
    if key == "family" and task in OF_A_RIG and value == NOTHING_DRAWN:
        return is_extended or dict(origin.choices).get("simulator") != origin.usual("simulator")
    if key == "family" and task == IDENTIFY and is_extended:
        return True
    others = (one for one in origin.given_by(key) if not one.startswith(f"{key}."))
    return (key == "simulator" and task in OF_A_RIG) or any(_acts(one, task, is_extended) for one in others)


def _set_by_tests(key: str, config: Mapping[str, Any]) -> str | None:
    """The key of a plan that sets a value of the rig in every test; None where none does."""
    group, _, name = key.partition(".")
    if config["task"] != PLAN or group != "simulator":
        return None
    by = SET_BY_TESTS.get(split_suffix(name, SET_BY_TESTS)[0])
    return by if by and _says(config, by) else None


def _says(config: Mapping[str, Any], name: str) -> bool:
    """Whether the plan says something under a key, whatever its unit."""
    plan = config.get("plan")
    given = plan.items() if isinstance(plan, Mapping) else ()
    return any(split_suffix(key, {name: ""})[0] == name for key, value in given if value)


def _of_the_experiment(task: str, is_extended: bool, origin: Origin) -> Found:
    given = {key: value for key, value in origin.given_by(EXPERIMENT).items() if key not in ("task", "name")}
    idle = [key for key in given if not _acts(key, task, is_extended)]
    if not any(key == "task" for key, _ in origin.typed()):
        for key in idle:
            if given[key] not in (None, False) and origin.place(key) != COMMAND_LINE:
                yield key, *_said(key, task, given[key])
    elif idle and len(idle) == len(given):
        remedy = _said(idle[0], task, None)[-1]
        rule = f"has no effect in task={task}: nothing that it gives acts there, {', '.join(idle)}"
        yield EXPERIMENT, rule, dict(origin.choices)[EXPERIMENT], remedy


def _acts(key: str, task: str, is_extended: bool) -> bool:
    """Whether a key acts in a task; one that the table does not know is not judged."""
    entry = _entry(key)
    if entry is None or task not in ACTS[entry]:
        return entry is None
    is_of_the_rig = entry.split(".")[0] == "simulator" and entry not in OF_ANY_FIT
    return is_extended or task != IDENTIFY or not is_of_the_rig


def _entry(key: str) -> str | None:
    """The entry of the table that a key belongs to: its own, or that of the next group around it."""
    while key and key not in ACTS:
        key = key.rpartition(".")[0]
    return key or None


def _said(key: str, task: str, value: Any) -> tuple[str, Any, str]:
    """Rule, value and remedy of a key that does not act."""
    entry = _entry(key)
    why, remedy = REASONS.get((task, entry), (f"it acts in {', '.join(f'task={one}' for one in ACTS[entry])}", ""))
    why = OF_THE_STUDY if task == PAPER else why
    return f"{IDLE}={task}: {why}", value, remedy or "leave it out"
