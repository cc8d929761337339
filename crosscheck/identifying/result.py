"""The result of an identification."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crosscheck.identifying.baselines import Baselines
from crosscheck.identifying.doubts import doubts
from crosscheck.identifying.health import Health
from crosscheck.identifying.holding_out import Division
from crosscheck.identifying.preparation import Preparation
from crosscheck.identifying.recommending import Recommendation, doubted, mean_error, recommendation
from crosscheck.recordings import Recording
from crosscheck.referee.subject import Subject
from graphdyn import InvalidInput
from graphdyn.identification import MethodComparison, MethodResult, Problem, TorqueModel
from graphdyn.identification.terms import KnownPayload
from graphdyn.identification.terms.term import CarriesKnownBodies
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """Measured and predicted torque of one interval of time.

    t (N,) [s]; measured, predicted (N, n) [N m or N]; velocity (N, n) [rad/s or m/s]
    """

    t: Array
    measured: Array
    predicted: Array
    velocity: Array


@dataclass(frozen=True, eq=False)
class HeldOutPrediction:
    """Rows that were predicted, with the parameters of every method that has a result.

    times: of the rows, interval by interval (N_k,) [s]; parameters: by method (p,)
    """

    problem: Problem
    times: Sequence[Array]
    parameters: Mapping[str, Array]

    @classmethod
    def of(cls, problem: Problem, times: Sequence[Array], comparison: MethodComparison) -> HeldOutPrediction:
        found = {result.name: result.estimate.parameters for result in comparison.results if result.estimate}
        return cls(problem, times, found)

    def curves(self, method: str) -> list[TorqueCurve]:
        """One curve per interval."""
        x = self.problem.structure.base.matrix @ self.parameters[method]
        parts = [  # in chunks, because the regressor of a long recording does not fit into memory
            (rows.measured, rows.measured + rows.matrix @ x - rows.right, rows.velocity) for rows in self.problem.rows()
        ]
        whole = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        borders = np.cumsum([len(t) for t in self.times])[:-1]
        pieces = zip(*(np.split(array, borders) for array in whole), strict=True)
        return [TorqueCurve(t, *piece) for t, piece in zip(self.times, pieces, strict=True)]


@dataclass(frozen=True, eq=False)
class Identified:
    """An identification: what was fitted, the result of every method, and which one to use.

    subject: the robot; its parameters are the prior
    recordings: as read, before filtering
    division: which rows were fitted and which predicted
    fit: the rows of the fit
    trials: the rows that were predicted
    comparison: every method; held-out errors are those of all trials together
    truth: the true parameters of a virtual robot           (p,)
    health: of the recordings of the fit; None where they are too short to tell
    baselines: errors of a constant, and of CAD with fitted drives, on the predicted rows
    """

    subject: Subject
    torque_model: TorqueModel
    recordings: tuple[Recording, ...]
    division: Division
    preparation: Preparation
    fit: HeldOutPrediction
    trials: tuple[HeldOutPrediction, ...]
    comparison: MethodComparison
    baselines: Baselines
    health: Health | None = None
    truth: Array | None = None

    @property
    def problem(self) -> Problem:
        """The equations of the fit."""
        return self.fit.problem

    @cached_property
    def recommendation(self) -> Recommendation:
        """Which method, and why; or why none, joint by joint."""
        found = recommendation(self.comparison)
        best = None if found.best is None else self.comparison.of(found.best)
        names = self.torque_model.model.independent_joints
        return doubted(found, doubts(best, self.problem, names, self.baselines, self.health))

    @property
    def usable(self) -> bool:
        """Whether a result can be recommended."""
        return self.recommendation.name is not None

    def shown(self, name: str | None = None) -> MethodResult | None:
        """The result to show: the named one, else the recommended one or the one that is doubted, else the one that
        predicts best.

        None where no method has a result. Raises InvalidInput for an unknown method, and for one that failed.
        """
        if name is not None:
            result = self.comparison.of(name)
            if result.failure is not None:
                raise InvalidInput(f"{name} has no result: {result.failure}")
            return result
        if self.recommendation.best is not None:
            return self.comparison.of(self.recommendation.best)
        answered = [result for result in self.comparison.results if result.failure is None]
        return min(answered, key=mean_error) if answered else None

    @property
    def prior_base_values(self) -> Array:
        """Base parameters of the robot as given; zero for those of the drives (r,)."""
        return self.problem.base.values(self.torque_model.prior())

    def fitted_errors(self, result: MethodResult) -> Array:
        """‖e‖ / ‖τ‖ per joint over the rows that were fitted (n,); the result must have an estimate."""
        assert result.base_values is not None
        equations = self.problem.equations
        return np.asarray(np.sqrt(equations.residual_squares(result.base_values) / equations.measured_squares))

    def body_parameters(self, result: MethodResult) -> Array:
        """Ten per link (n, 10): unknown or known bodies with an unknown payload; a known payload is left out.

        The result must have an estimate.
        """
        assert result.estimate is not None
        total = self.torque_model.inertial_parameters(result.estimate.parameters)
        for term in self.torque_model.known:
            if isinstance(term, KnownPayload) and isinstance(term, CarriesKnownBodies):
                total = total - term.known_inertial_parameters(self.torque_model.model)
        return total.reshape(-1, 10)
