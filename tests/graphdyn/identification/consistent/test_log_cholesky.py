"""Log-Cholesky coordinates, their derivatives, and the fit in them."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from identified import consistent_data as data

from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import LogCholesky
from graphdyn.identification.consistent import log_cholesky as fitting
from graphdyn.identification.consistent.fit import ConsistentProblem
from graphdyn.identification.consistent.log_cholesky import (
    Residuals,
    log_cholesky_factor,
    log_cholesky_factor_derivatives,
    log_cholesky_parameters,
    log_cholesky_pseudo_inertia,
    log_cholesky_pseudo_inertia_derivatives,
)
from graphdyn.identification.consistent.polishing import Cost

EXACT = 1e-12
STEP = 1e-6
DIFFERENCES = 1e-8
"""Central differences: STEP² of the third derivative, and rounding over STEP."""


@pytest.fixture
def theta():
    return np.random.default_rng(0).normal(size=(6, 10)) * 0.7


@pytest.fixture(scope="module")
def poor():
    return data.coordinates(data.poor_problem())


def differences(function, x):
    """∂f / ∂x_k, stacked in the second axis of (n, 10, 4, 4)."""
    steps = STEP * np.eye(10)
    return np.stack([(function(x + h) - function(x - h)) / (2 * STEP) for h in steps], axis=1)


class TestCoordinates:
    def test_every_theta_is_a_real_body(self, theta):
        assert np.all(np.linalg.eigvalsh(log_cholesky_pseudo_inertia(theta))[:, 0] > 0)

    def test_origin_is_the_unit_matrix(self):
        assert np.array_equal(log_cholesky_pseudo_inertia(np.zeros(10)), np.eye(4))

    def test_round_trip(self, theta):
        assert np.abs(log_cholesky_parameters(log_cholesky_pseudo_inertia(theta)) - theta).max() < EXACT

    def test_meaning(self):
        """α scales the mass by e^2α, t is the center of mass."""
        p = log_cholesky_pseudo_inertia(np.array([0.3, 0, 0, 0, 0, 0, 0, 0.1, -0.2, 0.5]))
        assert p[3, 3] == pytest.approx(np.exp(0.6))
        assert p[:3, 3] / p[3, 3] == pytest.approx([0.1, -0.2, 0.5])

    def test_factor_derivatives(self, theta):
        analytic = log_cholesky_factor_derivatives(theta)
        assert np.abs(analytic - differences(log_cholesky_factor, theta)).max() < DIFFERENCES * np.abs(analytic).max()

    def test_pseudo_inertia_derivatives(self, theta):
        analytic = log_cholesky_pseudo_inertia_derivatives(theta)
        numeric = differences(log_cholesky_pseudo_inertia, theta)
        assert np.abs(analytic - numeric).max() < DIFFERENCES * np.abs(analytic).max()

    def test_outside(self):
        with pytest.raises(np.linalg.LinAlgError):
            log_cholesky_parameters(np.diag([1.0, 1.0, -1.0, 1.0]))


class TestFit:
    def test_jacobian(self, poor, theta):
        problem = Residuals(poor[0], strength=3.0, margin=1e-4)
        unknowns = np.concatenate([theta.ravel(), np.random.default_rng(1).normal(size=18)])
        direction = np.random.default_rng(2).normal(size=unknowns.size)
        ahead, behind = (problem.residuals(unknowns + sign * STEP * direction) for sign in (1, -1))
        analytic = problem.jacobian(unknowns) @ direction
        assert np.abs(analytic - (ahead - behind) / (2 * STEP)).max() < DIFFERENCES * np.abs(analytic).max()

    @pytest.mark.parametrize("data", [1.0, 0.0], ids=["data", "prior alone"])
    def test_cost_is_that_of_the_convex_problem(self, poor, theta, data):
        """In other unknowns. Without data the weak squares of the further columns show."""
        coordinates = replace(poor[0], matrix=data * poor[0].matrix, right=data * poor[0].right)
        problem = Residuals(coordinates, strength=3.0, margin=1e-4)
        unknowns = np.concatenate([theta.ravel(), 5 * np.random.default_rng(1).normal(size=18)])
        expected = Cost(coordinates, "pullback", 3.0).value(problem.u(unknowns))
        assert problem.cost(unknowns) == pytest.approx(expected, rel=EXACT)

    def test_finds_the_minimum_of_the_convex_problem(self, poor):
        """Two solvers, two parametrizations, one minimum."""
        coordinates, inequalities = poor
        fit = fitting.log_cholesky_fit(coordinates, np.ones(18, dtype=bool))
        convex = ConsistentProblem(coordinates, inequalities, metric="pullback").solve(fitting.PRIOR_STRENGTH)
        assert fit.agreeing >= 1
        assert not fit.best_fit
        assert fit.starts[0].suboptimality < fitting.MAX_FIT_COST_EXCESS * fit.starts[0].cost
        assert fit.starts[0].cost == pytest.approx(convex.answer.objective, rel=1e-4)
        assert fit.excess == pytest.approx(convex.excess, rel=1e-2)

    def test_certificate_covers_the_true_distance(self, poor):
        """From points around the minimum, the bound is above the real excess of the cost, and 0 at the minimum."""
        coordinates, _ = poor
        fit = fitting.log_cholesky_fit(coordinates, np.zeros(18, dtype=bool), starts=1)
        cost, u = Cost(coordinates, "pullback", fitting.PRIOR_STRENGTH), fit.starts[0].u
        lowest = cost.value(u)
        none = (np.zeros((0, len(u))), np.zeros(0), np.zeros(0))
        for seed in range(10):
            direction = np.random.default_rng(seed).normal(size=len(u))
            for size in (1e-6, 1e-4, 1e-2):
                other = u + size * direction / np.linalg.norm(direction)
                bound = fitting.suboptimality(cost, other, *none, margin=1e-4)
                assert bound >= cost.value(other) - lowest - 1e-9 * lowest
        assert fitting.suboptimality(cost, u, *none, margin=1e-4) < 1e-2

    @pytest.mark.parametrize(("cost", "bound"), [(0.01, 1.0), (1.0, 1.0), (50.0, 50.0)])
    def test_a_start_is_accepted_by_its_bound(self, cost, bound):
        """Relative to the cost, and absolute where the cost is below one."""
        for share, accepted in ((0.99, True), (1.01, False)):
            excess = share * bound * fitting.MAX_FIT_COST_EXCESS
            assert fitting.LocalMinimum(np.zeros(3), cost, excess, "", 1).accepted is accepted

    @pytest.mark.parametrize(("starts", "strength"), [(0, 1.0), (1, 0.0), (1, np.nan)])
    def test_bad_settings(self, poor, starts, strength):
        with pytest.raises(InvalidInput, match=r"starts with strength .*; at least one, and a strength > 0 needed"):
            fitting.log_cholesky_fit(poor[0], np.ones(18, dtype=bool), starts=starts, strength=strength)

    def test_falls_back_to_the_convex_program(self, monkeypatch):
        monkeypatch.setattr(fitting, "MAX_EVALUATIONS", 1)
        estimate = LogCholesky(starts=2).estimate(data.poor_problem())
        assert "log-Cholesky: the cheapest of 2 starts may be" in estimate.remarks[0]
        assert "this is the answer of the convex program with the same cost" in estimate.remarks[0]
        assert estimate.settings["smallest part of prior"] > 0

    def test_without_fallback(self, monkeypatch):
        monkeypatch.setattr(fitting, "MAX_EVALUATIONS", 1)
        monkeypatch.setitem(sys.modules, "clarabel", None)
        with pytest.raises(
            EstimationFailed, match=r"cheapest of 3 starts.*and the convex fallback failed.*\[identify\]"
        ):
            LogCholesky().estimate(data.poor_problem())

    def test_needs_no_cone_solver(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "clarabel", None)
        assert LogCholesky().estimate(data.poor_problem()).settings["starts that agree"] >= 1
