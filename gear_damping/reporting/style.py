"""One look for every figure: colours, sizes, and the legend beside the data instead of on it."""

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib import font_manager
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

log = logging.getLogger("gear_damping")
# Okabe & Ito (2008): told apart also without colour vision.
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW = (
    "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442",
)  # fmt: skip
INK, PALE, FAINT = "#222222", "#8A8A8A", "#E6E6E6"
CYCLE = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
MODEL_COLOURS = {"raw_lstm": BLUE, "cwt_lstm": RED, "record_cwt_lstm": GREEN, "white_noise": PALE, "mean": INK}
MODEL_MARKERS = {"raw_lstm": "o", "cwt_lstm": "s", "record_cwt_lstm": "D", "white_noise": "x", "mean": "+"}
SEQUENTIAL, DIVERGING = "cividis", "RdBu_r"
WIDTH = 8.0  # inches; 1200 pixels at the resolution of saved files
# Fonts that have the letters of East Asia, on one system or another; the usual one has the others.
EAST_ASIAN = (
    "Noto Sans CJK JP", "Noto Sans JP", "Noto Sans CJK SC", "Noto Sans SC", "IPAexGothic", "Yu Gothic", "Meiryo",
    "MS Gothic", "Hiragino Sans", "SimHei", "Microsoft YaHei", "PingFang SC", "WenQuanYi Zen Hei", "Malgun Gothic",
    "Apple SD Gothic Neo", "NanumGothic",
)  # fmt: skip
NO_LETTER = "Glyph .* missing from"  # how a warning of matplotlib begins that a letter is drawn as a box
SAVED_DPI = 150  # sharp in print at half a page
_STYLE = {
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.labelsize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": FAINT,
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.2,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "hatch.linewidth": 0.6,
    "figure.dpi": 100,
    "savefig.dpi": SAVED_DPI,
    "svg.hashsalt": "gear_damping",  # the same figure gives the same file
    "path.simplify_threshold": 0.3,
}


@contextmanager
def styled() -> Iterator[None]:
    """The look, for what is made or drawn inside; that a font lacks letters is said in one line."""
    with mpl.rc_context(_STYLE | {"font.family": families()}), warnings.catch_warnings(record=True) as found:
        warnings.filterwarnings("always", NO_LETTER)
        yield
    for one in found:
        if re.match(NO_LETTER, str(one.message)):
            _say_boxes()
        else:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


@cache
def families() -> list[str]:
    """The fonts of a figure: the usual one, and for letters that it lacks those of East Asia that are installed."""
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return ["sans-serif", *(name for name in EAST_ASIAN if name in installed)]


@cache
def _say_boxes() -> None:
    """Once in a process."""
    log.info("no font here has all letters of the names: figures show boxes for them")


class StyledFigure(Figure):
    """A figure that keeps the look whoever draws it: ticks are made as late as in the drawing."""

    def draw(self, renderer: Any) -> None:
        """Draw with the look."""
        with styled():
            super().draw(renderer)


def new_figure(height: float = 4.0, width: float = WIDTH, layout: str | None = "constrained") -> Figure:
    """An empty figure (inches) that belongs to no window."""
    figure = StyledFigure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def colour_of(name: str, number: int = 0) -> str:
    """The colour of a model by name, else one of the cycle."""
    return MODEL_COLOURS.get(name, CYCLE[number % len(CYCLE)])


def marker_of(name: str) -> str:
    """The marker of a model by name: colour is never the only difference."""
    return MODEL_MARKERS.get(name, "o")


def legend_above(axes: Axes, handles: list[Artist] | None = None, columns: int = 4) -> None:
    """The legend over the axes, where it covers no data; none where nothing has a label."""
    handles = axes.get_legend_handles_labels()[0] if handles is None else handles
    if handles:
        place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
        axes.legend(handles=handles, ncols=columns, handlelength=1.8, columnspacing=1.4, **place)


def mark_empty(axes: Axes, words: str = "no finite values to show") -> None:
    """Say in the axes that there is nothing to see."""
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center", color=PALE, fontsize=11)


def save(figure: Figure, path: Path | str) -> Path:
    """Write a figure as the kind of file that its name says."""
    path = Path(path)
    with styled():
        figure.savefig(path)
    return path
