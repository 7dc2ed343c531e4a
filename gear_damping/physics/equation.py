"""The equation of motion: the sum of the model's terms at one instant.

m x'' + contact * F_d(delta') + N = F(t),   delta = x - e,   N = k * deflection + F_el
"""

from collections.abc import Mapping

import torch
from torch import Tensor

from gear_damping.physics.model import Model
from gear_damping.physics.moment import Moment
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

    def moment(self, time: Tensor, state: tuple[Tensor, ...], inputs: Values, base: Values) -> Moment:
        """The state at one instant, with the angles that belong to it."""
        turns = self.system.rotations(time, inputs, base)
        extra = dict(zip(self.extra_names, state[2:], strict=True))
        return Moment(time, state[0], state[1], extra=extra, inputs=inputs, **turns)

    def switches(self, now: Moment, terms: Mapping[str, Values]) -> dict[str, Tensor]:
        """Every switching function at this instant; a branch changes where one changes sign."""
        self._deform(now, terms)
        found: dict[str, Tensor] = {}
        for effect in self.switching:
            found |= effect.switches(now, terms[effect.name])
        return found

    def rates(self, now: Moment, base: Values, terms: Mapping[str, Values]) -> tuple[Tensor, ...]:
        """Rates of the states, in natural units; `now.locked` says which branch holds."""
        self._deform(now, terms)
        self._touch(now, base, terms)
        forces = [(e.acts_in_gap, e.damping_force(now, terms[e.name])) for e in self._filling(DampingForce)]
        in_contact = sum(force for in_gap, force in forces if not in_gap)
        now.mesh_force = now.normal_force + now.contact * in_contact + sum(force for in_gap, force in forces if in_gap)
        for effect in self._filling(MeshForceFactor):
            now.mesh_force = now.mesh_force * effect.force_factor(now, terms[effect.name])
        self._press(now, base, terms)
        now.bearing_force = sum(e.bearing_force(now, terms[e.name]) for e in self._filling(BearingForce))
        acceleration = (now.load - now.mesh_force) / base["equivalent_mass"]
        extra = (self._extra_rates(effect, now, terms) for effect in self._filling(ExtraStates))
        return now.velocity, acceleration, *(rate for rates in extra for rate in rates)

    def _extra_rates(self, effect: ExtraStates, now: Moment, terms: Mapping[str, Values]) -> list[Tensor]:
        rates = effect.state_rates(now, terms[effect.name])
        return [rates[name] for name in effect.states]

    def energy(self, now: Moment, base: Values, terms: Mapping[str, Values]) -> Tensor:
        """Kinetic energy and the energy of k * deflection, natural units."""
        self._deform(now, terms)
        self._touch(now, base, terms)
        return base["equivalent_mass"] * now.velocity**2 / 2 + now.stiffness * now.deflection**2 / 2

    def imposed_error(self, now: Moment, terms: Mapping[str, Values]) -> tuple[Tensor, Tensor]:
        """The geometric error e of the flanks and its rate at this instant."""
        self._deform(now, terms)
        return now.displacement - now.delta, now.velocity - now.delta_rate

    def _deform(self, now: Moment, terms: Mapping[str, Values]) -> None:
        """Fill in delta = x - e and its rate."""
        now.delta, now.delta_rate = now.displacement, now.velocity
        for effect in self._filling(TransmissionErrorSource):
            error, rate = effect.error(now, terms[effect.name])
            now.delta, now.delta_rate = now.delta - error, now.delta_rate - rate

    def _press(self, now: Moment, base: Values, terms: Mapping[str, Values]) -> None:
        """Fill in the load of the torques and the load that reaches the mesh."""
        load = self.system.load(now, base) + sum(e.load_force(now, terms[e.name]) for e in self._filling(Load))
        for effect in self._filling(LoadFactor):
            load = load * effect.load_factor(now, terms[effect.name])
        now.drive_load = load
        for effect in self._filling(LoadPath):
            load = effect.transmitted_load(now, terms[effect.name])
        now.load = load + now.inputs.get(HELD_LOAD, 0.0)

    def _touch(self, now: Moment, base: Values, terms: Mapping[str, Values]) -> None:
        """Fill in deflection, contact, stiffness and normal force."""
        now.deflection, now.contact = now.delta, torch.ones_like(now.delta)
        for effect in self._filling(Contact):
            now.deflection, now.contact = effect.deflect(now, terms[effect.name])
            now.clearances = effect.clearances(now, terms[effect.name])
        meshes = self._filling(MeshStiffness)
        now.stiffness = meshes[0].stiffness(now, terms[meshes[0].name]) if meshes else self.system.stiffness(base)
        for effect in self._filling(StiffnessFactor):
            now.stiffness = now.stiffness * effect.factor(now, terms[effect.name])
        elastic = sum(e.elastic_force(now, terms[e.name]) for e in self._filling(ElasticForce))
        now.normal_force = now.stiffness * now.deflection + elastic
