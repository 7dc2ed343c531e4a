"""gear_damping: how much damping a gear pair has, and why a simulation does not match a measurement."""

__version__ = "0.1.0"
