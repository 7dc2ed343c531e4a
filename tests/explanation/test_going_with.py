"""A cause that another one needs: without it the other is nothing either."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.model.candidates import going_with
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.steps.confirm import _dropped
from gear_damping.explanation.trials.bench import _without
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.effects.bearing_flexibility import BearingFlexibility
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.torque_ripple import TorqueRipple
from gear_damping.physics.effects.unbalance import Unbalance
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.gear_pair import GearPair

CAUSES = (BearingFlexibility(), Unbalance(), TorqueRipple())
NAMES = tuple(cause.name for cause in CAUSES)


@pytest.mark.parametrize(
    ("name", "goes"),
    [
        ("bearing_flexibility", {"bearing_flexibility", "unbalance"}),
        ("unbalance", {"unbalance"}),
        ("torque_ripple", {"torque_ripple"}),
    ],
)
def test_an_unbalance_goes_with_its_bearing(name, goes):
    effects = (FourierMeshStiffness(), ViscousDamping(), *CAUSES)
    assert going_with(name, effects) == goes


def hypothesis(causes):
    effects = (FourierMeshStiffness(), ViscousDamping(), *causes)
    sizes = {"bearing_flexibility.stiffness": 1e9, "unbalance.moment": 1e-3, "torque_ripple.amplitude": 1.0}
    free = [FreeParameter(name, size, size) for name, size in sizes.items()]
    given = {"unbalance.phase": 0.4, "torque_ripple.order": 2.0}
    return Hypothesis(GearPair(), effects, given, tuple(free), NAMES)


def test_a_model_without_a_bearing_is_one():
    left = _without(hypothesis(CAUSES), "bearing_flexibility")
    assert [effect.name for effect in left.model.effects][2:] == ["torque_ripple"]
    assert [parameter.name for parameter in left.free] == ["torque_ripple.amplitude"]
    assert (dict(left.given), left.causes) == ({"torque_ripple.order": 2.0}, ("torque_ripple",))


def test_a_search_that_drops_a_bearing_drops_what_acts_on_it():
    whole = hypothesis(CAUSES)
    accepted = tuple(Accepted(name, SimpleNamespace(outcome=None), 0.3, ()) for name in NAMES)
    outcome = SimpleNamespace(hypothesis=whole)
    bench = SimpleNamespace(excess=lambda outcome: SimpleNamespace(percent=1.0))
    known = {"bench": bench, "accepted": accepted, "outcome": outcome, "rejected": ()}
    state = State(**dict.fromkeys(State.__dataclass_fields__) | known)
    left = _dropped(state, "bearing_flexibility", outcome)
    assert [cause.name for cause in left.accepted] == ["torque_ripple"]
    assert len(left.rejected) == 2
