"""Effects in words, taken from their declarations: what kind of thing one is, what it does, what its numbers mean."""

from collections.abc import Mapping, Sequence

from gear_damping.physics import terms
from gear_damping.physics.catalogue import builtin_effects

# The first slot that an effect fills says what a simulation without it misses.
_KINDS: tuple[tuple[type[terms.Effect], str], ...] = (
    (terms.DampingForce, "a damping force"),
    (terms.ExtraStates, "a degree of freedom"),
    (terms.Sensor, "an error of the sensor"),
    (terms.TransmissionErrorSource, "an error in the geometry of the gears"),
    (terms.Contact, "a loss of contact"),
    (terms.ContactChange, "a change of the contact with the load"),
    (terms.StiffnessFactor, "a change of the stiffness"),
    (terms.MeshStiffness, "a change of the stiffness"),
    (terms.ElasticForce, "a restoring force"),
    (terms.MeshForceFactor, "a force between the flanks"),
    (terms.BearingForce, "a force on the bearing"),
    (terms.HeldLoad, "a random load"),
    (terms.Load, "a force of the load"),
    (terms.LoadFactor, "a force of the load"),
    (terms.LoadPath, "a part of the drive train"),
    (terms.SystemChange, "another inertia"),
)
UNKNOWN_KIND = "an effect of your own"


def words(name: str) -> str:
    """The name of an effect or a parameter in words."""
    return name.replace("_", " ")


def kind(name: str) -> str:
    """What kind of thing an effect is, with its article."""
    effect = builtin_effects().get(name)
    found = (phrase for slot, phrase in _KINDS if effect is not None and issubclass(effect, slot))
    return next(found, UNKNOWN_KIND)


def description(name: str, own: Mapping[str, str]) -> str:
    """One sentence about an effect: from `own`, else from its declaration; empty for an unknown one."""
    if name in own:
        return own[name]
    effect = builtin_effects().get(name)
    return (effect.__doc__ or "").strip().partition("\n")[0] if effect else ""


def equation(name: str) -> str:
    """The term that an effect adds; empty for an unknown one."""
    effect = builtin_effects().get(name)
    return effect.equation if effect else ""


def meaning(name: str, parameter: str) -> str:
    """What a parameter of an effect means; an element of a list (`values[3]`) means what the list does."""
    effect = builtin_effects().get(name)
    plain = parameter.partition("[")[0].removeprefix(f"{name}.")
    return next((p.meaning for p in effect.parameters if p.name == plain), "") if effect else ""


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names as they stand in a sentence: a, b and c."""
    names = [words(name) for name in names]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}" if names else ""
