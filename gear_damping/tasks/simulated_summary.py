"""What simulated runs hold, as plain values: what the report of a simulation is made of."""

from typing import Any

from torch import Tensor

from gear_damping.simulation.plan import SimulationPlan
from gear_damping.simulation.prior import DAMPING_RATIO
from gear_damping.simulation.runs import Runs
from gear_damping.tasks.recorded import Channels, units_of

MOST_RUNS = 1000  # that are told one by one; runs.npz has all


def summary_of(runs: Runs, plan: SimulationPlan, channels: Channels) -> dict[str, Any]:
    """Sizes, the range of each channel, and run by run what was drawn and how large the response is.

    Args:
        runs: The runs.
        plan: Of the runs.
        channels: As they were recorded, (runs, time), SI.
    """
    model, samples = runs.model, len(runs.time)
    declared = model.parameters()
    varied = [name for name in plan.prior.distributions if name != DAMPING_RATIO and name in runs.values]
    ratio, response = runs.damping_ratio_percent, channels[model.system.response]
    rms = (response - response.mean(1, keepdim=True)).square().mean(1).sqrt()
    units, by_law = units_of(model), runs.damping_ratio_by_law
    return {
        "system": model.system.name,
        "effects": {effect.name: effect.equation for effect in model.effects},
        "runs": len(runs.status),
        "diverged": runs.n_diverged,
        "samples": samples,
        "sampling_rate_hz": runs.sampling_rate,
        "duration_s": samples / runs.sampling_rate,
        "response": model.system.response,
        "unit": units.get(model.system.response, "m"),
        "damping_ratio_percent": [float(ratio.min()), float(ratio.max())],
        "by_law": {name: [float(one.min()), float(one.max())] for name, one in by_law.items()},
        "varied": {name: model.system.unit_of(declared[name].unit) for name in varied},
        "channels": {name: {"unit": units.get(name, "")} | _range(series) for name, series in channels.items()},
        "each": [
            {
                "damping_ratio_percent": float(ratio[k]),
                "rms": float(rms[k]),
                "values": {name: _first(runs.values[name], k) for name in varied},
            }
            for k in range(min(len(runs.status), MOST_RUNS))
        ],
    }


def _range(series: Tensor) -> dict[str, float]:
    low, high = series.aminmax()
    deviation = series.std(correction=0)
    return {"low": float(low), "high": float(high), "mean": float(series.mean()), "deviation": float(deviation)}


def _first(values: Tensor, run: int) -> float:
    """The value of a run; of a list the first."""
    return float(values[..., run].flatten()[0])
