"""The network: an LSTM that reads a window and says a damping ratio."""

from math import expm1, log

import torch
from torch import Tensor, nn


class DampingLSTM(nn.Module):
    """LSTM, dropout, dense, softplus: features (batch, time, feature) to damping ratio (batch,) in %.

    The dense layer reads the state after the last sample. 60 units, dropout 0.2 and softplus are those of
    Yousfi et al. (2026), section 2.3.

    Args:
        n_features: Features at each sample.
        hidden_size: Units of the LSTM.
        dropout: Part of the state that is dropped in training, 0 <= p < 1.
    """

    def __init__(self, n_features: int, hidden_size: int = 60, dropout: float = 0.2) -> None:
        super().__init__()
        self.lstm = nn.LSTM(n_features, hidden_size, batch_first=True)
        self.dropout = nn.Dropout(dropout)
        self.dense = nn.Linear(hidden_size, 1)

    def forward(self, features: Tensor) -> Tensor:
        """Damping ratio in % of critical, positive, (batch,)."""
        _, (state, _) = self.lstm(features)
        return nn.functional.softplus(self.dense(self.dropout(state[-1]))).squeeze(-1)

    def start_at(self, damping_ratio_percent: float) -> None:
        """Set the output bias so that training starts at this damping ratio (% of critical, > 0).

        Softplus of a zero bias says 0.69 %, and Adam would spend its first epochs walking from there.
        """
        with torch.no_grad():
            # The inverse of softplus, y -> log(exp(y) - 1); below 1e-6 it would only grow without bound.
            self.dense.bias.fill_(log(expm1(max(damping_ratio_percent, 1e-6))))
