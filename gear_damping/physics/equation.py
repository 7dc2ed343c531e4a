"""The equation of motion: the sum of the model's terms at one instant.

m x'' + contact * F_d(delta') + N = F(t),   delta = x - e,   N = k * deflection + F_el
"""

from collections.abc import Mapping

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Model
from gear_damping.physics.terms import (
    BearingForce,
    Contact,
    DampingForce,
    ElasticForce,
    ExtraStates,
    Load,
    LoadFactor,
    LoadPath,
    MeshForceFactor,
    MeshStiffness,
    StiffnessFactor,
    Switch,
    TransmissionErrorSource,
)

Values = Mapping[str, Tensor]
HELD_LOAD = "held_load"  # the input series that drawn loads add up to


class EquationOfMotion:
    """Evaluates the rates of a batch; stateless, so that it can be traced and compiled.

    States are ordered displacement, velocity, then those that effects add.
    """

    def __init__(self, model: Model) -> None:
        """Sort the effects of `model` into their slots."""
        self.system = model.system
        self.effects = model.effects
        self.switching = [effect for effect in model.effects if isinstance(effect, Switch)]
        with_states = [effect for effect in model.effects if isinstance(effect, ExtraStates)]
        self.extra_names = [f"{effect.name}.{state}" for effect in with_states for state in effect.states]

    def _filling(self, slot: type) -> list:
        return [effect for effect in self.effects if isinstance(effect, slot)]

    def kinematics(self, time: Tensor, state: tuple[Tensor, ...], inputs: Values, base: Values) -> Kinematics:
        """The state at one instant, with the angles that belong to it."""
        turns = self.system.rotations(time, inputs, base, state[0])
        extra = dict(zip(self.extra_names, state[2:], strict=True))
        return Kinematics(time, state[0], state[1], extra=extra, inputs=inputs, **turns)

    def switches(self, at: Kinematics, terms: Mapping[str, Values]) -> dict[str, Tensor]:
        """Every switching function at this instant; a branch changes where one changes sign."""
        self._deform(at, terms)
        found: dict[str, Tensor] = {}
        for effect in self.switching:
            found |= effect.switches(at, terms[effect.name])
        return found

    def rates(self, at: Kinematics, base: Values, terms: Mapping[str, Values]) -> tuple[Tensor, ...]:
        """Rates of the states, in natural units; `at.active_branch` says which branch holds."""
        self._deform(at, terms)
        self._touch(at, base, terms)
        forces = [(e.acts_in_gap, e.damping_force(at, terms[e.name])) for e in self._filling(DampingForce)]
        in_contact = sum(force for in_gap, force in forces if not in_gap)
        at.mesh_force = at.normal_force + at.contact * in_contact + sum(force for in_gap, force in forces if in_gap)
        for effect in self._filling(MeshForceFactor):
            at.mesh_force = at.mesh_force * effect.force_factor(at, terms[effect.name])
        self._press(at, base, terms)
        at.bearing_force = sum(e.bearing_force(at, terms[e.name]) for e in self._filling(BearingForce))
        acceleration = (at.load - at.mesh_force) / base["equivalent_mass"]
        extra = (self._extra_rates(effect, at, terms) for effect in self._filling(ExtraStates))
        return at.velocity, acceleration, *(rate for rates in extra for rate in rates)

    def _extra_rates(self, effect: ExtraStates, at: Kinematics, terms: Mapping[str, Values]) -> list[Tensor]:
        rates = effect.state_rates(at, terms[effect.name])
        return [rates[name] for name in effect.states]

    def energy(self, at: Kinematics, base: Values, terms: Mapping[str, Values]) -> Tensor:
        """Kinetic energy and the energy of k * deflection, natural units."""
        self._deform(at, terms)
        self._touch(at, base, terms)
        return base["equivalent_mass"] * at.velocity**2 / 2 + at.stiffness * at.deflection**2 / 2

    def imposed_error(self, at: Kinematics, terms: Mapping[str, Values]) -> tuple[Tensor, Tensor]:
        """The geometric error e of the flanks and its rate at this instant."""
        self._deform(at, terms)
        return at.displacement - at.delta, at.velocity - at.delta_rate

    def fill_in_loads(self, at: Kinematics, base: Values, terms: Mapping[str, Values]) -> None:
        """Fill in the loads alone, and what they may depend on; `at.active_branch` says which branch holds."""
        self._deform(at, terms)
        self._touch(at, base, terms)
        self._press(at, base, terms)

    def _deform(self, at: Kinematics, terms: Mapping[str, Values]) -> None:
        """Fill in delta = x - e and its rate."""
        at.delta, at.delta_rate = at.displacement, at.velocity
        for effect in self._filling(TransmissionErrorSource):
            error, rate = effect.error(at, terms[effect.name])
            at.delta, at.delta_rate = at.delta - error, at.delta_rate - rate

    def _press(self, at: Kinematics, base: Values, terms: Mapping[str, Values]) -> None:
        """Fill in the load of the torques, what of it is unbalanced, and the load that reaches the mesh."""
        forces = [(e.is_unbalanced, e.load_force(at, terms[e.name])) for e in self._filling(Load)]
        load = self.system.load(at, base) + sum(force for _, force in forces)
        at.unbalanced_load = sum(force for is_unbalanced, force in forces if is_unbalanced)
        for effect in self._filling(LoadFactor):
            factor = effect.load_factor(at, terms[effect.name])
            load, at.unbalanced_load = load * factor, at.unbalanced_load * factor
        at.drive_load = load
        for effect in self._filling(LoadPath):
            load = effect.transmitted_load(at, terms[effect.name])
        at.load = load + at.inputs.get(HELD_LOAD, 0.0)

    def _touch(self, at: Kinematics, base: Values, terms: Mapping[str, Values]) -> None:
        """Fill in deflection, contact, stiffness and normal force."""
        at.deflection, at.contact = at.delta, torch.ones_like(at.delta)
        for effect in self._filling(Contact):
            at.deflection, at.contact = effect.deflect(at, terms[effect.name])
            at.clearances = effect.clearances(at, terms[effect.name])
        meshes = self._filling(MeshStiffness)
        at.stiffness = meshes[0].stiffness(at, terms[meshes[0].name]) if meshes else self.system.stiffness(base)
        for effect in self._filling(StiffnessFactor):
            at.stiffness = at.stiffness * effect.factor(at, terms[effect.name])
        elastic = sum(e.elastic_force(at, terms[e.name]) for e in self._filling(ElasticForce))
        at.normal_force = at.stiffness * at.deflection + elastic
