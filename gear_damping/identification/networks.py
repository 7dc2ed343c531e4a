"""The networks: from features of a window to a damping ratio."""

from abc import abstractmethod
from math import expm1, log

import torch
from torch import Tensor, nn


class DampingNetwork(nn.Module):
    """What reads features (batch, time, feature), then dropout, dense, softplus: damping ratio (batch,) in %.

    A network of one's own gives `state`, and calls `end` when it has made its own layers.
    """

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
