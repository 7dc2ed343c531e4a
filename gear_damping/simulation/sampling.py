"""How runs are sampled: the bounds of rate and length, for configuration and Python alike."""

from math import inf
from numbers import Integral, Real

from gear_damping.errors import InputError, Problem
from gear_damping.physics.parameter import Parameter
from gear_damping.schema.values import Number, Problems

N_SAMPLES = Number(2, 100_000_000, whole=True)  # of a run; one sample has no interval to integrate over
SAMPLING_RATE = Parameter("sampling_rate", "Hz", 40e3, "output samples per second", 1e-9, 1e9)


def check_sampling(sampling_rate: float, n_samples: int) -> None:
    """Refuse what nothing can be sampled with; a measured record may have any positive rate.

    Args:
        sampling_rate: Hz.
        n_samples: Output samples of a run.

    Raises:
        InputError: either is no such number, or out of bounds.
    """
    problems = Problems(whole_number_problems("n_samples", n_samples, N_SAMPLES))
    is_number = isinstance(sampling_rate, Real) and not isinstance(sampling_rate, bool)
    if not is_number or not 0 < sampling_rate < inf:
        rule, remedy = "must be a positive, finite number in Hz", "give the output samples per second"
        problems.append(Problem("sampling_rate", rule, sampling_rate, remedy))
    problems.raise_any()


def whole_number_problems(key: str, value: int, kind: Number) -> list[Problem]:
    """What is wrong with a count; numpy's whole numbers are counts too."""
    own = int(value) if isinstance(value, Integral) and not isinstance(value, bool) else value
    try:
        kind.read(own, key)
    except InputError as error:
        wrong = error.problems[0]
        return [Problem(key, wrong.rule, wrong.value, wrong.remedy)]
    return []
