"""The trainings that the paper's figures rest on: an effect under a protocol."""

from collections.abc import Iterable
from dataclasses import dataclass

from gear_damping.reporting.paper.names import one_run_of
from gear_damping.reporting.paper.printed import ECCENTRICITY, RATIOS_PERCENT, REPRESENTATIVE_PERCENT, SNRS_DB

ONE_RUN, MANY_RUNS, BY_RUN = "paper", "paper_many_runs", "by_run"  # the three protocols
LONGER = 10  # times 20 epochs (figures 6 and 11) are the 200 of section 2.3
SNR_SHOWN_DB = 20.0  # of figure 8; the paper does not say (assumed)


@dataclass(frozen=True)
class Case:
    """One effect under one protocol.

    Args:
        effect: Its name here.
        protocol: `paper`, `paper_many_runs` or `by_run`.
        overrides: What makes the effect.
        ratio_percent: The one label of the one run (% of critical).
        figures: Those that show it.
        longer: Times the epochs of the budget.
        by_ratio: Whether the trained networks are tested on fresh runs of each ratio of figure 14 too.
    """

    effect: str
    protocol: str
    overrides: tuple[str, ...]
    figures: tuple[str, ...]
    ratio_percent: float = REPRESENTATIVE_PERCENT
    longer: int = 1
    by_ratio: bool = False

    def part(self, seed: int) -> str:
        """The name of one training of it."""
        return f"{self.effect}-{self.protocol}-seed_{seed}"


PRINTED_ECCENTRICITY = (
    "experiment=baseline",
    f"++simulator.pinion_eccentricity={{amplitude:{ECCENTRICITY},as_printed:true}}",
)


def cases(figures: Iterable[str]) -> tuple[Case, ...]:
    """The cases that these figures and tables show, each once."""
    wanted = set(figures)
    return tuple(case for case in _every() if wanted & set(case.figures))


def noise_name(snr_db: float) -> str:
    """What the load noise of this level is called."""
    return f"noise_{snr_db:g}_db"


def _every() -> list[Case]:
    both = ("figure_14", "table_2")
    found = _protocols("baseline", "experiment=baseline", ("figure_06", "figure_07"), also=both, by_ratio=True)
    found.append(Case("baseline_long", ONE_RUN, ("experiment=baseline",), ("figure_07",), longer=LONGER))
    found += _protocols("eccentricity", "experiment=eccentricity", ("figure_11", "figure_12"))
    found.append(Case("eccentricity_printed", ONE_RUN, PRINTED_ECCENTRICITY, ("figure_12",)))
    found += _protocols("backlash", "experiment=backlash", ("figure_13",))
    found += _protocols("torque", "experiment=torque", ("figure_15", "table_2"))
    found += [case for snr in SNRS_DB for case in _noise(snr)]
    for ratio in RATIOS_PERCENT:
        if ratio != REPRESENTATIVE_PERCENT:
            found.append(Case(one_run_of(ratio), ONE_RUN, ("experiment=baseline",), both, ratio_percent=ratio))
    return found


def _protocols(
    effect: str, experiment: str, figures: tuple[str, ...], also: tuple[str, ...] = (), by_ratio: bool = False
) -> list[Case]:
    """An effect under all three protocols; `also`: figures that the leak is not shown in."""
    return [
        Case(effect, ONE_RUN, (experiment,), figures + also),
        Case(effect, MANY_RUNS, (experiment,), figures),
        Case(effect, BY_RUN, (experiment,), figures + also, by_ratio=by_ratio),
    ]


def _noise(snr_db: float) -> list[Case]:
    """Noise on the load of one level; the one that figure 8 shows under all three protocols."""
    given = ("experiment=noise", f"++simulator.load_noise.snr_db={snr_db:g}")
    shown = snr_db == SNR_SHOWN_DB
    figures = ("figure_08", "figure_09") if shown else ("figure_09",)
    protocols = (ONE_RUN, MANY_RUNS, BY_RUN) if shown else (ONE_RUN, BY_RUN)
    name = noise_name(snr_db)
    return [Case(name, one, given, figures if one != MANY_RUNS else ("figure_08",)) for one in protocols]
