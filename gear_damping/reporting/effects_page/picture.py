"""The small figure of a signature: both responses, the residual over time, and its spectrum."""

import io
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from PIL import Image
from scipy.spatial import KDTree

from gear_damping.reporting.effects_page.signatures import Signature
from gear_damping.reporting.figures.marks import GEAR, MESH, PINION
from gear_damping.reporting.style import BLUE, FAINT, INK, PALE, RED, new_figure, styled

WIDTH, HEIGHT = 9.6, 2.35  # inches
DPI = 110  # legible on a page, some 40 kB each
SHADES = 7  # of each colour: few, so that the files are small
RESPONSE_LIMITS = (-5.0, 50.0)  # µm; one scale for all, widened only where a response leaves it
AMPLITUDE_LIMITS = (1e-4, 60.0)  # µm; one scale for all
ORDER_LIMITS = (0.35, 220.0)  # from below the shaft to ten meshes of 20 teeth
MESH_HARMONICS = 6  # that are marked
SHOWN_MESH_PERIODS = 6  # in which single teeth are still seen
SHOWN_SECONDS = 1.6  # in which single cycles are seen
REPEATING = 0.99  # share of the residual's energy on the harmonics and half harmonics of the mesh
NATURAL = {"color": INK, "linewidth": 0.9, "linestyle": (0, (1, 1))}


def signature_figure(found: Signature) -> Figure:
    """Responses with and without the effect, the residual, and the spectra of residual and response."""
    with styled():
        figure = new_figure(HEIGHT, WIDTH)
        responses, residual, spectrum = figure.subplots(1, 3, width_ratios=(1, 1, 1.35))
        _responses(responses, found)
        _residual(residual, found)
        _spectrum(spectrum, found)
        for axes in (responses, residual, spectrum):
            axes.tick_params(labelsize=8)
            axes.title.set_fontsize(9)
            axes.xaxis.label.set_fontsize(9)
        return figure


def _stretch(found: Signature) -> tuple[float, float]:
    """A few mesh periods about the largest residual, or the first seconds of an oscillator."""
    if not found.n_teeth:
        return 0.0, SHOWN_SECONDS
    length = SHOWN_MESH_PERIODS / found.n_teeth
    centre = found.place[int(np.argmax(np.abs(found.residual - found.residual.mean())))]
    first = float(np.clip(centre - length / 2, 0, found.place[-1] - length))
    return first, first + length


def _repeats_with_the_mesh(found: Signature) -> bool:
    """Whether all turns of the residual look like a few mesh periods of it."""
    if not found.n_teeth:
        return False
    energy = found.amplitudes[1:] ** 2
    on_mesh = 2 * found.orders[1:] / found.n_teeth % 1 < 1e-6  # two periods of a subharmonic repeat as well
    return bool(energy[on_mesh].sum() > REPEATING * energy.sum())


def _responses(axes: Axes, found: Signature) -> None:
    """Both responses over a stretch, with the same limits for all effects where they suffice."""
    first, last = _stretch(found)
    shown = (found.place >= first) & (found.place <= last)
    axes.plot(found.place[shown], found.without[shown], color=PALE, linewidth=2.2)
    axes.plot(found.place[shown], found.with_effect[shown], color=BLUE, linewidth=1.0)
    title = f"with (blue), without (grey) / {found.unit}"
    axes.set(title=title, xlabel=_place_label(found), xlim=(first, last))
    if found.n_teeth:
        drawn = np.concatenate([found.without[shown], found.with_effect[shown]])
        axes.set_ylim(min(RESPONSE_LIMITS[0], 1.05 * drawn.min()), max(RESPONSE_LIMITS[1], 1.05 * drawn.max()))


def _residual(axes: Axes, found: Signature) -> None:
    """The residual over all turns, or over the same stretch where it repeats with the mesh."""
    first, last = _stretch(found) if _repeats_with_the_mesh(found) else (0.0, float(found.place[-1]))
    shown = (found.place >= first) & (found.place <= last)
    axes.plot(found.place[shown], found.residual[shown], color=RED, linewidth=0.7)
    axes.set(title=f"residual / {found.unit}", xlabel=_place_label(found), xlim=(first, last))
    low, high = float(found.residual.min()), float(found.residual.max())
    if high - low < 1e-6 * max(abs(low), abs(high)):  # a constant: rounding is no signature
        axes.set_ylim(min(0.0, 1.5 * low), max(0.0, 1.5 * high))


def _spectrum(axes: Axes, found: Signature) -> None:
    """Residual in red over the response in grey, with the orders that gears make."""
    shown = found.orders > 0
    floor = AMPLITUDE_LIMITS[0] / 10
    for amplitudes, colour, width in ((found.amplitudes_without, PALE, 0.8), (found.amplitudes, RED, 0.9)):
        axes.plot(found.orders[shown], np.maximum(amplitudes[shown], floor), color=colour, linewidth=width)
    axes.set(yscale="log", xscale="log", title=f"residual (red), response (grey), peak / {found.unit}")
    if not found.n_teeth:
        axes.set(xlim=(0.3, 40.0), ylim=(1e-5, 1.0), xlabel="frequency / Hz")
        axes.axvline(found.natural, zorder=0.9, **NATURAL)
        axes.set_xticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5 f₀", "10", "20"])
    else:
        axes.set(xlim=ORDER_LIMITS, ylim=AMPLITUDE_LIMITS, xlabel="order of the pinion shaft")
        _marks(axes, found, found.n_teeth)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(visible=False, axis="x")


def _marks(axes: Axes, found: Signature, teeth: float) -> None:
    axes.axvline(1.0, zorder=0.9, **PINION)
    axes.axvline(found.gear_order or 1.0, zorder=0.9, **GEAR)
    for harmonic in range(1, MESH_HARMONICS + 1):
        axes.axvline(harmonic * teeth, zorder=0.9, **MESH)
    axes.axvline(found.natural, zorder=0.9, **NATURAL)
    names = {found.gear_order or 1.0: "s2", 1.0: "s1", 5.0: "5", 10.0: "10"}
    names |= {teeth: "M", 2 * teeth: "2M", 3 * teeth: "3M", found.natural: "f₀"}
    axes.set_xticks(list(names), list(names.values()))


def _place_label(found: Signature) -> str:
    return "turns of the pinion" if found.n_teeth else "time / s"


def write_signature(found: Signature, path: Path) -> Path:
    """Write the figure as a PNG of few colours."""
    drawn = io.BytesIO()
    with styled():
        signature_figure(found).savefig(drawn, format="png", dpi=DPI)
    drawn.seek(0)
    with Image.open(drawn) as image:
        pixels = np.asarray(image.convert("RGB"), dtype=np.float32)
    palette = _palette()
    nearest = KDTree(palette).query(pixels.reshape(-1, 3))[1].reshape(pixels.shape[:2])
    reduced = Image.fromarray(nearest.astype(np.uint8))
    reduced.putpalette(palette.ravel().tolist())
    reduced.save(path, optimize=True)
    return path


def _palette() -> np.ndarray:
    """Every colour of the figures and its shades towards white, (colour, 3), 0 … 255."""
    shares = np.linspace(0, 1, SHADES)[:, None]
    colours = (RED, BLUE, INK, PALE, FAINT, str(MESH["color"]), str(PINION["color"]), str(GEAR["color"]))
    shades = [255 * ((1 - shares) * to_rgb(colour) + shares) for colour in colours]
    return np.concatenate(shades).round().astype(int)
