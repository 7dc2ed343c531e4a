"""How well anybody could know the damping from a record."""

from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.identification.cramer_rao import cramer_rao
from gear_damping.interface.arguments import names, numbers, of_every_run
from gear_damping.interface.simulated import Simulation, refuse_other_runs, refuse_rest
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.schema.values import Problems


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
        InputError: a name is unknown, nothing moves, or neither or both of noise and snr_db are given.
    """
    refuse_other_runs(runs)
    if noise is not None and snr_db is not None:
        rule, remedy = "is given beside snr_db, and one of noise and snr_db is needed", "leave out one of the two"
        raise InputError(Problem("noise", rule, repr(noise), remedy))
    if noise is None and snr_db is None:
        raise InputError(Problem("noise", "one of noise and snr_db is needed", noise, "for example snr_db=30"))
    if snr_db is not None and not isinstance(snr_db, Real):
        raise InputError(Problem("snr_db", "is one level", repr(snr_db), "ask once for each, for example snr_db=30"))
    refuse_rest(runs.runs)
    response = runs.runs.response
    level = numbers("noise", noise) if snr_db is None else response.std(-1) * 10 ** (-snr_db / 20)
    Problems(of_every_run("noise", level, len(response))).raise_any()
    found = cramer_rao(runs.runs, names("free", free), level, expected=expected, samples=samples)
    return {name: found.deviation(name).numpy() for name in found.names}
