"""A model: one base system and the effects that are added to it, with their values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem, nearest, with_article
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.known import systems_of
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import (
    Contact,
    ContactChange,
    DampingLaw,
    Effect,
    LoadPath,
    MeshStiffness,
    SystemChange,
)
from gear_damping.units import parse_unit

Named = dict[str, Tensor]


@dataclass(frozen=True)
class Prepared:
    """A batch of one model in natural units, ready to integrate.

    Args:
        scales: Natural units of each member.
        base: Parameters and derived quantities of the system, natural units; for a gear pair also the
            zone of double contact, `contact_ratio` and `contact_lead` (rad of mesh angle).
        terms: For each effect name what its `prepare` gave, natural units.
        derived: Derived quantities of the system in SI.
        refinement: How much finer the steps must be than the rates alone ask for.
    """

    scales: Scales
    base: Named
    terms: dict[str, Named]
    derived: Named
    refinement: float = 1.0


class Model:
    """A base system with effects; values live outside it, as tensors by flat name.

    The flat name of a system's parameter is its own (`pinion_torque`), that of an effect's is
    `effect.parameter` (`backlash.gap`). It is fixed once it is made.
    """

    system: System
    effects: tuple[Effect, ...]
    _mesh: MeshStiffness | None

    def __init__(self, system: System, effects: Sequence[Effect] = ()) -> None:
        """Compose the model.

        Raises:
            InputError: an effect does not go with the system, is there twice, or a slot that holds
                one term (mesh stiffness, contact) is filled wrongly; or one of them is none.
        """
        _refuse_others(system, effects)
        effects = tuple(effects)
        mesh = next((effect for effect in effects if isinstance(effect, MeshStiffness)), None)
        vars(self).update(system=system, effects=effects, _mesh=mesh)
        problems = list(_composition_problems(system, self.effects))
        if problems:
            raise InputError(problems)

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse a new value.

        Raises:
            InputError: says how another model is made.
        """
        rule = "cannot be set: a model is fixed once it is made"
        remedy = "make another one with it: gd.Model(system, effects), where system and effects hold the values"
        raise InputError(Problem(f"model.{name}", rule, value, remedy))

    def parameters(self) -> dict[str, Parameter]:
        """Every parameter by its flat name."""
        found = {p.name: p for p in self.system.parameters}
        for effect in self.effects:
            found |= {f"{effect.name}.{p.name}": p for p in effect.parameters}
        return found

    @property
    def flanks_may_part(self) -> bool:
        """Whether there is a gap between them."""
        return any(isinstance(effect, Contact) for effect in self.effects)

    @property
    def damping_laws(self) -> tuple[DampingLaw, ...]:
        """The effects that state a damping ratio."""
        return tuple(effect for effect in self.effects if isinstance(effect, DampingLaw))

    @property
    def damping_coefficient(self) -> str | None:
        """Flat name of the coefficient of its one damping law; None where there is not one."""
        laws = self.damping_laws
        return f"{laws[0].name}.{laws[0].parameters[0].name}" if len(laws) == 1 else None

    @property
    def given(self) -> dict[str, float | tuple[float, ...]]:
        """Parameters with which its system and effects were made, in SI by flat name."""
        own = {f"{effect.name}.{name}": value for effect in self.effects for name, value in effect.given.items()}
        return {**self.system.given, **own}

    def values(self, batch: int, **given: float | Sequence[float] | Tensor) -> dict[str, Tensor]:
        """Values for a batch in SI: the model's own and the defaults, with those in `given` put in their place.

        Flat names with a dot are given as `**{"backlash.gap": 1e-4}`. Scalars are shared by the
        batch; tensors have shape (batch,), or (n, batch) for list-valued parameters.

        Raises:
            InputError: a name is unknown, or a parameter without a default is not given.
        """
        declared, given = self.parameters(), self.given | given
        problems = [Problem(k, "no such parameter", remedy=nearest(k, list(declared))) for k in given.keys() - declared]
        chosen = {name: given.get(name, p.default) for name, p in declared.items()}
        problems += [Problem(k, "must be given", remedy=declared[k].meaning) for k, v in chosen.items() if v is None]
        if problems:
            raise InputError(problems)
        return {name: _as_rows(value, batch, declared[name].vector) for name, value in chosen.items()}

    def prepare(self, values: Mapping[str, Tensor], scales: Scales | None = None) -> Prepared:
        """Everything the equation needs, in natural units, from SI values by flat name.

        Args:
            values: Parameters in SI.
            scales: Units to use in place of the members' own.
        """
        own = {p.name: values[p.name] for p in self.system.parameters}
        given = {e.name: {p.name: values[f"{e.name}.{p.name}"] for p in e.parameters} for e in self.effects}
        derived, zone = self._derived(own, given)
        for effect in self.effects:
            if isinstance(effect, SystemChange):
                derived = effect.change(given[effect.name], derived)
        scales = scales or self.system.scales(derived)
        units = {p.name: p.unit for p in self.system.parameters} | self.system.derived_units
        base = {k: v / scales.unit_of(parse_unit(units[k]).dimension) for k, v in (own | derived).items()} | zone
        terms = {e.name: e.prepare(e.to_natural(given[e.name], scales), base) for e in self.effects}
        refinement = max((effect.refinement for effect in self.effects), default=1.0)
        return Prepared(scales, base, terms, derived, refinement)

    def _derived(self, own: Named, given: dict[str, Named]) -> tuple[Named, Named]:
        """Derived quantities in SI, and the zone of double contact; a change of it goes into `given`."""
        if self._mesh is None:
            return self.system.derived(own, None), {}
        mesh = given[self._mesh.name]
        derived = self.system.derived(own, self._mesh.mean(mesh))
        lead = torch.zeros_like(mesh["contact_ratio"])
        for effect in self.effects:
            if isinstance(effect, ContactChange):
                mesh["contact_ratio"], lead = effect.contact(given[effect.name], mesh["contact_ratio"], derived)
                derived = self.system.derived(own, self._mesh.mean(mesh))
        return derived, {"contact_ratio": mesh["contact_ratio"], "contact_lead": lead}


# of which a model takes one: the quantity is theirs alone
ALONE: dict[type[Effect], str] = {
    Contact: "define the contact",
    LoadPath: "stand between the torques and the mesh",
    ContactChange: "change the zone of double contact",
}


def _refuse_others(system: object, effects: object) -> None:
    """Whatever is no system and no list of effects.

    Raises:
        InputError: says what it is instead.
    """
    if not isinstance(system, System):
        remedy = "give a system first, for example GearPair()"
        raise InputError(Problem("system", "is no system", _shown(system), remedy))
    if isinstance(effects, Effect) or not isinstance(effects, Sequence):
        raise InputError(Problem("effects", "must be a list", _shown(effects), "put the effects into [ ]"))
    wrong = [effect for effect in effects if not isinstance(effect, Effect)]
    remedy = "give effects with their values, for example [Backlash(gap=80e-6)]"
    if wrong:
        raise InputError([Problem("effects", "is no effect", _shown(one), remedy) for one in wrong])


def _shown(given: object) -> str:
    return f"the class {given.__name__}, which is not called" if isinstance(given, type) else repr(given)


def _composition_problems(system: System, effects: Sequence[Effect]) -> list[Problem]:
    problems = []
    names = [effect.name for effect in effects]
    for effect in effects:
        if not system.has(*effect.needs):
            rule = f"does not go with the system '{system.name}'"
            fitting = " or ".join(systems_of(type(effect))) or f"a system with {' and '.join(effect.needs)}"
            problems.append(Problem(f"simulator.{effect.name}", rule, remedy=f"it needs {fitting}"))
        if names.count(effect.name) > 1:
            problems.append(Problem(f"simulator.{effect.name}", "is there twice", remedy="name it once"))
        problems += [
            Problem(f"simulator.{effect.name}", f"needs the effect '{name}'", remedy=f"add simulator.{name}={{}}")
            for name in effect.requires
            if name not in names
        ]
    meshes = sum(isinstance(effect, MeshStiffness) for effect in effects)
    wanted = 1 if system.has(Trait.TEETH) else 0
    if meshes != wanted:
        rule = f"{with_article(system.name)} has {wanted} mesh stiffness, here there are {meshes}"
        problems.append(Problem("simulator.mesh_stiffness", rule, remedy="choose one form of mesh stiffness"))
    for kind, does in ALONE.items():
        found = [effect.name for effect in effects if isinstance(effect, kind)]
        if len(found) > 1:
            rule = f"{' and '.join(found)} each {does}, and one would silently undo the other"
            problems.append(Problem("simulator", rule, remedy="keep one of them"))
    return problems


def _as_rows(value: float | Sequence[float] | Tensor, batch: int, vector: bool) -> Tensor:
    tensor = torch.as_tensor(value, dtype=torch.float64)
    if vector and tensor.ndim < 2:
        tensor = tensor.reshape(-1, 1)
    shape = (tensor.shape[0], batch) if vector else (batch,)
    return tensor.expand(shape).clone()
