"""The networks: from features of a window to a damping ratio."""

from abc import abstractmethod
from math import ceil, expm1, inf, log, nan
from typing import ClassVar

import torch
from torch import Tensor, nn

TINY = 1e-12  # %^2, added below a root: its slope stays finite, and no error is so small
HIDDEN = 128  # units of the layer between a record's state and what is said of it
SMALLEST = 3e-3  # of the deviation of the labels: what a deviation stays above, so that no run draws all the gradient
LEVELS = (0.9, 0.95)  # probabilities that intervals state; 0.9 is the one in tables
BINS = 8  # of deviations, in each of which intervals are calibrated


class DampingNetwork(nn.Module):
    """What reads features (batch, time, feature), then dropout, dense, softplus: damping ratio (batch,) in %.

    A network of one's own gives `state`, and calls `end` when it has made its own layers.

    Class attribute: `is_likelihood`, whether `loss` is a likelihood, which validation then goes by, not by the RMSE.
    """

    is_likelihood: ClassVar[bool] = False

    def end(self, n_state: int, dropout: float = 0.0) -> None:
        """Make the last layers.

        Args:
            n_state: Features of the state.
            dropout: Part of the state that is dropped in training, 0 <= p < 1.
        """
        self.dropout = nn.Dropout(dropout)
        self.dense = nn.Linear(n_state, 1)

    @abstractmethod
    def state(self, features: Tensor) -> Tensor:
        """What was read of windows (batch, time, feature), (batch, n_state)."""

    def forward(self, features: Tensor) -> Tensor:
        """Damping ratio in % of critical, positive, (batch,)."""
        return nn.functional.softplus(self.dense(self.dropout(self.state(features)))).squeeze(-1)

    def loss(self, features: Tensor, labels: Tensor) -> tuple[Tensor, Tensor]:
        """What training makes small, a scalar, and the damping ratios (batch,) that it is of: here their RMSE.

        Args:
            features: Of windows, (batch, time, feature).
            labels: True damping ratios in %, (batch,).
        """
        found = self(features)
        # The root has no slope at zero, which one constant label can reach.
        return ((found - labels).square().mean() + TINY).sqrt(), found

    def begin(self, labels: Tensor) -> None:
        """Start at the mean of the training labels (% of critical)."""
        self.start_at(float(labels.double().mean()))

    def start_at(self, damping_ratio_percent: float) -> None:
        """Set the output bias so that training starts at this damping ratio (% of critical, > 0).

        Softplus of a zero bias says 0.69 %, and Adam would spend its first epochs walking from there.
        """
        with torch.no_grad():
            # The inverse of softplus, y -> log(exp(y) - 1); below 1e-6 it would only grow without bound.
            self.dense.bias.fill_(log(expm1(max(damping_ratio_percent, 1e-6))))


class DampingLSTM(DampingNetwork):
    """An LSTM, whose state after the last sample counts.

    60 units, dropout 0.2 and softplus are those of Yousfi et al. (2026), section 2.3.

    Args:
        n_features: Features at each sample.
        hidden_size: Units of the LSTM.
        dropout: Part of the state that is dropped in training, 0 <= p < 1.
        start_at_mean: Whether training starts at the mean label; if not, where the drawn weights lie.
    """

    def __init__(
        self, n_features: int, hidden_size: int = 60, dropout: float = 0.2, start_at_mean: bool = True
    ) -> None:
        super().__init__()
        self.start_at_mean = start_at_mean
        self.lstm = nn.LSTM(n_features, hidden_size, batch_first=True)
        self.end(hidden_size, dropout)

    def start_at(self, damping_ratio_percent: float) -> None:
        """Start at this damping ratio, unless the drawn weights are to be kept."""
        if self.start_at_mean:
            super().start_at(damping_ratio_percent)

    def state(self, features: Tensor) -> Tensor:
        """The hidden state after the last sample."""
        _, (state, _) = self.lstm(features)
        return state[-1]


class GaussianNetwork(DampingNetwork):
    """A network that says how sure it is: damping ratio and standard deviation in %, (batch,) each.

    It is trained on the negative log likelihood of a normal distribution (Nix and Weigend 1994). The width of its
    intervals comes from validation runs: of those that it is about as sure of, as many must lie within as it says
    (Romano, Patterson and Candes 2019, in bins of the deviation).
    """

    is_likelihood = True

    def end(self, n_state: int, dropout: float = 0.0) -> None:
        """Make the last layers: two numbers of a state that one hidden layer has read."""
        self.dropout = nn.Dropout(dropout)
        self.hidden = nn.Linear(n_state, HIDDEN)
        self.dense = nn.Linear(HIDDEN, 2)
        self.register_buffer("label_mean", torch.zeros(()))
        self.register_buffer("label_scale", torch.ones(()))
        self.register_buffer("sureness", torch.full((BINS - 1,), inf))
        self.register_buffer("widths", torch.full((BINS, len(LEVELS)), nan))

    def begin(self, labels: Tensor) -> None:
        """Start from the distribution of the training labels."""
        deviation, mean = torch.std_mean(labels.double(), correction=0)
        self.label_mean.fill_(float(mean))
        self.label_scale.fill_(max(float(deviation), SMALLEST * float(mean), TINY))

    def distribution(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Damping ratio and its standard deviation in %, (batch,) each."""
        read = nn.functional.silu(self.hidden(self.dropout(self.state(features))))
        place, raw_deviation = self.dense(read).unbind(-1)
        deviation = nn.functional.softplus(raw_deviation - 2) + SMALLEST
        return self.label_mean + self.label_scale * place, self.label_scale * deviation

    def forward(self, features: Tensor) -> Tensor:
        """Damping ratio in % of critical, (batch,)."""
        return self.distribution(features)[0]

    def loss(self, features: Tensor, labels: Tensor) -> tuple[Tensor, Tensor]:
        """Mean negative log likelihood of the labels, in units of their deviation, and the damping ratios."""
        found, deviation = self.distribution(features)
        return self.unlikelihood(found, deviation, labels), found

    def unlikelihood(self, found: Tensor, deviation: Tensor, labels: Tensor) -> Tensor:
        """Mean negative log likelihood of labels under normal distributions, (batch,) each; a scalar."""
        return (((labels - found) / deviation).square() / 2 + (deviation / self.label_scale).log()).mean()

    def calibrate(self, found: Tensor, deviation: Tensor, labels: Tensor) -> None:
        """Take the widths of the intervals from runs that training did not see, (runs,) each."""
        edges = torch.linspace(0, 1, BINS + 1, dtype=torch.float64, device=deviation.device)[1:-1]
        self.sureness.copy_(deviation.double().quantile(edges))
        place = torch.bucketize(deviation, self.sureness)
        off = ((labels - found) / deviation).abs().double()
        for number in range(BINS):
            own = off[place == number]
            for column, level in enumerate(LEVELS):
                self.widths[number, column] = _covering(own, level)

    def interval(self, found: Tensor, deviation: Tensor, level: float) -> tuple[Tensor, Tensor]:
        """Ends of the interval that holds the damping ratio with probability `level`, one of `LEVELS`, (batch,)."""
        half = deviation * self.widths[torch.bucketize(deviation, self.sureness), LEVELS.index(level)]
        return (found - half).clamp(min=0), found + half


def _covering(off: Tensor, level: float) -> float:
    """The width that so many of these lie within, and one more; nan where there are too few to tell."""
    rank = ceil((len(off) + 1) * level)
    return float(off.kthvalue(rank).values) if 0 < rank <= len(off) else nan


class RecordLSTM(GaussianNetwork):
    """An LSTM over the frames of a record; its states are pooled by attention (Bahdanau et al. 2015), mean and last.

    Args:
        n_features: Features of a frame.
        hidden_size: Units of the LSTM.
        dropout: Part of what was pooled that is dropped in training.
    """

    def __init__(self, n_features: int, hidden_size: int = 60, dropout: float = 0.0) -> None:
        super().__init__()
        self.lstm = nn.LSTM(n_features, hidden_size, batch_first=True)
        self.attention = nn.Linear(hidden_size, 1)
        self.end(3 * hidden_size, dropout)

    def state(self, features: Tensor) -> Tensor:
        """What was pooled over the frames."""
        states, _ = self.lstm(features)
        weights = torch.softmax(self.attention(states), dim=1)
        return torch.cat([(weights * states).sum(1), states.mean(1), states[:, -1]], dim=-1)
