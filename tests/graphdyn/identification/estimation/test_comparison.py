"""Results explain themselves: residuals, whiteness, plausibility, failures."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from identified import torque_data

import graphdyn
from graphdyn import InvalidInput
from graphdyn.identification import (
    Estimate,
    OrdinaryLeastSquares,
    Plausibility,
    Problem,
    Samples,
    TorqueModel,
    WeightedLeastSquares,
    compare_methods,
    plausibility,
    residual_statistics,
)
from graphdyn.identification.estimation.comparison import mass_matrices
from graphdyn.identification.statistics.residual_statistics import MIN_MOVING_SPEED, residuals_of_part
from graphdyn.identification.terms import KnownBodies, KnownPayload, RigidBodies, RotorInertia

POSES = 50

REASON = "cannot see the motor"


@dataclass
class Own:
    """A method of a user."""

    answer: object
    name: str = "own"
    reference: str = "none"
    assumptions: str = "none"
    needs: str = "nothing"

    def estimate(self, problem):
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


@pytest.fixture(scope="module")
def problem():
    return torque_data.noisy_problem()


@pytest.fixture(scope="module")
def comparison(problem):
    failing = Own(ValueError(REASON), name="failing")
    right = Own(Estimate(torque_data.true_parameters()), name="truth")
    methods = [OrdinaryLeastSquares(), failing, WeightedLeastSquares(), right]
    return compare_methods(problem, methods, torque_data.noisy_problem(seed=9), poses=POSES)


class TestComparison:
    def test_failure_has_its_reason_and_the_others_go_on(self, comparison):
        assert [result.name for result in comparison.results] == ["OLS", "failing", "WLS", "truth"]
        failed = comparison.of("failing")
        assert failed.failure == f"ValueError: {REASON}"
        assert failed.estimate is failed.training is failed.base_values is failed.relative_deviations is None
        assert all(comparison.of(name).failure is None for name in ("OLS", "WLS", "truth"))

    def test_explains_itself(self, comparison, problem):
        result = comparison.of("WLS")
        assert (comparison.rank, comparison.structural_rank) == (torque_data.RANK, torque_data.RANK)
        assert len(comparison.base_names) == len(comparison.base_units) == len(result.base_values) == torque_data.RANK
        assert comparison.base_units[comparison.base_names.index("FV_3")] == "N m s/rad"
        assert comparison.lost == ()
        assert "O3 viscous friction" not in comparison.undetermined
        assert "B1 m" in comparison.undetermined
        assert result.relative_deviations == pytest.approx(100 * result.block_deviations / abs(result.base_values))
        assert np.all(result.block_deviations > 0)
        assert comparison.gap[0] > 0.01
        assert 1 < comparison.condition_number < 200
        assert result.seconds > 0

    def test_lost_parameters_are_named(self):
        exact = torque_data.exact_samples()
        still = [np.where(np.arange(6) == 5, 0.0, x) for x in (exact.q, exact.v, exact.a)]
        problem = Problem(torque_data.torque_model(), Samples(*still, exact.tau))
        comparison = compare_methods(problem, [WeightedLeastSquares()], poses=1)
        assert comparison.rank < comparison.structural_rank
        assert "FV_6" in comparison.lost
        assert "O6 viscous friction" in comparison.undetermined

    def test_held_out(self, comparison):
        """The truth predicts with the noise alone; an estimate a little worse on what it has not seen."""
        truth, wls = comparison.of("truth"), comparison.of("WLS")
        assert truth.held_out.everything.rms == pytest.approx(torque_data.NOISE, rel=0.1)
        assert np.mean(wls.training.everything.rms / truth.training.everything.rms) < 1
        assert np.mean(wls.held_out.everything.rms / truth.held_out.everything.rms) > 1

    @pytest.mark.parametrize("answer", [Estimate(np.ones(3)), Estimate(np.full(87, np.nan))], ids=["short", "nan"])
    def test_useless_answers_are_failures(self, answer, problem):
        (result,) = compare_methods(problem, [Own(answer)], poses=1).results
        assert f"parameters of shape {answer.parameters.shape}; 87 finite numbers needed" in result.failure

    def test_nothing_but_failures(self, problem):
        (result,) = compare_methods(problem, [Own(None)], poses=1).results
        assert result.failure.startswith("AttributeError")

    def test_refusals(self, problem, comparison):
        with pytest.raises(InvalidInput, match="two methods are called 'WLS'; give at least one, each with a name"):
            compare_methods(problem, [WeightedLeastSquares(), WeightedLeastSquares()])
        with pytest.raises(InvalidInput, match="there is no method; give at least one"):
            compare_methods(problem, [])
        with pytest.raises(InvalidInput, match="the held-out recording has another torque model"):
            compare_methods(problem, [WeightedLeastSquares()], torque_data.small_problem(np.zeros((120, 2))))
        with pytest.raises(InvalidInput, match="there is no method 'LMI'; known: OLS, failing, WLS, truth"):
            comparison.of("LMI")

    def test_progress(self, problem):
        seen = []
        compare_methods(problem, [OrdinaryLeastSquares(), WeightedLeastSquares()], poses=1, progress=seen.append)
        assert seen == ["OLS", "WLS"]


class TestResiduals:
    def test_against_the_whole_arrays(self, problem):
        samples, x = torque_data.noisy_samples(), torque_data.true_parameters()
        slow = np.where(np.arange(600)[:, None] % 3 == 0, 0.001, 1.0)
        samples = Samples(samples.q, samples.v * slow, samples.a, samples.tau)
        (found,) = residual_statistics(Problem(torque_data.torque_model(), samples, min_speed=0.1), [x])
        error = torque_data.torque_model().torque(samples, x) - samples.tau
        moving = np.abs(samples.v) > MIN_MOVING_SPEED
        for sizes, counted in ((found.everything, np.ones_like(moving)), (found.moving, moving)):
            for j in range(6):
                e, tau = error[counted[:, j], j], samples.tau[counted[:, j], j]
                assert sizes.count[j] == len(e)
                assert sizes.mean[j] == pytest.approx(e.mean())
                assert sizes.rms[j] == pytest.approx(np.sqrt(np.mean(e**2)))
                assert sizes.largest[j] == pytest.approx(np.abs(e).max())
                assert sizes.relative[j] == pytest.approx(np.linalg.norm(e) / np.linalg.norm(tau))
        steps = np.sum(np.diff(error, axis=0) ** 2, axis=0) / np.sum(error**2, axis=0)
        assert found.durbin_watson == pytest.approx(steps)

    def test_ljung_box(self):
        """The formula over whole arrays; white noise is accepted at 5 % about 19 times in 20, a drift never."""
        from scipy.stats import chi2

        exact = torque_data.small_samples()
        rng = np.random.default_rng(0)
        accepted = []
        for run in range(60):
            noise = rng.normal(size=(120, 2))
            noise[:, 1] = np.cumsum(noise[:, 1])
            (found,) = residual_statistics(torque_data.small_problem(noise), [torque_data.small_parameters()])
            accepted.append(found.ljung_box_p > 0.05)
            if run == 0:
                e = -noise[:, 0]
                r = np.array([np.sum(e[k:] * e[:-k]) for k in range(1, 21)]) / np.sum(e**2)
                q = 120 * 122 * np.sum(r**2 / (120 - np.arange(1, 21)))
                assert found.ljung_box_p[0] == pytest.approx(chi2.sf(q, 20), rel=1e-6)
        assert len(exact) == 120
        assert 0.85 <= np.mean(accepted, axis=0)[0] <= 1.0
        assert np.mean(accepted, axis=0)[1] == 0

    def test_pieces_do_not_reach_into_each_other(self):
        exact = torque_data.small_samples()
        halves = [exact[:60], exact[60:]]
        shifted = [Samples(h.q, h.v, h.a, h.tau + s) for h, s in zip(halves, (1.0, -1.0), strict=True)]
        (found,) = residual_statistics(Problem(torque_data.small_arm(), shifted), [torque_data.small_parameters()])
        assert found.durbin_watson == pytest.approx([0.0, 0.0], abs=1e-12)

    def test_of_parts_the_longest_correlation(self):
        """White in one part and slow in the other, and the reverse; counts and squares are sums."""
        rng, x = np.random.default_rng(0), torque_data.small_parameters()[:, None]
        white, slow = rng.normal(size=120), np.cumsum(rng.normal(size=120))

        def part(*columns):
            problem = torque_data.small_problem(np.column_stack(columns))
            return residuals_of_part(problem.structure.base.matrix @ x, problem, slice(0, 10**9))

        one, other = part(white, slow), part(slow, white)
        lengths = [sums.statistics()[0].correlation_length for sums in (one, other)]
        (found,) = one.merge(other).statistics()
        assert np.all(np.max(lengths, axis=0) > 2)
        assert np.array_equal(found.correlation_length, np.max(lengths, axis=0))
        assert found.everything.count.tolist() == [240, 240]
        assert found.everything.rms == pytest.approx(np.sqrt((white @ white + slow @ slow) / 240), rel=1e-6)

    def test_a_joint_that_never_moves(self):
        exact = torque_data.small_samples()
        still = Samples(exact.q, exact.v * [1.0, 0.0], exact.a, exact.tau)
        (found,) = residual_statistics(Problem(torque_data.small_arm(), still), [torque_data.small_parameters()])
        assert found.moving.count[1] == 0
        assert np.isnan([found.moving.rms[1], found.moving.largest[1], found.moving.relative[1]]).all()


class TestPlausibility:
    def test_smallest_of_all_poses(self):
        found = Plausibility(np.array([2.0, 0.0]), np.array([3.0, -1.0, 2.0]))
        assert (found.smallest_mass_matrix_eigenvalue, found.consistent) == (-1.0, True)

    def test_mass_matrix(self):
        """That of the dynamics, plus the rotors on the diagonal, plus the coupling of the wrist."""
        model, x = torque_data.torque_model(), torque_data.true_parameters()
        robot = model.model.with_inertial_parameters(x[:60])
        q, _ = robot.random_state(np.random.default_rng(0), 5)
        expected = graphdyn.mass_matrix(robot, q) + np.diag(x[78:84])
        expected[:, 4, 5] += x[84]
        expected[:, 5, 4] += x[84]
        assert [column.symbol for column in model.columns][78] == "IA_1"
        assert mass_matrices(model, q, x[None])[:, 0] == pytest.approx(expected, rel=1e-10, abs=1e-10)

    def test_known_bodies_count(self):
        robot = torque_data.robot()
        known = TorqueModel(robot, (RotorInertia(),), (KnownBodies(), KnownPayload(robot.bodies[5].parameters)))
        q, _ = robot.random_state(np.random.default_rng(0), 5)
        pi = robot.inertial_parameters.copy()
        pi[50:] *= 2
        expected = graphdyn.mass_matrix(robot.with_inertial_parameters(pi), q)
        assert mass_matrices(known, q, np.zeros((1, 6)))[:, 0] == pytest.approx(expected, rel=1e-10, abs=1e-10)

    def test_real_and_impossible_bodies(self):
        robot = torque_data.robot()
        model = TorqueModel(robot, (RigidBodies(),))
        good = robot.inertial_parameters
        light = good.copy()
        light[20] *= 0.01  # the mass of body 3, its first moments as before
        negative = -good
        found = plausibility(model, [good, light, negative], poses=POSES)
        assert [result.consistent for result in found] == [True, False, False]
        assert [k for k in range(6) if found[1].pseudo_inertia_eigenvalues[k] < 0] == [2]
        assert found[0].positive_definite == POSES
        assert found[2].positive_definite == 0
        for body, eigenvalue in zip(robot.physical_consistency(), found[0].pseudo_inertia_eigenvalues, strict=True):
            assert body.pseudo_inertia_eigenvalue == pytest.approx(eigenvalue, rel=1e-9)

    def test_ten_thousand_poses_unless_told_otherwise(self):
        arm = torque_data.small_arm()
        (found,) = plausibility(replace(arm, terms=(RigidBodies(),)), [torque_data.small_parameters()[:20]])
        assert found.positive_definite == 10_000
