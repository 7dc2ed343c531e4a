"""The counting of blind cases: intervals, claims, resuming, stopping."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.blind.__main__ import PAGES
from tests.blind.accuracy import errors
from tests.blind.judge import judged
from tests.blind.rates import clopper_pearson, rates
from tests.blind.run import CASES, ask, begin_from, done_cases, keep, write
from tests.blind.strata import (
    CHANNEL_GEARS,
    CHANNEL_OSCILLATORS,
    CHANNEL_ROWS,
    COMMON,
    COUNTS,
    NAMEABLE,
    Question,
    question,
    questions,
    same_class,
)

ROOT = Path(__file__).resolve().parents[2]


def cause(name, status="established", alike=(), **parameters):
    stated = {k: {"value": v, "interval95": [0.9 * v, 1.1 * v]} for k, v in parameters.items()}
    known = {"name": name, "status": status, "confusable_with": list(alike)}
    return known | {"excess_explained": 0.9, "parameters": stated}


def case(stratum, hidden=(), verdict="explained", causes=(), seed=0, **more):
    effects = [{"name": name, "parameters": {"amplitude": 1e-6}} for name in hidden]
    answer = {"verdict": verdict, "causes": list(causes), "misfit": {"before": 9.0, "after": 1.1}}
    truth = {"effects": effects, "fault": None, "snr_db": 21.0}
    return {"stratum": stratum, "seed": seed, "truth": truth, "answer": answer, "seconds": 1.0, "engine": "a"} | more


def solved(asked: Question):
    """Stands in for an explanation."""
    return case(asked.stratum, [asked.drawn], causes=[cause(asked.drawn)], seed=asked.seed)


@pytest.mark.parametrize(
    ("count", "n", "expected"),
    [(0, 10, (0.0, 0.3085)), (10, 10, (0.6915, 1.0)), (5, 10, (0.1871, 0.8129)), (1, 100, (0.000253, 0.0545))],
)
def test_intervals_are_those_of_the_tables(count, n, expected):
    assert clopper_pearson(count, n) == pytest.approx(expected, abs=1e-4)


def test_an_interval_of_nothing_is_refused():
    with pytest.raises(ValueError, match="n be at least 1"):
        clopper_pearson(0, 0)


def test_a_null_that_suggests_a_name_counts_as_naming():
    claim = "null names a cause"
    assert judged(case("null", verdict="unexplained", causes=[cause("backlash", "suggested")]))[claim]
    assert not judged(case("null", verdict="consistent"))[claim]


def test_only_an_established_first_name_counts_as_named():
    claim = "effect established and named first"
    second = [cause("profile_error"), cause("cubic_stiffness")]
    assert judged(case("single", ["cubic_stiffness"], causes=[cause("cubic_stiffness")]))[claim]
    assert not judged(case("single", ["cubic_stiffness"], causes=[cause("cubic_stiffness", "suggested")]))[claim]
    assert not judged(case("single", ["cubic_stiffness"], causes=second))[claim]


def test_the_set_counts_apart_from_the_first_name():
    found = judged(case("single", ["cubic_stiffness"], causes=[cause("hertz_stiffness", alike=["cubic_stiffness"])]))
    assert found["effect named or in the set"]
    assert not found["effect established and named first"]
    assert not found["wrong name established"]


def test_a_neighbour_explains_a_removed_effect_wrongly_but_its_class_does_not():
    claim = "removed, explained by another"
    wrong = case("removed", ["torque_ripple"], causes=[cause("pinion_eccentricity")], removed="torque_ripple")
    alike = case("removed", ["encoder_error"], causes=[cause("pinion_eccentricity")], removed="encoder_error")
    partly = wrong | {"answer": wrong["answer"] | {"verdict": "partly_explained"}}
    assert [judged(c)[claim] for c in (wrong, alike, partly)] == [True, False, False]
    assert same_class("pinion_eccentricity", "encoder_error")
    assert not same_class("pinion_eccentricity", "torque_ripple")


def test_a_quiet_effect_outside_the_catalogue_need_not_be_called_unexplained():
    quiet = case("outside", ["impacts"], verdict="consistent")
    quiet["answer"]["misfit"]["before"] = 1.5
    assert judged(quiet)["outside, unexplained"] is None
    assert judged(case("outside", ["impacts"], verdict="unexplained"))["outside, unexplained"] is True


@pytest.mark.parametrize("verdict", ["explained", "partly_explained", "ambiguous"])
def test_a_damaged_file_that_is_explained_counts_against(verdict):
    assert judged(case("data_fault", verdict=verdict))["damaged file blamed on physics"]
    assert not judged(case("data_fault", verdict="refused"))["damaged file blamed on physics"]


def test_a_crash_is_counted():
    found = rates([case("null", verdict="crashed"), case("null", verdict="consistent", seed=1)])
    assert found["rates"]["did not crash"]["count"] == 1
    assert found["rates"]["did not crash"]["met"] == "no"


@pytest.mark.parametrize(("wrong", "n", "word"), [(0, 20, "not contradicted"), (0, 200, "met"), (5, 200, "no")])
def test_a_target_is_met_where_the_whole_interval_is_within_it(wrong, n, word):
    cases = [case("null", causes=[cause("backlash")] if i < wrong else [], seed=i) for i in range(n)]
    assert rates(cases)["rates"]["null names a cause"]["met"] == word


def test_a_diagnosis_over_its_budget_counts_and_times_are_told():
    slow = [case("null", seed=i) | {"seconds": 10.0 + 40 * i} for i in range(11)]
    found = rates(slow)
    assert found["rates"]["any case: over its budget"]["failed"] == [f"null {i}" for i in (8, 9, 10)]
    assert found["seconds"] == {"median": 210.0, "p95": pytest.approx(390.0), "longest": 410.0}


def test_cells_are_alike_unless_one_of_them_is_always_wrong():
    def asked(cell_wrong):
        return [
            other(verdict="unexplained" if wrong else "consistent", seed=10 * place + i, sensors=sensors)
            for place, sensors in enumerate(("ac", "encoders", "speed"))
            for i in range(10)
            for wrong in [sensors == cell_wrong or i == 0]
        ]

    assert rates(asked(None))["cells"] | {"p": None} == {"cells": 3, "cases": 30, "right": 27, "p": None, "alike": True}
    assert not rates(asked("speed"))["cells"]["alike"]


def test_rates_say_how_many_seeds_they_rest_on_and_which_failed():
    cases = [case("null", verdict="consistent", seed=i) for i in range(19)]
    cases.append(case("null", causes=[cause("backlash")], seed=19))
    row = rates(cases)["rates"]["null names a cause"]
    assert (row["count"], row["n"], row["seeds"], row["failed"]) == (1, 20, [0, 19], ["null 19"])
    assert row["met"] == "no"  # one of twenty, where one of fifty is allowed
    assert row["interval95"] == pytest.approx(clopper_pearson(1, 20))


def test_a_second_name_beside_the_right_one_is_a_wrong_name():
    claim = "any case: a wrong name established"
    right, more = cause("pinion_eccentricity"), cause("profile_error")
    asked = [
        case("single", ["encoder_error"], causes=[right]),
        case("single", ["pinion_eccentricity"], causes=[right, more]),
        case("single", ["pinion_eccentricity"], causes=[right, more | {"status": "suggested"}]),
        case("single", ["pinion_eccentricity"], causes=[more | {"confusable_with": ["pinion_eccentricity"]}]),
        case("null", causes=[more]),
    ]
    assert [judged(one)[claim] for one in asked] == [False, True, False, False, True]


def test_a_negative_amplitude_is_the_same_with_its_phase_turned():
    named = case("single", ["pinion_eccentricity"], causes=[cause("pinion_eccentricity", amplitude=-1.02e-6)])
    assert errors([named]) == [(pytest.approx(0.02), True)]


def test_every_effect_comes_up_and_order_is_balanced():
    assert {question("single", seed).drawn for seed in range(1000, 1000 + len(NAMEABLE))} == set(NAMEABLE)
    assert {question("removed", seed).removed for seed in range(len(COMMON))} == set(COMMON)
    listed = questions(tuple(COUNTS), None, 1000)
    assert len(listed) == sum(COUNTS.values()) == len({q.key for q in listed})
    first = {q.stratum for q in listed[: len(listed) // 4]}
    assert first == set(COUNTS)


def test_other_rigs_and_channels_come_up_with_every_effect():
    rigs = [question("rigs", seed) for seed in range(1000, 1000 + 3 * len(COMMON))]
    assert {q.drawn for q in rigs} == {*COMMON, "null"}
    assert {(q.rig, q.sensors) for q in rigs} == {("drawn", "drawn"), ("drawn", "inertia_wrong")}
    oscillators = [question("oscillators", seed) for seed in range(1000, 1016)]
    assert {q.drawn for q in oscillators} == {*CHANNEL_OSCILLATORS, "null"}
    channels = [question("channels", seed) for seed in range(1000, 1000 + len(CHANNEL_ROWS))]
    assert len({(q.drawn, q.sensors, q.channel, q.system) for q in channels}) == len(CHANNEL_ROWS)
    for name in CHANNEL_GEARS:
        seen = {q.draw for q in channels if q.drawn == name and q.system == "gear_pair"}
        assert len(seen) <= 2  # one draw of the case for all of its channels, but where the range begins within


def other(hidden=(), verdict="consistent", causes=(), seed=0, sensors="ac", interval=(0.9, 1.1)):
    made = case("rigs", hidden, verdict, causes, seed, sensors=sensors, rig="drawn")
    made["truth"] |= {"pair": "17/43", "sensors": sensors, "damping_ratio_percent": 1.0}
    made["answer"]["damping_ratio_percent"] = {"interval95": list(interval)}
    return made


def test_another_rig_counts_verdict_and_damping_of_a_null():
    good, wrong = judged(other()), judged(other(verdict="unexplained", interval=(1.2, 1.3)))
    for claim in ("other rig: null consistent", "other rig: damping of a null in its interval"):
        assert (good[claim], wrong[claim]) == (True, False)
    assert judged(other() | {"answer": {"verdict": "refused", "causes": []}})["other rig: null consistent"] is False


def test_a_wrong_inertia_has_to_be_ambiguous_with_its_class():
    claim = "other rig: a wrong inertia called ambiguous"
    named = [cause("sensor_gain", alike=["inertia_error"])]
    assert judged(other(verdict="ambiguous", causes=named, sensors="inertia_wrong"))[claim]
    assert not judged(other(verdict="explained", causes=named, sensors="inertia_wrong"))[claim]
    wrong = "any case: a wrong name established"  # the class of a wrong inertia is none, any other name is
    assert not judged(other(verdict="ambiguous", causes=named, sensors="inertia_wrong"))[wrong]
    assert judged(other(verdict="explained", causes=[cause("backlash")], sensors="inertia_wrong"))[wrong]
    assert not judged(other(verdict="ambiguous", causes=[cause("sensor_gain")], sensors="inertia_wrong"))[claim]


def test_rigs_and_channels_have_rows_of_their_own(tmp_path):
    cases = [other(), other(["tooth_crack"], "explained", [cause("tooth_crack")], seed=1)]
    seen = case("channels", ["cubic_stiffness"], causes=[cause("backlash")], seed=2)
    seen["truth"] |= {"system": "oscillator", "channel": "velocity"}
    found = rates([*cases, seen])
    assert found["rigs"] == {"17/43": {"nulls": 1, "consistent": 1, "damping held": 1, "effects": 1, "named": 1,
                                       "wrong": 0}}  # fmt: skip
    assert found["channels"]["oscillator, velocity"]["wrong"] == 1
    assert found["rates"]["another channel: a wrong name"]["count"] == 1
    write([*cases, seen], tmp_path, tmp_path / "blind.md", "make blind")
    page = (tmp_path / "blind.md").read_text()
    assert "| 17/43 | 1 | 1 | 1 | 1 | 1 | 0 |" in page
    assert "| oscillator, velocity | 0 | 0 | 0 | 1 | 0 | 1 |" in page


def test_an_unknown_stratum_is_refused():
    with pytest.raises(ValueError, match="no stratum 'nul'"):
        question("nul", 1)


def test_a_case_done_is_not_done_again(tmp_path):
    said = []
    asked = questions(("null", "faint"), 2, 5)
    ask(asked[:3], tmp_path, 1, said.append, solve=solved)
    with (tmp_path / CASES).open("a") as file:
        file.write('{"stratum": "null", "se')  # a line that a crash cut off
    (tmp_path / CASES).write_text((tmp_path / CASES).read_text() + "\n")
    cases = ask(asked, tmp_path, 1, said.append, solve=solved)
    assert "3 of 4 cases are done already, 1 to do" in said
    assert {(c["stratum"], c["seed"]) for c in cases} == {q.key for q in asked}
    found = write(cases, tmp_path, tmp_path / "docs" / "blind.md", "make blind")
    assert json.loads((tmp_path / "rates.json").read_text())["cases"] == found["cases"] == 4
    page = (tmp_path / "docs" / "blind.md").read_text()
    assert "95 % interval" in page
    assert "| faint effect named, suggested or in the set | 100.0 % | 2 | 15.8 to 100.0 %" in page


def test_what_is_kept_gives_the_same_rates_and_a_clone_goes_on_from_it(tmp_path):
    cases = [other(), other(["tooth_crack"], "explained", [cause("tooth_crack", depth=0.1)], seed=1)]
    cases += [case("single", ["pinion_eccentricity"], causes=[cause("pinion_eccentricity", amplitude=1e-6)], seed=2)]
    for one in cases:
        one["answer"] |= {"sentences": ["long"], "not_observable": [{"name": "backlash", "x": 1}]}
    keep(cases, tmp_path / "kept.jsonl")
    assert "long" not in (tmp_path / "kept.jsonl").read_text()
    begin_from(tmp_path / "kept.jsonl", tmp_path / "out" / CASES)
    again = done_cases(tmp_path / "out" / CASES)
    assert rates(again) == rates(sorted(cases, key=lambda one: one["stratum"]))
    (tmp_path / "out" / CASES).write_text("")
    begin_from(tmp_path / "kept.jsonl", tmp_path / "out" / CASES)
    assert done_cases(tmp_path / "out" / CASES) == []  # what is there already is not written over


def test_no_case_begins_after_the_minutes_are_over(tmp_path):
    assert ask(questions(("null",), 3, 0), tmp_path, 1, lambda text: None, minutes=-1.0, solve=solved) == []


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_done_and_leaves_no_process(tmp_path):
    command = [sys.executable, "-m", "tests.blind", "--stratum", "null", "--cases", "40", "--processes", "1"]
    command += ["--out", str(tmp_path)]
    alone = os.environ | {"OMP_NUM_THREADS": "1"}
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, env=alone) as running:
        running.stdout.readline()  # the workers are being started
        time.sleep(1.0)
        running.send_signal(signal.SIGINT)
        rest, _ = running.communicate(timeout=60)
    assert running.returncode == 130
    assert "stopped; the cases done so far are kept" in rest
    assert done_cases(tmp_path / CASES) == done_cases(PAGES / "blind_cases.jsonl")  # and none of its own
