"""Ripple of the driving torque."""

from collections.abc import Mapping
from typing import Any, ClassVar

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.shapes import share_of_shaft
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, LoadFactor, Values

LOW_ORDERS = 6  # of the pinion's shaft, of a motor's torque
GEAR_ORDERS = 3  # of the gear's shaft
# strength, what is none beside it, and what the gear's torque does
FORMS = (("amplitude", "share", "follows"), ("share", "amplitude", "follows"), ("amplitude", "share", "stays"))


def ripple_orders(rig: Rig) -> tuple[float, ...]:
    """Orders of the pinion's shaft: low ones of either shaft, those beside the mesh, and where lines stand out."""
    teeth = rig.n_teeth_pinion
    low = [float(order) for order in range(1, LOW_ORDERS + 1)]
    gear = [order * teeth / rig.n_teeth_gear for order in range(1, GEAR_ORDERS + 1)]
    return tuple(dict.fromkeys([*low, *gear, teeth - 1.0, teeth + 1.0, *rig.lines]))


def _every_order(rig: Rig) -> tuple[Recipe, ...]:
    """Every form at every order.

    Through the transmission error a gear's torque that follows and one that stays differ by a factor only; a sensor on
    a shaft sees how both shafts speed up. A gear's torque that is held stays in any case.
    """
    is_held = rig.values.get("load_per_gear_torque", 0.0) != 0
    return tuple(
        Recipe(
            {strength: None},
            {strength: "phase"},
            fixed={"order": order, other: 0.0},
            options={"proportional": strength == "share", "gear_torque": gear_torque},
            in_si=True,
            shaft="pinion" if order == round(order) else "gear",
        )
        for strength, other, gear_torque in FORMS
        if gear_torque == "follows" or (rig.on_shafts and not is_held)
        for order in ripple_orders(rig)
    )


def _alone(options: Mapping[str, Any], values: Mapping[str, float], base: Mapping[str, float]) -> str:
    """How large a ripple of the pinion's torque alone would have to be."""
    if options["proportional"] or options["gear_torque"] == "stays" or base.get("load_per_gear_torque", 0.0) != 0:
        return ""
    factor = base["load_per_pinion_torque"] / _per_pinion_torque(base)
    return (
        f"`torque_ripple` is one of both torques, as they were declared: of the pinion's alone, beside a torque of the "
        f"gear that stays as it is, {factor * values['amplitude']:.3g} N*m would do the same to the transmission error."
    )


def _per_pinion_torque(base: Mapping[str, Any]) -> Any:
    """The force of a torque of the pinion alone, which speeds up both shafts, per torque."""
    return share_of_shaft("pinion", base) / base["base_radius_pinion"]


class TorqueRipple(Load, LoadFactor):
    """A torque at an order of the pinion shaft that no torque channel shows."""

    name = "torque_ripple"
    equation = "F + R cos(q theta_1 + phi), R a torque or a share of the load"
    reference = "Vinayak, Singh & Padmanabhan (1995), J. Sound Vib. 185(1)"
    parameters: ClassVar = (
        Parameter("amplitude", "N*m", 3.0, "R as a torque", 0, 1e6),
        Parameter("share", "1", 0.02, "R as a share of the load, where proportional", 0, 1),
        Parameter("order", "1", 1.0, "q, cycles per turn of the pinion", 0, 1000),
        Parameter("phase", "rad", 0.0, "phi"),
    )
    options: ClassVar = (
        Option("proportional", (False, True), False, "a share of the load instead of a torque"),
        Option(
            "gear_torque", ("follows", "stays"), "follows", "what a balanced gear torque does; stays: shafts speed up"
        ),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TORQUE)
    cause: ClassVar = Cause(
        "a ripple of the torque that the torque channel does not show",
        _every_order,
        separated_by="torque_channel",
        turns_with="shaft",
        also=_alone,
    )

    @property
    def is_unbalanced(self) -> bool:
        """Where the gear's torque stays as it is."""
        return self.chosen["gear_torque"] == "stays"

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The amplitude as a force, or as a share."""
        per_torque = base["load_per_pinion_torque"]
        if self.is_unbalanced:
            self._check_is_torque()
            per_torque = _per_pinion_torque(base)
        force = values["amplitude"] * per_torque
        size = values["share"] if self.chosen["proportional"] else force
        return {"size": size, "order": values["order"], "phase": values["phase"]}

    def _check_is_torque(self) -> None:
        if self.chosen["proportional"]:
            rule, remedy = "stays beside a ripple of the torque alone, not of the load", "leave out proportional: true"
            raise InputError(Problem("simulator.torque_ripple.gear_torque", rule, remedy=remedy))

    def _wave(self, at: Kinematics, p: Values) -> Tensor:
        return p["size"] * torch.cos(p["order"] * at.pinion.angle + p["phase"])

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, where it is a torque of its own."""
        return torch.zeros_like(at.displacement) if self.chosen["proportional"] else self._wave(at, p)

    def load_factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor at this instant, where it is a share of the load."""
        return 1 + self._wave(at, p) if self.chosen["proportional"] else torch.ones_like(at.displacement)
