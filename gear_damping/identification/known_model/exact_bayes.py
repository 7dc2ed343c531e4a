"""What one window of a record tells of the damping ratio, exactly: Bayes' theorem on a grid.

For a family of runs that differ in nothing but the damping ratio, and windows that begin anywhere: no estimator that
sees the window alone has a smaller root mean square error.
"""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import LEVEL, Estimates
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.prior import DAMPING_RATIO

GRID = 201  # damping ratios; a window of 30 samples at 30 dB tells them to a hundredth of the range at best
CHUNK = 16  # windows that are compared at once


@dataclass(frozen=True, eq=False)
class WindowBayes:
    """Runs of a family on a grid of damping ratios, any of which is as likely as another.

    Args:
        ratios: Damping ratio in %, ascending, (grid,).
        signals: Runs without noise, (grid, time).
        noise: Standard deviation of the sensor's noise in each, (grid,).
        starts: Where windows may begin, each as likely as another, (starts,).
        window: Samples of a window.
    """

    ratios: Tensor
    signals: Tensor
    noise: Tensor
    starts: Tensor
    window: int

    def posterior(self, windows: Tensor) -> Tensor:
        """How likely each ratio of the grid is after a window: (windows, window) to (windows, grid), rows of sum 1."""
        parts = self.signals.double().unfold(1, self.window, 1)[:, self.starts]  # (grid, starts, window)
        length = parts.square().sum(-1)
        variance = self.noise.double().square()[:, None]
        found = []
        for some in windows.double().split(CHUNK):
            distance = some.square().sum(-1)[:, None, None] + length - 2 * torch.einsum("wn,gsn->wgs", some, parts)
            likelihood = torch.logsumexp(-distance / (2 * variance), -1) - self.window * self.noise.double().log()
            found.append(torch.softmax(likelihood, -1))
        return torch.cat(found)

    def estimate(self, windows: Tensor) -> Estimates:
        """The mean of what is left after each window, (windows, window), and where its middle nine tenths lie."""
        left = self.posterior(windows)
        below = left.cumsum(-1)
        edges = (self._quantile(below, share) for share in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
        return Estimates(left @ self.ratios.double(), *edges)

    def _quantile(self, below: Tensor, share: float) -> Tensor:
        """Between two ratios of the grid the probability grows evenly."""
        edges = torch.cat([torch.zeros_like(below[:, :1]), below], 1)
        place = torch.searchsorted(below, torch.full_like(below[:, :1], share)).clamp(max=below.shape[1] - 1)
        start, end = edges.gather(1, place), edges.gather(1, place + 1)
        inside = (share - start) / (end - start).clamp(min=1e-300)
        step = self.ratios[1] - self.ratios[0]
        return (self.ratios[0] + step * (place + inside - 0.5)).squeeze(1).clamp(self.ratios[0], self.ratios[-1])


def window_bayes(
    plan: SimulationPlan, ends: tuple[float, float], snr_db: float, starts: Tensor, window: int
) -> WindowBayes:
    """Exact Bayes for windows of a plan's runs.

    Args:
        plan: Runs that differ in nothing but their damping ratio.
        ends: Smallest and largest ratio, %.
        snr_db: Of the sensor, relative to the AC part of a run.
        starts: Where windows may begin.
        window: Samples of a window.

    Raises:
        ValueError: the family varies something else, of which a grid would need more dimensions.
    """
    others = sorted(set(plan.prior.distributions) - {DAMPING_RATIO})
    if others or plan.prior.start != "rest":
        what = ", ".join(others) or f"the start ({plan.prior.start})"
        raise ValueError(f"family {plan.prior.name} varies {what} too: choose one that varies the damping ratio alone")
    ratios = torch.linspace(*ends, GRID, dtype=torch.float64)
    signals = torch.cat(
        [run_plan(replace(plan, n_runs=1, damping_ratio_percent=float(ratio))).response for ratio in ratios]
    )
    noise = signals.std(-1, correction=0) * 10 ** (-snr_db / 20)
    return WindowBayes(ratios, signals, noise, starts, window)
