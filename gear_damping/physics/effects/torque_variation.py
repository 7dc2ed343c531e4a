"""A torque that changes during a run."""

from collections.abc import Mapping
from math import pi
from typing import Any, ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.mains import MAINS, STRAYS
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.shapes import same_length
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, Switch, Values

SHORTEST = 1e-9  # natural time that a ramp takes at least: a ramp that ends where it starts is a step


def _as_hum(options: Mapping[str, Any], values: Mapping[str, float], base: Mapping[str, float]) -> str:
    """What a sine at the frequency of the mains may be instead."""
    if options["form"] != "sine":
        return ""
    frequency = values["sine_frequency"]
    grid = next((f"{mains:g} Hz" for mains in MAINS if abs(frequency - mains) <= STRAYS), "")
    said = f"`torque_variation` is a sine of {frequency:.4g} Hz: at {grid}, the frequency of the mains, a hum that the "
    return said + "sensor picks up does the same to one channel." if grid else ""


class TorqueVariation(Load, Switch):
    """Steps, a ramp or a sine on top of the mean pinion torque."""

    name = "torque_variation"
    equation = "T1(t) = T1 + steps | ramp | A sin(2 pi f t + phi)"
    reference = "Yousfi et al. (2026), varying torque"
    parameters: ClassVar = (
        Parameter(
            "step_times",
            "s",
            (0.0125, 0.025, 0.0375),
            "when the torque steps, from the beginning of each record",
            0,
            1e6,
            vector=True,
        ),
        Parameter("step_changes", "N*m", (30.0, -45.0, 30.0), "by how much", -1e6, 1e6, vector=True),
        Parameter("ramp_start", "s", 0.01, "start of the ramp, counted likewise", 0, 1e6),
        Parameter("ramp_end", "s", 0.04, "end of the ramp", 0, 1e6),
        Parameter("ramp_change", "N*m", 30.0, "torque added by the end of the ramp and kept", -1e6, 1e6),
        Parameter("sine_amplitude", "N*m", 15.0, "A", 0, 1e6),
        Parameter("sine_frequency", "Hz", 40.0, "f", 0, 1e6),
        Parameter("sine_phase", "rad", 0.0, "phi"),
    )
    options: ClassVar = (Option("form", ("steps", "ramp", "sine"), "steps", "what the torque does"),)
    needs: ClassVar = (Trait.TORQUE,)
    cause: ClassVar = Cause(
        "a change of the torque during the records that the torque channel does not show",
        (
            *(
                Recipe(
                    {"sine_amplitude": None},
                    {"sine_amplitude": "sine_phase"},
                    timed={"sine_frequency": cycles},
                    options={"form": "sine"},
                )
                for cycles in (0.7, 1.0, 1.4, 1.8, 2.2, 2.6, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0)
            ),
            *(
                Recipe(
                    {"ramp_change": None},
                    timed={"ramp_start": at, "ramp_end": at + length},
                    options={"form": "ramp"},
                )
                for at in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
                for length in (0.02, 0.25)
            ),
        ),
        separated_by="torque_channel",
        turns_with="clock",
        also=_as_hum,
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Torques as forces along the line of action."""
        form, per_torque = self.chosen["form"], base["load_per_pinion_torque"]
        if form == "steps":
            same_length("torque_variation", values, "step_times", "step_changes")
            return {"times": values["step_times"], "forces": values["step_changes"] * per_torque}
        if form == "sine":
            rate = 2 * pi * values["sine_frequency"]
            return {"force": values["sine_amplitude"] * per_torque, "rate": rate, "phase": values["sine_phase"]}
        length = (values["ramp_end"] - values["ramp_start"]).clamp(min=SHORTEST)
        times = {"start": values["ramp_start"], "end": values["ramp_start"] + length, "length": length}
        return times | {"force": values["ramp_change"] * per_torque}

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Time since each corner."""
        if self.chosen["form"] == "sine":
            return {}
        corners = p["times"].unbind(0) if self.chosen["form"] == "steps" else (p["start"], p["end"])
        return {f"{self.name}.{i}": at.time - corner for i, corner in enumerate(corners)}

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force of the torque that was added."""
        form = self.chosen["form"]
        if form == "sine":
            return p["force"] * torch.sin(p["rate"] * at.time + p["phase"])
        if form == "steps":
            return sum(at.active_branch[f"{self.name}.{i}"] * force for i, force in enumerate(p["forces"].unbind(0)))
        begun, over = at.active_branch[f"{self.name}.0"], at.active_branch[f"{self.name}.1"]
        share = (at.time - p["start"]) / p["length"]
        return p["force"] * (begun * (1 - over) * share + over)
