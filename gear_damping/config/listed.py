"""Which keys take a list: asked where several values were typed, so that what takes long is imported then."""

from collections.abc import Mapping

OF_A_PLAN = ("speeds", "torques", "amplitudes", "durations", "unknown", "unknown_each")
NAMES = ("model.names", "model.plugins", "simulator.plugins")


def takes_list(key: str) -> bool:
    """Whether a key takes a list."""
    from gear_damping.config.keys import SCHEMA
    from gear_damping.physics.catalogue import catalogue
    from gear_damping.schema.values import Given, Levels, Names
    from gear_damping.units import SUFFIXES

    spelled = {key, key.rpartition("_")[0] if key.rpartition("_")[2] in SUFFIXES else key}
    if key in NAMES or any(f"plan.{name}" in spelled for name in OF_A_PLAN):
        return True
    group, effect, _ = (*key.split("."), "", "")[:3]
    if group == "simulator":
        parameters = catalogue()[effect].parameters if effect in catalogue() else ()
        return any(one.vector and f"{group}.{effect}.{one.name}" in spelled for one in parameters)
    kind = SCHEMA
    for part in key.split("."):
        kind = kind.get(part) if isinstance(kind, Mapping) else None
    return isinstance(kind.kind if isinstance(kind, Given) else kind, Names | Levels)
