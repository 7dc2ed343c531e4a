"""Makes the figures of docs/validation.md from the measured records: python docs/examples/validate_silverbox.py."""

import sys
from pathlib import Path

from gear_damping.config.locate import conf_folder
from gear_damping.explanation.explain import Listener, explain
from gear_damping.measurement.load import load_measurement
from gear_damping.reporting import figures
from gear_damping.reporting.explanation_report import report_input

RECORDS = conf_folder() / "measurement" / "records" / "silverbox.yaml"


def main(folder: Path) -> None:
    """Explain the records and draw what the page shows."""
    found = explain(load_measurement(RECORDS), Listener(print))
    shown = report_input(found)
    arrow = shown.overlays[0]
    look = {"unit": shown.unit, "quantity": shown.quantity, "noise": arrow.noise}
    spectrum, surface = shown.spectrum, shown.force_surface
    drawn = {
        "overlay": figures.overlay_figure(arrow.time, arrow.measured, arrow.nominal, arrow.extended, **look),
        "spectrum": figures.residual_frequencies_figure(
            spectrum.places, spectrum.before, after=spectrum.after, unit=shown.unit, measured=spectrum.measured,
            floor=spectrum.floor, natural_frequency_hz=spectrum.natural_frequency_hz,
        ),
        "force": figures.residual_force_surface_figure(
            surface.displacement, surface.velocity, surface.force, force_unit=surface.force_unit,
            visits=surface.visits, displacement_unit=surface.displacement_unit, velocity_unit=surface.velocity_unit,
        ),
        "misfit": figures.misfit_figure(found.content["misfit"]["records"], floor=1.0),
    }  # fmt: skip
    for name, figure in drawn.items():
        figures.save(figure, folder / f"silverbox_{name}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/figures"))
