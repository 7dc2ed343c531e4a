"""Whether a fitted linear oscillator is enough for its records, judged as task=explain judges it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from torch import Tensor

from gear_damping.explanation.evidence.excess import excess
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.identification.output_error.holdout import rmse
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Channel

ABOVE = 3.0  # times the noise: what noise of another colour leaves about a resonance is less
PARTS = 8  # of a record: a decay is over after one or two of them, and behind it noise hides what it left
LINEAR = 0.1  # % of the signal: no better is a sensor linear


def lack_of_fit(
    predictions: Mapping[str, Tensor],
    fit: Sequence[FitRecord],
    holdout: Sequence[FitRecord],
    channel: Channel,
    noise: NoiseLevel,
) -> dict[str, Any] | None:
    """The residual beside the noise; on the held-out records where there are some.

    Args:
        predictions: By record name, (time,).
        fit: Records that were fitted.
        holdout: Records that were predicted.
        channel: The channel of the response, with its declared unit.
        noise: Of the records.

    Returns:
        `significant`, and in the declared unit `residual`, `noise` and `loudest`, the residual of the eighth of a
        record with the largest, beside `percent_of_signal` of the residual; None where the records are too short to
        estimate their noise.
    """
    if noise.degrees_of_freedom < 1:
        return None
    judged = [replace(r, response=r.response[: len(predictions[r.name])], others=()) for r in holdout or fit]
    responses, predicted = [r.response for r in judged], [predictions[r.name][: len(r.response)] for r in judged]
    residuals = [measured - found for measured, found in zip(responses, predicted, strict=True)]
    left = rmse(responses, predicted)
    loudest = max(float(part.square().mean()) for one in residuals for part in one.chunk(PARTS)) ** 0.5
    signal = rmse(responses, [response.mean().expand_as(response) for response in responses])
    return {
        "significant": bool(excess(residuals, judged, noise).significant),
        "residual": float(left / channel.declared_factor),
        "loudest": loudest / channel.declared_factor,
        "percent_of_signal": float(100 * left / signal),
        "noise": float(noise.value / channel.declared_factor),
        "noise_method": noise.method,
        "unit": channel.declared_unit,
    }


def sentence(found: Mapping[str, Any]) -> str | None:
    """What a lack of fit means for the figures, and what to do about it; None where there is hardly one."""
    if not found["significant"]:
        is_seen = found["loudest"] > ABOVE * found["noise"] > 0 and found["percent_of_signal"] > LINEAR
        return _small(found) if is_seen else None
    return (
        f"lack of fit: the linear oscillator leaves {found['residual']:.3g} {found['unit']}, "
        f"{found['percent_of_signal']:.3g} % of the signal, where the noise is {found['noise']:.3g} {found['unit']} "
        f"({found['noise_method']}). Stiffness and damping are those of the nearest linear motion, and their "
        f"intervals do not cover what is missing; task=explain measurement.path={found['source']} looks for its name"
    )


def _small(found: Mapping[str, Any]) -> str:
    """What the noise of a sensor does not leave, though it is less of the signal than is looked for a name of."""
    times = found["loudest"] / found["noise"]
    return (
        f"The residual, {found['percent_of_signal']:.2g} % of the signal, is up to {times:.2g} times the noise of "
        f"{found['noise']:.3g} {found['unit']} ({found['noise_method']}). What makes it is small, as a law that "
        "differs little from the linear one or channels that are a part of a sample apart; the intervals do not cover "
        f"what it does to the figures, and task=explain measurement.path={found['source']} may find it"
    )
