"""What `explain` says of real measured records whose answer is known from their authors: `make real`.

The records are read from `GEAR_DAMPING_DATA` (default `../shared/data`); none of them is in this repository. Answers
are kept as they come, so that the same command goes on, as long as the code that explains is the same; writes
`docs/real_records.md` and its figure.
"""

import argparse
import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.explaining import engine
from benchmarks.marked import put
from gear_damping.config.locate import conf_folder
from gear_damping.interface.explained import explain
from gear_damping.measurement.files import data_root
from gear_damping.measurement.load import load_measurement
from gear_damping.reporting.figures import misfit_figure, save
from gear_damping.reporting.numbers import estimate, number
from gear_damping.reporting.tables import markdown

ROOT = Path(__file__).parents[1]
PAGE, PICTURE = ROOT / "docs" / "real_records.md", ROOT / "docs" / "figures" / "real_records.png"
OWN = conf_folder() / "measurement" / "records"
BEFORE, AFTER = "<!-- measured by `make real` -->", "<!-- end -->"
HEADER = ("records", "verdict", "established", "held-out misfit before → after", "named as filed", "s of one core")


@dataclass(frozen=True)
class Filed:
    """What is known of a rig. needed: causes that are there; allowed: that may be, by its authors or by physics."""

    place: str
    needed: frozenset[str] = frozenset()
    allowed: frozenset[str] = frozenset()

    @property
    def path(self) -> Path:
        """The declaration: with the data, or one of the examples of the package."""
        own = OWN / f"{self.place}.yaml"
        return own if own.exists() else data_root() / self.place / "measurement.yaml"


FRICTION = frozenset({"coulomb_friction"})
SHIP = Filed("ship_roll_21337", frozenset({"power_law_damping"}), frozenset({"cubic_stiffness"}))
FILED = {
    "Silverbox": Filed("silverbox", frozenset({"cubic_stiffness"})),
    "ship roll 21337": SHIP,
    "EMPS drive": Filed("emps", FRICTION, frozenset({"offset_force", "asymmetric_friction"})),
    "multiarm pendulum": Filed("multiarm", FRICTION | {"sine_restoring"}, frozenset({"power_law_damping"})),
    "pendulum on a motor": Filed("dfki_pendulum", FRICTION | {"sine_restoring"}),
    "seismometer (null)": Filed("seismometer"),
    "wheel by its rate (null)": Filed("wheel_gyro"),
}


def answered(filed: Filed) -> dict[str, Any]:
    """The answer to one measurement, and what it took."""
    began = time.process_time()
    content = explain(load_measurement(filed.path)).content
    causes = [
        {"name": cause["name"], "parameters": cause["parameters"]}
        for cause in content["causes"]
        if cause["status"] == "established"
    ]
    misfit = content["misfit"]
    return {
        "verdict": content["verdict"], "causes": causes, "misfit": {key: misfit[key] for key in ("before", "after")},
        "seconds": time.process_time() - began, "sentences": content["sentences"],
    }  # fmt: skip


def judged(filed: Filed, answer: dict[str, Any]) -> str:
    """In a word: all that is there and nothing else, a part of it, or a wrong name."""
    names = {cause["name"] for cause in answer["causes"]}
    if wrong := names - filed.needed - filed.allowed:
        return f"**no: {', '.join(sorted(wrong))}**"
    if missing := filed.needed - names:
        return f"in part: not {', '.join(sorted(missing))}"
    return "yes" if filed.needed or answer["verdict"] == "consistent" else f"no: {answer['verdict']}"


def row(name: str, answer: dict[str, Any]) -> tuple[str, ...]:
    """A line of the table."""
    causes = [
        f"`{cause['name']}` " + ", ".join(f"{key} {estimate(one)}" for key, one in cause["parameters"].items())
        for cause in answer["causes"]
    ]
    before, after = (number(answer["misfit"][key], 3) for key in ("before", "after"))
    return (
        name, f"`{answer['verdict']}`", "; ".join(causes) or "–", f"{before} → {after}", judged(FILED[name], answer),
        f"{answer['seconds']:.0f}",
    )  # fmt: skip


def write(answers: dict[str, dict[str, Any]]) -> None:
    """Table and figure."""
    rows = [row(name, answer) for name, answer in answers.items()]
    put(markdown(HEADER, rows), PAGE, BEFORE, AFTER)
    save(misfit_figure({name: answer["misfit"] for name, answer in answers.items()}), PICTURE)


def of_this_engine(kept: Path, version: str) -> dict[str, dict[str, Any]]:
    """Answers that were kept, where the code that explains is that which gave them; none of any other."""
    noted = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    return noted["answers"] if noted.get("engine") == version else {}


def main() -> None:
    """Ask what has not been asked, and write."""
    parser = argparse.ArgumentParser(prog="make real", description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "real", help="folder of the answers")
    parser.add_argument("--redo", action="store_true", help="ask again what was answered")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / "answers.json"
    version = engine()
    answers = {} if options.redo else of_this_engine(kept, version)
    for name, filed in FILED.items():
        if name not in answers:
            answers[name] = answered(filed)
            noted = {"engine": version, "answers": answers}
            kept.write_text(json.dumps(noted, indent=1, allow_nan=False), encoding="utf-8")
        print(f"{name}: {answers[name]['verdict']}, {judged(filed, answers[name])}", flush=True)
        write({one: answers[one] for one in FILED if one in answers})  # stopped here, the page has what was asked


if __name__ == "__main__":
    main()
