"""What a term sees when it is evaluated: state, angles, inputs and active branches at one instant."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import torch
from torch import Tensor


@dataclass
class Rotation:
    """A shaft, or the mesh, at one instant: angle (rad) and angular speed; shape (batch,).

    The cosine and sine are taken once, and only where a term asks for them. (Not by `cached_property`:
    before Python 3.12 it takes a lock, which torch.compile cannot trace.)
    """

    angle: Tensor
    speed: Tensor
    _cos: Tensor | None = field(default=None, init=False, repr=False)
    _sin: Tensor | None = field(default=None, init=False, repr=False)

    @property
    def cos(self) -> Tensor:
        """Cosine of the angle."""
        if self._cos is None:
            self._cos = torch.cos(self.angle)
        return self._cos

    @property
    def sin(self) -> Tensor:
        """Sine of the angle."""
        if self._sin is None:
            self._sin = torch.sin(self.angle)
        return self._sin


@dataclass
class Kinematics:
    """State and kinematics of a batch at one instant, in natural units; every tensor has shape (batch,).

    The equation fills the later fields in as it goes, in their order: a term may use those that
    come before its own slot.

    Args:
        time: Time since the start of the run.
        displacement: x, along the line of action for a gear pair.
        velocity: Its rate.
        extra: States that effects added, by name.
        inputs: Measured or drawn time series at this instant, by name.
        active_branch: Of each switch, 1 where its function is positive, else 0. Inside a step it
            is held, so that the step sees one smooth branch.
        pinion: Pinion shaft (gear pair only).
        gear: Gear shaft (gear pair only).
        mesh: Mesh angle, n_teeth_pinion times the pinion angle (gear pair only).
    """

    time: Tensor
    displacement: Tensor
    velocity: Tensor
    extra: Mapping[str, Tensor] = field(default_factory=dict)
    inputs: Mapping[str, Tensor] = field(default_factory=dict)
    active_branch: Mapping[str, Tensor] = field(default_factory=dict)
    pinion: Rotation | None = None
    gear: Rotation | None = None
    mesh: Rotation | None = None
    delta: Tensor | None = None
    delta_rate: Tensor | None = None
    deflection: Tensor | None = None
    clearances: tuple[Tensor, Tensor] | None = None
    contact: Tensor | float = 1.0
    stiffness: Tensor | None = None
    normal_force: Tensor | None = None
    mesh_force: Tensor | None = None
    drive_load: Tensor | None = None
    unbalanced_load: Tensor | float = 0.0
    load: Tensor | None = None
    bearing_force: Tensor | float = 0.0
