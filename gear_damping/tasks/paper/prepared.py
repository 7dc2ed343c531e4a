"""A case made ready: its settings, its runs and the budget of its networks."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.datamodule import Material
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import Protocol
from gear_damping.identification.runs import RunSet
from gear_damping.identification.trainer import PAPER_TRAINING, Training
from gear_damping.simulation.plan import SimulationPlan
from gear_damping.tasks.composed import composed
from gear_damping.tasks.paper.cases import ONE_RUN, Case
from gear_damping.tasks.simulated import plan_of, run_set_of, simulated
from gear_damping.tasks.train import estimators

FRACTION = 0.01  # of a label in %: the unit that makes errors of the printed size


@dataclass(frozen=True)
class Prepared:
    """Everything that decides a training but its seed.

    Args:
        case: The effect and the protocol.
        settings: Those of the case.
        plan: Its runs, before they exist.
        training: The budget of each fit.
    """

    case: Case
    settings: Settings
    plan: SimulationPlan
    training: Training

    @property
    def per_percent(self) -> float:
        """Size of 1 % in the unit of the labels: one run is learned as a fraction, as the paper seems to."""
        return FRACTION if self.case.protocol == ONE_RUN else 1.0

    def decided_by(self, seed: int) -> dict[str, Any]:
        """What a finished part must share with this one to be kept, as plain values."""
        return {
            "runs": self.plan.hash,
            "protocol": self.settings.protocol,
            "training": vars(self.training),
            "models": {name: config.settings for name, config in self.models().items()},
            "wavelet": self.settings.wavelet,
            "by_ratio": self.case.by_ratio,
            "seed": seed,
        }

    def models(self) -> dict[str, EstimatorConfig]:
        """The two networks; on one run they start as drawn, for starting at its label would be knowing it."""
        start = {"start_at_mean": self.case.protocol != ONE_RUN}
        made = estimators(self.settings)
        return {name: replace(config, settings={**config.settings, **start}) for name, config in made.items()}

    def material(self) -> Material:
        """The runs under the protocol; labels in the unit of `per_percent`."""
        runs = run_set_of(simulated(self.plan, self.settings), self.plan)
        noise = SensorNoise(self.settings.simulator.sensor_noise_db)
        return Material(self._in_unit(runs), Protocol(**self.settings.protocol), noise)

    def test_material(self, material: Material, ratio_percent: float, plan: SimulationPlan) -> Material:
        """The same with other runs to test on, all of one ratio (% of critical)."""
        other = replace(plan, damping_ratio_percent=ratio_percent)
        return replace(material, test_runs=self._in_unit(run_set_of(simulated(other, self.settings), other)))

    def _in_unit(self, runs: RunSet) -> RunSet:
        return replace(runs, damping_ratio_percent=runs.damping_ratio_percent * self.per_percent)


@cache
def _read(overrides: tuple[str, ...]) -> Settings:
    """Settings of these overrides: cases that differ by their label alone share them."""
    return read_settings(*composed(overrides))


def prepared(case: Case, settings: Settings) -> Prepared:
    """Compose a case as its own experiment, with sizes and budget of the study.

    Raises:
        InputError: what is wrong with it.
    """
    sizes, protocol = settings.simulator, settings.protocol
    overrides = [
        *case.overrides,
        "family=paper",
        f"protocol={case.protocol}",
        f"++simulator.n_runs={sizes.n_runs}",
        f"++simulator.n_samples={sizes.n_samples}",
        f"++simulator.solver.accuracy={sizes.solver.accuracy}",
        f"++seed={settings.seed}",
    ]
    if case.protocol != ONE_RUN:
        overrides.append(f"++protocol.windows_per_epoch={protocol['windows_per_epoch'] or 'null'}")
        overrides.append(f"++protocol.evaluation_stride={protocol['evaluation_stride']}")
    own = _read(tuple(overrides))
    own = replace(own, data_folder=settings.data_folder, progress=settings.progress)
    plan, training = plan_of(own), Training(**settings.training)
    training = replace(training, max_epochs=case.longer * training.max_epochs)
    if case.protocol == ONE_RUN:
        plan = replace(plan, n_runs=1, damping_ratio_percent=case.ratio_percent)
        training = replace(training, batch_size=PAPER_TRAINING.batch_size, patience=PAPER_TRAINING.patience)
    return Prepared(case, own, plan, training)
