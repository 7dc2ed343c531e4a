"""One look for every figure."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

# Okabe & Ito (2008): told apart also without colour vision.
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW = (
    "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442",
)  # fmt: skip
INK, PALE = "#222222", "#999999"
CYCLE = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
MODEL_COLOURS = {"raw_lstm": BLUE, "cwt_lstm": RED, "white_noise": PALE, "mean": INK, "record_cwt_lstm": GREEN}
_STYLE = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "figure.dpi": 100,
    "savefig.dpi": 150,
}


@contextmanager
def styled() -> Iterator[None]:
    """The look, for figures made inside."""
    with mpl.rc_context(_STYLE):
        yield


def new_figure(width: float = 8.0, height: float = 4.0) -> Figure:
    """An empty figure that belongs to no window."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def colour_of(name: str, number: int = 0) -> str:
    """The colour of a model by name, else one of the cycle."""
    return MODEL_COLOURS.get(name, CYCLE[number % len(CYCLE)])


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as the kind of file that its name says."""
    with styled():
        figure.savefig(path)
    return path
