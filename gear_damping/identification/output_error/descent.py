"""One round of Levenberg–Marquardt, with secant updates between linearisations.

A linearisation simulates a member for every column, a trial only one. As long as the linear model foretells what a
step brings, its sensitivities are carried along by Broyden's update, record by record; where it does not, where a
step fails, and before a start counts as converged, they are worked out anew. (Broyden, Math. Comp. 19, 1965; scaled by
the columns' norms.) Small problems are linearised at every trial. Sensitivities that another fit of the same records
has lent are worked out only where the others lead no further.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import torch
from torch import Tensor

from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction
from gear_damping.identification.output_error.step import Points, accelerated, moves, newton_step

FIRST_DAMPING, LARGEST_DAMPING, SMALLEST_DAMPING = 1e-2, 1e10, 1e-12  # of Levenberg and Marquardt, relative to J'J
SMALLEST_GAIN = 1e-7  # relative fall of the cost below which a start has converged
CALM_STEPS = 3  # steps in a row that change the cost by little: one alone may be short
FORETOLD = 0.5  # of the fall that the linear model predicts: with less of it, it is made anew
CARRIED = 4  # steps over which sensitivities are carried along at most
AT_ONCE = 2e5  # values of the sensitivities: a linearisation of fewer costs hardly more than a trial
LENT_FOR = 6  # linearisations that borrow at most,
LENT_DAMPING = 1e3  # and the damping at which borrowing leads no further
TRIALS = 3  # for each linearisation that a round may take
SHORT_OF = 2  # linearisations in a row that foretell no success: then a start is given up
CRAWLED, FAR = 4, 4.0  # linearisations over which a start crawls; times the cost of noise alone, below which none does
LEAST_TRIALS = 3  # whatever the time: a model without one of its causes is nearly converged by then


@dataclass(frozen=True)
class Lent:
    """Sensitivities by some shared coordinates, as another fit to the same records found them.

    Args:
        places: The coordinates.
        columns: (records, samples, places), of whole records.
    """

    places: list[int]
    columns: Tensor


@dataclass(frozen=True)
class Ends:
    """When a fit stops before that.

    Args:
        enough: Fall of the cost below which a start has converged, whatever share of the cost it is.
        reach: Cost in the last round; a start that will not get below it is given up.
        crawl: Share of the cost; a start far above the noise is given up that gets it down by less than this over a few
            linearisations.
        is_over: Whether time is over: after a few steps of each round nothing more is tried then.
    """

    enough: float = 0.0
    reach: float = inf
    crawl: float = 0.0
    is_over: Callable[[], bool] = lambda: False


TO_THE_END = Ends()


class Descent:
    """Starts on their way down over one horizon.

    Every tensor has a row for each start: `points`, `linearised` (at them), `cost`, `damping`, `calm` (steps in a row
    that changed little), `carried` (steps since the sensitivities were worked out), `made` (linearisations),
    `short` (those in a row from which a start seemed to get neither below `reach` nor below the best start), `strayed`
    (whether a step has failed: where sensitivities are fresh, steps then follow the bend of the response),
    `costs` (at its last linearisations).
    """

    def __init__(
        self,
        problem: OutputErrorProblem,
        points: Points,
        horizon: float | None,
        ends: Ends = TO_THE_END,
        lent: Lent | None = None,
    ) -> None:
        """Begin at points; arguments as for `least_squares.fit`."""
        self.problem, self.horizon, self.ends = problem, horizon, ends
        self.points = Points(points.shared.clone(), points.states.clone())
        samples = problem.response.samples_within(horizon) * len(problem.response.channels)
        self.noise_cost = problem.noise**2 * samples * len(problem.records)
        # beside more than noise, what is enough counts in what is left instead
        self.smallest_gain = max(SMALLEST_GAIN, ends.enough / self.noise_cost if self.noise_cost > 0 else 0.0)
        self.at_once = samples * len(problem.records) * (problem.n_shared + len(problem.local)) < AT_ONCE
        self.lent = None if self.at_once else lent
        self.linearised = problem.linearise(points.shared, points.states, horizon, self._own())
        if self.lent:
            columns = problem.response.cut(self.lent.columns.permute(2, 0, 1), horizon).permute(1, 2, 0)
            self.linearised.sensitivity[..., self.lent.places] = columns
        self.cost = self._cost(points, self.linearised.residual, self.linearised.level)
        self.damping = torch.full_like(self.cost, FIRST_DAMPING)
        self.calm, self.made, self.carried, self.short = torch.zeros(4, len(self.cost), dtype=torch.long)
        self.looked_at = self.made - 1
        self.converged, self.strayed = self.calm > 0, self.calm > 0
        self.costs = torch.full((len(self.cost), CRAWLED), inf, dtype=torch.float64)

    def run(self, iterations: int, is_last: bool = True) -> None:
        """Go down until every start has converged or has been linearised so many times, or time is over.

        Where another round follows, nothing is worked out but the points that are reached.
        """
        self._go_down(iterations)
        if not is_last:
            return
        if self.lent:
            self._give_back()
            self._go_down(iterations)
        self._linearise(((self.carried > 0) & ~self.converged & self.is_promising).nonzero()[:, 0])

    @property
    def is_promising(self) -> Tensor:
        """Which starts are not given up, (starts,)."""
        crawls = self.costs[:, 0] - self.cost < self.ends.crawl * self.cost
        return (self.short < SHORT_OF) & ~(crawls & (self.cost > FAR * self.noise_cost))

    def _go_down(self, iterations: int) -> None:
        most = min(iterations, LENT_FOR) if self.lent else iterations
        for number in range(TRIALS * most):
            left = (~self.converged & (self.made < most) & self.is_promising).nonzero()[:, 0]
            if not len(left) or (number >= LEAST_TRIALS and self.ends.is_over()):
                break
            self._advance(left)

    def _own(self) -> list[int] | None:
        """The coordinates whose sensitivities are worked out; None for all."""
        return None if self.lent is None else sorted({*range(self.problem.n_shared)} - {*self.lent.places})

    def _give_back(self) -> None:
        """Go on with sensitivities of one's own, the points that are reached being new starts."""
        self.lent = None
        self.calm, self.made = torch.zeros(2, len(self.cost), dtype=torch.long)
        self.costs = torch.full_like(self.costs, inf)
        self.converged = torch.zeros_like(self.converged)
        self.damping = torch.full_like(self.damping, FIRST_DAMPING)
        self._linearise(torch.arange(len(self.cost)))

    def _advance(self, left: Tensor) -> None:
        """One trial of some starts."""
        points, linearised, fresh = self.points.pick(left), self.linearised.pick(left), self.carried[left] == 0
        trial = newton_step(self.problem, points, linearised, self.damping[left])
        is_known = self.at_once or (not self.lent and bool(fresh.all()))  # the slope, by which the bend is seen
        if is_known and self.strayed[left].any():
            trial = accelerated(self.problem, points, linearised, self.damping[left], trial, self.horizon)
        seen = self._looked_at(trial)
        old, cost = self.cost[left], self._cost(trial, seen.residual, linearised.level)
        if not self.at_once and not self.lent and (self.ends.reach < inf or len(self.cost) > 1):
            self._look_ahead(left[self.looked_at[left] < self.made[left]])
        gain, better = old - cost, cost < old
        flat = self._judge(left, gain, better, fresh)
        taken = left[better]
        self.points.put(taken, trial.pick(better))
        self.linearised.residual[taken], self.cost[taken] = seen.residual[better], cost[better]
        if self.at_once:
            self.linearised.sensitivity[taken] = seen.sensitivity[better]
            self._weigh_anew(taken, None if seen.level is None else seen.level[better])
            self.made[left] += 1
            return
        changes = moves(self.problem, points, trial)
        linear = linearised.along(changes)
        foretold = old - self._cost(trial, linearised.residual - linear, linearised.level)
        self.carried[taken] += 1
        self._carry(taken, (linearised.residual - seen.residual - linear)[better], changes[better])
        astray = torch.where(better, ~(gain >= FORETOLD * foretold) & ~flat, ~fresh)
        due = astray | (self.carried[left] >= CARRIED) | (self.calm[left] >= CALM_STEPS - 1)
        self._linearise(left[due & (self.carried[left] > 0) & ~self.converged[left]])

    def _looked_at(self, trial: Points) -> Prediction:
        """Residuals at a trial, with their sensitivities where these come at once."""
        if self.at_once:
            return self.problem.linearise(trial.shared, trial.states, self.horizon)
        residual = self.problem.residuals(trial.shared, trial.states, self.horizon)
        return Prediction(residual, residual.new_zeros(len(residual), 0))

    def _judge(self, left: Tensor, gain: Tensor, better: Tensor, fresh: Tensor) -> Tensor:
        """Damping, calm and convergence after a trial; returns whose cost has hardly changed.

        A step that stale sensitivities led astray says nothing.
        """
        enough = torch.full_like(gain, self.ends.enough)
        flat = gain.abs() <= torch.maximum(self.smallest_gain * self.cost[left], enough)
        self.calm[left] = torch.where(better | fresh, torch.where(flat, self.calm[left] + 1, 0), self.calm[left])
        softer, harder = self.damping[left] / 5, self.damping[left] * torch.where(fresh, 6.0, 1.0)
        self.damping[left] = torch.where(better, softer, harder).clamp(SMALLEST_DAMPING, LARGEST_DAMPING)
        is_stuck = self.damping[left] >= (LENT_DAMPING if self.lent else LARGEST_DAMPING)
        self.strayed[left] |= ~better
        self.converged[left] = fresh & ((self.calm[left] >= CALM_STEPS) | is_stuck)
        return flat

    def _look_ahead(self, fresh: Tensor) -> None:
        """Count in how many linearisations in a row the undamped step would not get below what is to be reached."""
        self.looked_at[fresh] = self.made[fresh]
        points, linearised = self.points.pick(fresh), self.linearised.pick(fresh)
        end = newton_step(
            self.problem, points, linearised, torch.full((len(fresh),), SMALLEST_DAMPING, dtype=torch.float64)
        )
        linear = linearised.along(moves(self.problem, points, end))
        best = torch.where(self.cost[fresh] > self.cost.min(), self.cost.min(), inf)  # of another start
        falls_short = self._cost(end, linearised.residual - linear, linearised.level) > best.clamp(max=self.ends.reach)
        self.short[fresh] = torch.where(falls_short, self.short[fresh] + 1, 0)

    def _carry(self, places: Tensor, missed: Tensor, changes: Tensor) -> None:
        """Broyden's update of the sensitivities, for what the linear model missed of the response's change."""
        weighed = changes * self.linearised.sensitivity[places].square().sum(2)
        length = (weighed * changes).sum(-1, keepdim=True).clamp(min=1e-300)
        self.linearised.sensitivity[places] += missed.unsqueeze(-1) * (weighed / length).unsqueeze(2)

    def _linearise(self, places: Tensor) -> None:
        """Sensitivities of some starts worked out at their points."""
        if not len(places):
            return
        points, residual = self.points.pick(places), self.linearised.residual[places]
        found = self.problem.linearise(points.shared, points.states, self.horizon, self._own(), residual=residual)
        if self.lent:
            found.sensitivity[..., self.lent.places] = self.linearised.sensitivity[places][..., self.lent.places]
        self.linearised.sensitivity[places] = found.sensitivity
        self._weigh_anew(places, found.level)
        self.carried[places] = 0
        self.made[places] += 1
        self.costs[places] = torch.cat([self.costs[places, 1:], self.cost[places, None]], 1)

    def _weigh_anew(self, places: Tensor, level: Tensor | None) -> None:
        """Expectations weighed by what is left where starts are linearised: from there to the next they count alike."""
        if level is None:
            return
        self.linearised.level[places] = level
        self.cost[places] = self._cost(self.points.pick(places), self.linearised.residual[places], level)

    def _cost(self, points: Points, residual: Tensor, level: Tensor | None) -> Tensor:
        total = self.problem.cost(points.shared, residual, level)
        return torch.where(total.isfinite(), total, torch.full_like(total, float("inf")))
