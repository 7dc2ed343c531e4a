"""Gear pairs that are heard through a casing: mesh force, unknown path, tacho; an independent truth.

Nothing here comes from the package. The mesh is a sum of tooth pairs, each a spring of its own with its own error;
the motion is stepped by Runge-Kutta propagators; the path is a sum of modes.
"""

from .case import CasingCase, draw_case
from .write import write_case

__all__ = ["CasingCase", "draw_case", "write_case"]
