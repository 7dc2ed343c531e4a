"""Which keys take a list: asked where several values were typed, so that what takes long is imported then."""

from collections.abc import Mapping

OF_A_PLAN = (
    "plan.speeds", "plan.torques", "plan.amplitudes", "plan.durations", "plan.unknown", "plan.unknown_each",
)  # fmt: skip
NAMES = ("model.names", "model.plugins", "simulator.plugins")


def takes_list(key: str) -> bool:
    """Whether a key takes a list."""
    from gear_damping.config.keys import SCHEMA
    from gear_damping.config.quantities import split_suffix
    from gear_damping.physics.catalogue import catalogue
    from gear_damping.schema.values import Given, Levels, Names

    if key in NAMES or split_suffix(key, OF_A_PLAN)[0] in OF_A_PLAN:
        return True
    group, effect, _ = (*key.split("."), "", "")[:3]
    if group == "simulator":
        parameters = catalogue()[effect].parameters if effect in catalogue() else ()
        lists = [f"{group}.{effect}.{one.name}" for one in parameters if one.vector]
        return split_suffix(key, lists)[0] in lists
    kind = SCHEMA
    for part in key.split("."):
        kind = kind.get(part) if isinstance(kind, Mapping) else None
    return isinstance(kind.kind if isinstance(kind, Given) else kind, Names | Levels)
