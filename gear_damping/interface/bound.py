"""How well anybody could know the damping from a record."""

from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from gear_damping.config.decided import decided_by_options
from gear_damping.errors import InputError, Problem
from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.interface.arguments import names, numbers, of_every_run, plain, refuse_no_level
from gear_damping.interface.simulated import Simulation, refuse_other_runs, refuse_rest
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.schema.values import Number, Problems
from gear_damping.simulation.sampling import whole_number_problems

SAMPLES = Number(whole=True)  # a count; how many there are is said with those of the record


def bound(
    runs: Simulation,
    free: str | Sequence[str] = (DAMPING_RATIO,),
    *,
    noise: float | Sequence[float] | None = None,
    snr_db: float | None = None,
    expected: Mapping[str, float] | None = None,
    samples: int | None = None,
) -> dict[str, NDArray[np.float64]]:
    """The smallest standard deviation that any unbiased estimate can have, by name, run by run, (batch,).

    The Cramer-Rao bound for a record of the response behind white noise, whose displacement and velocity at the start
    are unknown. Of a chaotic run, in which flanks part again and again, it says nothing: its sensitivities grow without
    end.

    Args:
        runs: As `simulate` gives them, with the values that are true.
        free: What is unknown beside the start, by flat name; `damping_ratio` in % of critical.
        noise: Standard deviation of the noise, in the unit of the response, of all runs or (batch,); or
        snr_db: its level below the response about its mean, run by run.
        expected: Standard deviations of what is known beforehand, by name (`initial_displacement` and
            `initial_velocity` too).
        samples: How many samples of the record are used; all where absent.

    Raises:
        InputError: a name is unknown, nothing moves, neither or both of noise and snr_db are given, or the response
            tells nothing of what is unknown.
    """
    refuse_other_runs(runs)
    if noise is not None and snr_db is not None:
        rule, remedy = "is given beside snr_db, and one of noise and snr_db is needed", "leave out one of the two"
        raise InputError(Problem("noise", rule, repr(noise), remedy))
    if noise is None and snr_db is None:
        raise InputError(Problem("noise", "one of noise and snr_db is needed", noise, "for example snr_db=30"))
    if snr_db is not None:
        refuse_no_level("snr_db", snr_db)
    if samples is not None:
        Problems(whole_number_problems("samples", samples, SAMPLES)).raise_any()
    expected, free = _expected(expected), names("free", free)
    _refuse_decided(runs, free)
    refuse_rest(runs.runs)
    response = runs.runs.response
    level = numbers("noise", noise) if snr_db is None else response.std(-1) * 10 ** (-snr_db / 20)
    Problems(of_every_run("noise", level, len(response))).raise_any()
    found = cramer_rao(runs.runs, free, level, expected=expected, samples=samples)
    deviations = {name: found.deviation(name).numpy() for name in found.names}
    _refuse_no_bound({name: deviations[name] for name in free})
    return deviations


def _refuse_decided(runs: Simulation, free: Sequence[str]) -> None:
    """Refuse what an option of the system decides, as the torque of a gear that follows the pinion's.

    Raises:
        InputError: names all of it.
    """
    decided = decided_by_options(runs.runs.model)
    Problems(Problem("free", decided[one].rule, one, decided[one].remedy) for one in free if one in decided).raise_any()


def _refuse_no_bound(deviations: Mapping[str, NDArray[np.float64]]) -> None:
    """Refuse what the response does not tell from the other unknowns, as the gain of a torque beside that torque.

    Raises:
        InputError: names all of it.
    """
    rule = "has no bound in a run, whose response does not tell it from the other unknowns"
    remedy = "leave one of them out, or say with expected={NAME: deviation} how well it is known"
    untold = [name for name, one in deviations.items() if not np.isfinite(one).all()]
    Problems(Problem("free", rule, name, remedy) for name in untold).raise_any()


def _expected(given: object) -> dict[str, float] | None:
    """Standard deviations of what is known beforehand, as plain numbers.

    Raises:
        InputError: it says not of which parameter it is, or one is no number.
    """
    if given is None:
        return None
    if not isinstance(given, Mapping):
        rule, remedy = "must say how well which parameter is known", "for example expected={'stiffness': 10.0}"
        raise InputError(Problem("expected", rule, repr(given), remedy))
    problems = [
        Problem(f"expected.{name}", "must be one number, a standard deviation", repr(value), "give it in SI")
        for name, value in given.items()
        if not isinstance(plain(value), Real) or isinstance(plain(value), bool)
    ]
    Problems(problems).raise_any()
    return {name: float(value) for name, value in given.items()}
