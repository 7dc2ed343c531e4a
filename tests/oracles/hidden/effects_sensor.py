"""Hidden faults of the instruments that a catalogue of causes should know."""

from __future__ import annotations

from .effect import Effect, Params, phase, signed


def _encoder(rng, duration) -> Params:
    pinion, gear = ((1, 0), (0, 1), (1, 0.5))[int(rng.integers(3))]
    return {"pinion_amplitude": 1.4e-3 * pinion, "pinion_phase": phase(rng),
            "gear_amplitude": 0.7e-3 * gear, "gear_phase": phase(rng)}  # fmt: skip


SENSOR = (
    Effect(
        "encoder_error", _encoder,
        lambda p, record: {"encoder_1": p["pinion_amplitude"], "encoder_1_phase": p["pinion_phase"],
                           "encoder_2": p["gear_amplitude"], "encoder_2_phase": p["gear_phase"]},
        {"pinion_amplitude": 1, "gear_amplitude": 1},
    ),
    Effect(
        "shaft_angle_error", lambda rng, T: {"amplitude": 0.02, "phase": phase(rng)},
        lambda p, record: {"angle_error": p["amplitude"], "angle_error_phase": p["phase"]}, {"amplitude": 1},
        as_modelled=lambda p, record: {"wobble": p["amplitude"], "wobble_phase": p["phase"]},
    ),
    Effect(
        "sensor_gain", lambda rng, T: {"gain": 1.0 + signed(rng, 0.3)}, lambda p, record: {"gain": p["gain"]},
        shrink=lambda p, size: {"gain": 1.0 + (p["gain"] - 1.0) * size},
    ),
    Effect(
        "sensor_offset", lambda rng, T: {"offset": signed(rng, 1e-5)}, lambda p, record: {"offset": p["offset"]},
        {"offset": 1},
    ),
    Effect(
        "sensor_drift", lambda rng, T: {"rate": signed(rng, 2e-5 / T)}, lambda p, record: {"drift": p["rate"]},
        {"rate": 1},
    ),
    Effect(
        "sensor_delay", lambda rng, T: {"delay": 1e-4}, lambda p, record: {"delay": p["delay"]}, {"delay": 1},
    ),
    Effect(
        "sensor_lowpass", lambda rng, T: {"cutoff": 1500.0, "order": 2.0},
        lambda p, record: {"lowpass": p["cutoff"]}, {"cutoff": -0.4},
    ),
    Effect(
        "sensor_saturation", lambda rng, T: {"limit": 1e-5}, lambda p, record: {"limit": p["limit"]},
        {"limit": -0.2},
    ),
    Effect("sensor_quantisation", lambda rng, T: {"step": 1e-5}, lambda p, record: {"step": p["step"]}, {"step": 1}),
)  # fmt: skip
