"""The physically consistent estimators: exact where they must be, real bodies always, and honest about failures."""

import dataclasses
import re
import subprocess
import sys

import cvxpy
import numpy as np
import pytest
from identified import consistent_data as data
from identified import torque_data

from graphdyn import EstimationFailed, InvalidInput, mass_matrix
from graphdyn.identification import (
    ConsistentLeastSquares,
    ConsistentWithPrior,
    LogCholesky,
    PhysicalLimits,
    Prior,
    Problem,
    ReweightedLeastSquares,
    RobustConsistent,
    TorqueModel,
    WeightedLeastSquares,
)
from graphdyn.identification.bodies.limits import CAD_FACTOR
from graphdyn.identification.consistent import fit as fitting
from graphdyn.identification.consistent import semidefinite
from graphdyn.identification.consistent.coordinates import MAX_TRUSTED_DEVIATIONS
from graphdyn.identification.consistent.fit import PRIOR_MARGIN, ConsistentProblem
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT
from graphdyn.identification.estimators.consistent import MAX_TORQUE_CHANGE
from graphdyn.identification.terms import Coulomb, KnownBodies, Payload, RigidBodies, Viscous
from graphdyn.model.inertia import pseudo_inertia_from_parameters

EXACT = 1e-8
"""Relative error of every base parameter from data without noise; measured 1e-11."""

POSES = 10_000

FEW_STRENGTHS = (0.0, 1.0, 1e3)
"""For cross-validation: every strength is one cone program for each fold."""

ESTIMATORS = [
    ConsistentLeastSquares(),
    ConsistentWithPrior(strengths=FEW_STRENGTHS),
    ConsistentWithPrior("pullback", strengths=FEW_STRENGTHS),
    ConsistentWithPrior(strength=0.0),
    LogCholesky(),
]
IDS = ["LMI", "entropic", "pullback", "entropic, strength 0", "log-Cholesky"]


@pytest.fixture(params=ESTIMATORS, ids=IDS)
def estimator(request):
    return request.param


def parts_of_prior(torque_model, parameters):
    """Eigenvalues of P relative to the prior's, smallest of every body (n,)."""
    bodies = pseudo_inertia_from_parameters(parameters[:60].reshape(-1, 10))
    prior = pseudo_inertia_from_parameters(torque_model.model.inertial_parameters.reshape(-1, 10))
    return np.linalg.eigvals(np.linalg.solve(prior, bodies)).real.min(axis=1)


def failing(*_):
    return "failed: out of luck"


class TestExactData:
    def test_base_parameters(self, estimator):
        problem = data.exact_problem()
        estimate = estimator.estimate(problem)
        true = problem.base.values(data.true_parameters())
        assert problem.base.rank == data.RANK
        assert np.abs(problem.base.values(estimate.parameters) / true - 1).max() <= EXACT
        assert parts_of_prior(problem.torque_model, estimate.parameters).min() > PRIOR_MARGIN

    def test_covariance_is_that_of_wls(self):
        estimate = ConsistentLeastSquares().estimate(data.exact_problem())
        expected = WeightedLeastSquares().estimate(data.exact_problem()).covariance
        assert estimate.remarks == (
            "consistent parameters are among the best fits: base parameters and their covariance are those of WLS",
        )
        assert np.abs(estimate.covariance - expected).max() <= 1e-6 * np.abs(expected).max()

    @pytest.mark.parametrize("metric", ["entropic", "pullback"])
    def test_what_the_data_leave_open_is_nearest_to_the_prior(self, metric):
        """At strength 0, no other point among the best fits is nearer."""
        coordinates, inequalities = data.coordinates(data.exact_problem())
        problem = ConsistentProblem(coordinates, inequalities, metric=metric)
        u = np.linalg.solve(coordinates.to_parameters, problem.solve().parameters)
        distance = fitting.Cost(coordinates, metric, 1.0)

        def far(u):
            return distance.value(u) - np.sum((coordinates.matrix @ u - coordinates.right) ** 2)

        for direction in np.random.default_rng(0).normal(size=(20, coordinates.null.shape[1])):
            for step in (1e-3, 1e-2):
                other = u + step * coordinates.null @ direction
                inside = inequalities.matrix @ coordinates.to_parameters @ other >= 0
                assert far(other) > far(u) or not inside.all()

    def test_scaling_of_exact_data(self):
        assert np.linalg.norm(data.coordinates(data.exact_problem())[0].right) == pytest.approx(MAX_TRUSTED_DEVIATIONS)


class TestPoorData:
    def test_the_best_fit_is_no_robot(self):
        """Else the tests below would show nothing."""
        problem = data.poor_problem()
        wls = WeightedLeastSquares().estimate(problem).parameters
        assert parts_of_prior(problem.torque_model, wls).min() < -1.0

    def test_bodies_are_real_and_the_mass_matrix_positive_definite(self, estimator):
        problem = data.poor_problem()
        estimate = estimator.estimate(problem)
        robot = problem.torque_model.model.with_inertial_parameters(estimate.parameters[:60])
        assert all(body.consistent for body in robot.physical_consistency())
        assert (
            parts_of_prior(problem.torque_model, estimate.parameters).min() >= fitting.MIN_MARGIN_SHARE * PRIOR_MARGIN
        )
        assert estimate.parameters[60:].min() >= -1e-9  # friction and rotors
        q, _ = robot.random_state(np.random.default_rng(0), POSES)
        assert np.count_nonzero(np.linalg.eigvalsh(mass_matrix(robot, q))[:, 0] > 0) == POSES
        assert estimate.covariance is None
        assert "no best fit is consistent, or the prior counts" in estimate.remarks[-1]

    @pytest.mark.parametrize("seed", range(4))
    def test_predicts_better(self, seed):
        """Projection on a convex set that holds the truth brings nearer to it; a fair prior nearer still."""
        problem = data.poor_problem(seed)
        wls, consistent, entropic = (
            data.prediction_error(method.estimate(problem).parameters)
            for method in (WeightedLeastSquares(), ConsistentLeastSquares(), ConsistentWithPrior(strength=10.0))
        )
        assert consistent < wls
        assert entropic < consistent

    @pytest.mark.parametrize("seed", range(4))
    def test_nearer_in_the_metric_of_the_data(self, seed):
        """‖A (u - u_true)‖ of the constrained fit is at most that of the unconstrained one, whatever the noise."""
        coordinates, inequalities = data.coordinates(data.poor_problem(seed))
        true = np.linalg.solve(coordinates.to_parameters, data.true_parameters())
        fit = ConsistentProblem(coordinates, inequalities, metric="pullback").solve()
        u = np.linalg.solve(coordinates.to_parameters, fit.parameters)
        assert not fit.best_fit
        assert np.linalg.norm(coordinates.matrix @ (u - true)) < np.linalg.norm(
            coordinates.matrix @ (coordinates.fitting - true)
        )

    @pytest.mark.parametrize("metric", ["entropic", "pullback"])
    def test_strength_leads_from_the_data_to_the_prior(self, metric):
        coordinates, inequalities = data.coordinates(data.poor_problem())
        problem = ConsistentProblem(coordinates, inequalities, metric=metric)
        fits = [problem.solve(strength) for strength in (0.1, 10.0, 1e3, 1e6)]
        excess = [fit.excess for fit in fits]
        assert excess == sorted(excess)
        far = [np.abs(np.linalg.solve(coordinates.to_parameters, f.parameters) - coordinates.origin)[:60] for f in fits]
        assert far[-1].max() < far[0].max() / 10
        assert all(fit.suboptimality < 1e-3 * fit.answer.objective for fit in fits)

    def test_cross_validation_chooses_between_the_ends(self):
        problem = Problem(data.torque_model(), data.noisy(100, 0, 20.0, 0.15), n_blocks=3)
        method = ConsistentWithPrior("pullback", strengths=(0.0, 1.0, 10.0, 1e6))
        assert method.estimate(problem).settings["strength"] in (1.0, 10.0)

    def test_link_frames_do_not_matter(self):
        """The prior in other units of the columns: the same minimum, with R and x scaled against each other."""
        coordinates, inequalities = data.coordinates(data.poor_problem())
        reference = ConsistentProblem(coordinates, inequalities, metric="entropic").solve(1.0)
        turn = np.linalg.qr(np.random.default_rng(0).normal(size=(4, 4)))[0]  # another factor of the same prior: U₀ Q
        basis = np.einsum("ai,ijk,bj->kab", turn, semidefinite.SYMMETRIC_BASIS, turn)
        rotation = np.einsum("kab,abl->lk", basis, semidefinite.SYMMETRIC_BASIS)
        turned = np.eye(len(coordinates.origin))
        turned[:60, :60] = np.kron(np.eye(6), rotation)
        other = dataclasses.replace(
            coordinates,
            to_parameters=coordinates.to_parameters @ turned,
            matrix=coordinates.matrix @ turned,
            fitting=turned.T @ coordinates.fitting,
            null=turned.T @ coordinates.null,
        )
        fit = ConsistentProblem(other, inequalities, metric="entropic").solve(1.0)
        assert np.abs(fit.parameters - reference.parameters).max() < 1e-6 * np.abs(reference.parameters).max()


class TestLimits:
    def masses(self, limits):
        estimate = ConsistentLeastSquares(limits).estimate(data.poor_problem())
        return estimate.parameters[0:60:10], estimate.parameters[:60].reshape(6, 10)

    def test_mass_and_center(self):
        free, bodies = self.masses(data.UNLIMITED)
        low, high = free[3] * 1.5, free[3] * 2
        box = bodies[2, 1:4] / bodies[2, 0] + np.array([[0.05, 0.05, 0.05], [0.2, 0.2, 0.2]])
        limits = PhysicalLimits(
            mass={"B4": (low, high), "B6": (0, np.inf)}, center={"B3": box}, total_mass=(0.0, free.sum() * 0.9)
        )
        masses, bodies = self.masses(limits)
        assert low * (1 - 1e-6) <= masses[3] <= high
        assert masses.sum() <= free.sum() * 0.9 * (1 + 1e-6)
        center = bodies[2, 1:4] / bodies[2, 0]
        assert np.all(center >= box[0] - 1e-5)
        assert np.all(center <= box[1] + 1e-5)

    def test_contradiction_names_the_limits(self):
        limits = PhysicalLimits(mass={"B2": (30.0, 60.0), "B5": (1.0, 2.0)}, total_mass=(0.0, 25.0))
        with pytest.raises(EstimationFailed) as caught:
            ConsistentLeastSquares(limits).estimate(data.poor_problem())
        assert "no bodies with at least 0.0001 of the prior inertia keep all limits; relax" in str(caught.value)
        assert "total mass ≤ 25 kg" in str(caught.value) or "mass of 'B2' ≥ 30 kg" in str(caught.value)
        assert "B5" not in str(caught.value)

    @pytest.mark.parametrize(
        ("limits", "message"),
        [
            (PhysicalLimits(mass={"B9": (0, 1)}), "mass limits of 'B9', which is not an unknown body; known: B1, B2"),
            (PhysicalLimits(center={"B9": np.zeros((2, 3))}), "center limits of 'B9', which is not an unknown body"),
            (PhysicalLimits(mass={"B1": (2, 1)}), "mass of 'B1': the lower limit 2.0 is above the upper limit 1.0 kg"),
            (PhysicalLimits(mass={"B1": 3.0}), r"limits of the mass of 'B1' are 3.0; \[lower, upper\] of shape \(2,\)"),
            (PhysicalLimits(total_mass=(np.nan, 1)), r"limits of the total mass are \[nan, 1.0\]"),
            (PhysicalLimits(center={"B1": [[1, 0, 0], [0, 0, 0]]}), "center of mass of 'B1': the lower limit"),
            (PhysicalLimits(cad_factor=0.5), "CAD factor of 'B1' is 0.5; give a number of 1 or more, inf for none"),
            (PhysicalLimits(cad_factors={"B9": 2.0}), "CAD factor limits of 'B9', which is not an unknown body"),
            (PhysicalLimits(box={"B2": [[0, 0, 0]]}), r"limits of the box of 'B2' are \[\[0.0, 0.0, 0.0\]\]"),
        ],
    )
    def test_senseless(self, limits, message):
        with pytest.raises(InvalidInput, match=message):
            ConsistentLeastSquares(limits).estimate(data.poor_problem())


class TestPlausibleByDefault:
    """Masses within a factor of CAD, their sum within its root, matter within reach: for every method."""

    @pytest.fixture(params=[*ESTIMATORS, RobustConsistent()], ids=[*IDS, "Huber"])
    def limited(self, request):
        return request.param

    def tight(self, method):
        return dataclasses.replace(method, limits=PhysicalLimits(cad_factor=1.2))

    def test_the_free_fit_is_not(self):
        """Else the test below would show nothing."""
        problem = data.poor_problem(1)
        x = ConsistentLeastSquares(data.UNLIMITED).estimate(problem).parameters[:60].reshape(6, 10)
        cad = problem.torque_model.model.inertial_parameters.reshape(6, 10)[:, 0]
        assert np.max(np.abs(np.log(x[:, 0] / cad))) > np.log(CAD_FACTOR)

    @pytest.mark.parametrize("factor", [CAD_FACTOR, 1.2])
    def test_bodies_stay_near_cad_and_in_their_boxes(self, limited, factor):
        problem = data.poor_problem(1)
        estimate = (limited if factor == CAD_FACTOR else self.tight(limited)).estimate(problem)
        x = estimate.parameters[:60].reshape(6, 10)
        cad = problem.torque_model.model.inertial_parameters.reshape(6, 10)[:, 0]
        assert np.abs(np.log(x[:, 0] / cad)).max() <= np.log(factor) + 1e-5
        assert abs(np.log(x[:, 0].sum() / cad.sum())) <= np.log(factor) / 2 + 1e-5
        boxes, center = estimate.limits.box, x[:, 1:4] / x[:, :1]
        assert np.all((center >= boxes[:, 0] - 1e-5) & (center <= boxes[:, 1] + 1e-5))
        matrices = pseudo_inertia_from_parameters(x)
        spread = np.einsum("nkk->nk", matrices[:, :3, :3]) / x[:, :1] - center**2
        room = (center - boxes[:, 0]) * (boxes[:, 1] - center)
        assert np.all(spread <= room + 1e-5)

    def test_a_box_of_its_own(self):
        problem = data.poor_problem(1)
        reach = ConsistentLeastSquares().estimate(problem).limits
        box = np.array([[-2.0, -2.0, -0.1], [2.0, 2.0, 3.0]])
        own = ConsistentLeastSquares(PhysicalLimits(box={"B2": box})).estimate(problem).limits
        assert np.array_equal(own.box[[0, 2, 3, 4, 5]], reach.box[[0, 2, 3, 4, 5]])
        assert np.all(own.box[1, 0] <= box[0])  # widened for the prior
        assert np.array_equal(own.box[1, :, :2], box[:, :2])

    def test_what_stands_behind_cad(self):
        problem, cad = data.poor_problem(1), data.torque_model().model.inertial_parameters[::10]
        limits = ConsistentLeastSquares(PhysicalLimits(cad_factors={"B2": 1.2, "B5": np.inf})).estimate(problem).limits
        assert limits.mass[1] == pytest.approx([cad[1] / 1.2, 1.2 * cad[1]])
        assert np.array_equal(limits.mass[4], [0.0, np.inf])
        assert limits.total_mass[1] == np.inf

    def test_placeholders_limit_no_mass_and_say_so(self):
        model = data.torque_model()
        same = np.tile([2.0, 0, 0, 0, 0.1, 0, 0.1, 0, 0, 0.1], 6)
        problem = Problem(
            dataclasses.replace(model, model=model.model.with_inertial_parameters(same)), data.exact(400, 0)
        )
        estimate = ConsistentLeastSquares().estimate(problem)
        assert "all bodies of CAD have the same mass and tensor, placeholders: they limit no mass" in estimate.remarks
        assert np.array_equal(estimate.limits.mass, [[0.0, np.inf]] * 6)

    def test_a_body_without_mass_has_no_limit_of_its_own(self):
        mean = data.torque_model().prior()
        mean[30:40] = 0.0
        method = ConsistentLeastSquares(prior=Prior(mean, np.ones_like(mean)))
        estimate = method.estimate(Problem(data.torque_model(), data.exact(400, 0)))
        assert "CAD has no mass of B4: only the total mass limits it" in estimate.remarks
        assert np.array_equal(estimate.limits.mass[3], [0.0, np.inf])
        assert np.isfinite(estimate.limits.total_mass).all()

    def test_log_cholesky_says_which_limit_it_left(self):
        *_, said, _ = self.tight(LogCholesky()).estimate(data.poor_problem(1)).remarks
        assert re.match("log-Cholesky left (mass|total) .*; this is the answer of the convex program", said)


class TestBodies:
    def test_unknown_payload(self):
        """It is a body of its own: real, limited by name; only its sum with the carrier shows in the data."""
        model = TorqueModel(torque_data.robot(), (RigidBodies(), Payload(), Viscous(), Coulomb()))
        samples = data.exact(200, 3)
        problem = Problem(model, samples)
        limits = PhysicalLimits(mass={"payload": (0.0, 4.0)})
        x = ConsistentLeastSquares(limits).estimate(problem).parameters
        payload = pseudo_inertia_from_parameters(x[60:70])
        assert np.linalg.eigvalsh(payload)[0] > 0
        assert 0 < x[60] <= 4.0 * (1 + 1e-6)

    def test_no_unknown_body(self):
        problem = Problem(
            TorqueModel(torque_data.robot(), (Viscous(), Coulomb()), known=(KnownBodies(),)), data.exact(200, 3)
        )
        with pytest.raises(EstimationFailed, match="no body is unknown in this torque model: there is nothing to keep"):
            ConsistentLeastSquares().estimate(problem)

    def test_unreal_prior_is_told(self):
        mean = data.torque_model().prior()
        mean[34:40] = 0.0
        estimate = ConsistentLeastSquares(prior=Prior(mean, np.ones_like(mean))).estimate(data.exact_problem())
        assert estimate.remarks[0] == "no real body has the prior inertia of B4; it was made heavier or thicker"


class TestSolver:
    @pytest.fixture
    def poor(self):
        return data.coordinates(data.poor_problem())

    def answering(self, monkeypatch, poor, status, shift):
        """The solver's answer, moved and given another status."""
        coordinates, inequalities = poor
        real = semidefinite.SemidefiniteProgram.solve

        def solve(program, strength, unit=1.0):
            answer = real(program, strength, unit)
            return dataclasses.replace(answer, u=answer.u + shift, status=status) if answer.u is not None else answer

        monkeypatch.setattr(semidefinite.SemidefiniteProgram, "solve", solve)
        monkeypatch.setattr(fitting, "polished", lambda cost, u, multipliers, *_: (u, multipliers))
        monkeypatch.setattr(ConsistentProblem, "_by_newton", lambda *_: None)
        return ConsistentProblem(coordinates, inequalities, metric="pullback")

    def test_inaccurate_but_good_is_accepted_and_told(self, monkeypatch, poor):
        self.answering(monkeypatch, poor, "AlmostSolved", 0.0)
        remarks = ConsistentLeastSquares().estimate(data.poor_problem()).remarks
        assert remarks[0].startswith("Clarabel stopped with 'AlmostSolved'; the answer passed the checks: its cost")
        assert "above the minimum, every body keeps 0.0001 of its prior" in remarks[0]

    @pytest.mark.parametrize("status", ["Solved", "AlmostSolved"])
    def test_bad_is_refused_whatever_the_status(self, monkeypatch, poor, status):
        problem = self.answering(monkeypatch, poor, status, 0.05)
        with pytest.raises(EstimationFailed, match=rf"Clarabel's answer \({status}\) is not good enough: .*its cost"):
            problem.solve(1.0)

    def test_outside_is_refused(self, monkeypatch, poor):
        problem = self.answering(monkeypatch, poor, "Solved", -3.0 * poor[0].origin)
        with pytest.raises(EstimationFailed, match="body 1 has eigenvalue -"):
            problem.solve(1.0)

    def test_violated_limit_is_named(self, monkeypatch, poor):
        shift = np.zeros(78)
        shift[60] = -1.0
        problem = self.answering(monkeypatch, poor, "Solved", shift)
        with pytest.raises(EstimationFailed, match="O1 viscous friction ≥ 0 is violated"):
            problem.solve(1.0)

    def test_no_answer(self, monkeypatch, poor):
        monkeypatch.setattr(semidefinite, "solved", failing)
        monkeypatch.setattr(ConsistentProblem, "_by_newton", lambda *_: None)
        with pytest.raises(EstimationFailed, match="Clarabel gives no answer: failed: out of luck"):
            ConsistentProblem(*poor, metric="entropic").solve(1.0)

    @pytest.mark.parametrize("strength", [1.0, 1e3, 1e6])
    @pytest.mark.parametrize("metric", ["entropic", "pullback"])
    def test_newton_from_the_prior_and_the_cone_solver_agree(self, monkeypatch, poor, metric, strength):
        alone = ConsistentProblem(*poor, metric=metric).solve(strength)
        monkeypatch.setattr(ConsistentProblem, "_by_newton", lambda *_: None)
        solver = ConsistentProblem(*poor, metric=metric).solve(strength)
        assert np.abs(alone.parameters - solver.parameters).max() < 1e-5 * np.abs(solver.parameters).max()

    @pytest.mark.parametrize("metric", ["entropic", "pullback"])
    def test_the_cone_program_is_that_of_the_distances(self, metric, poor):
        """Written by cvxpy from the definitions, without what this module makes of them."""
        coordinates, (g, h) = poor[0], (poor[1].matrix @ poor[0].to_parameters, poor[1].right)
        answer = semidefinite.SemidefiniteProgram(coordinates, (g, h), metric=metric, margin=PRIOR_MARGIN).solve(2.0)
        u, basis = cvxpy.Variable(len(coordinates.origin)), semidefinite.SYMMETRIC_BASIS.reshape(16, 10, order="F")
        bodies = [
            cvxpy.reshape(basis @ u[10 * i : 10 * i + 10], (4, 4), order="F") for i in range(coordinates.n_bodies)
        ]
        if metric == "entropic":
            distance = sum(cvxpy.trace(body) - cvxpy.log_det(body) - 4 for body in bodies)
        else:
            distance = sum(cvxpy.sum_squares(body - np.eye(4)) / 2 for body in bodies)
        weak = FURTHER_COLUMN_WEIGHT / 2 * cvxpy.sum_squares(u[coordinates.width :])
        cost = cvxpy.sum_squares(coordinates.matrix @ u - coordinates.right) + 2.0 * (distance + weak)
        kept = [body >> PRIOR_MARGIN * np.eye(4) for body in bodies]
        value = cvxpy.Problem(cvxpy.Minimize(cost), [*kept, g @ u >= h]).solve(solver="CLARABEL")
        assert answer.status == semidefinite.OPTIMAL
        assert answer.objective == pytest.approx(value, rel=1e-5)
        assert fitting.Cost(coordinates, metric, 2.0).value(answer.u) == pytest.approx(value, rel=1e-5)

    def test_newton_finishes_what_the_solver_began(self, monkeypatch, poor):
        full = ConsistentProblem(*poor, metric="entropic").solve(1.0)
        monkeypatch.setattr(ConsistentProblem, "_by_newton", lambda *_: None)
        monkeypatch.setattr(semidefinite, "MAX_SOLVER_ITERATIONS", 6)
        early = ConsistentProblem(*poor, metric="entropic").solve(1.0)
        assert early.answer.status != semidefinite.OPTIMAL
        assert np.abs(early.parameters - full.parameters).max() < 1e-6 * np.abs(full.parameters).max()

    def test_missing_library(self, monkeypatch, poor):
        monkeypatch.setitem(sys.modules, "clarabel", None)
        with pytest.raises(EstimationFailed, match=r"clarabel is not installed; .*pip install 'graphdyn\[identify\]'"):
            ConsistentProblem(*poor, metric="pullback").solve()

    def test_imported_only_where_used(self):
        late = ("clarabel", "scipy.optimize")
        code = f"import sys, graphdyn.identification; sys.exit(not sys.modules.keys().isdisjoint({late}))"
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


class TestCrossValidation:
    def test_needs_two_blocks(self):
        problem = Problem(data.torque_model(), data.noisy(100, 0, 20.0, 0.15), n_blocks=1)
        with pytest.raises(
            EstimationFailed, match="cross-validation needs two time blocks, there is 1; give a strength"
        ):
            ConsistentWithPrior().estimate(problem)

    def test_failed_fits_are_told_and_left_out(self, monkeypatch):
        real = ConsistentProblem.solve
        calls = []

        def solve(problem, strength=0.0):
            calls.append(strength)
            if strength == 1.0 and len(calls) < 3:
                raise EstimationFailed("as asked")
            return real(problem, strength)

        monkeypatch.setattr(ConsistentProblem, "solve", solve)
        estimate = ConsistentWithPrior("pullback", strengths=(1.0, 10.0)).estimate(data.poor_problem())
        assert estimate.settings["strength"] == 10.0
        assert estimate.remarks[:2] == (
            "the strongest prior tried (10) predicts best; the data add little",
            "cross-validation left out 1 of 8 fits that failed; the first: strength 1, without fold 1: as asked",
        )

    def test_all_failed(self, monkeypatch):
        monkeypatch.setattr(semidefinite, "solved", failing)
        monkeypatch.setattr(ConsistentProblem, "_by_newton", lambda *_: None)
        with pytest.raises(EstimationFailed, match="every strength fails in some fold; strength 10, without fold 1"):
            ConsistentWithPrior(strengths=(1.0, 10.0)).estimate(data.poor_problem())

    @pytest.mark.parametrize("strengths", [(), (-1.0, 1.0), (1.0, 1.0), (2.0, 1.0), (np.nan,)])
    def test_senseless_strengths(self, strengths):
        with pytest.raises(InvalidInput, match=r"strengths are \[.*\]; increasing numbers ≥ 0 needed"):
            ConsistentWithPrior(strengths=strengths)

    def test_senseless_metric(self):
        with pytest.raises(InvalidInput, match="metric is 'riemannian'; use 'entropic' or 'pullback'"):
            ConsistentWithPrior(metric="riemannian")


class TestRobust:
    @pytest.fixture(scope="class")
    @staticmethod
    def outliers():
        """Every tenth torque is wrong by ten times the noise."""
        rng = np.random.default_rng(5)
        noise = rng.normal(size=(120, 2))
        noise[rng.random(noise.shape) < 0.1] += 10.0
        return torque_data.small_problem(noise, n_blocks=4)

    def test_is_the_robust_fit_where_that_is_real(self, outliers):
        robust = ReweightedLeastSquares("huber").estimate(outliers)
        found = RobustConsistent().estimate(outliers)
        off = np.abs(outliers.base.values(found.parameters - robust.parameters))
        assert np.all(off <= 0.05 * np.sqrt(np.diag(robust.covariance)))
        assert found.settings["mean weight"] == pytest.approx(robust.settings["mean weight"], rel=1e-3)
        assert found.noise == pytest.approx(robust.noise, rel=1e-2)

    def test_minimum_with_a_prior(self, outliers):
        """The same torques as by one cone program with Huber's norm, at the same scale."""
        strength, columns = 1000.0, len(outliers.torque_model.columns)
        found = RobustConsistent("pullback", strength=strength).estimate(outliers)
        w = np.concatenate([outliers.reduced(rows) for rows in outliers.rows()]) @ outliers.base.matrix
        torque = np.concatenate([rows.right for rows in outliers.rows()])
        x = cvxpy.Variable(columns)
        residuals = [(w[:, j] @ x - torque[:, j]) / found.noise[j] for j in range(2)]
        cost = sum(cvxpy.sum(cvxpy.huber(residual, 1.345)) for residual in residuals)
        bodies = []
        for i in range(2):
            prior = pseudo_inertia_from_parameters(outliers.torque_model.model.bodies[i].parameters)
            inverse = np.linalg.inv(np.linalg.cholesky(prior))
            basis = pseudo_inertia_from_parameters(np.eye(10))
            matrix = sum(x[10 * i + k] * basis[k] for k in range(10))
            relative = inverse @ (matrix - prior) @ inverse.T
            cost = cost + strength / 2 * cvxpy.sum_squares(relative)
            bodies.append(relative + np.eye(2 * 2) * (1 - PRIOR_MARGIN) >> 0)
        cvxpy.Problem(cvxpy.Minimize(cost), [*bodies, x[20:] >= 0]).solve(solver="CLARABEL")
        apart = (w @ (found.parameters - x.value)) / found.noise
        assert np.sqrt(np.mean(apart**2, axis=0)).max() <= 2 * MAX_TORQUE_CHANGE
        plain = ConsistentWithPrior("pullback", strength=strength).estimate(outliers)
        assert (
            np.sqrt(np.mean(((w @ (plain.parameters - x.value)) / found.noise) ** 2, axis=0)).min()
            > 10 * MAX_TORQUE_CHANGE
        )

    def test_strength_is_chosen(self, outliers):
        found = RobustConsistent("pullback", strengths=(1.0, 10.0)).estimate(outliers)
        assert found.settings["strength"] in (1.0, 10.0)
        assert found.covariance is None

    def test_stops_and_says_so(self, outliers, monkeypatch):
        monkeypatch.setattr("graphdyn.identification.estimators.consistent.MAX_ROBUST_ITERATIONS", 1)
        assert (
            "stopped after 1 reweightings before the torques had settled"
            in RobustConsistent().estimate(outliers).remarks
        )
