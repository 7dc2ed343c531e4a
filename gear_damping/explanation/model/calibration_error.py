"""Step 3b: what errors of the calibrated parameters leave on held-out records, though nothing is wrong."""

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import Scatter
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.identification.output_error.least_squares import Rounds, fit
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.segments import in_segments
from gear_damping.identification.output_error.uncertainty import noise_covariance
from gear_damping.simulation.solver_settings import Solver

ITERATIONS = 20  # of the fit of initial states


def calibration_error(nominal: Outcome, evidence: Evidence, solver: Solver | None = None) -> Scatter:
    """Mean and deviation of the squared prediction error that noise in the fitted records causes.

    A held-out operating condition may show what the fitted ones hardly do, such as a harmonic of the stiffness at
    resonance: the error of a parameter weighs more there.
    """
    hypothesis = nominal.hypothesis
    segmented = in_segments(evidence.holdout, evidence.segments)
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, hypothesis.free, segmented, solver, evidence.noise)
    settled, states = problem.unknowns.coordinates(nominal.own), _initial_states(problem, nominal, evidence)
    found = problem.linearise(settled.unsqueeze(0), states.unsqueeze(0)).sensitivity[0]
    if not bool(found.isfinite().all()):
        return Scatter()
    common = min(problem.unknowns.n_common, nominal.problem.unknowns.n_common)
    orthogonal = project_out(found[..., : problem.n_shared], nuisance_basis(found, problem.n_shared)).flatten(0, 1)
    basis = torch.linalg.qr(orthogonal[:, problem.unknowns.n_common :]).Q
    sensitivity = orthogonal[:, :common] - basis @ (basis.T @ orthogonal[:, :common])
    samples = sum(len(segment.stacked) for segment in segmented)
    covariance = noise_covariance(nominal.problem, nominal.fitted)[:common, :common]
    shares = sensitivity.T @ sensitivity @ covariance
    shares = shares / (samples * max(evidence.noise**2, 1e-300))
    return Scatter(float(shares.trace()), float((2 * (shares @ shares).trace()).clamp(min=0).sqrt()))


def _initial_states(problem: OutputErrorProblem, nominal: Outcome, evidence: Evidence) -> Tensor:
    """Initial states (records, local) that go with the records: a first guess from an acceleration may be far off."""
    hypothesis = nominal.hypothesis
    own = [parameter for parameter in hypothesis.free if parameter.per_record]
    given = {**hypothesis.given, **hypothesis.gains}
    alone = OutputErrorProblem(hypothesis.model, given, own, problem.records, problem.solver, evidence.noise)
    start = alone.unknowns.coordinates(nominal.own)
    found = fit(alone, start.unsqueeze(0), Rounds(ITERATIONS), alone.safe_states(start).unsqueeze(0))
    return problem.states_of(alone, found.states, range(len(problem.records)))
