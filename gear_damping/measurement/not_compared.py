"""What was recorded beside a response and is not compared with a simulation: said, so that nobody waits for it."""

from collections.abc import Iterator

from gear_damping.measurement.record import Finding, Record

_RESPONSES = ("transmission_error", "gear_speed")  # that make a record one of a simulation, not of a casing


def not_compared(record: Record) -> Iterator[Finding]:
    """A note for every channel that the explanation leaves aside."""
    if not any(name in record.channels for name in _RESPONSES):
        return
    acceleration = record.channels.get("acceleration")
    if acceleration is not None and acceleration.mounting == "casing":
        message = (
            "the path from the mesh to a casing is unknown, so that this accelerometer is not compared with the "
            "simulation; for its orders and its signs of damage, declare it in a file without the other responses"
        )
        yield Finding("not_compared", message, channel="acceleration", severity="note")
    if {"pinion_speed", "pinion_angle"} <= {*record.channels} and "transmission_error" in record.channels:
        message = (
            "the angle is the measured one, and beside a transmission error the pinion's speed is no response: "
            "it is checked against the angle and used for nothing else"
        )
        yield Finding("not_compared", message, channel="pinion_speed", severity="note")
