"""Simulated runs with what one does with them: channels, wavelet transforms, pictures."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import torch
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from gear_damping.errors import InputError, Problem, with_article
from gear_damping.interface.arguments import SEED, numbers, of_every_run, refuse_no_model, refuse_other_solver
from gear_damping.interface.driven_by import ANGLE, driven_by, refuse_idle
from gear_damping.physics.model import Model
from gear_damping.reporting import figures
from gear_damping.schema.values import Number, Problems
from gear_damping.signals.wavelets.base import ContinuousWavelet
from gear_damping.signals.wavelets.catalogue import builtin_wavelets
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.sampling import whole_number_problems
from gear_damping.simulation.simulate import simulate as integrate
from gear_damping.simulation.solver_settings import Solver

AT_REST = "nothing moves: the response is 0 throughout"
MOVED_BY = "give initial_displacement, initial_velocity or a force (amplitude is the solver's unit of length)"
LOWEST, HIGHEST, SCALES = 4.0, 0.4, 32  # periods of the record; share of the sampling rate; frequencies between
BATCH = Number(1, 10_000_000, whole=True)  # runs of one call
Array = NDArray[np.float64]


class Simulation:
    """Runs of one model, SI.

    Every channel is an attribute, (batch, time): `transmission_error` or `displacement`, `velocity`, states of effects,
    inputs and angles; `names` lists them.
    """

    def __init__(self, runs: Runs) -> None:
        """Hold runs of `gear_damping.simulation.simulate`."""
        self.runs = runs

    @property
    def model(self) -> Model:
        """The model."""
        return self.runs.model

    @property
    def sampling_rate(self) -> float:
        """Hz."""
        return self.runs.sampling_rate

    @property
    def time(self) -> Array:
        """Time of the samples in s, (time,)."""
        return self.runs.time.numpy()

    @property
    def damping_ratio_percent(self) -> Array:
        """Equivalent damping ratio of all damping laws together at the reference velocity, % of critical, (batch,).

        Dry friction, hysteresis and what grows with the deflection count with what a harmonic motion of that velocity
        loses to them, as in `identify`; `damping_ratio_by_law` tells them apart. It is nan without a damping law,
        without a linear stiffness, and where a law has no such ratio.
        """
        return self.runs.damping_ratio_percent.numpy()

    @property
    def damping_ratio_by_law(self) -> dict[str, Array]:
        """What each damping law adds to `damping_ratio_percent`, % of critical, (batch,) by the name of the law."""
        return {name: ratio.numpy() for name, ratio in self.runs.damping_ratio_by_law.items()}

    @property
    def names(self) -> tuple[str, ...]:
        """Channels, the response first."""
        others = (self.runs.states | self.runs.inputs | self.runs.angles).keys() - {"displacement"}
        return (self.model.system.response, *sorted(others))

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_") or name == "runs":
            raise AttributeError(name)
        return self.channel(name)

    def channel(self, name: str) -> Array:
        """A channel by its name, such as `shaft_torsion.twist`, (batch, time).

        Raises:
            AttributeError: there is no such channel.
        """
        try:
            return self.runs.channel(name).numpy()
        except KeyError as error:
            raise AttributeError(f"no channel '{name}'; there are {', '.join(self.names)}") from error

    def recorded(self, seed: int = 0) -> Array:
        """The response behind the model's sensors, noise included, (batch, time).

        Args:
            seed: Of the noise, 0 or more.

        Raises:
            InputError: it is none.
        """
        Problems(whole_number_problems("seed", seed, SEED)).raise_any()
        return self.runs.record(torch.Generator().manual_seed(int(seed))).numpy()

    def cwt(
        self,
        wavelet: str | type[ContinuousWavelet] = "ricker",
        frequencies_hz: float | Sequence[float] | None = None,
        channel: str | None = None,
    ) -> tuple[Array, Array]:
        """Continuous wavelet transform of a channel.

        Args:
            wavelet: `ricker` (real), `morlet` (complex), or a class of one's own that derives from
                `signals.wavelets.ContinuousWavelet`.
            frequencies_hz: One or several; 32 in equal ratios from four periods of the record to 0.4 of the rate where
                absent.
            channel: The response where absent.

        Returns:
            Coefficients (batch, frequencies, time), and the frequencies in Hz.

        Raises:
            ValueError: there is no such wavelet or channel (an InputError), or a frequency is out of range.
        """
        kind = _wavelet(wavelet)
        if channel is not None and not (isinstance(channel, str) and self._has(channel)):
            remedy = f"choose one of {', '.join(self.names)}"
            raise InputError(Problem("channel", "the runs have no such channel", channel, remedy))
        if frequencies_hz is None:
            lowest, highest = LOWEST / len(self.runs.time), HIGHEST
            if lowest >= highest:
                few = f"{len(self.runs.time)} samples hold no {LOWEST:g} periods of any frequency"
                raise ValueError(f"{few}; simulate {int(LOWEST / HIGHEST) + 1} of them or more")
            frequencies_hz = (self.sampling_rate * np.geomspace(lowest, highest, SCALES)).tolist()
        frequencies_hz = numbers("frequencies_hz", frequencies_hz, "Hz").flatten().tolist()
        transform = kind(self.sampling_rate, frequencies_hz=frequencies_hz)
        signal = self.runs.channel(channel or self.model.system.response)
        return transform(signal).numpy(), np.asarray(frequencies_hz)

    def _has(self, channel: str) -> bool:
        try:
            self.runs.channel(channel)
        except KeyError:
            return False
        return True

    def plot(self, run: int = 0) -> Figure:
        """One run, counted from 0, over time, its spectrum (in orders where there is a shaft), and its phase plane.

        Raises:
            InputError: there is no such run.
        """
        Problems(whole_number_problems("run", run, Number(0, len(self) - 1, whole=True))).raise_any()
        return run_figure(self.runs, self.runs.response, run)

    def __len__(self) -> int:
        return len(self.runs.status)

    def __repr__(self) -> str:
        samples, seconds = len(self.runs.time), len(self.runs.time) / self.sampling_rate
        lost = f", {self.runs.n_diverged} diverged" if self.runs.n_diverged else ""
        return f"<{len(self)} runs of {samples} samples, {seconds:.4g} s at {self.sampling_rate:g} Hz{lost}>"


def _wavelet(asked: object) -> type[ContinuousWavelet]:
    """The class of a wavelet.

    Raises:
        InputError: there is none of this name, or it is no class of one.
    """
    known = builtin_wavelets()
    if isinstance(asked, str) and asked in known:
        return known[asked]
    if isinstance(asked, type) and issubclass(asked, ContinuousWavelet):
        return asked
    rule = f"no wavelet '{asked}'" if isinstance(asked, str) else "is no wavelet"
    remedy = f"choose one of {', '.join(known)}, or give a class of signals.wavelets.ContinuousWavelet"
    raise InputError(Problem("wavelet", rule, repr(asked), remedy))


def simulate(
    model: Model,
    *,
    sampling_rate: float,
    n_samples: int,
    batch: int = 1,
    inputs: Mapping[str, ArrayLike] | Driven | None = None,
    solver: Solver | None = None,
    **parameters: ArrayLike,
) -> Simulation:
    """Simulate a batch of runs.

    Args:
        model: What is simulated, with its values.
        sampling_rate: Output samples per second, Hz.
        n_samples: Output samples of a run.
        batch: Runs.
        inputs: Measured series that drive it, (time,) or (batch, time), SI: `force`, `base_acceleration`;
            `pinion_torque`, `pinion_angle`, which takes the place of the model's speed, and `gear_torque` where
            `gear_torque_mode` is `held`. `gd.Driven` says which of them hold, and seeds drawn loads.
        solver: Settings of the solver, and who is told of its progress: `gd.Solver`.
        parameters: In the place of the model's, by name in SI, or in the `unit` of an oscillator: numbers, or (batch,);
            of an effect `**{"backlash.gap": 8e-5}`.

    Raises:
        InputError: a name is unknown, a value out of range, or one has no effect beside an option or a series.
    """
    refuse_no_model(model)
    Problems(whole_number_problems("batch", batch, BATCH)).raise_any()
    refuse_other_solver(solver)
    driven = driven_by(inputs)
    refuse_idle(model, parameters, driven.series)
    given = _within_bounds(model, parameters, int(batch))
    runs = integrate(
        model,
        model.values(batch, **given),
        sampling_rate=sampling_rate,
        n_samples=n_samples,
        inputs=driven,
        solver=solver,
    )
    if runs.n_diverged:
        lost = f"{runs.n_diverged} of {len(runs.status)} runs diverged: their values are no motion of this model"
        warnings.warn(f"{lost}; give solver=gd.Solver(substeps=...) or a damping that is less stiff", stacklevel=2)
    elif _rests(runs):
        warnings.warn(f"{AT_REST}; {MOVED_BY}", stacklevel=2)
    return Simulation(runs)


def refuse_other_runs(runs: object) -> None:
    """Refuse what is no simulation.

    Raises:
        InputError: it is none.
    """
    if not isinstance(runs, Simulation):
        remedy = "give what gd.simulate(model, sampling_rate=…, n_samples=…) returns"
        raise InputError(
            Problem("runs", f"must be a simulation, and is {with_article(type(runs).__name__)}", remedy=remedy)
        )


def refuse_rest(runs: Runs) -> None:
    """Refuse runs of which a level of noise says nothing.

    Raises:
        InputError: none of them moves.
    """
    if _rests(runs):
        raise InputError(Problem("runs", AT_REST, remedy=MOVED_BY))


def _rests(runs: Runs) -> bool:
    return not bool(runs.response.any())


def _within_bounds(model: Model, values: Mapping[str, ArrayLike], batch: int) -> dict[str, torch.Tensor]:
    """Values as tensors; the model itself refuses names that it does not know.

    Raises:
        InputError: a value is none, or out of range.
    """
    if grouped := [name for name, value in values.items() if isinstance(value, Mapping)]:
        rule = "is a mapping, and every parameter is a keyword argument of its own"
        remedy = f"write gd.simulate(model, …, **{grouped[0].upper()}), or for example stiffness=400.0"
        raise InputError(Problem(grouped[0], rule, remedy=remedy))
    found, declared = {name: numbers(name, value) for name, value in values.items()}, model.parameters()
    single = [(name, value) for name, value in found.items() if name in declared and not declared[name].vector]
    problems = [problem for name, value in single for problem in of_every_run(name, value, batch)]
    empty = [name for name, value in found.items() if bool(value.isnan().any())]
    problems += [Problem(name, "must be finite, and holds nan", remedy="leave it out, or give it") for name in empty]
    if problems:
        raise InputError(problems)
    ends = [(name, float(end)) for name, v in found.items() if name in declared for end in (v.min(), v.max())]
    told = {name: replace(declared[name], unit=model.system.told_unit(declared[name].unit)) for name, _ in ends}
    problems = [problem for name, end in ends if (problem := told[name].problem(end, name))]
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
    return found


def run_figure(runs: Runs, response: torch.Tensor, run: int = 0) -> Figure:
    """One run over time, its spectrum and its phase plane.

    Args:
        runs: The runs.
        response: What is shown of them, (batch, time).
        run: Which.
    """
    signal, velocity = response[run].numpy(), runs.states["velocity"][run].numpy()
    name = runs.model.system.response
    time, rate = runs.time.numpy(), runs.sampling_rate
    words: dict[str, Any] = {"label": name.replace("_", " "), "title": f"run {run + 1} of {len(runs.status)}"}
    if "pinion_speed" not in runs.values:
        units = {"unit": runs.model.system.unit_of("m"), "velocity_unit": runs.model.system.unit_of("m/s")}
        return figures.simulation_figure(figures.ShownRun(time, signal, velocity, sampling_rate=rate, **units, **words))
    speed, teeth = _mean_speed(runs, run), float(runs.values["n_teeth_pinion"][run])
    shafts = {"shaft_frequency_hz": abs(speed) / (2 * pi) or None, "n_teeth_pinion": teeth}
    shafts["gear_order"] = teeth / float(runs.values["n_teeth_gear"][run])
    return figures.simulation_figure(figures.ShownRun(time, 1e6 * signal, velocity, "µm", rate, **words, **shafts))


def _mean_speed(runs: Runs, run: int) -> float:
    """Of the pinion in one run, rad/s: as a series of its angle has it, or as it is at the start."""
    angle = runs.inputs.get(ANGLE)
    if angle is None or angle.shape[1] < 2:
        return float(runs.values["pinion_speed"][run])
    return float(angle[run, -1] - angle[run, 0]) * runs.sampling_rate / (angle.shape[1] - 1)
