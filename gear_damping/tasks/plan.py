"""task=plan: what tests of the configured rig would tell of its damping, and the cheapest that tell enough."""

from dataclasses import asdict, replace
from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.identification.test_plan.repeated import Repeated
from gear_damping.interface import planned
from gear_damping.interface.model import Model
from gear_damping.interface.planned_page import goal_precision
from gear_damping.reporting import figures
from gear_damping.reporting.numbers import number
from gear_damping.tasks import statements
from gear_damping.tasks.progress import progress_bar
from gear_damping.tasks.run_folder import RunFolder

MOST_SHOWN = 16  # tests on the terminal; plan.txt has all


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Plan and write; returns the metrics for run.json."""
    asked = settings.plan
    folder.add_inputs(settings.simulator.files, "simulator.extended")
    with progress_bar("simulating the tests", settings.progress) as progress:
        solver = replace(settings.simulator.solver, progress=progress)
        kept = {"unknown": asked.unknown, "goal": asked.goal, "solver": solver}
        found = planned.plan(Model.of_settings(settings.simulator), asked.tests, asked.sensors, **kept)
    content, sentences = found.content, found.sentences
    if asked.simulated_tests:
        joint, of = asked.goal.joint, found.cheapest or found.best
        shown = found.simulated(of, count=asked.simulated_tests, joint=joint, seed=settings.seed)
        content["simulated"] = asdict(shown)
        sentences = [*sentences, _said(shown)]
    folder.write_json("plan.json", content | {"sentences": sentences})
    folder.write_text("plan.txt", found.table() + "\n" + "\n".join(sentences) + "\n")
    statements.log(found.table(MOST_SHOWN))
    for sentence in sentences:
        statements.log(sentence)
    statements.log("drawing the interval between the tests")
    figures.save(found.plot(), folder.path / "plan_map.png")
    statements.log(f"wrote plan.txt with every test, plan.json and plan_map.png into {folder.path}")
    best = goal_precision(found.found, found.cheapest or found.best)
    return {"reached": found.cheapest is not None, "percent": best.percent, "cost": (found.cheapest or found.best).cost}


def _said(shown: Repeated) -> str:
    one = shown.damping_ratio
    text = f"{shown.count} simulated and fitted tests of it: standard deviation {number(one.deviation, 3)} % of "
    text += f"critical, promised {number(one.promised, 3)}; the interval holds the truth in {100 * one.covered:.1f} %"
    return text + (f"; {shown.lost} fits did not converge" if shown.lost else "")
