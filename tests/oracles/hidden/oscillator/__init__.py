"""Hidden oscillators: what is measured on them, and the truth, made without the package that has to find it.

Everything inside is in natural units: time times the natural angular frequency, displacement over its amplitude.
"""

from .case import OscillatorCase, draw_oscillator
from .laws import OSCILLATOR_EFFECTS
from .write import write_oscillator

__all__ = ["OSCILLATOR_EFFECTS", "OscillatorCase", "draw_oscillator", "write_oscillator"]
