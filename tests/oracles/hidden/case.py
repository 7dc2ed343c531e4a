"""Draw hidden cases: size the effects, run the records, put instruments and noise on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .catalogue import FOREIGN
from .draft import Draft, Wanted, draft, true_mean_stiffness
from .instruments import HiddenRecord, records_of, stated
from .integrate import Trajectory
from .invariants import invariants
from .knobs import Knobs, stack
from .pair import Rig
from .setup import Setup
from .sizing import LADDER, Sized, clean, corrected, members_of, path_of, run, size
from .stiffness import Arrays

SIZING_SPAN = 2500  # samples of each record that the size is judged by
LARGEST_BATCH = 2000  # that are integrated together
SUBSTEPS = 4
CORRECTIONS = 2  # of the size, where rig or sensors were asked for; such a case is drawn alone


@dataclass(frozen=True, eq=False)
class HiddenCase:
    """A measurement with something hidden in it; `truth` is JSON-able and tells everything.

    nominal: what the user states, by the names of measurement.yaml. gear_torque: balanced | held. fault: what
    write_case spoils, or None. Records whose condition is `added` answer what the first ones left open.
    """

    stratum: str
    seed: int
    plan: str
    nominal: dict[str, dict[str, float | str]]
    gear_torque: str
    records: tuple[HiddenRecord, ...]
    fault: str | None
    truth: dict[str, object] = field(repr=False)
    origin: Draft = field(repr=False)
    params: tuple[dict, ...] = field(repr=False)

    @property
    def setup(self) -> Setup:
        """Its sensors and units."""
        return self.origin.setup

    @property
    def first(self) -> tuple[HiddenRecord, ...]:
        """The records of the measurement before anything was added."""
        return tuple(record for record in self.records if not record.condition.added)


def draw_case(
    stratum: str,
    seed: int,
    *,
    duration: float = 0.05,
    snr_db: float | None = None,
    target_excess: float | None = None,
    rig: str | Rig | None = None,
    sensors: str | Setup | None = None,
    chosen: Mapping[str, float | str] | None = None,
    size: float | None = None,
    gear_apart: bool = False,
) -> HiddenCase:
    """One case; see draw_cases, which draws many at a fraction of the cost of each.

    rig: the usual one where None, `drawn`, or its teeth, `17/43`. sensors: the usual ones where None, `drawn`, or a
    plan by name (setup.PLANS). chosen: parameters of the first effect, where chance should not choose them. size: of
    the effects as a share of their largest, in the place of an excess. gear_apart: in every record the gear stands
    elsewhere, by whole turns of the pinion, which its angle does not tell.
    """  # fmt: skip
    asked = Wanted(stratum, seed, duration, snr_db, target_excess, rig, sensors, chosen or {}, size, gear_apart)
    return _drawn([draft(asked)])[0]


def draw_cases(
    wanted: Sequence[tuple[str, int]],
    *,
    duration: float = 0.05,
    snr_db: float | None = None,
    target_excess: float | None = None,
) -> list[HiddenCase]:
    """Cases of (stratum, seed), integrated together; each is what it would be alone, to rounding.

    duration: of each record / s. snr_db: AC part of the channel over its noise; drawn from 20 to 40 where None.
    target_excess: the excess D / % that each effect is sized for; drawn where None.
    """
    return _drawn([draft(Wanted(stratum, seed, duration, snr_db, target_excess)) for stratum, seed in wanted])


def _drawn(drafts: list[Draft]) -> list[HiddenCase]:
    """The cases of drafts that share their rate and length."""
    cases, group, members = [], [], 0
    for index, one in enumerate(drafts):
        group.append(one)
        members += len(one.records) * (1 + LADDER * len(one.effects))
        if members > LARGEST_BATCH or index == len(drafts) - 1:
            cases += _together(group)
            group, members = [], 0
    return cases


def _together(drafts: list[Draft]) -> list[HiddenCase]:
    sized = size(drafts, min(drafts[0].n, SIZING_SPAN))
    knobs, path = _run(drafts, sized)
    for _ in range(CORRECTIONS if not drafts[0].usual else 0):
        seen = clean(drafts[0], knobs, path)[: sized[0].basis.response.shape[0]]
        if not corrected(drafts[0], sized[0], sized[0].basis.excess(seen - sized[0].basis.response)["excess_percent"]):
            break
        knobs, path = _run(drafts, sized)
    cases, first = [], 0
    for one, s in zip(drafts, sized, strict=True):
        own = slice(first, first + len(one.records))
        cases.append(_case(one, s, members_of(knobs, own), path_of(path, own)))
        first = own.stop
    return cases


def _run(drafts: list[Draft], sized: list[Sized]) -> tuple[Arrays, Trajectory]:
    knobs = stack([member for one, s in zip(drafts, sized, strict=True) for member in true_members(one, s.params)])
    return knobs, run(knobs, drafts, [1] * len(drafts), drafts[0].n, SUBSTEPS)


def true_members(one: Draft, params: Sequence[dict]) -> list[Knobs]:
    """The records' knobs with every effect in them."""
    members = []
    for record in one.records:
        member = dict(record)
        for effect, chosen in zip(one.effects, params, strict=True):
            member |= effect.turn(chosen, member)
        members.append(member)
    return members


def _case(one: Draft, sized: Sized, knobs: Arrays, path: Trajectory) -> HiddenCase:
    seen = clean(one, knobs, path)
    sigma = float(np.sqrt(np.mean(np.var(seen, axis=0)))) * 10.0 ** (-one.snr_db / 20.0)
    records = records_of(one, knobs, path, sigma)
    truth = _truth(one, sized, path, seen, sigma)
    mode = "held" if one.shape["held"] else "balanced"
    params = tuple(sized.params)
    nominal = stated(one.nominal, one.setup)
    return HiddenCase(one.stratum, one.seed, one.plan, nominal, mode, records, one.fault, truth, one, params)


def _truth(one: Draft, sized: Sized, path: Trajectory, seen: np.ndarray, sigma: float) -> dict[str, object]:
    basis = sized.basis
    difference = seen[: basis.response.shape[0]] - basis.response
    misread = sum(p or 0.0 for e, p in zip(one.effects, sized.predicted, strict=True) if e.as_modelled)
    stiffness = true_mean_stiffness(one.shape)
    rms_rate = float(np.sqrt(np.mean(np.var(path.v, axis=0))))
    return {
        "stratum": one.stratum,
        "seed": one.seed,
        "plan": one.plan,
        "fault": one.fault,
        "snr_db": one.snr_db,
        "noise_std": sigma,
        "mean_stiffness": stiffness,
        "damping_ratio_percent": 50.0 * one.shape["viscous"] / float(np.sqrt(stiffness * one.rig.mass)),
        "in_catalogue": not any(effect.name in FOREIGN for effect in one.effects),
        **basis.excess(difference),
        "excess_percent_by_misreading": misread,
        "first_records": basis.excess(difference, with_added=False),
        "separates": bool(np.any(path.delta < 0.0)),
        "diverged": bool(np.any(path.diverged)),
        "effects": [
            {
                "name": effect.name,
                "parameters": params,
                "target_percent": target,
                "excess_percent": predicted,
                "invariants": invariants(effect, params, one.records[0], rms_rate),
            }
            for effect, params, target, predicted in zip(
                one.effects, sized.params, one.targets, sized.predicted, strict=True
            )
        ],
        "pair": one.rig.name,
        "natural_frequency": one.rig.natural_frequency,
        "rate": one.rig.rate,
        "sensors": one.setup.name,
        "colour": one.setup.colour,
        "rig": one.shape,
        "records": [{"name": f"run_{i + 1}", **vars(c)} for i, c in enumerate(one.conditions)],
    }
