"""Figures and files as data URIs, so that a page needs nothing beside itself."""

import base64
import io
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from gear_damping.reporting.style import SAVED_DPI, styled

LARGEST_SVG = 1_500_000  # bytes; a drawing with more is shown as a picture
PICTURE_DPI = 200  # sharp on a screen of twice the density


@dataclass(frozen=True)
class Picture:
    """A picture in a page.

    Args:
        uri: The picture.
        caption: What to see in it, in one or two sentences.
        alt: What it shows, for those who do not see it: its kind, its axes, its curves, the figures in it.
    """

    uri: str
    caption: str
    alt: str


def figure_uri(figure: Figure) -> str:
    """The figure as SVG, or as PNG where the drawing would be too large; the same figure gives the same text."""
    content = _saved(figure, "svg", SAVED_DPI, {"Date": None, "Creator": None})
    if len(content) <= LARGEST_SVG:
        return _uri("image/svg+xml", content)
    return _uri("image/png", _saved(figure, "png", PICTURE_DPI, {"Software": None}))


def file_uri(path: Path) -> str:
    """A PNG file."""
    return _uri("image/png", path.read_bytes())


def _saved(figure: Figure, kind: str, dpi: int, metadata: dict[str, None]) -> bytes:
    target = io.BytesIO()
    with styled():
        figure.savefig(target, format=kind, dpi=dpi, metadata=metadata)
    return target.getvalue()


def _uri(kind: str, content: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"
