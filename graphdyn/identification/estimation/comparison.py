"""Comparison of several methods on the same recording: failures with reasons, and physical consistency."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate, Estimator
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.statistics.residual_statistics import ResidualStatistics, residual_statistics
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import pseudo_inertia_from_parameters

log = logging.getLogger(__name__)

CHECKED_POSES = 10_000
POSES_PER_CHUNK = 256


@dataclass(frozen=True, eq=False)
@short_repr
class Plausibility:
    """Whether identified parameters are physically consistent.

    pseudo_inertia_eigenvalues: the smallest of every body, ≥ 0 for a consistent one (n,)
    mass_matrix_eigenvalues: the smallest in every pose, > 0 for a real robot (poses,) [kg m² or kg]
    """

    pseudo_inertia_eigenvalues: Array
    mass_matrix_eigenvalues: Array

    @property
    def consistent(self) -> bool:
        """Whether every body is physically consistent."""
        return bool(np.all(self.pseudo_inertia_eigenvalues >= 0))

    @property
    def positive_definite(self) -> int:
        """Number of poses with a positive definite mass matrix."""
        return int(np.count_nonzero(self.mass_matrix_eigenvalues > 0))

    @property
    def poses(self) -> int:
        """Number of poses that were tried."""
        return len(self.mass_matrix_eigenvalues)

    @property
    def smallest_mass_matrix_eigenvalue(self) -> float:
        """Smallest eigenvalue over all poses [kg m² or kg]."""
        return float(self.mass_matrix_eigenvalues.min())


def plausibility(
    torque_model: TorqueModel, parameters: Array, *, poses: int = CHECKED_POSES, seed: int = 0
) -> list[Plausibility]:
    """Plausibility of every row of parameters (m, p); poses are drawn from the limits of the robot."""
    x = np.asarray(parameters, dtype=float)
    torque_model = replace(torque_model, model=torque_model.model.opened)  # loops leave its motions inertia, too
    q, _ = torque_model.model.random_state(np.random.default_rng(seed), poses)
    parts = []
    for k in range(0, poses, POSES_PER_CHUNK):
        if poses > POSES_PER_CHUNK:
            log.info("mass matrix in pose %d of %d", k + 1, poses)
        parts.append(mass_matrices(torque_model, q[k : k + POSES_PER_CHUNK], x))
    smallest = np.concatenate([np.linalg.eigvalsh(part)[..., 0] for part in parts])
    bodies = np.array([torque_model.inertial_parameters(row).reshape(-1, BODY_PARAMETERS) for row in x])
    real = np.linalg.eigvalsh(pseudo_inertia_from_parameters(bodies))[..., 0]
    return [Plausibility(real[k], smallest[:, k]) for k in range(len(x))]


def mass_matrices(torque_model: TorqueModel, q: Array, parameters: Array) -> Array:
    """M (N, m, n, n) at q (N, n) for parameters (m, p): derivative of the torque of all terms by a, rotors included."""
    n = q.shape[1]
    rest = np.zeros_like(q)
    still = Samples(q, rest, rest, rest, time=rest[:, 0], temperature=rest)  # drifts do not change with a
    rows, known = torque_model.rows(still), torque_model.known_torque(still)
    columns = []
    for j in range(n):
        a = np.zeros_like(q)
        a[:, j] = 1.0
        moved = replace(still, a=a)
        change = (torque_model.rows(moved) - rows) @ parameters.T
        columns.append(change + (torque_model.known_torque(moved) - known)[..., None])
    m = np.moveaxis(np.stack(columns, axis=-2), -1, 1)
    return (m + np.swapaxes(m, -1, -2)) / 2


MIN_CORRELATION_TIMES = 80
"""Fewest correlation times of a recording for which block deviations are right: twice as much covers the truth in 90 to
98 of 100 cases, as `python tests/tools interval_coverage` shows."""


@dataclass(frozen=True, eq=False)
@short_repr
class MethodResult:
    """Result of one method: the estimate and its quality, or the reason why there is none.

    name: as in the tables; reference: where it is published
    assumptions: what has to hold; needs: what has to be measured
    failure: why there is no answer, None if there is an estimate
    base_values: of the base parameters of the problem (r,)
    standard_deviations: of the base parameters, right for white noise; None if the method gives none
    block_deviations: of the base parameters, allowing for correlation in time (jackknife over time blocks); None
        likewise. Right for recordings of MIN_CORRELATION_TIMES or more, a lower bound for shorter ones
        (`training.correlation_times`)
    training: residuals on the rows of the fit, slow ones included
    held_out: residuals on the predicted rows, of all trials together
    seconds: of the estimation alone, without the compression of the recording; NaN without an answer [s]
    """

    name: str
    reference: str
    assumptions: str
    needs: str
    failure: str | None = None
    seconds: float = float("nan")
    estimate: Estimate | None = None
    base_values: Array | None = None
    standard_deviations: Array | None = None
    block_deviations: Array | None = None
    training: ResidualStatistics | None = None
    held_out: ResidualStatistics | None = None
    plausibility: Plausibility | None = None

    @property
    def relative_deviations(self) -> Array | None:
        """100 block_deviations / |base_values|, infinite for a value of zero (r,) [%]."""
        if self.base_values is None or self.block_deviations is None:
            return None
        with np.errstate(divide="ignore", invalid="ignore"):
            return 100.0 * self.block_deviations / np.abs(self.base_values)


@dataclass(frozen=True, eq=False)
@short_repr
class MethodComparison:
    """Identifiability of the parameters, the same for all methods, and the results of the methods in the order given.

    names, units: of the p parameters of the torque model; base_names, base_units: of the r base parameters
    base_symbols: short names of these in Khalil's notation, such as XXR_2
    rank: number of base parameters that the recording determines, r
    structural_rank: number that some motion could determine
    gap: smallest accepted and largest rejected pivot, relative to the first
    condition_number: of the regressor, joints weighted by their measured torque and columns at unit length
    undetermined: standard parameters that are determined only in combinations, or not at all
    lost: base parameters of the structure that this recording does not determine individually
    nearly_undetermined: parameters that only the rounding of angles in the robot's file shows; regrouped with others
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    base_names: tuple[str, ...]
    base_units: tuple[str, ...]
    base_symbols: tuple[str, ...]
    rank: int
    structural_rank: int
    gap: tuple[float, float]
    condition_number: float
    undetermined: tuple[str, ...]
    lost: tuple[str, ...]
    nearly_undetermined: tuple[str, ...]
    results: tuple[MethodResult, ...]

    def of(self, name: str) -> MethodResult:
        """The result of a method by name. Raises InvalidInput for an unknown method."""
        for result in self.results:
            if result.name == name:
                return result
        raise InvalidInput(f"there is no method '{name}'; known: {', '.join(result.name for result in self.results)}")


def compare_methods(
    problem: Problem,
    estimators: Sequence[Estimator],
    held_out: Problem | None = None,
    *,
    poses: int = CHECKED_POSES,
    progress: Callable[[str], None] | None = None,
) -> MethodComparison:
    """Estimate with every method, predict both recordings, test the bodies and the mass matrix.

    held_out: another recording with the same torque model; none if left out
    poses: random poses in which the mass matrix is tested
    progress: called with the name of every method before it starts

    An error that a method raises becomes its result; the others go on. Raises InvalidInput for two methods of the same
    name, for a held-out recording with other parameters, and if the recording itself cannot be used.
    """
    names = [estimator.name for estimator in estimators]
    repeated = [name for name in names if names.count(name) > 1]
    if repeated or not names:
        what = f"two methods are called '{repeated[0]}'" if repeated else "there is no method"
        raise InvalidInput(f"{what}; give at least one, each with a name of its own")
    if held_out is not None and held_out.torque_model.columns != problem.torque_model.columns:
        raise InvalidInput("the held-out recording has another torque model; the parameters must be the same")
    with one_thread():
        _ = problem.equations  # reads and compresses the recording before the clock of the first method starts
        results = [_estimated(problem, estimator, progress) for estimator in estimators]
        return _described(problem, _judged(problem, results, held_out, poses))


def _judged(
    problem: Problem, results: Sequence[MethodResult], held_out: Problem | None, poses: int
) -> tuple[MethodResult, ...]:
    """The results with the residuals and the plausibility of all estimates."""
    judged = list(results)
    solved = [k for k, result in enumerate(results) if result.estimate is not None]
    if solved:
        log.info("residuals of %d estimates", len(solved))
        parameters = np.array([results[k].estimate.parameters for k in solved])  # type: ignore[union-attr]
        training = residual_statistics(problem, parameters)
        ahead = [None] * len(solved) if held_out is None else residual_statistics(held_out, parameters)
        bodies = plausibility(problem.torque_model, parameters, poses=poses)
        for k, here, there, body in zip(solved, training, ahead, bodies, strict=True):
            judged[k] = replace(results[k], training=here, held_out=there, plausibility=body)
    return tuple(judged)


def _estimated(problem: Problem, estimator: Estimator, progress: Callable[[str], None] | None) -> MethodResult:
    if progress is not None:
        progress(estimator.name)
    blank = MethodResult(estimator.name, estimator.reference, estimator.assumptions, estimator.needs)
    start = time.perf_counter()
    try:
        if problem.torque_model.expected and not getattr(estimator, "takes_expected", False):
            raise EstimationFailed(
                "the method takes no expected values; use one that does (WLS, ridge, consistent, …), or expect none"
            )
        estimate = estimator.estimate(problem)
        _check(problem, estimate)
    except EstimationFailed as failure:
        return replace(blank, failure=str(failure), seconds=time.perf_counter() - start)
    except Exception as failure:  # whatever a method written elsewhere raises, the comparison goes on
        why = f"{type(failure).__name__}: {failure}"
        return replace(blank, failure=why, seconds=time.perf_counter() - start)
    return replace(
        blank,
        seconds=time.perf_counter() - start,
        estimate=estimate,
        base_values=problem.base.values(estimate.parameters),
        standard_deviations=_deviations(estimate.covariance),
        block_deviations=_deviations(estimate.block_covariance),
    )


def _check(problem: Problem, estimate: Estimate) -> None:
    expected = (len(problem.torque_model.columns),)
    given = np.shape(estimate.parameters)
    if given != expected or not np.all(np.isfinite(estimate.parameters)):
        raise EstimationFailed(f"the method answers parameters of shape {given}; {expected[0]} finite numbers needed")


def _deviations(covariance: Array | None) -> Array | None:
    return None if covariance is None else np.sqrt(np.maximum(np.diag(covariance), 0.0))


def _described(problem: Problem, results: tuple[MethodResult, ...]) -> MethodComparison:
    columns, base, structural = problem.torque_model.columns, problem.base, problem.structure.base
    symbols = [column.symbol for column in columns]
    determined = set(base.names(symbols))
    alone = set(base.alone.tolist())
    return MethodComparison(
        names=tuple(column.name for column in columns),
        units=tuple(column.unit for column in columns),
        base_names=base.names(symbols),
        base_units=tuple(columns[k].unit for k in base.independent),
        base_symbols=base.symbols(symbols),
        rank=base.rank,
        structural_rank=structural.rank,
        gap=base.gap,
        condition_number=problem.condition_number,
        undetermined=tuple(column.name for k, column in enumerate(columns) if k not in alone),
        lost=tuple(name for name in structural.names(symbols) if name not in determined),
        nearly_undetermined=tuple(columns[k].name for k in problem.structure.nearly_undetermined),
        results=results,
    )
