"""The figures of a study by name."""

from collections.abc import Callable, Mapping
from functools import partial

from matplotlib.figure import Figure

from gear_damping.reporting.paper.curves import convergence_figure
from gear_damping.reporting.paper.effect import effect_figure
from gear_damping.reporting.paper.names import EFFECT_OF
from gear_damping.reporting.paper.responses import responses_figure, stiffness_figure
from gear_damping.reporting.paper.study import Study
from gear_damping.reporting.paper.sweeps import noise_figure, ratios_figure

DRAWN: Mapping[str, Callable[[Study], Figure]] = {
    "figure_04": stiffness_figure,
    "figure_05": partial(responses_figure, left="right", right="as_printed"),
    "figure_06": partial(convergence_figure, name="figure_06", effect="baseline"),
    "figure_09": noise_figure,
    "figure_10": partial(responses_figure, left="eccentricity", right="eccentricity_printed", beside="right"),
    "figure_11": partial(convergence_figure, name="figure_11", effect="eccentricity"),
    "figure_14": ratios_figure,
    **{name: partial(effect_figure, name=name, effect=effect) for name, effect in EFFECT_OF.items()},
}


def figure(name: str, study: Study) -> Figure:
    """A figure of the paper, repeated."""
    return DRAWN[name](study)
