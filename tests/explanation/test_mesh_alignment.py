"""How the meshes of records stand to each other: by a regression on a stiffness that varies little."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from second_rig.case import Case, Stream, measured, write
from second_rig.channels import WHITE
from second_rig.files import Table
from second_rig.motion import Run
from second_rig.pair import steel_rig
from second_rig.sensors import Noise, Sensor

from gear_damping.explanation.evidence.records import evidence_of, with_own_angles
from gear_damping.explanation.model.mesh_alignment import Regression, aligned, all_around, begun_aligned, turned
from gear_damping.explanation.model.nominal_gear_pair import shaped
from gear_damping.identification.output_error.segments import shortened
from gear_damping.measurement.load import load_measurement

RIG = steel_rig((20, 47), 3e-3, 0.023, (3e-3, 1e-2), 0.0105, law="fourier")
SLOW = 7.3  # th harmonic of the mesh of the slowest record at the resonance: no low one tells where the mesh stands


def series(harmonics: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """sum_h a_h cos(h angle) + b_h sin(h angle) of (2 H,) harmonics."""
    count = len(harmonics) // 2
    parts = [
        a * np.cos((h + 1) * angle) + b * np.sin((h + 1) * angle)
        for h, (a, b) in enumerate(zip(harmonics[:count], harmonics[count:], strict=True))
    ]
    return sum(parts)


def test_a_turned_mesh_has_its_harmonics_turned():
    rng = np.random.default_rng(51)
    harmonics, angle = rng.standard_normal(10), np.linspace(0, 9, 40)
    found = turned(0.7, 5).numpy() @ harmonics
    np.testing.assert_allclose(series(found, angle), series(harmonics, angle + 0.7), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_angles_are_found_to_a_common_turn(seed):
    """Records of a response that weighs harmonics otherwise in each of them, as other speeds do."""
    rng = np.random.default_rng(seed)
    harmonics, angles = rng.standard_normal(12), rng.uniform(0, 2 * np.pi, 4)
    quadratic, linear, constant = [], [], []
    for angle in angles:
        columns = torch.as_tensor(rng.standard_normal((60, 12)) * np.tile(rng.uniform(0.1, 3.0, 6), 2))
        residual = -columns @ turned(angle, 6) @ torch.as_tensor(harmonics) + 0.01 * torch.as_tensor(
            rng.normal(size=60)
        )
        quadratic.append(columns.T @ columns)
        linear.append(columns.T @ residual)
        constant.append(residual.square().sum())
    told = Regression(
        torch.stack(quadratic), torch.stack(linear), torch.stack(constant), torch.full((12,), 1e-9).double()
    )
    cost, found = aligned(told, all_around(6))
    apart = np.angle(np.exp(1j * (np.array(found) - angles)))
    assert np.abs(np.angle(np.exp(1j * (apart - apart[0])))).max() < 2 * 2 * np.pi / 48
    assert cost < 0.2 * sum(constant)


@pytest.fixture(scope="module")
def evidence(tmp_path_factory):
    """Three records behind an accelerometer, whose angles begin anywhere."""
    slowest = RIG.natural_frequency * 60 / RIG.teeth[0] / SLOW
    runs = tuple(Run(20e3, 0.2, speed, torque) for speed, torque in ((slowest, 110.0), (1500.0, 60.0), (2500.0, 90.0)))
    sensor = Sensor("acceleration", "m/s^2", radius=RIG.radii[0])
    case = Case(RIG, runs, sensor, Table("csv", "a"), Noise(WHITE, 32), Stream(3, 0), "", assembled=True)
    folder = tmp_path_factory.mktemp("aligned") / "case"
    write(case, folder)
    found = with_own_angles(evidence_of(load_measurement(folder / "measurement.yaml")))
    found = replace(found, noise=measured(case)[1])
    return replace(found, fit=tuple(shortened(record, 2000) for record in found.fit))


@pytest.mark.slow
def test_a_fit_from_there_leaves_nothing_but_noise(evidence):
    samples = sum(len(record.response) for record in evidence.fit)
    assert len(evidence.fit) > 1
    signal = sum(float(record.response.square().sum()) for record in evidence.fit)
    assert not begun_aligned(evidence, samples * evidence.noise**2), "a fit down to the noise has not failed"
    found = shaped(begun_aligned(evidence, signal)[0], evidence, 30)
    assert found.fitted.cost < 1.15 * samples * evidence.noise**2
