"""The mains: what a hum or a torque of theirs goes by."""

MAINS = (50.0, 60.0)  # Hz, of public grids
STRAYS = 0.5  # Hz, by which one strays before consumers are cut off
