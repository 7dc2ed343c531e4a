"""Sensors and kinds of noise that several cases share."""

from .sensors import Sensor

COUNTS = 14_745_600  # of an encoder with 3600 lines, interpolated 4096 times, in a revolution
WHITE, PINK, COLOURED = "white", "pink", "coloured"
AC = (("coupling", "AC"),)
ARBITRARY = (("datum", "arbitrary"),)
ERROR_UM = Sensor("transmission_error", "um", said=ARBITRARY)
ERROR_MM = Sensor("transmission_error", "mm", said=ARBITRARY)
ERROR_WITH_ZERO = Sensor("transmission_error", "um")
ERROR_OF_ENCODERS = Sensor("transmission_error", "m")  # laid on both shafts; no file holds it
