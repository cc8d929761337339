"""Estimators on Pinocchio's regressor instead of ours: the independent baseline."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from crosscheck.comparing.baseline import PinocchioBodies
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import EstimationFailed
from graphdyn.identification import Estimate, Estimator, Problem
from graphdyn.identification.terms import RigidBodies


@dataclass(frozen=True, eq=False)
class WithPinocchio:
    """An estimator that runs on Pinocchio's regressor, and on ours for comparison.

    estimator: runs on both; reference: Pinocchio's reading of the robot, made from its RobotModel if left out

    The setting "difference" of its estimate compares the base parameters with those on our regressor: the largest
    difference, as the torque it causes, relative to the largest torque of a base parameter.
    """

    estimator: Estimator
    pinocchio: PinocchioModel | None = None

    @property
    def name(self) -> str:
        return f"{self.estimator.name}, Pinocchio's regressor"

    @property
    def reference(self) -> str:
        return f"{self.estimator.reference}; Pinocchio, computeJointTorqueRegressor"

    @property
    def assumptions(self) -> str:
        return self.estimator.assumptions

    @property
    def needs(self) -> str:
        return f"{self.estimator.needs}; unknown rigid bodies"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed if no body is unknown."""
        model = problem.torque_model
        if not any(isinstance(term, RigidBodies) for term in model.terms):
            raise EstimationFailed("no body is unknown, so there is no regressor of rigid bodies to exchange")
        bodies = PinocchioBodies(self.pinocchio or PinocchioModel.from_model(model.model))
        terms = [bodies if isinstance(term, RigidBodies) else term for term in model.terms]
        there = replace(problem, torque_model=replace(model, terms=terms))
        theirs, ours = self.estimator.estimate(there), self.estimator.estimate(problem)
        scale = np.linalg.norm(problem.equations.factors[..., :-1], axis=(0, 1))
        x, y = (scale * problem.base.values(estimate.parameters) for estimate in (ours, theirs))
        difference = float(np.abs(x - y).max() / np.abs(x).max())
        same = np.array_equal(there.base.independent, problem.base.independent)
        return replace(
            theirs,
            covariance=theirs.covariance if same else None,
            block_covariance=theirs.block_covariance if same else None,
            settings={**theirs.settings, "difference": difference},
            remarks=(*theirs.remarks, f"differs from {self.estimator.name} by {difference:.1e} of the torque"),
        )
