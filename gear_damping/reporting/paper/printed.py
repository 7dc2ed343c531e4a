"""What Yousfi et al. (2026), Sound & Vibration 60(2), 3869, print: figures by number, tables, words beside them.

The paper never says whether an error is a fraction or in % of critical; numbers stand here as they are printed.
"""

from collections.abc import Mapping
from dataclasses import dataclass

RAW, CWT = "raw_lstm", "cwt_lstm"
EFFECTS = {  # what a figure or table studies, by its name here
    "figure_04": "mesh stiffness",
    "figure_05": "wavelet transform of the response",
    "figure_06": "convergence, nonlinear damping",
    "figure_07": "nonlinear damping",
    "figure_08": "noise on the load",
    "figure_09": "noise on the load, 1 to 50 dB",
    "figure_10": "wavelet transform under eccentricity",
    "figure_11": "convergence, eccentricity",
    "figure_12": "eccentricity",
    "figure_13": "backlash",
    "figure_14": "damping ratios of 0.1 to 0.6 %",
    "figure_15": "varying torque",
    "table_1": "parameters of the gear pair",
    "table_2": "damping ratios, varying torque",
}
SNRS_DB = (1.0, 10.0, 20.0, 30.0, 40.0, 50.0)  # dB; section 3.3, "increasing the SNR from 1 to 50 dB"
RATIOS_PERCENT = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)  # % of critical; section 4.1
REPRESENTATIVE_PERCENT = 0.6  # % of critical; section 4.1, "a representative case"
BASE_CIRCLES_M = (0.05, 0.11)  # m; table 1, of pinion and gear
STIFFNESS_N_PER_M = (2e8, 4e8)  # N/m; table 1, least and most
ECCENTRICITY = 0.001  # of no stated unit; equation 11
DOMINANT_FREQUENCIES = 5  # in figures 5 and 10


@dataclass(frozen=True)
class Errors:
    """The two errors that are printed for one effect.

    Args:
        raw_lstm: Of the network on samples.
        cwt_lstm: Of the network on wavelet columns.
    """

    raw_lstm: float
    cwt_lstm: float

    def of(self, name: str) -> float | None:
        """The error of a network by its name; None of what the paper does not have."""
        return {RAW: self.raw_lstm, CWT: self.cwt_lstm}.get(name)


RMSE: Mapping[str, Errors] = {  # sections 3.2 to 3.5, table 2
    "figure_07": Errors(6.37e-4, 3.19e-4),
    "figure_08": Errors(3.99e-4, 1.034e-4),
    "figure_12": Errors(2.38e-4, 8.33e-4),
    "figure_13": Errors(3.92e-4, 1.93e-4),
    "figure_14": Errors(0.0534, 0.0083),
    "figure_15": Errors(0.062, 0.003),
}
CONVERGED_AT: Mapping[str, Mapping[str, int]] = {  # epochs, of at most 20
    "figure_06": {CWT: 2, RAW: 5},
    "figure_11": {CWT: 2, RAW: 10},
}
