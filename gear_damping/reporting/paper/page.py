"""`python -m gear_damping.reporting.paper.page RUN`: write tables and figures of a study into docs/paper.md.

RUN is the folder that `experiment=paper_figures` left. What stands outside the markers is kept.
"""

import argparse
import json
import re
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from gear_damping.reporting.paper.cells import Found
from gear_damping.reporting.paper.printed import EFFECTS
from gear_damping.reporting.paper.tables import TABLES
from gear_damping.reporting.smaller import smaller_png

FIGURES = Path("figures") / "paper"  # beside the page
NUMBERS = "paper.json"
ALWAYS = ("settings", "overview", "leads")  # tables of no figure: over all of them
MARKED = re.compile(r"(<!-- (\w+): begin[^>]*-->\n).*?(<!-- \2: end -->)", re.DOTALL)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m gear_damping.reporting.paper.page", description=__doc__)
    parser.add_argument("run", type=Path, help="folder of a finished experiment=paper_figures")
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where paper.md lies")
    given = parser.parse_args(arguments)
    shutil.copyfile(given.run / NUMBERS, given.folder / NUMBERS)
    pictures = given.folder / FIGURES
    pictures.mkdir(parents=True, exist_ok=True)
    for path in sorted(given.run.glob("figure_*.png")):
        smaller_png(path, pictures / path.name)
    page = given.folder / "paper.md"
    found = json.loads((given.run / NUMBERS).read_text(encoding="utf-8"))
    page.write_text(with_tables(page.read_text(encoding="utf-8"), found), encoding="utf-8")
    print(f"wrote the tables of {page}")
    return 0


def with_tables(text: str, found: Found) -> str:
    """The page with its tables as these numbers have them.

    Args:
        text: The page, with a pair of markers for every table.
        found: The content of paper.json.
    """
    return MARKED.sub(lambda mark: f"{mark[1]}\n{TABLES[mark[2]](found)}\n\n{mark[3]}", text)


def report(found: Found, wanted: Iterable[str]) -> str:
    """Every table that was asked for, as one text; over all effects only where all were."""
    names = [name for name in wanted if name in TABLES]
    over_all = ALWAYS if set(EFFECTS) <= set(names) else ALWAYS[:1]
    parts = ["# Figures and tables of Yousfi et al. (2026), repeated"]
    parts += [TABLES[name](found) for name in over_all]
    for name in sorted(names):
        parts.append(f"## {name.replace('_0', ' ').replace('_', ' ').capitalize()}: {EFFECTS[name]}")
        parts.append(TABLES[name](found))
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    raise SystemExit(main())
