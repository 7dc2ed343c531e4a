"""Step 8: what nobody named. Where the unexplained residual lies, and which kind of force would take it."""

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import Shaft, shaft_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.linear import linear_of
from gear_damping.explanation.statistics.bursts import BURST_KURTOSIS, pooled_kurtosis
from gear_damping.explanation.trials.line import strongest_line
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
SHAFT_ORDERS = 3  # harmonics of either shaft that are looked at
MESH_ORDERS = 6  # harmonics of the mesh
STATE_POWERS = 3  # of displacement and rate
BINS = 16  # of the contact phase


def unexplained_residual(outcome: Outcome, evidence: Evidence) -> dict[str, object]:
    """The unexplained residual of held-out records, as plain values for the file.

    Args:
        outcome: The model at the end of the search.
        evidence: The records.

    Returns:
        `shares` of the residual's energy by family of features (held out: fitted on the other records'
        residuals), the strongest `line`, `orders` (gear pairs only), `contact_phase` and `kurtosis`.
    """
    trained = [_features(record, outcome, evidence) for record in evidence.fitted]
    tested = [_features(record, outcome, evidence) for record in evidence.held]
    residual_fit = first_channel(outcome.fit_residuals, evidence.fitted)
    residual_test = first_channel(outcome.holdout, evidence.held)
    families = trained[0].keys()
    shares = {
        family: _share([f[family] for f in trained], residual_fit, [f[family] for f in tested], residual_test)
        for family in families
    }
    line, said = strongest_line(outcome, evidence), ("place", "unit", "hertz", "is_force", "share")
    peaked = pooled_kurtosis(residual_test)
    found: dict[str, object] = {
        "shares": shares,
        "line": line and {name: getattr(line, name) for name in said},
        "kurtosis": peaked,
        "bursts": peaked > BURST_KURTOSIS,
    }
    shafts = [shaft_of(record, evidence) for record in evidence.held]
    if all(shafts):
        found["orders"] = _orders(residual_test, shafts)
        found["contact_phase"] = _contact_phase(residual_test, shafts)
    return found


def first_channel(residuals: Sequence[Tensor], records: Sequence[FitRecord]) -> list[Array]:
    """Residuals of the first response channel, (time,) each."""
    return [r[: len(record.response)].numpy() for r, record in zip(residuals, records, strict=True)]


def _features(record: FitRecord, outcome: Outcome, evidence: Evidence) -> dict[str, Array]:
    """Columns by family, each (time, n), of order one."""
    response = record.response.numpy()
    middle, deviation = response.mean(), response.std() or 1.0
    place = (response - middle) / deviation
    rate = np.gradient(response) if record.observed.derivatives == 0 else response
    rate = rate / (rate.std() or 1.0)
    powers = [place**i * rate**j for i in range(STATE_POWERS + 1) for j in range(STATE_POWERS + 1 - i) if i + j]
    found = {
        "state": np.stack([*powers, np.sign(rate), np.abs(rate) * rate], 1),
        "offset_and_drift": np.stack([np.ones_like(place), np.linspace(-1, 1, len(place))], 1),
    }
    shaft = shaft_of(record, evidence)
    if shaft:
        ratio = shaft.teeth[0] / shaft.teeth[1]
        found["pinion_orders"] = _waves(shaft.angle, SHAFT_ORDERS)
        found["gear_orders"] = _waves(shaft.angle * ratio, SHAFT_ORDERS)
        found["mesh_orders"] = _waves(shaft.angle * shaft.teeth[0], MESH_ORDERS)
        found["mesh_phase_and_state"] = np.concatenate(
            [_waves(shaft.angle * shaft.teeth[0], 2) * place[:, None], _waves(shaft.angle * shaft.teeth[0], 2)], 1
        )
    if "force" in record.inputs:
        series = record.at_samples("force")
        values = series.numpy() / (series.std().item() or 1.0)
        found["input"] = np.stack([values, values**2, values**3, np.gradient(values)], 1)
    return found


def _waves(angle: Array, count: int) -> Array:
    return np.stack([wave(h * angle) for h in range(1, count + 1) for wave in (np.cos, np.sin)], 1)


def _share(
    trained: Sequence[Array], residual: Sequence[Array], tested: Sequence[Array], held: Sequence[Array]
) -> float:
    """Share of the held-out residual's energy that a regression on the fitted records' residuals takes; 0 for none."""
    columns, target = np.concatenate(trained), np.concatenate(residual)
    found = np.linalg.lstsq(columns, target, rcond=1e-8)[0]
    before = sum(float(r @ r) for r in held)
    after = sum(float(((r - f @ found) ** 2).sum()) for r, f in zip(held, tested, strict=True))
    return max(1 - after / before, 0.0) if before > 0 else 0.0


def _orders(residuals: Sequence[Array], shafts: Sequence[Shaft | None]) -> dict[str, float]:
    """Share of the energy at the orders of pinion, gear and mesh, and what belongs to none."""
    families: Mapping[str, Sequence[float]] = {
        "s2": (shafts[0].teeth[0] / shafts[0].teeth[1],),
        "s1": (1.0,),
        "k_s1": (2.0, 3.0, 4.0),
        "M": tuple(float(shafts[0].teeth[0] * h) for h in range(1, MESH_ORDERS + 1)),
        "M_half": (shafts[0].teeth[0] / 2,),
        "M_sidebands": tuple(shafts[0].teeth[0] * h + s for h in (1, 2) for s in (-1.0, 1.0)),
    }
    total = sum(float(r @ r) for r in residuals)
    found = {}
    for name, orders in families.items():
        taken = 0.0
        for residual, shaft in zip(residuals, shafts, strict=True):
            waves = np.stack([f(o * shaft.angle) for o in orders for f in (np.cos, np.sin)], 1)
            fitted = waves @ np.linalg.lstsq(waves, residual, rcond=1e-8)[0]
            taken += float(fitted @ fitted)
        found[name] = taken / max(total, 1e-300)
    found["mean"] = sum(len(r) * float(r.mean()) ** 2 for r in residuals) / max(total, 1e-300)
    found["rest"] = max(0.0, 1 - sum(found.values()))
    return found


def _contact_phase(residuals: Sequence[Array], shafts: Sequence[Shaft | None]) -> list[float]:
    """Mean squared residual by phase of the mesh period, over its mean."""
    total, count = np.zeros(BINS), np.zeros(BINS)
    for residual, shaft in zip(residuals, shafts, strict=True):
        place = np.floor((shaft.angle * shaft.teeth[0] / (2 * np.pi)) % 1 * BINS).astype(int) % BINS
        np.add.at(total, place, residual**2)
        np.add.at(count, place, 1)
    mean = total / np.maximum(count, 1)
    return [float(v) for v in mean / max(float(mean.mean()), 1e-300)]


def residual_force(outcome: Outcome, residual: Tensor, rate: float) -> Tensor:
    """The force per sample that would have closed the gap: m r'' + c r' + k r of the smoothed residual, (time,)."""
    mass, damping, stiffness = linear_of(outcome)
    spectrum = torch.fft.rfft(residual)
    turn = 2j * torch.pi * torch.fft.rfftfreq(len(residual), 1 / rate, dtype=torch.float64)
    limit = 3 * (stiffness / mass) ** 0.5
    kept = 1 / (1 + (turn.abs() / limit) ** 6)  # differentiation amplifies noise: nothing beyond 3 natural frequencies
    return torch.fft.irfft(spectrum * kept * (mass * turn**2 + damping * turn + stiffness), n=len(residual))
