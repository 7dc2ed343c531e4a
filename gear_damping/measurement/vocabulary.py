"""The words of measurement.yaml as plain tables, taken from their declarations."""

from types import MappingProxyType as Frozen

from gear_damping.measurement import layout, rig
from gear_damping.measurement.channels import AnyChannel, Held, Speed
from gear_damping.schema.mappings import Declared, inner_model, kind_of, names

SYSTEMS = layout.SYSTEMS
GEAR_TORQUE_MODES = rig.GEAR_TORQUE_MODES


def channels_of(model: type[Declared]) -> dict[str, type[AnyChannel]]:
    """The channels that a mapping may hold, by name."""
    found = {name: inner_model(info) for name, info in names(model).items()}
    return {name: kind for name, kind in found.items() if kind and issubclass(kind, AnyChannel)}


def units_of(model: type[Declared]) -> Frozen[str, str | None]:
    """The unit of every quantity that a mapping may hold, by name."""
    return Frozen({name: kind_of(info).unit for name, info in names(model).items()})


_GEAR, _OSCILLATOR = channels_of(layout.GearChannels), channels_of(layout.OscillatorChannels)
CHANNEL_MODELS = Frozen({"gear_pair": Frozen(_GEAR), "oscillator": Frozen(_OSCILLATOR)})
CHANNELS = Frozen({system: tuple(models) for system, models in CHANNEL_MODELS.items()})
# channel -> the SI unit that its values are converted to
GEAR_CHANNELS = Frozen({name: kind.si for name, kind in _GEAR.items()})
# channel -> how many times the displacement is differentiated; None for an input
OSCILLATOR_CHANNELS = Frozen({name: kind.derivative for name, kind in _OSCILLATOR.items()})
# given to the system, not its response
HOLDABLE = tuple(name for name, kind in (_GEAR | _OSCILLATOR).items() if issubclass(kind, Held))
SHAFT_SPEEDS = tuple(name for name, kind in _GEAR.items() if issubclass(kind, Speed))
INPUTS = tuple(name for name, kind in (_GEAR | _OSCILLATOR).items() if kind.is_input)
# name -> SI unit; "own": in the units that the oscillator was measured in
PARAMETERS = Frozen({"gear_pair": units_of(rig.GearParameters), "oscillator": units_of(rig.OscillatorParameters)})
