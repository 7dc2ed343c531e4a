"""Every term equals an independent form of it, written in numpy and SI."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from effect_bench import EFFECTS, Bench
from gear_case import GearCase, Ripple
from gear_terms import sampled

from gear_damping.physics.terms import DampingForce, ExtraStates

TURNED = {"mesh_phase": 0.7, "pinion_angle": 0.3, "gear_phase": 1.1, "pinion_torque": 90.0}
CASE = GearCase(mesh_phase=0.7, pinion_angle_0=0.3, gear_angle_0=1.1, torque=90.0)


def close(found: torch.Tensor, wanted: np.ndarray, share: float = 1e-11) -> None:
    wanted = np.asarray(wanted)
    assert np.abs(found.numpy() - wanted).max() <= share * np.abs(wanted).max()


@pytest.mark.parametrize(
    ("options", "given", "case"),
    [
        ({}, {}, {}),
        ({"n_harmonics": 1}, {}, {"n_harmonics": 1}),
        ({"weighting": "lanczos", "n_harmonics": 12}, {}, {"weighting": "lanczos", "n_harmonics": 12}),
        ({"n_harmonics": 13}, {"contact_ratio": 1.37}, {"n_harmonics": 13, "contact_ratio": 1.37}),
        ({"n_harmonics": 32}, {"maximum": 5e8, "minimum": 1e8}, {"n_harmonics": 32, "k_max": 5e8, "k_min": 1e8}),
    ],
)
def test_fourier_mesh_stiffness(options, given, case):
    own = {f"fourier_mesh_stiffness.{k}": v for k, v in given.items()}
    bench = Bench("fourier_mesh_stiffness", options, TURNED | own)
    found = bench.evaluated().stiffness * bench.unit("N/m")
    close(found, sampled(replace(CASE, **case), "stiffness", bench.times().numpy()))


def test_edges_take_up_the_load_over_a_share_of_the_mesh_period():
    """The harmonics of a rectangle that is averaged over the edge, by integration."""
    own = {"fourier_mesh_stiffness.edge": 0.2, "fourier_mesh_stiffness.contact_ratio": 1.45}
    bench = Bench("fourier_mesh_stiffness", {"n_harmonics": 5}, {"mesh_phase": 0.0} | own, batch=50)
    place = (np.arange(200_000) + 0.5) / 200_000  # of the mesh period
    ramp = np.clip((0.45 / 2 + 0.1 - np.abs((place - 0.45 / 2 + 0.5) % 1 - 0.5)) / 0.2, 0, 1)
    lines = [2 * np.mean(2e8 * ramp * np.exp(-2j * np.pi * h * place)) for h in range(1, 6)]
    turns = np.arange(50) / 50
    wanted = (
        2e8
        + 2e8 * ramp.mean()
        + sum((line * np.exp(2j * np.pi * h * turns)).real for h, line in enumerate(lines, start=1))
    )
    at = bench.evaluated(time=torch.as_tensor(turns * CASE.mesh_period))
    close(at.stiffness * bench.unit("N/m"), wanted, 1e-8)


def test_rectangular_mesh_stiffness():
    given = TURNED | {"rectangular_mesh_stiffness.contact_ratio": 1.4}
    bench = Bench("rectangular_mesh_stiffness", {}, given, batch=200)
    found = bench.evaluated().stiffness * bench.unit("N/m")
    case = replace(CASE, stiffness_form="rectangular", contact_ratio=1.4)
    wanted = sampled(case, "stiffness", bench.times().numpy())
    close(found, wanted)
    assert set(np.round(wanted)) == {2e8, 4e8}


@pytest.mark.parametrize("name", ["fourier_mesh_stiffness", "rectangular_mesh_stiffness"])
def test_the_mean_of_the_mesh_stiffness_is_its_time_mean(name):
    bench = Bench(name, batch=5000)
    period = CASE.mesh_period
    at = bench.evaluated(time=(torch.arange(5000, dtype=torch.float64) + 0.5) / 5000 * period)
    found = (at.stiffness * bench.unit("N/m")).mean()
    assert found.item() == pytest.approx(bench.prepared.derived["mean_stiffness"][0].item(), rel=1e-9)


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
def test_stiffness_modulation(shaft):
    name = f"{shaft}_stiffness_modulation"
    bench = Bench(name, {}, TURNED | {f"{name}.amplitude": 0.03, f"{name}.phase": 0.4})
    case = replace(CASE, **{name: (0.03, 0.4)})
    close(bench.evaluated().stiffness * bench.unit("N/m"), sampled(case, "stiffness", bench.times().numpy()))


def errors(bench: Bench) -> tuple[torch.Tensor, torch.Tensor]:
    at = bench.evaluated()
    e, rate = bench.equation.imposed_error(at, bench.prepared.terms)
    return e * bench.unit("m"), rate * bench.unit("m/s")


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
def test_eccentricity(shaft):
    name = f"{shaft}_eccentricity"
    bench = Bench(name, {}, TURNED | {f"{name}.amplitude": 3e-5, f"{name}.phase": 0.4})
    case = replace(CASE, **{name: (3e-5, 0.4)})
    close(errors(bench)[0], sampled(case, "error", bench.times().numpy()))


def test_profile_error():
    given = {"profile_error.amplitudes": [3e-6, 2e-6, 1e-6], "profile_error.phases": [0.1, -0.4, 2.0]}
    bench = Bench("profile_error", {}, TURNED | given)
    case = replace(CASE, profile_error=((1, 3e-6, 0.1), (2, 2e-6, -0.4), (3, 1e-6, 2.0)))
    close(errors(bench)[0], sampled(case, "error", bench.times().numpy()))


@pytest.mark.parametrize("name", ["pinion_eccentricity", "gear_eccentricity", "profile_error", "pitch_error"])
def test_the_rate_of_an_error_is_its_derivative_in_time(name):
    given = {f"{name}.phase": 0.4} if name != "profile_error" else {}
    bench, width = Bench(name, {}, TURNED | given), 1e-7
    rate = errors(bench)[1]
    ends = []
    for shift in (-width, width):
        at = bench.kinematics(bench.times() + shift, bench.random())
        ends.append(bench.equation.imposed_error(at, bench.prepared.terms)[0] * bench.unit("m"))
    close(rate, (ends[1] - ends[0]).numpy() / (2 * width), 1e-6)


@pytest.mark.parametrize(("shaft", "teeth"), [("pinion", 20), ("pinion", 21), ("gear", 40)])
def test_pitch_error_goes_through_its_values_without_their_mean(shaft, teeth):
    source = np.random.default_rng(1)
    values = 1e-6 * source.standard_normal(teeth)
    angle = 2 * np.pi * np.arange(teeth) / teeth
    given = {"pitch_error.values": values.tolist(), f"n_teeth_{shaft}": teeth, "pitch_error.phase": 0.5}
    bench = Bench("pitch_error", {"shaft": shaft, "form": "interpolated"}, given, batch=teeth)
    speed = 4600 * math.pi / 30 * (1.0 if shaft == "pinion" else 0.5)
    at = bench.evaluated(time=torch.as_tensor((angle + 2 * np.pi - 0.5) / speed))
    found = bench.equation.imposed_error(at, bench.prepared.terms)[0] * bench.unit("m")
    close(found, values - values.mean())


@pytest.mark.parametrize("edge", [1.0, 0.7, 0.2])
@pytest.mark.parametrize("rounding", [0.0, 1.0])
@pytest.mark.parametrize(("shaft", "teeth", "share"), [("pinion", 20, 0.4), ("pinion", 21, 0.7), ("gear", 40, 1.0)])
def test_pitch_error_is_that_of_the_tooth_in_mesh_and_hands_over(shaft, teeth, share, rounding, edge):
    """The next tooth takes over in two ramps, at the ends of the handover, whose rate is even or goes like 1 - cos."""
    source = np.random.default_rng(2)
    values = 1e-6 * source.standard_normal(teeth)
    values -= values.mean()
    fine = 400  # angles a pitch
    at = (np.arange(fine) + 0.5) / fine
    begins = 0.5 - share / 2 + np.array([[0.0], [share * (1 - edge)]])
    passed = (at - begins) / (share * edge)
    pace = np.where((passed > 0) & (passed < 1), 1 - rounding * np.cos(2 * np.pi * passed), 0.0).sum(0)
    taken = np.cumsum(pace) / pace.sum()
    expected = values[:, None] + (np.roll(values, -1) - values)[:, None] * taken
    given = {"pitch_error.values": values.tolist(), f"n_teeth_{shaft}": teeth, "pitch_error.handover": share}
    given |= {"pitch_error.rounding": rounding, "pitch_error.phase": 0.3, "pitch_error.edge": edge}
    bench = Bench("pitch_error", {"shaft": shaft}, given, batch=teeth * fine)
    speed = 4600 * math.pi / 30 * (1.0 if shaft == "pinion" else 0.5)
    angle = 2 * np.pi * (np.arange(teeth * fine) + 1) / (teeth * fine) + 2 * np.pi - 0.3
    at = bench.evaluated(time=torch.as_tensor(angle / speed))
    found = bench.equation.imposed_error(at, bench.prepared.terms)[0] * bench.unit("m")
    close(found, expected.reshape(-1), 1e-2)  # of sums over small steps


def load(bench: Bench) -> torch.Tensor:
    return bench.evaluated().load * bench.unit("N")


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("form", ["steps", "ramp", "sine"])
def test_torque_variation(form, held):
    given = {
        "torque_variation.step_times": [0.004, 0.012],
        "torque_variation.step_changes": [30.0, -50.0],
        "torque_variation.ramp_start": 0.004,
        "torque_variation.ramp_end": 0.02,
        "torque_variation.ramp_change": 40.0,
        "torque_variation.sine_phase": 0.3,
        "gear_torque": 170.0,
    }
    system = {"gear_torque_mode": "held"} if held else {}
    bench = Bench("torque_variation", {"form": form}, TURNED | given, system_options=system)
    shapes = {
        "steps": {"torque_steps": ((0.004, 30.0), (0.012, -50.0))},
        "ramp": {"torque_ramp": (0.004, 0.02, 40.0)},
        "sine": {"torque_sine": (15.0, 40.0, 0.3)},
    }
    case = replace(CASE, gear_torque=170.0 if held else None, **shapes[form])
    close(load(bench), sampled(case, "load", bench.times().numpy()))


def test_a_ramp_without_length_is_a_step():
    given = {"torque_variation.ramp_start": 0.01, "torque_variation.ramp_end": 0.01}
    bench = Bench("torque_variation", {"form": "ramp"}, given)
    radius = GearCase().base_radii[0]
    close(load(bench), np.where(bench.times().numpy() > 0.01, 180.0, 150.0) / radius)


def test_torque_ripple():
    given = {"torque_ripple.amplitude": 4.0, "torque_ripple.order": 3.0, "torque_ripple.phase": 0.2}
    bench = Bench("torque_ripple", {}, TURNED | given)
    wave = Ripple(4.0 / CASE.base_radii[0], 3.0, 0.2)
    close(load(bench), sampled(replace(CASE, ripple=(wave,)), "load", bench.times().numpy()))


def test_a_proportional_ripple_scales_the_varying_torque_but_not_the_drawn_load():
    given = {"torque_ripple.share": 0.1, "torque_ripple.order": 2.0, "torque_ripple.phase": 0.2}
    bench = Bench("torque_ripple", {"proportional": True}, TURNED | given, others=("torque_variation",))
    drawn = torch.linspace(-1, 1, bench.batch, dtype=torch.float64) * 100
    at = bench.kinematics(bench.times(), bench.random(), {"held_load": drawn / bench.unit("N")})
    bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    steps = ((0.0125, 30.0), (0.025, -45.0), (0.0375, 30.0))
    case = replace(CASE, torque_steps=steps, ripple=(Ripple(0.1, 2.0, 0.2, proportional=True),))
    close(at.load * bench.unit("N"), sampled(case, "load", bench.times().numpy()) + drawn.numpy())


def test_windage_drag_takes_from_the_torque_and_turns_with_the_rotation():
    for sign in (1.0, -1.0):
        bench = Bench("windage_drag", {}, {"windage_drag.coefficient": 5e-6, "pinion_speed": sign * 480.0})
        wanted = (150.0 - sign * 5e-6 * 480.0**2) / GearCase().base_radii[0]
        close(load(bench), np.full(bench.batch, wanted))


def test_offset_force():
    bench = Bench("offset_force", {}, {"offset_force.force": -0.3})
    close(bench.evaluated().load * bench.unit("N"), np.full(bench.batch, -0.3))


DAMPING = {
    "viscous_damping": lambda p, d, v, s: p["damping_coefficient"] * v,
    "power_law_damping": lambda p, d, v, s: p["coefficient"] * np.sign(v) * np.abs(v) ** p["exponent"],
    "coulomb_friction": lambda p, d, v, s: p["force"] * np.tanh(v / (p["width"] * s)),
    "hunt_crossley_damping": lambda p, d, v, s: (
        p["damping_coefficient"] * (np.abs(d) / p["reference_deflection"]) ** p["exponent"] * v
    ),
}


@pytest.mark.parametrize("name", DAMPING)
def test_damping_forces(name):
    given = {"power_law_damping.exponent": 1.7} if name == "power_law_damping" else {}
    bench = Bench(name, {}, given, others=("backlash", "pinion_eccentricity"))
    at = bench.evaluated()
    assert not torch.allclose(at.delta_rate, at.velocity, rtol=1e-3)
    assert not torch.allclose(at.deflection, at.delta, rtol=1e-3)
    p = {k: v.numpy() for k, v in bench.own.items()}
    found = bench.effect.damping_force(at, bench.p) * bench.unit("N")
    deflection, rate = (at.deflection * bench.unit("m")).numpy(), (at.delta_rate * bench.unit("m/s")).numpy()
    scale = CASE.natural_frequency * replace(CASE, torque=150.0).static_deflection
    close(found, DAMPING[name](p, deflection, rate, scale))


def test_asymmetric_friction_has_its_own_values_in_each_direction():
    given = {"asymmetric_friction.damping_forward": 40.0, "asymmetric_friction.damping_backward": 90.0}
    given |= {"asymmetric_friction.width": 0.02}
    bench = Bench("asymmetric_friction", {}, given)
    fast = torch.linspace(0.3, 1.0, bench.batch, dtype=torch.float64)
    for v, force, damping in ((fast, 20.0, 40.0), (-fast, -10.0, 90.0)):
        at = bench.kinematics(bench.times(), (torch.full_like(v, 1e-5), v))
        bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
        close(bench.effect.damping_force(at, bench.p) * bench.unit("N"), force + damping * v.numpy())


@pytest.mark.parametrize("rest", [0.0, 0.4, 1.0])
def test_asymmetric_friction_at_rest_is_a_share_of_the_mean_of_both_forces(rest):
    """With all of it the two forces change over by a convex combination (Filippov 1988)."""
    width, force = 0.05, {"forward": 20.0, "backward": 50.0}
    given = {f"asymmetric_friction.force_{way}": size for way, size in force.items()}
    given |= {"asymmetric_friction.width": width, "asymmetric_friction.rest_share": rest}
    bench = Bench("asymmetric_friction", {}, given)
    v = torch.linspace(-0.3, 0.3, bench.batch, dtype=torch.float64)
    at = bench.kinematics(bench.times(), (torch.full_like(v, 1e-5), v))
    bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    found = bench.effect.damping_force(at, bench.p) * bench.unit("N")
    scale = CASE.natural_frequency * replace(CASE, torque=150.0).static_deflection
    ahead = 1 / (1 + np.exp(-2 * v.numpy() / (width * scale)))
    convex = force["forward"] * ahead - force["backward"] * (1 - ahead)
    still = (force["forward"] - force["backward"]) / 2 * 4 * ahead * (1 - ahead)  # of that, what is there at rest
    close(found, convex - (1 - rest) * still)


def test_squeeze_film_damping_acts_across_the_gap():
    given = {"backlash.gap": 1e-4, "squeeze_film_damping.film_thickness": 8e-6}
    bench = Bench("squeeze_film_damping", {}, given)
    at = bench.evaluated()
    x, v = (s.numpy() for s in bench.random())
    drive, coast = np.maximum(-x, 0), np.maximum(x + 1e-4, 0)
    assert (drive > 0).any()
    assert (coast == 0).any()
    assert (drive == 0).any()
    h = 8e-6
    force = 64.5 * v * ((h / (h + drive)) ** 3 + (h / (h + coast)) ** 3)
    close(bench.effect.damping_force(at, bench.p) * bench.unit("N"), force)
    close((at.mesh_force - at.normal_force) * bench.unit("N"), force, 1e-9)


ELASTIC = {
    "cubic_stiffness": lambda p, d: p["coefficient"] * d**3,
    "quadratic_stiffness": lambda p, d: p["coefficient"] * d**2,
    "sine_restoring": lambda p, d: p["stiffness"] * p["length"] * np.sin(d / p["length"]),
}


@pytest.mark.parametrize("name", ELASTIC)
def test_elastic_forces(name):
    given = {"sine_restoring.length": 0.7, "amplitude": 2.0} if name == "sine_restoring" else {}
    bench = Bench(name, {}, given, others=("backlash",))
    at = bench.evaluated()
    assert bench.kind == "oscillator" or not torch.allclose(at.deflection, at.delta, rtol=1e-3)
    wanted = ELASTIC[name]({k: v.numpy() for k, v in bench.own.items()}, (at.deflection * bench.unit("m")).numpy())
    close(bench.effect.elastic_force(at, bench.p) * bench.unit("N"), wanted)


def test_hertz_stiffness():
    bench = Bench("hertz_stiffness", {}, {"hertz_stiffness.exponent": 0.5}, others=("backlash",))
    at = bench.evaluated()
    x = bench.random()[0].numpy()
    d = np.where(x > 0, x, np.minimum(x + 1e-4, 0))
    force = sampled(GearCase(), "stiffness", bench.times().numpy()) * d * (np.abs(d) / 1.66e-5) ** 0.5
    close(at.normal_force * bench.unit("N"), force)


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
@pytest.mark.parametrize("edges", ["switched", "smooth"])
@pytest.mark.parametrize("extent", [0.4, 1.0])
def test_tooth_crack_softens_the_mesh_in_the_middle_of_the_contact_of_its_tooth(shaft, edges, extent):
    given = {"tooth_crack.depth": 0.2, "tooth_crack.phase": 0.4, "tooth_crack.edge": 1e-6, "pinion_angle": 0.3}
    given["tooth_crack.extent"] = extent
    bench = Bench("tooth_crack", {"shaft": shaft, "edges": edges}, given, batch=400)
    speed, teeth = 4600 * math.pi / 30, 20
    angle = 0.3 + speed * bench.times().numpy()
    angle, teeth = (angle, teeth) if shaft == "pinion" else (angle / 2, 40)
    contact = 2 * np.pi * 1.6 / teeth
    since = np.mod(angle + 0.4, 2 * np.pi)
    inside = (since > contact * (1 - extent) / 2) & (since < contact * (1 + extent) / 2)
    assert 0.01 < inside.mean() < 0.15
    close(bench.effect.factor(bench.evaluated(), bench.p), 1 - 0.2 * inside)


@pytest.mark.parametrize("shaft", ["pinion", "gear"])
@pytest.mark.parametrize("edges", ["switched", "smooth"])
def test_a_halved_crack_takes_what_one_of_equally_stiff_pairs_loses(shaft, edges):
    """Pairs of stiffness 1, or of 1/2 while two carry: the mesh has lost d times the pair's over that of all."""
    given = {"tooth_crack.depth": 0.2, "tooth_crack.phase": 0.4, "tooth_crack.edge": 1e-6, "pinion_angle": 0.3}
    bench = Bench("tooth_crack", {"shaft": shaft, "edges": edges, "halved": True}, given, batch=2000)
    angle = 0.3 + 4600 * math.pi / 30 * bench.times().numpy()
    angle, teeth = (angle, 20) if shaft == "pinion" else (angle / 2, 40)
    met = np.mod((angle + 0.4) * teeth / (2 * np.pi), teeth)  # base pitches since the tooth came into contact
    carries = met < 1.6
    others = sum((met + step > 0) & (met + step < 1.6) for step in (-1, 1))
    own = carries / (1 + others)
    assert {0.0, 0.5, 1.0} == set(np.unique(own))
    close(bench.effect.factor(bench.evaluated(), bench.p), 1 - 0.2 * own)


@pytest.mark.parametrize(("extent", "edge"), [(1.0, 0.02), (0.2, 0.3)])
def test_a_crack_with_smooth_edges_takes_its_whole_depth_in_the_middle_of_the_contact(extent, edge):
    middle = math.pi * 1.6 / 20 - 0.4  # pinion angle at which the tooth is half through its contact
    given = {"tooth_crack.depth": 0.2, "tooth_crack.phase": 0.4, "tooth_crack.extent": extent}
    bench = Bench("tooth_crack", {}, given | {"tooth_crack.edge": edge, "pinion_angle": middle}, batch=400)
    factor = bench.effect.factor(bench.evaluated(), bench.p)
    assert float(factor.min()) == pytest.approx(0.8, abs=1e-4)
    assert float(factor.max()) == pytest.approx(1.0, abs=1e-4)


def test_backlash_has_two_flanks_and_damps_in_contact_only():
    bench = Bench("backlash", {}, {"backlash.gap": 8e-5}, others=("viscous_damping",))
    at = bench.evaluated()
    x, v = (s.numpy() for s in bench.random())
    deflection = np.where(x > 0, x, np.where(x < -8e-5, x + 8e-5, 0.0))
    assert {-1.0, 0.0, 1.0} == set(np.sign(deflection))
    force = sampled(GearCase(), "stiffness", bench.times().numpy()) * deflection
    close(at.mesh_force * bench.unit("N"), force + 64.5 * v * (deflection != 0))
    drive, coast = (h * bench.unit("m") for h in at.clearances)
    close(drive, np.maximum(-x, 0))
    close(coast, np.maximum(x + 8e-5, 0))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "name",
    [n for n, c in EFFECTS.items() if c.dissipative and issubclass(c, DampingForce) and not issubclass(c, ExtraStates)],
)
def test_a_dissipative_force_never_drives_the_motion(name, seed):
    bench = Bench(name)
    at = bench.evaluated(seed)
    power = bench.effect.damping_force(at, bench.p) * at.delta_rate
    assert (power >= 0).all()
    assert (power > 0).any()
