"""What is said of causes that take most of too little for a name, on a made-up state."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.answer import too_little
from gear_damping.explanation.settings import SearchSettings

FRICTION = SimpleNamespace(name="coulomb_friction")
TAKES = "`coulomb_friction` would take 98 % of what is missing, too little of the signal for a name"
OF_DAMPING = "; of the damping ratio, 2.44 %, it would make 0.24 %."


@pytest.mark.parametrize(
    ("accepted", "share", "by_law", "said"),
    [
        ((FRICTION,), 0.98, {"viscous_damping": 2.2, "coulomb_friction": 0.24}, f"{TAKES}{OF_DAMPING}"),
        ((FRICTION,), 0.98, None, f"{TAKES}."),  # of a rig that no spring holds nothing is critical
        ((FRICTION,), 0.98, {"viscous_damping": 2.44}, f"{TAKES}."),
        ((FRICTION,), 0.4, {"coulomb_friction": 0.24}, ""),
        ((), 0.98, {}, ""),
    ],
)  # fmt: skip
def test_what_takes_most_is_said_with_its_part_of_the_damping(accepted, share, by_law, said, monkeypatch):
    found = None if by_law is None else {"value": sum(by_law.values()), "by_law": by_law}
    monkeypatch.setattr(too_little, "damping_ratio", lambda *_: found)
    monkeypatch.setattr(too_little, "told_covariance", lambda *_: None)
    bench = SimpleNamespace(settings=SearchSettings(), evidence=None)
    state = SimpleNamespace(
        accepted=accepted, nominal=None, outcome=None, bench=bench, share_between=lambda *_: share
    )  # fmt: skip
    assert too_little.takes_of_little(state) == said
