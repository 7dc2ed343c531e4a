"""Every page that a run leaves: self-contained, readable for everybody, its colours told apart in both schemes."""

import json
import re
from functools import cache
from html.parser import HTMLParser
from importlib.resources import files
from itertools import product
from pathlib import Path

import pytest

from gear_damping.reporting import tables
from gear_damping.reporting.explanation_report import Overlay, ReportInput, ResidualSpectrum, render
from gear_damping.reporting.page.render import render_page
from gear_damping.reporting.run_index import IndexRow, index_page
from gear_damping.reporting.run_report import REPORTED
from gear_damping.reporting.run_report.sweep import SweepLeft
from gear_damping.reporting.run_report.training import errors_table
from gear_damping.reporting.run_report.write import write_report, write_sweep_report
from gear_damping.reporting.style import new_figure, save

ROOT = Path(__file__).resolve().parents[2]
STYLE = files("gear_damping.reporting.page").joinpath("templates", "style.css").read_text(encoding="utf-8")
TEXT, GROUNDS = ("ink", "pale", "link", "good", "doubt", "bad"), ("paper", "panel")
READ, SEEN = 4.5, 3.0  # contrast of text, and of a frame around what has the focus (WCAG 2.2, 1.4.3 and 1.4.11)
VOID = {"meta", "img", "br", "wbr", "link", "input", "hr"}
STARTED = "2026-01-02T03:04:05+00:00"
HOSTILE = "<script>alert(1)</script> & \"quoted\" 'name'"


class Page(HTMLParser):
    """What is wrong with a page."""

    def __init__(self, text, script=False):
        super().__init__()
        self.problems, self.headings, self.ids, self.named, self.tags = [], [], [], [], []
        self.open, self.of_table, self.has_script = [], None, script
        self.feed(text)
        self.close()
        self.problems += [] if text.startswith("<!DOCTYPE html>") else ["no doctype"]
        self.problems += [f"{tag} left open" for tag in self.open]
        self.problems += [f"{count} elements {tag}" for tag in ("h1", "main", "header", "title", "html")
                          if (count := self.tags.count(tag)) != 1]  # fmt: skip
        self.problems += self._order()
        self.problems += [f"id {one} twice" for one in self.ids if self.ids.count(one) > 1]
        self.problems += [f"nothing has the id {one}" for one in self.named if one not in self.ids]
        self.problems += ["a script"] if self.tags.count("script") != script else []

    def _order(self):
        before = [0, *self.headings]
        return [f"h{two} after h{one}" for one, two in zip(before, self.headings, strict=False) if two > one + 1]

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        if re.fullmatch(r"h[1-6]", tag):
            self.headings.append(int(tag[1]))
        self.ids += [found["id"]] if "id" in found else []
        self.named += found["aria-labelledby"].split() if "aria-labelledby" in found else []
        self.named += [found["href"][1:]] if found.get("href", "").startswith("#") else []
        self._check(tag, found)

    def _check(self, tag, found):
        complain = self.problems.append
        if tag == "html" and found.get("lang") != "en":
            complain("no language")
        if tag == "img" and len(found.get("alt") or "") < 20:
            complain(f"an image without an alternative text: {found.get('alt')!r}")
        for key in ("src", "href", "srcset", "action", "poster"):
            if re.match(r"\s*(\w+:)?//|javascript:", found.get(key) or ""):
                complain(f"fetches {found[key]}")
        if any(key.startswith("on") for key in found) or "style" in found:
            complain(f"{tag} has a script or a style of its own")
        if tag == "table":
            self.of_table = {"caption": False, "col": False, "row": False}
        if tag == "caption" and self.of_table:
            self.of_table["caption"] = True
        if tag == "th" and self.of_table:
            complain("a heading without scope") if found.get("scope") not in ("col", "row") else None
            self.of_table[found.get("scope", "col")] = True
        if tag == "div" and "scroll" in (found.get("class") or "").split():
            named = found.get("aria-labelledby") and found.get("role") == "region"
            complain("a scrolling region without focus or name") if not named or found.get("tabindex") != "0" else None

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"{tag} is closed out of turn")
        if tag == "table":
            self.problems += [f"a table without {key}" for key, there in self.of_table.items() if not there]
            self.of_table = None


def problems(text, script=False):
    found = Page(text, script).problems
    found += [f"fetches {one}" for one in re.findall(r"@import|url\([^)]*\)", text)]
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)
    return found + ([] if policy and "default-src 'none'" in policy[1] else ["no policy"])


@cache
def explanation():
    time = [k / 100 for k in range(400)]
    measured = [(k % 20 - 10) / 10 for k in range(400)]
    content = {
        "verdict": "explained", "sentences": ["It is explained."],
        "records": {"run": {"role": "holdout", "rmse": {"before": 1.0, "after": 0.1, "unit": "um"}}},
        "misfit": {"before": 9.0, "after": 1.0, "floor": 1.0, "records": {"run": {"before": 9.0, "after": 1.0}}},
        "candidates": [{"name": "backlash", "share": 0.9, "status": "established"}],
        "visible": {"by_name": {"backlash": 9.0, "unbalance": 1.0}, "limit": 3.5},
        "causes": [{
            "name": "backlash", "status": "established", "parameters": {
                "gap": {"value": 8e-5, "unit": "m", "interval95": [7e-5, 9e-5]}},
            "per_record": [{"record": "run", "value": 8e-5, "interval95": [7e-5, 9e-5]}],
            "homogeneous": {"parameter": "backlash.gap"},
        }],
        "findings": [{"record": "run", "channel": "x", "message": HOSTILE}],
    }  # fmt: skip
    overlay = Overlay("run, held out", time, measured, [0.0] * 400, [0.9 * one for one in measured], 0.1)
    spectrum = ResidualSpectrum([1.0, 2.0, 3.0], [0.1, 0.3, 0.1], [0.1, 0.1, 0.1], record="run")
    return render(ReportInput(HOSTILE, content, overlays=[overlay], spectrum=spectrum, provenance={"command": HOSTILE}))


def record(task):
    return {
        "task": task, "config": {"name": HOSTILE}, "git": {"revision": "abc", "dirty": True}, "inputs": {HOSTILE: "0"},
        "command": HOSTILE, "started": STARTED, "seed": 0, "versions": {"python": "3"},
    }  # fmt: skip


def scored(error):
    return {"rmse_percent": {"mean": error, "std": 0.0}, "rmse_paper": 1.0, "median_relative_error": 0.2,
            "skill": 0.1, "epochs": 3}  # fmt: skip


def said(error):
    bands = [{"from_percent": 0.1, "to_percent": 0.6, "runs": 4, "rmse_percent": error}]
    keys = ("ratio_to_bound", "typical_ratio", "rmse_to_bound", "skill", "coverage90")
    return {"rmse_percent": error, "seconds_per_record": 0.1, "by_damping_ratio": bands} | dict.fromkeys(keys)


def results(network, noise=0.14):
    controls = {"mean": scored(0.14), "white_noise": scored(noise)}
    return {"experiment": "x", "family": "bench", "protocol": "by_run", "seeds": [0], "n_runs": 4, "n_diverged": 1,
            "models": {"raw_lstm": scored(network)}, "controls": controls}  # fmt: skip


def evaluation(network):
    found = {"raw_lstm": said(network), "mean": said(0.14)}
    return {"family": "bench", "test_runs": 4, "snr_db": {"30": {"bound_percent": 0.01, "estimators": found}}}


FIT = {
    "method": "output_error", "parameters": {"stiffness": {"value": 6.0, "interval95": [5.0, 7.0], "unit": "1/s^2"}},
    "damping_ratio_percent": {"value": 0.5, "interval95": [0.4, 0.6], "unit": "%"}, "natural_frequency_hz": None,
    "records": {"a": {"role": "fit", "rmse": 0.1, "unit": "m"}}, "converged": True, "lack_of_fit": None,
}  # fmt: skip
UNSUITED = {"damping_ratio_percent": None, "unsuited": "it is too short"}
CLASSICAL = {
    "channels": {"a": {"channel": "x", "unit": "m"}},
    "records": {"a": {"half_power": UNSUITED, "log_decrement": {
        "damping_ratio_percent": 0.5, "interval95": [0.4, 0.6], "frequency_hz": 1.0, "amplitudes": [2.0, 1.0]}}},
    "laws": {"a": {"extended simulation": {"damping_ratio_percent": 0.7}}},
}  # fmt: skip
NETWORK = {
    "method": "network", "parameters": {}, "damping_ratio_percent": {"value": 0.5, "interval95": None},
    "records": {"a": {"damping_ratio_percent": 0.5, "interval95": [0.4, 0.6], "spread_percent": 0.1,
                      "outside_training": ["sampling rate"]}},
}  # fmt: skip
SIMULATED = {
    "system": "gear_pair", "effects": {"backlash": HOSTILE}, "runs": 30, "diverged": 0, "samples": 200,
    "sampling_rate_hz": 40e3, "duration_s": 5e-3, "response": "transmission_error", "unit": "m",
    "damping_ratio_percent": [0.1, 0.5], "varied": {"pinion_torque": "N*m"}, "measured": True,
    "channels": {"transmission_error": {"unit": "m", "low": -1e-6, "high": 6e-5, "mean": 2e-5, "deviation": 9e-6}},
    "each": [{"damping_ratio_percent": 0.3, "rms": 1.2e-5, "values": {"pinion_torque": 150.0}}] * 30,
}  # fmt: skip
HALF = "half_interval95_percent_of_ratio"


def told(percent, cost, seconds=0.2):
    known = {HALF: percent, "half_interval95_exponent": None}
    free = {HALF: None if percent is None else 2 * percent, "half_interval95_exponent": 0.1}
    return {"tests": [{"speed_rpm": 1500.0, "torque_nm": 75.0, "duration_s": seconds}], "sensors": ["encoders"],
            "exponent_known": known, "exponent_unknown": free, "cost": cost}  # fmt: skip


PLANNED = {
    "sentences": ["the cheapest set that knows it: one", "every set was tried"], "wanted": {"exponent_unknown": True},
    "sensors": [{"name": "encoders", "channel": "transmission_error", "unit": "m", "noise": 5e-6, "snr_db": None,
                 "offset_unknown": True, "cost": 1}],
    "tests": [told(None, 9), told(30.0, 7), *[told(20.0, 6)] * 30, told(4.0, 5)], "cheapest": told(4.0, 5),
    "best": told(4.0, 5), "front": [told(20.0, 3), told(4.0, 5)],
}  # fmt: skip
COLUMN = {"column": HOSTILE, "shape": "100", "unit": "unit not known", "kind": "a signal", "guess": "displacement: so",
          "looks": ["from 1 to 2", "noise 3"]}  # fmt: skip
INSPECTED = {"file": "a.csv", "rows": 100, "time": "50 Hz, 2 s", "notes": ["time: it is even."], "columns": [COLUMN],
             "open": 0}  # fmt: skip
DECLARED = {
    "file": "a.yaml", "system": "gear_pair", "data_problems": 0, "says": ["fitted: run"],
    "records": [{"name": "run", "says": "100 samples", "notes": ["note: fine"], "channels": [["velocity", HOSTILE]]}],
}  # fmt: skip
LEFT = {
    "simulate": ("simulation.json", SIMULATED, "simulation.png"),
    "plan": ("plan.json", PLANNED, "plan_map.png"),
    "inspect": ("inspection.json", INSPECTED, "inspection.png"),
    "paper": ("paper.json", None, "figure_12.png"),
    "train": ("results.json", results(0.05), "predicted_against_true.png"),
    "evaluate": ("evaluation.json", evaluation(0.05), "evaluation.png"),
    "identify": ("identification.json", FIT, "identification.png"),
}


def run_report(task, folder, content=None):
    name, usual, figure = LEFT[task]
    usual = json.loads((ROOT / "docs" / name).read_text()) if usual is None else usual
    (folder / name).write_text(json.dumps(content or usual))
    save(new_figure(1.0, 1.0), folder / figure)
    return write_report(folder, record(task)).read_text()


def sweep_report(folder):
    rows = [
        {"job": "0", "status": "finished", "seed": 0, "raw_lstm/rmse_percent": 0.1, "error": ""},
        {"job": "1", "status": "failed", "seed": 1, "error": HOSTILE},
    ]
    save(new_figure(1.0, 1.0), folder / "sweep.png")
    pages = {"0": "0/report.html", "1": "1/"}
    return write_sweep_report(SweepLeft(folder, ["seed"], 2, rows, pages, HOSTILE)).read_text()


def index():
    rows = [
        IndexRow(HOSTILE, STARTED, "train", HOSTILE, "finished", "x 1", 61.0, "a b/x.png", "a/r.html"),
        IndexRow("b", "", "explain", "b", "failed", HOSTILE),
    ]
    return index_page(rows)


def test_the_explanation(tmp_path):
    page = explanation()
    assert problems(page) == []
    assert page.count("<figure>") == 5
    for shown in ("Three line charts over time", "misfit of each", "bar chart", "estimates of gap", "largest line"):
        assert re.search(f'alt="[^"]*{shown}', page, re.IGNORECASE), shown


def test_every_report_of_a_run(tmp_path):
    assert set(LEFT) == set(REPORTED)
    for task in REPORTED:
        (tmp_path / task).mkdir()
        page = run_report(task, tmp_path / task)
        assert problems(page) == [], task
        assert page.count("<img") == 1
        assert "abc, changed" in page


def rows_of(page, caption):
    """The cells of each row of the table with this caption."""
    table = next(one for one in page.split("<table") if caption in one)
    body = table.partition("<tbody>")[2].partition("</tbody>")[0]
    cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL) for row in body.split("</tr>") if row.strip()]
    return [[re.sub(r"<[^>]*>", "", cell).strip() for cell in row] for row in cells]


def test_a_simulation_lists_channels_and_runs_in_units_that_suit(tmp_path):
    page = run_report("simulate", tmp_path)
    assert "30 runs of 200 samples, 5 ms at 40000 Hz; damping ratio 0.1 … 0.5 % of critical." in page
    [channel] = rows_of(page, "The channels over all runs")
    assert channel == ["transmission_error", "-1 µm", "60 µm", "20 µm", "9 µm"]
    runs = rows_of(page, "What differs from run to run")
    assert len(runs) == 20
    assert runs[0] == ["1", "0.3", "150", "12 µm"]
    assert "10 more runs stand in" in page
    assert 'class="verdict finished"' in page
    lost = run_report("simulate", tmp_path, SIMULATED | {"diverged": 2})
    assert 'class="verdict doubtful"' in lost
    assert "2 runs diverged and were left out." in lost


def test_a_plan_names_the_tests_and_lists_those_first_that_tell_most(tmp_path):
    page = run_report("plan", tmp_path)
    assert "The cheapest set that knows it: one." in page
    assert rows_of(page, "The cheapest set that tells enough, with encoders; cost 5.") == [["1", "1500", "75", "0.2"]]
    tests = rows_of(page, "What each test tells by itself")
    assert tests[0] == ["encoders", "1500", "75", "0.2", "4", "8", "0.1", "5"]
    assert len(tests) == 24
    assert "9 more stand in" in page
    assert [row[0] for row in rows_of(page, "Sets none of which")] == ["3", "5"]
    assert 'class="verdict finished"' in page
    assert 'class="verdict doubtful"' in run_report("plan", tmp_path, PLANNED | {"cheapest": None})


def test_an_inspection_of_a_bare_file_and_of_a_declared_measurement(tmp_path):
    page = run_report("inspect", tmp_path)
    assert "a.csv holds 1 column of 100 rows." in page
    assert "nothing is left open" in page
    assert rows_of(page, "The columns of the file")[0][1:] == [
        "100", "unit not known", "a signal", "displacement: so", "from 1 to 2; noise 3"]  # fmt: skip
    assert "fill in its 3 blanks" in run_report("inspect", tmp_path, INSPECTED | {"open": 3})
    declared = run_report("inspect", tmp_path, DECLARED)
    assert problems(declared) == []
    assert "a.yaml declares 1 record of a gear pair." in declared
    assert 'class="verdict doubtful"' in run_report("inspect", tmp_path, DECLARED | {"data_problems": 1})


def test_a_study_shows_every_table_of_the_page_of_the_paper(tmp_path):
    """From the numbers of the page itself."""
    page = run_report("paper", tmp_path)
    assert "14 figures and tables of Yousfi et al. (2026) are repeated." in page
    printed = (ROOT / "docs" / "paper.md").read_text()
    found = rows_of(page, "Figure 12: eccentricity;")
    assert len(found) >= 4
    for row in found:
        assert f"| {' | '.join(row)} |" in printed
    assert page.count("<table") == 2 + 14  # two over all effects, and one of each figure and table
    few = record("paper") | {"config": {"name": "x", "figures": ["figure_12", "table_1"]}}
    assert write_report(tmp_path, few).read_text().count("<table") == 2


def test_an_identification_by_estimators_of_records(tmp_path):
    (tmp_path / "damping.json").write_text(json.dumps(CLASSICAL))
    page = run_report("identify", tmp_path)
    assert problems(page) == []
    for said in ("0.5 … 0.7 % of critical", "2 … 1 m", "<code>half_power</code> says nothing of a: it is too short.",
                 "<code>extended simulation</code>"):  # fmt: skip
        assert said in page


def test_an_identification_by_a_network(tmp_path):
    page = run_report("identify", tmp_path, NETWORK)
    assert problems(page) == []
    assert "Damping ratio 0.5 % of critical, by a network." in page
    assert "Not to be relied on for a" in page
    assert 'class="verdict doubtful"' in page


def test_the_sweep(tmp_path):
    page = sweep_report(tmp_path)
    assert problems(page) == []
    assert '<a href="0/report.html">0</a>' in page
    assert "1 of 2 jobs are finished" in page


def test_the_index():
    page = index()
    assert problems(page, script=True) == []
    assert page.index("03:04:05") < page.index(">b</"), "the newest first"
    assert "1 min 01 s" in page
    assert 'src="a%20b/x.png"' in page


@pytest.mark.parametrize("page", [explanation, index])
def test_text_of_a_user_is_never_markup(page):
    assert "alert(1)" in page()
    assert "<script>alert" not in page()


def test_a_network_no_better_than_noise_is_said_first(tmp_path):
    assert 'class="verdict finished"' in run_report("train", tmp_path)
    assert 'class="verdict doubtful"' in run_report("train", tmp_path, results(0.139))
    assert 'class="verdict finished"' in run_report("evaluate", tmp_path)
    assert "no better than a control (0.14 %)" in run_report("evaluate", tmp_path, evaluation(0.139))
    assert 'class="verdict doubtful"' in run_report("identify", tmp_path, FIT | {"converged": False})


def test_what_is_not_finite_stands_in_a_report_as_a_dash(tmp_path):
    """JSON knows no such numbers: they are null in what a run leaves."""
    lost = results(None)
    lost["models"]["raw_lstm"] |= {"rmse_percent": {"mean": None, "std": None}, "rmse_paper": None, "skill": None}
    assert "No network says a number." in run_report("train", tmp_path, lost | {"seeds": [0, 1]})
    assert "no estimator answered" in run_report("evaluate", tmp_path, evaluation(None))


def test_the_table_is_that_of_the_terminal(tmp_path):
    found = errors_table(results(0.05))
    assert found.headings == list(tables.COLUMNS)
    assert [row[0] for row in found.rows] == ["raw_lstm", "mean (control)", "white_noise (control)"]
    assert '<th scope="row">raw_lstm</th>' in run_report("train", tmp_path)


BROKEN = {
    "an image without": ('alt="Main figure', 'title="Main figure'),
    "fetches https": ('href="b/"', 'href="https://example.org"'),
    "h3 after h1": ("<footer>", "<footer><h3>Deep</h3>"),
    "without caption": ("<caption", "<p"),
    "without scope": ('<th scope="col">status', "<th>status"),
    "without focus or name": ('aria-labelledby="runs" tabindex="0"', 'aria-labelledby="runs"'),
    "has the id runs": ('id="runs"', 'id="other"'),
    "no language": ('lang="en"', 'lang=""'),
    "0 elements main": ("<main", "<section"),
    "no policy": ("default-src 'none'", "default-src *"),
}


@pytest.mark.parametrize("problem", BROKEN)
def test_what_is_broken_is_seen(problem):
    page, (right, wrong) = index(), BROKEN[problem]
    assert right in page
    assert any(problem in one for one in problems(page.replace(right, wrong), script=True))


def colours(block):
    return dict(re.findall(r"--([\w-]+):\s*(#[0-9a-f]{6})", block))


def schemes():
    light = re.search(r":root \{(.*?)\}", STYLE, re.DOTALL)[1]
    dark = re.search(r"prefers-color-scheme: dark\) \{\s*:root \{(.*?)\}", STYLE, re.DOTALL)[1]
    return {"light": colours(light), "dark": colours(light) | colours(dark)}


def luminance(colour):
    """Relative luminance of sRGB (WCAG 2.2)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [one / 12.92 if one <= 0.04045 else ((one + 0.055) / 1.055) ** 2.4 for one in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_contrast_is_that_of_wcag():
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_is_told_from_its_ground(scheme):
    known = schemes()[scheme]
    faint = {pair for pair in product(TEXT, GROUNDS) if contrast(known[pair[0]], known[pair[1]]) < READ}
    assert faint == set()
    assert min(contrast(known["focus"], known[ground]) for ground in GROUNDS) >= SEEN


def test_both_schemes_are_whole_and_no_colour_stands_outside_of_them():
    found = schemes()
    assert {*TEXT, *GROUNDS, "line", "focus", "sheet"} == set(found["light"])
    changed = {name for name in found["light"] if found["light"][name] != found["dark"][name]}
    assert changed == set(found["light"]) - {"sheet"}
    rules = re.sub(r":root \{.*?\}", "", STYLE, flags=re.DOTALL)
    assert re.findall(r"#[0-9a-f]{3,8}\b|rgba?\(", rules) == []
    uses = set(re.findall(r"[^-]color: var\(--([\w-]+)\)", rules)) | set(re.findall(r"--accent: var\(--(\w+)\)", rules))
    assert uses <= {*TEXT, "accent"}


def test_a_page_without_a_script_allows_none():
    page = render_page("gear_damping.reporting.run_index", "index.html", rows=[])
    assert "script-src 'none'" in page
    assert "Nothing has run here yet." in page
