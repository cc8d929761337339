"""Every estimator: exact data give the exact answer, noise the stated standard deviations."""

from dataclasses import replace

import numpy as np
import pytest
from identified import torque_data
from identified.replayed_problem import ReplayedProblem
from long_check import LONG
from scipy.optimize import least_squares, minimize

from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import (
    EssentialParameters,
    GeneralizedLeastSquares,
    OrdinaryLeastSquares,
    Prior,
    Problem,
    ReweightedLeastSquares,
    Ridge,
    Samples,
    TorqueModel,
    TotalLeastSquares,
    WeightedLeastSquares,
    model_prior,
)
from graphdyn.identification.algebra.compressed import joint_noise, merged
from graphdyn.identification.estimators.generalized import error_covariance
from graphdyn.identification.estimators.reweighted import huber, tukey
from graphdyn.identification.estimators.ridge import RidgePath
from graphdyn.identification.terms import AsymmetricCoulomb, Coulomb, Offset, RigidBodies

EXACT = 1e-8
"""Relative error of every base parameter from data without noise."""

EACH, MEAN = 0.10, 0.03
"""Stated standard deviation over that of RUNS estimates. The latter is uncertain by 1 / sqrt(2 RUNS) = 1.6 %."""

RUNS, FEW_RUNS = 2000, 500
"""The latter, uncertain by 3.2 %, where a run takes many times as long."""

ESTIMATORS = [
    OrdinaryLeastSquares(),
    WeightedLeastSquares(),
    GeneralizedLeastSquares(),
    ReweightedLeastSquares("huber"),
    ReweightedLeastSquares("tukey"),
    Ridge(),
    EssentialParameters(),
]

INDEPENDENT = np.diag([3.0, 8.0])
CORRELATED = np.array([[3.0, 0.0], [4.0, 5.0]])
"""Factors of the covariance of the noise [N m]."""


@pytest.fixture(params=ESTIMATORS, ids=lambda estimator: estimator.name)
def estimator(request):
    return request.param


@pytest.fixture(scope="module")
def exact():
    return torque_data.exact_problem()


@pytest.fixture(scope="module")
def noisy():
    return torque_data.noisy_problem()


def dense(problem):
    """W (N, n, r), τ (N, n)."""
    rows = list(problem.rows())
    return np.concatenate([problem.reduced(part) for part in rows]), np.concatenate([part.right for part in rows])


def test_exact_data(estimator, exact):
    true = exact.base.values(torque_data.true_parameters())
    estimate = estimator.estimate(exact)
    assert exact.base.rank == torque_data.RANK
    assert np.abs(exact.base.values(estimate.parameters) / true - 1).max() <= EXACT


def test_says_what_it_is(estimator):
    assert all(len(text) > 2 for text in (estimator.name, estimator.reference, estimator.assumptions, estimator.needs))


@pytest.mark.parametrize(
    ("method", "factor", "runs"),
    [
        (OrdinaryLeastSquares(), INDEPENDENT, RUNS),
        pytest.param(WeightedLeastSquares(), INDEPENDENT, RUNS, marks=LONG),
        (GeneralizedLeastSquares(), CORRELATED, FEW_RUNS),
        pytest.param(ReweightedLeastSquares("huber"), INDEPENDENT, FEW_RUNS, marks=LONG),
        (Ridge(strength=1.0), INDEPENDENT, RUNS),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_standard_deviations_against_monte_carlo(method, factor, runs):
    problem = ReplayedProblem(torque_data.small_problem(np.zeros((120, 2)), n_blocks=1))
    rng = np.random.default_rng(0)
    values, variances = [], []
    for _ in range(runs):
        estimate = method.estimate(problem.replay(rng.normal(size=(120, 2)) @ factor.T))
        values.append(problem.base.values(estimate.parameters))
        variances.append(np.diag(estimate.covariance))
    ratio = np.sqrt(np.mean(variances, axis=0)) / np.std(values, axis=0, ddof=1)
    assert np.abs(ratio - 1).max() <= EACH
    assert abs(ratio.mean() - 1) <= MEAN


def test_noise_of_each_joint(estimator, noisy):
    """600 samples: known to 3 %."""
    assert np.abs(estimator.estimate(noisy).noise / torque_data.NOISE - 1).max() <= 0.12


class TestOrdinary:
    def test_against_lstsq(self, noisy):
        w, torque = dense(noisy)
        expected = np.linalg.lstsq(w.reshape(-1, w.shape[-1]), torque.reshape(-1), rcond=None)[0]
        estimate = OrdinaryLeastSquares().estimate(noisy)
        assert noisy.base.values(estimate.parameters) == pytest.approx(expected, rel=1e-9, abs=1e-9)


class TestWeighted:
    def test_against_lstsq(self, noisy):
        """With the noise of each joint from a fit of that joint alone."""
        w, torque = dense(noisy)
        noise = []
        for j in range(6):
            length = np.linalg.norm(w[:, j], axis=0)
            counted = length > 1e-9 * length.max()  # a column of rounding is none
            seen = w[:, j, counted] / length[counted]
            fit, _, rank, _ = np.linalg.lstsq(seen, torque[:, j], rcond=1e-9)
            noise.append(np.sqrt(np.sum((seen @ fit - torque[:, j]) ** 2) / (len(seen) - rank)))
        weights = 1 / np.array(noise)
        expected = np.linalg.lstsq(
            (w * weights[:, None]).reshape(-1, w.shape[-1]), (torque * weights).reshape(-1), rcond=None
        )[0]
        estimate = WeightedLeastSquares().estimate(noisy)
        assert estimate.noise == pytest.approx(noise, rel=1e-9)
        assert noisy.base.values(estimate.parameters) == pytest.approx(expected, rel=1e-9, abs=1e-9)

    def test_block_deviations_see_correlation_in_time(self):
        """White noise: both standard deviations agree in the mean. Noise that repeats for 20 samples: √20 apart."""
        size = 6000
        exact = torque_data.small_samples(size)
        rng = np.random.default_rng(0)
        for repeated in (1, 20):
            ratios = []
            for _ in range(10):
                noise = np.repeat(rng.normal(size=(size // repeated, 2)), repeated, axis=0)
                samples = Samples(exact.q, exact.v, exact.a, exact.tau + noise)
                estimate = WeightedLeastSquares().estimate(Problem(torque_data.small_arm(), samples, n_blocks=40))
                ratios.append(np.sqrt(np.diag(estimate.block_covariance) / np.diag(estimate.covariance)).mean())
            assert np.mean(ratios) == pytest.approx(np.sqrt(repeated), rel=0.15)

    def test_too_few_equations(self):
        samples = torque_data.small_samples()
        third = np.sort(np.abs(samples.v[:, 1]))[-3]
        problem = Problem(torque_data.small_arm(), samples, min_speed=[0.0, third], n_blocks=1)
        assert list(problem.equations.counts) == [120, 3]
        with pytest.raises(EstimationFailed, match=r"joint 2 has 3 equations, .*nothing is left to estimate its noise"):
            WeightedLeastSquares().estimate(problem)


class TestTotal:
    @pytest.mark.parametrize("scaled", [True, False])
    def test_exact_data(self, scaled, exact):
        true = exact.base.values(torque_data.true_parameters())
        estimate = TotalLeastSquares(scaled).estimate(exact)
        assert np.abs(exact.base.values(estimate.parameters) / true - 1).max() <= 1e-6
        assert estimate.remarks == (
            "errors of a regressor are neither independent nor alike: WLS, or the simulated loop, are better founded",
        )

    @pytest.mark.parametrize("scaled", [True, False])
    def test_minimum(self, scaled):
        """Errors E, e with (W + E) x = τ + e that are smallest have ‖W x - τ‖² / (1 + ‖x‖²), columns in their units."""
        problem = torque_data.small_problem(np.random.default_rng(0).normal(size=(120, 2)))
        w, torque = dense(problem)
        noise = joint_noise(problem.equations)
        rows, right = (w / noise[:, None]).reshape(-1, w.shape[-1]), (torque / noise).ravel()
        units = np.linalg.norm(rows, axis=0) if scaled else np.ones(rows.shape[1])
        unit = np.linalg.norm(right) if scaled else 1.0

        def cost(x):
            return np.sum((rows @ x - right) ** 2) / (unit**2 + np.sum((units * x) ** 2))

        x = problem.base.values(TotalLeastSquares(scaled).estimate(problem).parameters)
        lowest = cost(x)
        for step in np.random.default_rng(1).normal(size=(200, len(x))):
            assert cost(x + 1e-3 * step / units) > lowest
            assert cost(x + step / units) > lowest


class TestGeneralized:
    NOISE = np.random.default_rng(0).normal(size=(120, 2)) @ CORRELATED.T

    def test_against_whitened_lstsq(self):
        problem = torque_data.small_problem(self.NOISE)
        w, torque = dense(problem)
        estimate = GeneralizedLeastSquares().estimate(problem)
        start = problem.base.values(WeightedLeastSquares().estimate(problem).parameters)
        residual = w @ start - torque
        sample = residual.T @ residual
        correlation = sample[0, 1] / np.sqrt(sample[0, 0] * sample[1, 1])
        assert estimate.settings["largest correlation between joints"] == pytest.approx(abs(correlation), abs=0.01)
        covariance = estimate.noise[:, None] * [[1, correlation], [correlation, 1]] * estimate.noise
        whiten = np.linalg.inv(np.linalg.cholesky(covariance))
        expected = np.linalg.lstsq((whiten @ w).reshape(-1, w.shape[-1]), (torque @ whiten.T).reshape(-1), rcond=None)[
            0
        ]
        assert problem.base.values(estimate.parameters) == pytest.approx(expected, rel=0.01, abs=0.01)

    def test_left_out_equations(self):
        """min_speed leaves equations of single joints out: theirs are whitened among themselves."""
        problem = torque_data.small_problem(self.NOISE, min_speed=0.2)
        patterns = np.unique(np.concatenate([rows.kept for rows in problem.rows()]), axis=0)
        assert len(patterns) > 2
        estimate = GeneralizedLeastSquares().estimate(problem)
        error = problem.base.values(estimate.parameters) - problem.base.values(torque_data.small_parameters())
        assert error @ np.linalg.solve(estimate.covariance, error) < 30  # χ² of 12

    @pytest.mark.parametrize("sign", [-1.0, 1.0])
    def test_largest_correlation_is_told_whatever_its_sign(self, sign):
        noise = np.random.default_rng(0).normal(size=(120, 2)) @ [[1.0, sign * 0.8], [0.0, 0.6]]
        found = GeneralizedLeastSquares().estimate(torque_data.small_problem(noise))
        expected = abs(np.corrcoef(noise.T)[0, 1])
        assert found.settings["largest correlation between joints"] == pytest.approx(expected, abs=0.05)

    def test_too_few_complete_samples(self):
        with pytest.raises(EstimationFailed, match=r"only \d+ samples have equations of all 2 joints, 20 needed"):
            GeneralizedLeastSquares().estimate(torque_data.small_problem(self.NOISE, min_speed=[0.9, 0.9]))

    def test_repeated_noise(self):
        problem = torque_data.small_problem(np.random.default_rng(0).normal(size=(120, 1)) * [3.0, 8.0])
        true = problem.base.values(torque_data.small_parameters())
        with pytest.raises(EstimationFailed, match="the noise of some joints repeats that of others"):
            error_covariance(problem, true, np.zeros(2))


@pytest.fixture(scope="module")
def outliers():
    """Every tenth torque is wrong by ten times the noise."""
    rng = np.random.default_rng(5)
    noise = rng.normal(size=(120, 2))
    noise[rng.random(noise.shape) < 0.1] += 10.0
    return torque_data.small_problem(noise)


class TestReweighted:
    @pytest.mark.parametrize("norm", ["huber", "tukey"])
    def test_minimum(self, norm, outliers):
        """The same minimum as a general optimizer finds at the same scale."""
        w, torque = dense(outliers)
        estimate = ReweightedLeastSquares(norm).estimate(outliers)
        x = outliers.base.values(estimate.parameters)
        size = np.linalg.norm(w, axis=(0, 1))

        def residual(y):
            return ((w @ (y / size) - torque) / estimate.noise).reshape(-1)

        if norm == "huber":
            fit = least_squares(
                residual, x * size * 1.01, loss="huber", f_scale=1.345, xtol=1e-15, ftol=1e-15, gtol=1e-12
            )
        else:

            def cost(y):
                return -np.sum(np.maximum(1 - (residual(y) / 4.685) ** 2, 0.0) ** 3)

            fit = minimize(
                cost, x * size + 0.1, method="Powell", options={"xtol": 1e-12, "ftol": 1e-15, "maxiter": 200}
            )
        assert np.abs(x * size - fit.x).max() <= {"huber": 1e-3, "tukey": 1e-2}[norm]
        assert np.abs(x * size).max() > 100

    @pytest.mark.parametrize(("norm", "rho"), [
        (huber(), lambda u: np.where(np.abs(u) < 1.345, u**2 / 2, 1.345 * (np.abs(u) - 1.345 / 2))),
        (tukey(), lambda u: 4.685**2 / 6 * (1 - np.maximum(1 - (u / 4.685) ** 2, 0) ** 3)),
    ], ids=["huber", "tukey"])  # fmt: skip
    def test_norms_are_derivatives_of_each_other(self, norm, rho):
        """ψ = ρ', w = ψ / u, and ψ' by central differences."""
        u, step = np.linspace(-6.05, 6.05, 41), 1e-6
        influence = (rho(u + step) - rho(u - step)) / (2 * step)
        slope = (norm.influence(u + step) - norm.influence(u - step)) / (2 * step)
        np.testing.assert_allclose(norm.influence(u), influence, atol=1e-8)
        np.testing.assert_allclose(norm.slope(u), slope, atol=1e-8)
        np.testing.assert_allclose(norm.weight(u[u != 0]), (influence / np.where(u, u, 1))[u != 0], atol=1e-7)

    @pytest.mark.parametrize("norm", ["huber", "tukey"])
    def test_outliers_count_less(self, norm, outliers):
        true = outliers.base.values(torque_data.small_parameters())

        def error(method):
            size = np.sqrt(np.diag(method.estimate(outliers).covariance))
            return np.abs(outliers.base.values(method.estimate(outliers).parameters) - true), size

        robust, stated = error(ReweightedLeastSquares(norm))
        plain, _ = error(WeightedLeastSquares())
        assert np.linalg.norm(robust) < 0.6 * np.linalg.norm(plain)
        assert np.all(robust < 5 * stated)
        assert ReweightedLeastSquares(norm).estimate(outliers).settings["mean weight"] < 0.95

    def test_stops_and_says_so(self, outliers, monkeypatch):
        monkeypatch.setattr("graphdyn.identification.estimators.reweighted.MAX_REWEIGHTINGS", 1)
        (remark,) = ReweightedLeastSquares().estimate(outliers).remarks
        assert remark == "stopped after 1 iterations before the parameters had settled"

    def test_unknown_norm(self):
        with pytest.raises(InvalidInput, match="norm is 'cauchy'; use 'huber' or 'tukey'"):
            ReweightedLeastSquares("cauchy")


class TestRidge:
    @pytest.mark.parametrize("strength", [1e-3, 1.0, 1e4])
    def test_against_augmented_lstsq(self, strength, noisy):
        """λ as additional rows of an ordinary problem."""
        prior = model_prior(noisy.torque_model)
        noise = WeightedLeastSquares().estimate(noisy).noise
        r, z = noisy.standard_equations(noise)
        drawn = np.isfinite(prior.scale)
        rows = np.sqrt(strength) * np.eye(len(drawn))[drawn] / prior.scale[drawn, None]
        stacked, right = np.vstack([r, rows]), np.concatenate([z, rows @ prior.mean])
        scale = np.linalg.norm(stacked, axis=0)
        expected = np.linalg.lstsq(stacked / scale, right, rcond=None)[0] / scale
        estimate = Ridge(strength=strength).estimate(noisy)
        found, by_data = estimate.parameters, np.linalg.pinv(stacked / scale)[:, : len(r)] / scale[:, None]
        covariance = noisy.base.matrix @ by_data @ by_data.T @ noisy.base.matrix.T
        deviations = np.sqrt(np.diag(covariance))
        np.testing.assert_allclose(
            estimate.covariance / deviations / deviations[:, None],
            covariance / deviations / deviations[:, None],
            atol=1e-6,
        )
        rounding = np.finfo(float).eps * np.linalg.cond(stacked / scale) ** 2  # squared where there is a residual
        assert np.abs((found - expected) * scale).max() <= rounding * np.abs(expected * scale).max()

    def test_extreme_strengths(self, noisy):
        """Strong: the prior. Weak: weighted least squares, and what no data determine is still the prior."""
        prior, wls = model_prior(noisy.torque_model), WeightedLeastSquares().estimate(noisy)
        strong, weak = (Ridge(strength=s).estimate(noisy).parameters for s in (1e16, 1e-6))
        assert strong[:60] == pytest.approx(prior.mean[:60], abs=1e-6)
        assert noisy.base.values(weak) == pytest.approx(noisy.base.values(wls.parameters), rel=1e-5, abs=1e-5)
        zeros = noisy.base.structural_zeros
        assert weak[zeros] == pytest.approx(prior.mean[zeros], rel=1e-9)

    def test_a_good_prior_helps_little_data(self):
        """Sixty noisy samples and a prior that is right: cross-validation draws hard, and the error falls."""
        exact = torque_data.exact_samples()
        some = slice(None, None, 10)
        noise = np.random.default_rng(0).normal(size=exact.tau[some].shape) * 50
        samples = Samples(exact.q[some], exact.v[some], exact.a[some], exact.tau[some] + noise)
        problem = Problem(torque_data.torque_model(), samples, n_blocks=5)
        mean = torque_data.true_parameters().copy()
        prior = replace(model_prior(problem.torque_model), mean=mean)
        true = problem.base.values(mean)
        size = np.sqrt(np.diag(WeightedLeastSquares().estimate(problem).covariance))
        errors = {}
        for method in (WeightedLeastSquares(), Ridge(prior)):
            errors[method.name] = np.abs(problem.base.values(method.estimate(problem).parameters) - true) / size
        assert np.linalg.norm(errors["ridge"]) < 0.8 * np.linalg.norm(errors["WLS"])

    def test_free_parameters_that_depend_on_each_other(self):
        """Coulomb, its two directions and an offset: four columns, of which two are independent; the drawn ones must
        not suffer."""
        exact = torque_data.small_samples()
        model = TorqueModel(torque_data.small_arm().model, (RigidBodies(), Coulomb(), AsymmetricCoulomb(), Offset()))
        noise = np.random.default_rng(0).normal(size=(120, 2))
        x = np.zeros(len(model.columns))
        x[:20], x[20:22] = torque_data.small_parameters()[:20], 10.0
        torque = model.torque(exact, x) + noise
        problem = Problem(model, Samples(exact.q, exact.v, exact.a, torque))
        prior = model_prior(model)
        r, z = problem.standard_equations(np.ones(2))
        found = RidgePath.of(*problem.equations.weighted(np.ones(2)), problem.base.matrix, prior).at(1.0)
        scale = np.where(np.isfinite(prior.scale), prior.scale, 1.0)
        drawn = np.isfinite(prior.scale)
        rows = np.eye(len(x))[drawn] / prior.scale[drawn, None]
        stacked = np.vstack([r, rows]) * scale
        step = np.linalg.lstsq(stacked, np.concatenate([z - r @ prior.mean, np.zeros(20)]), rcond=1e-10)[0]
        expected = prior.mean + scale * step
        assert found[:20] == pytest.approx(expected[:20], rel=1e-7, abs=1e-7)
        assert problem.base.values(found) == pytest.approx(problem.base.values(expected), rel=1e-7, abs=1e-7)

    def test_cross_validation(self, noisy):
        """The strength whose answer to all blocks but one predicts that one best, block after block."""
        strengths = (1e-2, 1e2, 1e4, 1e6)
        noise = WeightedLeastSquares().estimate(noisy).noise
        errors = np.zeros(4)
        for k, block in enumerate(noisy.folds):
            for s, strength in enumerate(strengths):
                r, z = merged(noisy.folds[:k] + noisy.folds[k + 1 :]).weighted(noise)
                x = noisy.base.values(
                    RidgePath.of(r, z, noisy.base.matrix, model_prior(noisy.torque_model)).at(strength)
                )
                errors[s] += np.sum(block.residual_squares(x) / noise**2)
        estimate = Ridge(strengths=strengths).estimate(noisy)
        assert estimate.settings["strength"] == strengths[int(np.argmin(errors))]
        assert estimate.settings["validation error"] == pytest.approx(np.sqrt(errors.min() / 3600))

    def test_needs_blocks(self):
        with pytest.raises(EstimationFailed, match="cross-validation needs two time blocks, there is 1"):
            Ridge().estimate(torque_data.small_problem(np.zeros((120, 2)), n_blocks=1))

    def test_own_prior(self, noisy):
        prior = Prior(np.ones(87), np.ones(87))
        assert Ridge(prior, strength=1e20).estimate(noisy).parameters == pytest.approx(np.ones(87))


class TestEssential:
    def test_drops_what_is_lost_in_the_noise(self, noisy):
        full = WeightedLeastSquares().estimate(noisy)
        estimate = EssentialParameters(ratio=30).estimate(noisy)
        x = noisy.base.values(estimate.parameters)
        dropped = np.abs(x) < 1e-9
        assert 0 < np.count_nonzero(dropped) == noisy.base.rank - estimate.settings["essential parameters"]
        assert estimate.remarks[0].startswith("set to zero: ")
        assert estimate.remarks[0].count(";") == np.count_nonzero(dropped) - 1
        relative = np.sqrt(np.diag(full.covariance)) / np.abs(noisy.base.values(full.parameters))
        assert relative[dropped].min() > np.median(relative)
        everything = EssentialParameters(ratio=30, increase=10.0).estimate(noisy)
        x = noisy.base.values(everything.parameters)
        relative = np.sqrt(np.diag(everything.covariance)) / np.abs(x)
        relative = relative[np.abs(x) > 1e-9]
        assert relative.max() <= 30 * relative.min()

    def test_residual_may_not_grow(self, noisy):
        estimate = EssentialParameters(ratio=1.0, increase=0.01).estimate(noisy)
        before = noisy.equations.residual_squares(noisy.base.values(WeightedLeastSquares().estimate(noisy).parameters))
        after = noisy.equations.residual_squares(noisy.base.values(estimate.parameters))
        noise = estimate.noise
        assert np.sum(after / noise**2) <= 1.01**2 * np.sum(before / noise**2)
        assert estimate.settings["essential parameters"] > 1
