"""How visible each effect is in what a simulation leaves, beside the limit of all of them together."""

from collections.abc import Mapping

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gear_damping.reporting.style import BLUE, INK, PALE, mark_empty, new_figure, styled

MOST_BARS = 16  # that can be read on one page
UNNAMED = "unnamed: "  # as explanation.json writes it; what explains is not imported to draw
LIMIT = {"color": INK, "linewidth": 1.0, "linestyle": "--"}


def visible_figure(statistics: Mapping[str, float], limit: float) -> Figure:
    """Bars of the standardised score statistic of every effect and family, the largest on top, with the limit.

    Args:
        statistics: By name; families that have no name in the catalogue begin with `unnamed: `.
        limit: That one of them exceeds by chance in one of a hundred measurements.
    """
    rows = sorted(statistics.items(), key=lambda row: -row[1])
    shown = rows[:MOST_BARS]
    with styled():
        figure = new_figure(1.2 + 0.29 * max(len(shown), 3))
        axes = figure.subplots()
        rest = f"      ({len(rows) - len(shown)} smaller ones not shown)" if len(rows) > len(shown) else ""
        axes.set_xlabel(f"standardised score statistic of what is left{rest}")
        if not shown:
            mark_empty(axes, "nothing was tested")
            return figure
        for place, (name, value) in enumerate(shown):
            unnamed = name.startswith(UNNAMED)
            look = {"color": PALE, "hatch": "///"} if unnamed else {"color": BLUE}
            axes.barh(place, value, edgecolor="white", height=0.72, **look)
            axes.annotate(f"{value:.3g}", (max(value, 0), place), (4, 0), textcoords="offset points", va="center")
        axes.axvline(limit, **LIMIT)
        axes.set_xlim(min(0.0, 1.15 * shown[-1][1]), 1.15 * max(shown[0][1], limit))
        axes.set_yticks(range(len(shown)), labels=[_words(name) for name, _ in shown])
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        handles = [Patch(facecolor=BLUE, label="an effect")]
        handles.append(Patch(facecolor=PALE, hatch="///", edgecolor="white", label="a shape without a name"))
        handles.append(Line2D([], [], label="limit of all together, 1 %", **LIMIT))
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        return figure


def _words(name: str) -> str:
    return name.removeprefix(UNNAMED).replace("_", " ")
