"""Flanks that part in most records: damping and stiffness are found from what is stated of the rig."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
import torch
from second_rig.case import Case, Stream, write
from second_rig.channels import ERROR_UM, WHITE
from second_rig.files import Table
from second_rig.motion import Hidden, Run
from second_rig.pair import steel_rig
from second_rig.sensors import Noise

from gear_damping.explanation.evidence.records import Evidence, evidence_of
from gear_damping.explanation.explain import fitting_solver, with_noise
from gear_damping.explanation.model import parting_flanks
from gear_damping.explanation.model.parting_flanks import (
    are_crossed,
    flanks_part,
    stay_closed,
    with_parting_flanks,
)
from gear_damping.explanation.steps.calibrate import calibrated
from gear_damping.identification.output_error.segments import Segments
from gear_damping.measurement.load import load_measurement

HARMONICS = 6


@pytest.fixture(scope="module")
def at_resonance(tmp_path_factory):
    """Two records under a low torque, one of them near resonance, and no angle known: rig, evidence, nominal model."""
    rig = steel_rig((38, 33), 2.5e-3, 0.03, (2e-3, 3e-3), 0.02, law="fourier")
    runs = tuple(Run(20e3, 0.25, round(rig.speed_at(tuning)), 20.0) for tuning in (0.97, 0.6))
    case = Case(rig, runs, ERROR_UM, Table("csv", "te"), Noise(WHITE, 38), Stream(5, 0), "",
                Hidden("backlash", {"gap": 9e-5}), assembled=True)  # fmt: skip
    folder = tmp_path_factory.mktemp("measured") / "case"
    write(case, folder)
    measurement = load_measurement(folder / "measurement.yaml")
    evidence = evidence_of(measurement)
    evidence = replace(evidence, fit=(*evidence.fit, *evidence.holdout), holdout=())
    found = calibrated(with_noise(evidence, measurement, lambda _: None)[0], fitting_solver(None))
    return rig, found.evidence, found.nominal


def cost_over_noise(outcome, evidence):
    return outcome.fitted.cost / evidence.noise**2 / float((outcome.problem.response.weights > 0).sum())


@pytest.mark.slow
def test_damping_is_found_where_flanks_part(at_resonance):
    rig, evidence, nominal = at_resonance
    found = with_parting_flanks(evidence, HARMONICS, fitting_solver(None))
    assert found.hypothesis.causes == ("backlash",)
    assert cost_over_noise(found, evidence) < 1.2
    assert found.values["viscous_damping.damping_coefficient"] == pytest.approx(rig.viscous, rel=0.05)
    assert cost_over_noise(nominal, evidence) > 3 * cost_over_noise(found, evidence)


@pytest.mark.parametrize(("cost", "growth"), [(3.0, 1.5), (5.0, math.inf)])
def test_a_fit_of_segments_counts_for_whole_records_only_where_these_bear_it_out(cost, growth, monkeypatch):
    """Of a run-up through resonance whole records kept 40 times the cost, and errors grew by 1.5."""
    near, whole = (
        SimpleNamespace(name=name, is_finite=True, fitted=SimpleNamespace(cost=c), hypothesis=None)
        for name, c in (("near", 1.0), ("whole", cost))
    )
    whole.error_amplification = 1.5
    fits = iter([near, whole])
    monkeypatch.setattr(parting_flanks, "fit_hypothesis", lambda *_, **__: next(fits))
    monkeypatch.setattr(parting_flanks, "error_amplification_over", lambda *_: 1.5)
    monkeypatch.setattr(parting_flanks, "with_shape", lambda *_: None)
    monkeypatch.setattr(parting_flanks, "_in_short", lambda *_: None)
    monkeypatch.setattr(parting_flanks, "replace", lambda one, **new: SimpleNamespace(**{**vars(one), **new}))
    rough = SimpleNamespace(hypothesis=None, of_records={})
    evidence = SimpleNamespace(fit=(), settings=SimpleNamespace(most_growth=2.0))
    found = parting_flanks._shaped(rough, evidence, 4, None)
    assert (found.name, found.error_amplification) == ("whole" if cost < 4 else "near", growth)


@pytest.mark.parametrize(
    ("there", "again", "kept"),
    [
        (1.0, 0.999, "again"),  # nothing crosses it: no fit went on from the width of the widest motion
        (1.05, 1.02, "found"),
        (40.0, 0.5, "found"),  # crossed: not even tried
    ],
)
def test_a_gap_that_no_motion_crosses_is_any_wider_one(there, again, kept, monkeypatch):
    found, beyond, best = (
        SimpleNamespace(name=name, is_finite=True, fitted=SimpleNamespace(cost=cost), error_amplification=1.0)
        for name, cost in (("found", 1.0), ("there", there), ("again", again))
    )
    found.hypothesis, found.values = None, {parting_flanks.GAP: 26e-6}
    fits = iter([beyond, best])
    monkeypatch.setattr(parting_flanks, "fit_hypothesis", lambda *_, **__: next(fits))
    monkeypatch.setattr(parting_flanks, "settled_at", lambda _, values: values[parting_flanks.GAP])
    monkeypatch.setattr(parting_flanks, "replace", lambda one, **new: SimpleNamespace(**{**vars(one), **new}))
    evidence = SimpleNamespace(settings=SimpleNamespace(most_growth=2.0))
    assert parting_flanks._out_of_reach(found, evidence, None).name == kept


@pytest.mark.parametrize(("left_without", "missed"), [(2.5, True), (1.5, False)])
def test_a_gap_seen_in_segments_takes_half_of_what_is_left_of_the_same_segments(left_without, missed, monkeypatch):
    """Any model leaves little of segments that begin anew, whatever is hidden beside it."""
    found, without = (SimpleNamespace(fitted=SimpleNamespace(cost=c), hypothesis=None) for c in (1.0, left_without))
    monkeypatch.setattr(parting_flanks, "fit_hypothesis", lambda *_, **__: without)
    monkeypatch.setattr(parting_flanks, "_in_short", lambda *_: None)
    nominal = SimpleNamespace(hypothesis=None, of_records={})
    evidence = SimpleNamespace(settings=SimpleNamespace(lost_share=0.5))
    assert parting_flanks.are_missed(found, nominal, evidence, None) is missed


def test_a_gap_that_is_stated_is_in_the_nominal_model_already(at_resonance):
    _, evidence, _ = at_resonance
    stated = replace(evidence, known=replace(evidence.known, values={**evidence.known.values, "backlash_gap": 9e-5}))
    assert with_parting_flanks(stated, HARMONICS, None) is None


def test_an_error_that_is_measured_from_its_zero_on_shows_flanks_that_part(at_resonance):
    evidence = at_resonance[1]
    first = evidence.fit[0]
    first = replace(first, observed=replace(first.observed, offset=False), response=0.1 * first.response)

    def part(response, **more):
        return flanks_part(replace(evidence, fit=(replace(first, response=response, **more),)))

    parted = first.response - first.response.median()
    assert part(parted)
    assert not part(first.response - first.response.min())
    assert not part(0.0 * parted - 2 * evidence.noise)
    unknown = replace(first.observed, offset=True)
    assert not part(parted, observed=unknown)
    assert part(10 * parted, observed=unknown)  # the mesh carries nothing in flight
    closed, torque = first.response - first.response.min(), first.conditions["pinion_torque"]
    assert not part(-closed, conditions=first.conditions | {"pinion_torque": -torque})  # on the other flanks
    assert part(-closed)
    assert not part(-closed, conditions={})
    assert not part(-closed, inputs={"pinion_torque": -torch.ones_like(closed)})


def test_an_error_that_falls_from_one_flank_to_the_other_is_told_from_waves_and_runouts(at_resonance):
    """Waves of closed flanks, a runout far larger than the load's deflection, and a fall across a gap at once."""
    evidence = at_resonance[1]
    first = evidence.fit[0]
    (base, _), (inertia, _) = shafts(evidence)[0], (1 / sum(r**2 / j for r, j in shafts(evidence)), None)
    stiffness = evidence.known.values["mesh_stiffness_max"]
    natural = math.sqrt(stiffness / inertia) / (2 * math.pi)
    static = first.conditions["pinion_torque"] / base / stiffness
    time = torch.arange(8000, dtype=torch.float64) / first.sampling_rate
    wave = static * torch.sin(2 * math.pi * natural * time)
    runout = 60 * static * torch.sin(2 * math.pi * 25 * time)
    fall = torch.where(time < 0.01, -20 * static, 0.0)

    def crossed(response, **more):
        one = replace(first, response=response, **more)
        return are_crossed(replace(evidence, fit=(one,), noise=0.05 * static))[0]

    assert not crossed(wave + runout)
    assert crossed(wave + fall)
    assert not crossed(wave + fall, observed=replace(first.observed, name="acceleration"))
    assert not crossed(
        wave + fall, conditions=first.conditions | {"pinion_torque": 20 * first.conditions["pinion_torque"]}
    )


def test_a_mesh_that_carries_nothing_for_long_shows_it_wherever_the_zero_lies(at_resonance):
    """The force in the mesh is the load less the inertia of the relative motion; made up from a sine."""
    evidence = at_resonance[1]
    first, mass = evidence.fit[0], 1 / sum(radius**2 / inertia for radius, inertia in shafts(evidence))
    first = replace(first, sampling_rate=80e3)  # 23 samples of a natural period
    load = first.conditions["pinion_torque"] / shafts(evidence)[0][0]
    angle = 2 * torch.pi * 0.04 * torch.arange(4000, dtype=torch.float64)  # 25 samples a period
    size = load / mass / (2 * torch.pi * 0.04 * first.sampling_rate) ** 2  # the force just reaches zero

    def seen(share, noise=0.0, **more):
        response = 1.0 + share * size * torch.sin(angle)
        one = replace(first, response=response, observed=replace(first.observed, offset=True), **more)
        return replace(evidence, fit=(one,), noise=noise)

    def part(*args, **more):
        return flanks_part(seen(*args, **more))

    assert part(1.0)
    assert not part(0.7)
    for share, closed in ((0.7, True), (0.85, False)):  # the mesh carries 30 and 15 % of the load at least
        assert stay_closed(seen(share)) is closed
    assert not stay_closed(seen(0.7, noise=0.1 * float(size)))  # nobody sees
    assert stay_closed(
        seen(0.7, conditions=first.conditions | {"pinion_torque": 2 * first.conditions["pinion_torque"]})
    )
    both = replace(evidence, fit=(*seen(0.7).fit, *seen(1.0).fit), noise=0.0)
    assert not stay_closed(both)
    assert not part(1.0, noise=0.1 * float(size))  # nothing to be seen behind it
    assert part(1.0, noise=0.003 * float(size))
    assert not part(1.0, conditions=first.conditions | {"pinion_torque": 2 * first.conditions["pinion_torque"]})
    fewer = replace(first.observed, name="gear_speed", offset=True)
    turning = torch.cos(angle) * size * 2 * torch.pi * 0.04 * first.sampling_rate
    radius, inertia = shafts(evidence)[1]
    for share, parted in ((1.0, True), (0.7, False)):
        speed = -share * turning * mass * radius / inertia
        one = replace(first, response=speed, observed=fewer)
        assert flanks_part(replace(evidence, fit=(one,), noise=0.0)) is parted


@pytest.mark.parametrize(
    ("part", "crossed", "teeth", "change"),
    [
        (True, [False], True, True),
        (False, [False, True], True, True),
        (False, [False], True, False),
        (False, None, False, False),
    ],
)
def test_flanks_change_where_they_part_or_an_error_of_any_zero_crosses_a_gap(part, crossed, teeth, change, monkeypatch):
    monkeypatch.setattr(parting_flanks, "flanks_part", lambda evidence: part)
    monkeypatch.setattr(parting_flanks, "are_crossed", lambda evidence: crossed)
    assert parting_flanks.flanks_change(SimpleNamespace(has=lambda trait: teeth)) is change


def shafts(evidence):
    """Base radius and moment of inertia of pinion and gear."""
    known = evidence.known.values
    per_tooth = known["module"] * math.cos(known["pressure_angle"]) / 2
    return [(per_tooth * known[f"n_teeth_{shaft}"], known[f"inertia_{shaft}"]) for shaft in ("pinion", "gear")]


@pytest.mark.parametrize(("stated", "seconds"), [(0.0, 0.3), (0.2, 0.2)])
def test_records_that_are_cut_already_are_cut_no_other_way(stated, seconds, monkeypatch):
    monkeypatch.setattr(parting_flanks, "segments_of", lambda *_: Segments(0.3))
    evidence = Evidence("gear_pair", (), (), {}, None, False, segments=Segments(stated))
    assert parting_flanks._in_short(None, evidence).segments.seconds == seconds
