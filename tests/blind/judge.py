"""What an answer is worth: the claims that the table counts, each true, false, or None where it does not apply."""

from __future__ import annotations

from typing import Any

from .strata import NOISES, same_class

LOUD = 4.0  # times the noise floor, from where an effect outside the catalogue has to be called unexplained
LARGEST_SET = 4
BUDGET = 300.0  # s of one core
UNDISTURBED = ("data_problem", "refused", "consistent", "unexplained")
Case = dict[str, Any]


def names(case: Case) -> list[str]:
    """Names of what was hidden."""
    return [effect["name"] for effect in case["truth"]["effects"]]


def established(answer: dict[str, Any]) -> list[str]:
    """Names of established causes, the strongest first."""
    return [cause["name"] for cause in answer["causes"] if cause["status"] == "established"]


def offered(answer: dict[str, Any]) -> list[str]:
    """Everything that the answer allows for: causes, suggestions, and what each is confused with."""
    return [name for cause in answer["causes"] for name in (cause["name"], *cause["confusable_with"])]


def judged(case: Case) -> dict[str, bool | None]:
    """The claims about one case by the names of `rates.TARGETS`."""
    everywhere = {
        "any case: a wrong name established": _wrong(case),
        "any case: over its budget": case["seconds"] > BUDGET,
        "did not crash": _sound(case),
    }
    return JUDGES[case["stratum"]](case, case["answer"]) | everywhere


def _wrong(case: Case) -> bool:
    """Whether a cause is established that was not hidden, and that is in no set with one that was."""
    truth = names(case) or (["inertia_error"] if case.get("sensors") == "inertia_wrong" else [])
    sets = [(c["name"], *c["confusable_with"]) for c in case["answer"]["causes"] if c["status"] == "established"]
    return any(not any(same_class(name, true) for name in one for true in truth) for one in sets)


def _sound(case: Case) -> bool:
    return all(case[key]["verdict"] != "crashed" for key in ("answer", "answer_with_more") if key in case)


def _null(case: Case, answer: dict) -> dict[str, bool | None]:
    return {"null names a cause": bool(answer["causes"]), "null consistent": answer["verdict"] == "consistent",
            "damping of a null in its interval": damping_held(case, answer)}  # fmt: skip


def _single(case: Case, answer: dict) -> dict[str, bool | None]:
    name, found = names(case)[-1], established(answer)
    wrong = bool(found) and not any(same_class(name, other) for other in offered(answer))
    first = found[:1] == [name] or (found and same_class(name, found[0]) and name in offered(answer))
    return {"effect established and named first": bool(first), "wrong name established": wrong,
            "effect named or in the set": any(same_class(name, other) for other in offered(answer))}  # fmt: skip


def _faint(case: Case, answer: dict) -> dict[str, bool | None]:
    name = names(case)[-1]
    in_set = any(same_class(name, other) for other in offered(answer))
    return {"faint effect named, suggested or in the set": in_set}


def _below(case: Case, answer: dict) -> dict[str, bool | None]:
    truth, found = names(case), established(answer)
    return {"below the limit, a wrong name": any(not same_class(truth[-1], name) for name in found)}


def _pairs(case: Case, answer: dict) -> dict[str, bool | None]:
    return {"pair, both named": set(names(case)) <= set(established(answer))}


def _outside(case: Case, answer: dict) -> dict[str, bool | None]:
    misfit = (answer.get("misfit") or {}).get("before", 0.0)
    loud = answer["verdict"] == "unexplained" if misfit >= LOUD else None
    return {"outside, called explained": answer["verdict"] in ("explained", "ambiguous"), "outside, unexplained": loud,
            "outside or removed, a name established": bool(established(answer))}  # fmt: skip


def _removed(case: Case, answer: dict) -> dict[str, bool | None]:
    called = answer["verdict"] == "explained"
    wrong = [name for name in established(answer) if not same_class(case["removed"], name)]
    named = bool(wrong) and not any(same_class(case["removed"], name) for name in offered(answer))
    return {"removed, explained by another": called and len(wrong) == len(established(answer)),
            "outside or removed, a name established": named}  # fmt: skip


def _one_record(case: Case, answer: dict) -> dict[str, bool | None]:
    name = names(case)[-1]
    unseen = [entry["name"] for entry in answer.get("not_observable") or []]
    honest = name in (*offered(answer), *unseen)
    more = case["answer_with_more"]
    size = max((1 + len(cause["confusable_with"]) for cause in answer["causes"]), default=0)
    return {"one record, in the set or not observable": honest, "one record, set too large": size > LARGEST_SET,
            "with the experiment, named": name in offered(more)}  # fmt: skip


def _tacho(case: Case, answer: dict) -> dict[str, bool | None]:
    truth = names(case)
    wrong = [name for name in established(answer) if not any(same_class(name, true) for true in truth)]
    return {"tacho error, a wrong name": bool(wrong)}


def _unidentifiable(case: Case, answer: dict) -> dict[str, bool | None]:
    found = any(same_class(name, other) for name in names(case) for other in offered(answer))
    wrong = answer["verdict"] == "explained" and not found
    return {"unidentifiable, explained by another": wrong}


def _fault(case: Case, answer: dict) -> dict[str, bool | None]:
    return {"damaged file blamed on physics": bool(established(answer)) or answer["verdict"] not in UNDISTURBED}


def _any_lab(kind: str):
    """A judge of nulls, singles and wrong inertias whose claims begin with what varies."""

    def judge(case: Case, answer: dict) -> dict[str, bool | None]:
        if case.get("sensors") == "inertia_wrong":
            return {f"{kind}: a wrong inertia called ambiguous": _inertia_found(answer)}
        if not names(case):
            return {f"{kind}: null consistent": answer["verdict"] == "consistent",
                    f"{kind}: damping of a null in its interval": damping_held(case, answer)}  # fmt: skip
        own = _single(case, answer)
        claims = {"named or in the set": "effect named or in the set", "a wrong name": "wrong name established"}
        return {f"{kind}: {short}": own[claim] for short, claim in claims.items()}

    return judge


def _inertia_found(answer: dict) -> bool:
    """One class of gain, inertia and torque, and no verdict that picks one of them."""
    return answer["verdict"] == "ambiguous" and {"sensor_gain", "inertia_error"} <= {*offered(answer)}


def _noises(case: Case, answer: dict) -> dict[str, bool | None]:
    kind = NOISES[case["seed"] % len(NOISES)].replace("_", " ")
    return {"other noise: consistent": answer["verdict"] == "consistent",
            "other noise: damping in its interval": damping_held(case, answer),
            f"{kind}: consistent": answer["verdict"] == "consistent",
            f"{kind}: damping in its interval": damping_held(case, answer)}  # fmt: skip


def damping_held(case: Case, answer: dict) -> bool | None:
    """Whether the 95 % interval of the damping ratio holds the truth; None where none is stated."""
    interval = (answer.get("damping_ratio_percent") or {}).get("interval95")
    return None if interval is None else interval[0] <= case["truth"]["damping_ratio_percent"] <= interval[1]


def channel_of(case: Case) -> str:
    """The channel that shows the motion, or the plan of sensors, of a case."""
    truth = case["truth"]
    if truth.get("system") == "oscillator":
        return f"oscillator, {truth['channel']}"
    return f"gear pair, {truth.get('sensors') or 'full'}"


def _channels(case: Case, answer: dict) -> dict[str, bool | None]:
    kind = "usual channel" if channel_of(case) in USUAL_CHANNELS else "another channel"
    return _any_lab(kind)(case, answer)


USUAL_CHANNELS = ("gear pair, full", "oscillator, displacement")
JUDGES = {
    "null": _null, "single": _single, "faint": _faint, "below": _below, "pairs": _pairs, "outside": _outside,
    "removed": _removed, "one_record": _one_record, "tacho_error": _tacho, "unidentifiable": _unidentifiable,
    "data_fault": _fault, "rigs": _any_lab("other rig"), "oscillators": _any_lab("oscillator"), "channels": _channels,
    "noises": _noises,
}  # fmt: skip
