"""Names that figures and tables share."""

from gear_damping.reporting.paper.printed import REPRESENTATIVE_PERCENT

SHOWN_NOISE = "noise_20_db"  # of figure 8
EFFECT_OF = {  # of figures that show one effect under the protocols
    "figure_07": "baseline",
    "figure_08": SHOWN_NOISE,
    "figure_12": "eccentricity",
    "figure_13": "backlash",
    "figure_15": "torque",
}


def one_run_of(ratio_percent: float) -> str:
    """What the run of a damping ratio (%) is called: the representative one is the baseline."""
    return "baseline" if ratio_percent == REPRESENTATIVE_PERCENT else f"ratio_{ratio_percent:g}"
