"""The report of task=evaluate: every estimator on the same records, beside the bound."""

import math
from collections.abc import Mapping
from typing import Any

from gear_damping.identification.controls import NO_BETTER
from gear_damping.reporting.evaluation import COLUMNS, NO_NOISE, evaluation_rows, ratio_rows
from gear_damping.reporting.numbers import number
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

CONTROLS = ("mean", "white_noise")
TEXT_COLUMN = 2  # of the table: the estimator
TABLE = (
    "Errors on unseen records. The bound is the Cramér–Rao bound of what a record holds, in % of critical as RMSE is; "
    "skill is 1 where all is right and 0 for the mean of the training labels."
)
BY_RATIO = "RMSE in % of critical by the true damping ratio."


def report_of(left: Left) -> RunReport:
    """What an evaluation has come to."""
    content = left.read("evaluation.json")
    numbers = [place for place in range(len(COLUMNS)) if place != TEXT_COLUMN]
    whole = Table(TABLE, COLUMNS, evaluation_rows(content), numbers)
    columns, rows = ratio_rows(content)
    by_ratio = Table(BY_RATIO, columns, rows, [0, *range(2, len(columns))])
    sections = [
        Section("Errors beside the bound", [_runs(content)], [whole], _against_noise(left, content)),
        Section("By damping ratio", (), [by_ratio], _pairs(left, content)),
    ]
    leads = [_lead(snr, level) for snr, level in content["snr_db"].items()]
    tells = any(_tells(level) for level in content["snr_db"].values())
    state = FINE if tells else DOUBTFUL
    return RunReport("Evaluation", f"Evaluation of {left.name}", leads, state, sections)


def _errors(level: Mapping[str, Any], controls: bool = False) -> dict[str, float]:
    """RMSE of the estimators, or of the controls, that answered."""
    found = level["estimators"].items()
    return {n: f["rmse_percent"] for n, f in found if (n in CONTROLS) == controls and f["rmse_percent"] is not None}


def _tells(level: Mapping[str, Any]) -> bool:
    """Whether any estimator is better than the controls by more than chance makes it."""
    best, control = (min(_errors(level, controls).values(), default=math.inf) for controls in (False, True))
    return best <= NO_BETTER * control


def _lead(snr: str, level: Mapping[str, Any]) -> str:
    errors, where = _errors(level), _noise(snr)
    if not errors:
        return f"{where}: no estimator answered."
    best = min(errors, key=errors.__getitem__)
    bound = level["bound_percent"]
    beside = "" if bound is None else f", where the bound is {number(bound, 3)} %"
    controls = _errors(level, controls=True)
    hardly = "" if _tells(level) else f", no better than a control ({number(min(controls.values()), 3)} %)"
    return f"{where}: `{best}` is nearest, RMSE {number(errors[best], 3)} % of critical{hardly}{beside}."


def _noise(snr: str) -> str:
    return "Without noise" if float(snr) >= NO_NOISE else f"At {snr} dB"


def _in_text(snr: str) -> str:
    return _noise(snr)[0].lower() + _noise(snr)[1:]


def _runs(content: Mapping[str, Any]) -> str:
    text = f"{content['test_runs']} runs of the family `{content['family']}` that no estimator has met"
    irregular = content.get("irregular_runs")
    return text + (f"; {irregular} of them have no bound." if irregular else ".")


def _against_noise(left: Left, content: Mapping[str, Any]) -> list[Picture]:
    said = [
        f"{_in_text(snr)} {', '.join(f'{n} {number(e, 3)} %' for n, e in _errors(level).items())}, mean "
        f"{number(level['estimators']['mean']['rmse_percent'], 3)} %, bound {number(level['bound_percent'], 3)} %"
        for snr, level in content["snr_db"].items()
    ]
    alt = (
        "Line chart of the RMSE of the damping ratio in % of critical, on a logarithmic axis, over the signal-to-noise "
        f"ratio of the sensor in dB, a line an estimator, and the bound: {'; '.join(said)}."
    )
    return left.picture(
        "evaluation.png",
        "Error against the noise of the sensor. No estimator without a bias gets into the shaded area.",
        alt,
    )


def _pairs(left: Left, content: Mapping[str, Any]) -> list[Picture]:
    snr, level = next(iter(content["snr_db"].items()))
    name = next(iter(level["estimators"]))
    error = number(level["estimators"][name]["rmse_percent"], 3)
    alt = (
        f"Scatter plot of the damping ratio that {name} says over the true one of {content['test_runs']} runs, in % of "
        f"critical; RMSE {error} %."
    )
    caption = f"Predicted against true damping ratio, {_in_text(snr)}. On the dotted line a prediction is right."
    return left.picture("predicted_against_true.png", caption, alt)
