"""The tables of the page, each from the content of paper.json alone."""

from collections.abc import Callable, Mapping
from functools import partial

from gear_damping.reporting.numbers import NOTHING, number
from gear_damping.reporting.paper import overview
from gear_damping.reporting.paper.cells import (
    Found,
    as_fraction,
    in_percent,
    markdown,
    percent_of,
    plain_number,
    printed,
    score,
)
from gear_damping.reporting.paper.names import EFFECT_OF, one_run_of
from gear_damping.reporting.paper.printed import (
    BASE_CIRCLES_M,
    CONVERGED_AT,
    DOMINANT_FREQUENCIES,
    RATIOS_PERCENT,
    SNRS_DB,
)
from gear_damping.reporting.paper.study import BLIND, MEAN, NETWORKS

ESTIMATORS = (*NETWORKS, BLIND, MEAN)
SAID = {BLIND: "white noise (control)", MEAN: "mean of the labels (control)"}


def effect_table(found: Found, name: str, effect: str) -> str:
    """The errors of an effect: printed, on one run in the paper's unit, and in % on many."""
    head = ("estimator", "printed", "one run, 1/N", "one run, Eq 7", "many runs / %", "unseen runs / %", "Eq 7 / %",
            "skill", "median rel. error")  # fmt: skip
    rows = [_effect_row(found, name, effect, one) for one in ESTIMATORS]
    if score(found, f"{effect}_long", "paper", BLIND):
        long = [score(found, f"{effect}_long", "paper", one) for one in ESTIMATORS]
        forms = [score(found, f"{effect}_long", "paper", one, "rmse_paper") for one in ESTIMATORS]
        for one, error, form in zip(ESTIMATORS[:-1], long, forms, strict=False):
            cells = (f"{SAID.get(one, one)}, ten times the epochs", "", as_fraction(error), as_fraction(form))
            rows.append((*cells, *[NOTHING] * 5))
    return markdown(head, rows)


def _effect_row(found: Found, name: str, effect: str, one: str) -> tuple[str, ...]:
    by_run = partial(score, found, effect, "by_run", one)
    return (
        SAID.get(one, one),
        printed(name, one),
        as_fraction(score(found, effect, "paper", one)),
        as_fraction(score(found, effect, "paper", one, "rmse_paper")),
        in_percent(score(found, effect, "paper_many_runs", one)),
        in_percent(by_run()),
        plain_number(by_run("rmse_paper"), 1),
        plain_number(by_run("skill")),
        percent_of(by_run("median_relative_error")),
    )


def convergence_table(found: Found, name: str, effect: str) -> str:
    """The epoch from which the validation error is within 5 % of the best."""
    rows = [
        (
            SAID.get(one, one),
            str(CONVERGED_AT[name].get(one, NOTHING)),
            plain_number(score(found, effect, "paper", one, "epochs"), 1),
            plain_number(score(found, effect, "by_run", one, "epochs"), 1),
        )
        for one in ESTIMATORS[:-1]
    ]
    return markdown(("estimator", "printed", "one run", "unseen runs"), rows)


def noise_table(found: Found) -> str:
    """Errors by signal-to-noise ratio of the load."""
    head = ("SNR / dB", *(f"one run, {one}" for one in (*NETWORKS, BLIND)), *(f"unseen, {one}" for one in ESTIMATORS))
    rows = []
    for snr in SNRS_DB:
        effect = f"noise_{snr:g}_db"
        one_run = [as_fraction(score(found, effect, "paper", one)) for one in (*NETWORKS, BLIND)]
        rows.append((f"{snr:g}", *one_run, *(in_percent(score(found, effect, "by_run", one)) for one in ESTIMATORS)))
    return markdown(head, rows)


def ratio_table(found: Found) -> str:
    """Errors by damping ratio."""
    head = ("ratio / %", *(f"one run, {one}" for one in (*NETWORKS, BLIND)), *(f"unseen, {one}" for one in ESTIMATORS))
    rows = []
    for ratio in RATIOS_PERCENT:
        one_run = [as_fraction(score(found, one_run_of(ratio), "paper", one)) for one in (*NETWORKS, BLIND)]
        rows.append((f"{ratio:g}", *one_run, *(in_percent(_of_ratio(found, ratio, one)) for one in ESTIMATORS)))
    return markdown(head, rows)


def _of_ratio(found: Found, ratio: float, one: str) -> Mapping[str, float] | None:
    each = found["learned"].get("baseline", {}).get("by_run", {}).get("by_ratio")
    return None if each is None else overview.mean_and_std([seed[f"{ratio:g}"][one]["rmse_percent"] for seed in each])


def table_1(found: Found) -> str:
    """What follows from the printed parameters, and from the equations as printed."""
    right, wrong = found["physics"]["derived"]["right"], found["physics"]["derived"]["as_printed"]
    mm = {key: (1e3 * right[f"base_radius_{key}_m"], 1e3 * wrong[f"base_radius_{key}_m"]) for key in ("pinion", "gear")}
    rows = [
        (f"base radius of the {key} / mm", f"“base circle” {1e3 * value:g}", f"{mm[key][0]:.2f}", f"{mm[key][1]:.2f}")
        for key, value in zip(("pinion", "gear"), BASE_CIRCLES_M, strict=True)
    ]
    for label, key, factor, digits in DERIVED:
        rows.append((label, NOTHING, number(factor * right[key], digits), number(factor * wrong[key], digits)))
    return markdown(("", "printed", "here", "equations as printed"), rows)


DERIVED = (  # label, key, factor to the unit of the label, digits
    ("equivalent mass / kg", "equivalent_mass_kg", 1, 4),
    ("mean mesh stiffness / (10⁸ N/m)", "mean_stiffness_n_per_m", 1e-8, 3),
    ("natural frequency / Hz", "natural_frequency_hz", 1, 4),
    ("load on the line of action / N", "mean_load_n", 1, 4),
    ("static deflection / µm", "static_deflection_m", 1e6, 4),
    ("damping of 1 % / (N·s/m)", "damping_per_percent_ns_per_m", 1, 4),
    ("α of 1 % at n = 2 / N·(s/m)²", "alpha_per_percent", 1, 4),
    ("mesh frequency at 3000 rpm / Hz", "mesh_frequency_hz", 1, 4),
)


def ridge_table(found: Found, names: tuple[str, ...]) -> str:
    """The lines that the transform shows all along a record."""
    rows = []
    for name in names:
        ridges = found["physics"]["ridges"][name]
        places = "; ".join(f"{one['frequency_hz']:.0f} ({one['low_hz']:.0f} … {one['high_hz']:.0f})" for one in ridges)
        rows.append((RESPONSES[name], str(len(ridges)), places))
    count = f"ridges (printed: {DOMINANT_FREQUENCIES})"
    return markdown(("response", count, "frequency (half-power width) / Hz"), rows)


RESPONSES = {
    "right": "mass of Table 1",
    "as_printed": "mass 1 kg, base circles as printed",
    "eccentricity": "geometric centres off by 20 µm",
    "eccentricity_printed": "0.001 added to the stiffness, as printed",
}


def stiffness_table(found: Found) -> str:
    """Mean of the mesh stiffness in every reading."""
    means = found["physics"]["mean_stiffness_n_per_m"]
    return markdown(("mesh stiffness", "mean / (10⁸ N/m)"), [(k, f"{v / 1e8:.3f}") for k, v in means.items()])


TABLES: Mapping[str, Callable[[Found], str]] = {
    "settings": overview.settings_text,
    "overview": overview.overview_table,
    "leads": overview.leads_table,
    "table_1": table_1,
    "table_2": overview.table_2,
    "figure_04": stiffness_table,
    "figure_05": partial(ridge_table, names=("right", "as_printed")),
    "figure_06": partial(convergence_table, name="figure_06", effect="baseline"),
    "figure_09": noise_table,
    "figure_10": partial(ridge_table, names=("right", "eccentricity", "eccentricity_printed")),
    "figure_11": partial(convergence_table, name="figure_11", effect="eccentricity"),
    "figure_14": ratio_table,
    **{name: partial(effect_table, name=name, effect=effect) for name, effect in EFFECT_OF.items()},
}
