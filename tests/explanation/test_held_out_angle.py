"""The angle of a held-out record that nobody knows, where a harmonic of its mesh meets the resonance."""

import pytest
from second_rig.case import Case, Stream, measured, write
from second_rig.channels import WHITE
from second_rig.files import Table
from second_rig.motion import Run
from second_rig.pair import steel_rig
from second_rig.sensors import Noise, Sensor

from gear_damping.explanation.evidence.records import evidence_of, with_own_angles
from gear_damping.explanation.evidence.unsteady import with_unsteady_shafts
from gear_damping.explanation.model.nominal_gear_pair import first_gear_pair
from gear_damping.identification.output_error.holdout import Frozen, predict_holdout
from gear_damping.measurement.load import load_measurement

RIG = steel_rig((20, 47), 3e-3, 0.023, (3e-3, 1e-2), 0.0105, law="fourier")


@pytest.mark.parametrize(("harmonic", "seed"), [(8.1, 0), (6.9, 1), (7.87, 2)])
def test_a_known_model_predicts_a_record_whose_angle_nobody_knows(harmonic, seed, tmp_path):
    """Valleys lie an eighth of a pitch apart, and a speed that is followed from a short stretch leads to others."""
    speeds = (round(RIG.natural_frequency * 60 / RIG.teeth[0] / harmonic), 1500.0, 2500.0)
    runs = tuple(Run(20e3, 0.28, speed, 110.0 if speed < 2000 else 60.0) for speed in speeds)
    sensor = Sensor("acceleration", "m/s^2", radius=RIG.radii[0])
    case = Case(RIG, runs, sensor, Table("csv", "a"), Noise(WHITE, 32), Stream(seed, 0), "", assembled=True)
    write(case, tmp_path / "case")
    evidence = evidence_of(load_measurement(tmp_path / "case" / "measurement.yaml"))
    evidence = with_unsteady_shafts(with_own_angles(evidence))
    slowest = min(evidence.records, key=lambda record: record.conditions["pinion_speed"])
    first, noise = first_gear_pair(evidence), measured(case)[1]
    held = predict_holdout(Frozen(first.model, first.given, (), noise), [slowest], 1 / RIG.natural_frequency)
    assert float(held.residuals[0].square().mean()) ** 0.5 < 1.05 * noise
