"""What is wrong with values that are each right by themselves."""

from collections.abc import Callable, Iterable
from pathlib import Path

import torch

from gear_damping.config.acting import PLAN, SIMULATED, Found, idle_keys
from gear_damping.config.by_task import BY_TASK
from gear_damping.config.decided import TORQUE, UNSAID, holds_unsaid, unseen_sensors
from gear_damping.config.folders import unusable
from gear_damping.config.light import wrong_measurement, wrong_name
from gear_damping.config.overruled import OVERRULED, given_on_top
from gear_damping.config.simulator import SimulatorSettings
from gear_damping.config.whole import Whole
from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.catalogue import catalogue
from gear_damping.simulation.prior import DAMPING_RATIO, coefficients_for
from gear_damping.simulation.runs import reference_velocity

SIMULATING = (*SIMULATED, "paper")  # tasks that simulate runs
TRAINING = ("train", "paper")  # tasks that train networks


def combination_problems(whole: Whole, wrong: set[str]) -> list[Problem]:
    """The problems of every check none of whose keys is wrong by itself.

    Of a key that cannot act nothing else is said.

    Args:
        whole: The configuration; its simulator and models are None where these are wrong.
        wrong: The keys that are wrong by themselves.
    """
    problems: list[Problem] = []
    idle = set() if "task" in wrong else {key for key, *_ in idle_keys(whole.config, whole.origin)}
    groups = {key.split(".")[0] for key in wrong}
    for needed, check in CHECKS:
        if groups & set(needed) or ("simulator" in needed and whole.simulator is None):
            continue
        found = [one for one in check(whole) if check is _idle or one[0] not in idle]
        problems += [Problem(key, rule, value, remedy, whole.origin.of(key)) for key, rule, value, remedy in found]
    return problems


def _name(whole: Whole) -> Found:
    yield from wrong_name(whole.config, whole.origin)


def _idle(whole: Whole) -> Found:
    yield from idle_keys(whole.config, whole.origin)


def _measurement(whole: Whole) -> Found:
    yield from wrong_measurement(whole.config, whole.origin)


def _ruled_out(whole: Whole) -> Found:
    if not whole["ruled_out"]:
        return  # without a look at the catalogue, which runs the user's files
    known = list(catalogue(whole.simulator.plugins))
    for name in whole["ruled_out"]:
        if name not in known:
            yield "ruled_out", "no such effect", name, nearest(name, known)


def _data_folder(whole: Whole) -> Found:
    """Simulated runs are kept there: said before they are simulated."""
    rule = unusable(Path(whole["data_folder"]))
    if whole["task"] in SIMULATING and rule:
        yield "data_folder", rule, whole["data_folder"], "give another folder"


def _unseen(whole: Whole) -> Found:
    """Every effect shows in what is simulated."""
    if whole["task"] not in (*SIMULATING, PLAN):
        return
    extended = whole.config.get("simulator", {}).get("extended")
    for name, rule, remedy in unseen_sensors(whole.simulator.model):
        if extended is not None:
            yield "simulator.extended", f"holds {name}, which {rule}", extended, remedy
        else:
            yield f"simulator.{name}", rule, None, remedy


def _windows(whole: Whole) -> Found:
    """A window fits into every part that a run is cut into."""
    protocol, samples = whole["protocol"], whole.simulator.n_samples
    if whole["task"] not in TRAINING:
        return
    part = samples
    if protocol["name"] != "by_run":
        test = max(1, round(samples * protocol["test_fraction"]))
        part = min(test, samples - test)
    if protocol["window"] > part:
        rule = f"must not exceed {part}, the samples of the shortest part of a run of {samples}"
        yield "protocol.window", rule, protocol["window"], "shorten it, or raise simulator.n_samples"


def _split(whole: Whole) -> Found:
    """Every part gets a run."""
    protocol, runs = whole["protocol"], whole.simulator.n_runs
    if whole["task"] not in TRAINING:
        return
    run = protocol["run"]
    if protocol["name"] == "paper" and run >= runs:
        yield "protocol.run", f"must lie below simulator.n_runs = {runs}", run, f"nearest valid value {runs - 1}"
    shares = [protocol["validation_fraction"]]
    shares += [protocol["test_fraction"]] if whole.simulator.damping_ratio_percent is None else []
    taken = sum(max(1, round(share * runs)) for share in shares)
    if protocol["name"] == "by_run" and taken >= runs:
        rule = f"leaves no run to train on: {taken} of {runs} are for validation and test"
        yield "simulator.n_runs", rule, runs, "raise it, or lower protocol.validation_fraction and test_fraction"


def _wavelet(whole: Whole) -> Found:
    wavelet = whole["wavelet"]
    if wavelet["frequency_min_hz"] >= wavelet["frequency_max_hz"]:
        yield "wavelet.frequency_min_hz", "must lie below frequency_max_hz", wavelet["frequency_min_hz"], "lower it"


def _nyquist(whole: Whole) -> Found:
    highest, half = whole["wavelet"]["frequency_max_hz"], whole.simulator.sampling_rate / 2
    if whole["task"] in TRAINING and highest >= half:
        rule = f"must lie below half the sampling rate, {half:g} Hz"
        yield "wavelet.frequency_max_hz", rule, highest, "lower it, or sample faster"


def _test_ratio(whole: Whole) -> Found:
    ratio, key = whole.simulator.damping_ratio_percent, "simulator.damping_ratio_percent"
    if ratio is None:
        return
    if whole["task"] == "train" and whole["protocol"]["name"] != "by_run":
        yield key, "test runs of one ratio need whole runs to test on", ratio, "choose protocol=by_run"
    if whole.simulator.damping_law is None:
        yield key, "no effect carries a damping ratio", ratio, "give simulator.damping_law"


def _without_effect(whole: Whole) -> Found:
    """Values that were given and that something else decides."""
    simulator = whole.simulator
    drawn = simulator.family.distributions if whole["task"] in SIMULATED else {}  # others are for one rig
    for name, distribution in drawn.items():
        key = None if name == DAMPING_RATIO else given_on_top(name, whole.origin)
        if key and not distribution.relative:
            remedy = f"leave it out, or add family.spreads.{name}=null"
            yield key, "has no effect: the family draws it for every run", simulator.given[name], remedy
    if simulator.damping_law is None:
        if DAMPING_RATIO in drawn:
            remedy = f"name the effect, or add family.spreads.{DAMPING_RATIO}=null"
            yield "simulator.damping_law", "the family draws a damping ratio and no effect carries it", None, remedy
    elif DAMPING_RATIO in drawn or simulator.damping_ratio_percent is not None:
        for name in _set_by_ratio(simulator)[0]:
            if given_on_top(name, whole.origin):
                remedy = f"leave it out, or add simulator.damping_law=null family.spreads.{DAMPING_RATIO}=null"
                rule = "has no effect: the damping ratio decides it"
                yield f"simulator.{name}", rule, simulator.given[name], remedy


def _set_by_ratio(simulator: SimulatorSettings) -> tuple[Iterable[str], list[Problem]]:
    """Flat names of the parameters that follow from the damping ratio, and why none do."""
    values = simulator.model.values(1, **simulator.given)
    velocity = reference_velocity(simulator.model.prepare(values).derived)
    ratio = torch.full_like(velocity, 0.01)
    try:
        return coefficients_for(simulator.model, values, simulator.damping_law, ratio, velocity), []
    except InputError as error:
        return (), error.problems


def _ratio_carried(whole: Whole) -> Found:
    """The damping law can carry the damping ratio."""
    simulator = whole.simulator
    wanted = DAMPING_RATIO in simulator.family.distributions or simulator.damping_ratio_percent is not None
    if whole["task"] in SIMULATING and simulator.damping_law is not None and wanted:
        yield from ((p.key, p.rule, p.value, p.remedy) for p in _set_by_ratio(simulator)[1])


def _label(whole: Whole) -> Found:
    """Runs to learn from have a damping ratio."""
    model, given = whole.simulator.model, whole.simulator.given
    if whole["task"] not in ("train", "evaluate"):
        return
    if not model.damping_laws:
        remedy = "switch one on, for example simulator.viscous_damping={}"
        yield "simulator.damping_law", f"task={whole['task']} needs an effect that states a damping ratio", None, remedy
    elif not bool((model.prepare(model.values(1, **given)).derived["mean_stiffness"] > 0).all()):
        yield "simulator.stiffness", "must be positive: a damping ratio needs a linear stiffness", 0, "give one"


def _physics(whole: Whole) -> Found:
    simulator = whole.simulator
    value = {name: simulator.given.get(name, p.default) for name, p in simulator.model.parameters().items()}
    if holds_unsaid(simulator.model, simulator.given):
        balance = value["pinion_torque"] * value["n_teeth_gear"] / value["n_teeth_pinion"]
        remedy = f"simulator.gear_torque={balance:g} balances the torque on the pinion"
        yield f"simulator.{TORQUE}", UNSAID, None, remedy
    for effect in (effect.name for effect in simulator.model.effects):
        low, high = value.get(f"{effect}.minimum"), value.get(f"{effect}.maximum")
        if low is not None and high is not None and low > high:
            key = f"simulator.{effect}.minimum"
            yield key, f"must not exceed maximum = {high:g}", low, f"nearest valid value {high:g}"


CHECKS: tuple[tuple[tuple[str, ...], Callable[[Whole], Found]], ...] = (
    (("task",), _idle),
    *BY_TASK,
    (("name",), _name),
    (("task", "measurement"), _measurement),
    (("ruled_out", "simulator"), _ruled_out),
    (("task", "data_folder"), _data_folder),
    (("task", "simulator"), _unseen),
    (("task", "protocol", "simulator"), _windows),
    (("task", "protocol", "simulator"), _split),
    (("wavelet",), _wavelet),
    (("task", "wavelet", "simulator"), _nyquist),
    (("task", "protocol", "simulator"), _test_ratio),
    (("task", "simulator", "family"), _ratio_carried),
    (("task", "simulator"), _label),
    (("task", "simulator", "family"), _without_effect),
    (("simulator",), _physics),
    *OVERRULED,
)
