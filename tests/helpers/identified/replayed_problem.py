"""The same motion with new torques, thousands of times: the factors of the regressor are made once."""

import numpy as np

from graphdyn.identification import CompressedEquations
from graphdyn.identification.problem.problem import Rows


class ReplayedProblem:
    """What estimators read of a Problem, for one motion and varying noise. One time block."""

    def __init__(self, problem):
        self.torque_model, self.base, self.support = problem.torque_model, problem.base, problem.support
        self.n_joints = problem.n_joints
        (self._rows,) = problem.rows()
        matrix = problem.reduced(self._rows)
        self._q, self._r = np.linalg.qr(np.moveaxis(matrix, 1, 0))
        self._matrix, self._exact = matrix, self._rows.right
        self.replay(np.zeros(self._exact.shape))

    def replay(self, noise):
        right = self._exact + noise
        n, b = self.n_joints, self._matrix.shape[-1]
        factors = np.zeros((n, b + 1, b + 1))
        factors[:, :b, :b] = self._r
        factors[:, :b, b] = np.einsum("gtk,tg->gk", self._q, right)
        factors[:, b, b] = np.sqrt(np.maximum(np.sum(right**2, axis=0) - np.sum(factors[:, :b, b] ** 2, axis=1), 0.0))
        self.equations = CompressedEquations(factors, np.full(n, len(right)))
        self.blocks = (self.equations,)
        self._rows = Rows(self._matrix, right, right, self._rows.velocity, np.ones(right.shape, dtype=bool), 0, True)
        return self

    def rows(self):
        yield self._rows

    def reduced(self, rows):
        return rows.matrix
