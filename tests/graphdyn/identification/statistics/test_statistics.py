"""What is lost to the parameters: corrections for few equations, the jackknife, the correlation time, ties and gaps.

Statistics are held against simulation or against the formula written out, thresholds against numbers on both sides.
"""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.stats
from identified import torque_data
from identified.coverage_trials import Case, correlated_noise, coverage
from identified.replayed_problem import ReplayedProblem
from long_check import LONG

from graphdyn.identification import (
    GeneralizedLeastSquares,
    OrdinaryLeastSquares,
    Problem,
    ReweightedLeastSquares,
    Samples,
    WeightedLeastSquares,
    base_parameters,
)
from graphdyn.identification.algebra.compressed import CompressedEquations
from graphdyn.identification.estimation.cross_validation import CrossValidation
from graphdyn.identification.estimators.generalized import error_covariance
from graphdyn.identification.statistics.correlation import (
    MAX_CELLS,
    CorrelationLength,
    jackknife_covariance,
    left_out_covariance,
)

FEW = 30
"""Samples of two joints: 60 equations for 12 parameters, which use up a fifth of them."""

RUNS = 200

USED_UP = 0.89
"""Estimate of a noise of 1 that takes all equations for free ones."""


def thinned(samples, size):
    every = slice(None, None, len(samples) // size)
    return samples[every]


def few_equations():
    exact = thinned(torque_data.small_samples(120), FEW)
    return Problem(torque_data.small_arm(), exact, n_blocks=1)


@pytest.mark.parametrize(
    "method",
    [
        OrdinaryLeastSquares(),
        pytest.param(WeightedLeastSquares(), marks=LONG),
        pytest.param(GeneralizedLeastSquares(), marks=LONG),
        pytest.param(ReweightedLeastSquares("huber"), marks=LONG),
    ],
    ids=lambda method: method.name,
)
def test_noise_of_few_equations(method):
    problem = ReplayedProblem(few_equations())
    rng = np.random.default_rng(0)
    found = [method.estimate(problem.replay(rng.normal(size=(FEW, 2)))).noise for _ in range(RUNS)]
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(1.0, abs=(1 - USED_UP) / 3)


def test_covariance_of_few_equations_with_huber():
    """A⁻¹ B A⁻¹ with κ and the equations used up, written out."""
    exact = thinned(torque_data.small_samples(120), FEW)
    noise = np.random.default_rng(1).standard_t(3, size=(FEW, 2))
    problem = Problem(torque_data.small_arm(), dataclasses.replace(exact, tau=exact.tau + noise), n_blocks=1)
    estimate = ReweightedLeastSquares("huber").estimate(problem)
    (rows,) = problem.rows()
    w, size = problem.reduced(rows), estimate.noise
    u = (w @ problem.base.values(estimate.parameters) - rows.right) / size
    psi, slope = np.clip(u, -1.345, 1.345), np.abs(u) <= 1.345
    n_equations, n_parameters = 60, 12
    first, second = np.zeros((12, 12)), np.zeros((12, 12))
    for j in range(2):
        gram = w[:, j].T @ w[:, j] / size[j] ** 2
        m = slope[:, j].mean()
        kappa = 1 + n_parameters / n_equations * m * (1 - m) / m**2
        first += m * gram
        second += kappa**2 * (psi[:, j] ** 2).mean() / (1 - n_parameters / n_equations) * gram
    inverse = np.linalg.inv(first)
    np.testing.assert_allclose(estimate.covariance, inverse @ second @ inverse, rtol=1e-6)
    assert kappa**2 > 1.02


def test_noise_between_joints_of_samples_without_all_equations():
    """Joint 1 has 40 equations for 8 parameters, joint 2 half of them for 4: on average the noise is that of all."""
    turns = 2 * np.pi * np.arange(40) / 40
    waves = np.column_stack([f(k * turns) for k in range(1, 5) for f in (np.cos, np.sin)])
    kept = np.column_stack([np.ones(40), np.arange(40) % 2 == 0]).astype(bool)
    matrix = np.zeros((40, 2, 12))
    matrix[:, 0, :8], matrix[:, 1, 8:] = waves, waves[:, :4]
    rng, size, found = np.random.default_rng(0), np.array([2.0, 0.5]), []
    for _ in range(400):
        right = size * rng.normal(size=(40, 2))
        x = np.linalg.lstsq(matrix[kept], right[kept], rcond=None)[0]
        problem = SimpleNamespace(
            n_joints=2,
            rows=lambda right=right: [SimpleNamespace(kept=kept, right=right)],
            reduced=lambda rows: matrix,
            equations=SimpleNamespace(counts=np.array([40, 20])),
        )
        found.append(np.diag(error_covariance(problem, x, np.array([8.0, 4.0]))) / size**2)
    assert np.mean(found, axis=0) == pytest.approx(1.0, abs=5 * np.sqrt(2 / 16 / 400))


class TestJackknife:
    def problem(self, n_blocks):
        samples = torque_data.small_samples()
        noise = np.random.default_rng(0).normal(size=samples.tau.shape)
        return Problem(
            torque_data.small_arm(), dataclasses.replace(samples, tau=samples.tau + noise), n_blocks=n_blocks
        )

    @pytest.mark.parametrize(("n_blocks", "factor"), [(2, 0.5), (4, 0.75), (10, 0.9)])
    def test_against_leaving_blocks_out(self, n_blocks, factor):
        """(B - 1) / B Σ (x_b - x)², every x_b by lstsq without the rows of its block."""
        problem = self.problem(n_blocks)
        rows = list(problem.rows())
        w, right, block = (
            np.concatenate(arrays)
            for arrays in zip(*((problem.reduced(r), r.right, np.full(len(r), r.block)) for r in rows), strict=True)
        )

        def solved(kept):
            return np.linalg.lstsq(w[kept].reshape(-1, 12), right[kept].ravel(), rcond=None)[0]

        changes = np.array([solved(block != b) - solved(block >= 0) for b in range(n_blocks)])
        estimate = OrdinaryLeastSquares().estimate(problem)
        np.testing.assert_allclose(np.diag(estimate.block_covariance), factor * np.sum(changes**2, axis=0), rtol=1e-6)

    def test_of_sums_without_their_rows(self):
        """Blocks that are not symmetric, as of instruments, each left out; of one mean it is the standard error."""
        rng = np.random.default_rng(0)
        blocks, right = rng.normal(size=(6, 3, 3)) + 4 * np.eye(3), rng.normal(size=(6, 3))
        x = np.linalg.solve(blocks.sum(axis=0), right.sum(axis=0))
        changes = [
            np.linalg.solve(np.delete(blocks, b, 0).sum(axis=0), np.delete(right, b, 0).sum(axis=0)) - x
            for b in range(6)
        ]
        found = left_out_covariance(blocks, right - blocks @ x, np.array([1.0, 2.0, 30.0]))
        np.testing.assert_allclose(found, 5 / 6 * np.transpose(changes) @ changes, rtol=1e-10)
        mean = left_out_covariance(np.ones((6, 1, 1)), right[:, :1] - right[:, 0].mean(), np.ones(1))
        assert mean[0, 0] == pytest.approx(scipy.stats.sem(right[:, 0]) ** 2)
        assert left_out_covariance(blocks[:1], right[:1], np.ones(3)) is None

    def test_with_huber(self):
        """One Newton step from the answer to that without a block: x_b - x = (A - A_b)⁻¹ g_b, A with the mean of ψ'."""
        problem = self.problem(4)
        estimate = ReweightedLeastSquares("huber").estimate(problem)
        x, first, gradients = problem.base.values(estimate.parameters), [], []
        parts = [(problem.reduced(rows), rows.right) for rows in problem.rows()]
        u = np.concatenate([(w @ x - right) / estimate.noise for w, right in parts])
        weight = np.minimum(1.0, 1.345 / np.abs(u))
        ratio = (np.abs(u) <= 1.345).mean(axis=0) / weight.mean(axis=0)
        for (w, right), here in zip(parts, np.split(weight, 4), strict=True):
            scaled = w / estimate.noise[:, None]
            first.append(np.einsum("tj,tji,tjk->ik", here * ratio, scaled, scaled))
            gradients.append(np.einsum("tj,tji->i", here * (w @ x - right) / estimate.noise, scaled))
        changes = [np.linalg.solve(sum(first) - a, g) for a, g in zip(first, gradients, strict=True)]
        np.testing.assert_allclose(
            np.diag(estimate.block_covariance), 0.75 * np.sum(np.square(changes), axis=0), rtol=1e-4
        )
        assert np.all(ratio < 0.95)

    def test_one_block_says_nothing(self):
        assert OrdinaryLeastSquares().estimate(self.problem(1)).block_covariance is None

    def test_what_one_block_alone_determines(self):
        """Of two columns, the second differs from zero in one block: its variance is infinite."""
        rng = np.random.default_rng(0)
        blocks = []
        for k in range(5):
            w = np.column_stack([rng.normal(size=50), rng.normal(size=50) * (k == 3)])
            blocks.append(
                CompressedEquations(
                    np.linalg.qr(np.column_stack([w, rng.normal(size=50)]), mode="r")[None], np.array([50])
                )
            )
        x = np.linalg.lstsq(
            np.concatenate([b.factors[0, :, :2] for b in blocks]),
            np.concatenate([b.factors[0, :, 2] for b in blocks]),
            rcond=None,
        )[0]
        covariance = jackknife_covariance(blocks, x, np.ones(1))
        assert 0 < covariance[0, 0] < 0.1
        assert covariance[1, 1] == np.inf
        assert np.isnan(covariance[0, 1])


@pytest.mark.parametrize(
    ("case", "correlation_times"),
    [
        (Case(10, 0.0), (1000, 1e99)),
        pytest.param(Case(10, 0.1), (70, 140), marks=LONG),
        pytest.param(Case(20, 0.15, cutoff=4.0), (80, 170), marks=LONG),
        (Case(20, 0.2, white=1.5), (60, 140)),
        pytest.param(Case(40, 0.5), (45, 110), marks=LONG),
    ],
    ids=str,
)
def test_two_standard_deviations_cover_the_truth(case, correlation_times):
    """From 80 correlation times on, in 90 to 98 of 100 cases; those for white noise do not."""
    found = coverage(case, 12, (WeightedLeastSquares(),))
    assert 0.90 <= found.block["WLS"] <= 0.98
    assert correlation_times[0] < min(found.correlation_times, 1e98) < correlation_times[1]
    assert (found.white["WLS"] > 0.9) == (case.correlated == 0)


@pytest.mark.parametrize(
    "method",
    [
        GeneralizedLeastSquares(),
        ReweightedLeastSquares("huber"),
        pytest.param(OrdinaryLeastSquares(), marks=LONG),
        pytest.param(ReweightedLeastSquares("tukey"), marks=LONG),
    ],
    ids=lambda method: method.name,
)
def test_the_other_methods_cover_it_too(method):
    assert 0.88 <= coverage(Case(20, 0.1), 6, (method,)).block[method.name] <= 0.99


class TestCorrelationLength:
    def length(self, residual, cuts=(), kept=None):
        lengths = CorrelationLength(*residual.shape[1:])
        kept = np.ones(residual.shape[:2], dtype=bool) if kept is None else kept
        for part, counted in zip(np.split(residual, cuts), np.split(kept, cuts), strict=True):
            lengths.add(part, counted)
        return lengths.samples()

    def test_of_an_exponential(self):
        """AR(1) with e⁻¹ after 20 samples, beside white noise of twice its variance or not."""
        rng = np.random.default_rng(0)
        noise = correlated_noise(rng, (50_000, 1, 2), 20 / 50)
        noise[:, :, 1] += np.sqrt(2) * rng.normal(size=(50_000, 1))
        np.testing.assert_allclose(self.length(noise), [[20, 20]], rtol=0.2)

    def test_white(self):
        assert self.length(np.random.default_rng(0).normal(size=(5000, 2, 1))).tolist() == [[0], [0]]

    def test_pieces(self):
        noise = correlated_noise(np.random.default_rng(0), (4000, 2, 1), 1.0)
        assert np.array_equal(self.length(noise), self.length(noise, range(7, 4000, 131)))

    def test_long_recordings_are_thinned(self):
        """As long as ten times the cells: correlations of thousands of samples are still found."""
        size = 10 * MAX_CELLS
        noise = correlated_noise(np.random.default_rng(0), (size, 1, 1), 2000 / 50)
        np.testing.assert_allclose(self.length(noise, range(0, size, 4999)), self.length(noise), rtol=1e-3)
        np.testing.assert_allclose(self.length(noise), [[2000]], rtol=0.3)

    def test_what_does_not_count(self):
        noise = np.random.default_rng(0).normal(size=(4000, 1, 1))
        still = np.zeros((4000, 1), dtype=bool)
        still[1000:1500] = True
        standing = np.where(still[..., None], 1e3, noise)
        assert self.length(standing)[0, 0] > 100
        assert self.length(standing, kept=~still)[0, 0] == 0

    def test_nothing(self):
        assert np.isnan(self.length(np.zeros((2, 1, 1)))).all()
        assert np.isnan(self.length(np.zeros((50, 1, 1)))).all()

    def test_never_forgotten(self):
        assert self.length(np.ones((50, 1, 1)))[0, 0] == pytest.approx(49 * (1 - 1 / np.e)), "1 - k / 50 at lag k"


class TestChoice:
    def test_of_equal_strengths_the_strongest(self):
        errors = np.array([[4.0, 1.0, 2.0, 1.5], [3.0, 2.0, 1.0, 1.5]])
        assert CrossValidation((0.1, 1.0, 10.0, 100.0), errors, ()).best == 100.0
        assert CrossValidation((0.1, 1.0, 10.0, 100.0), errors + np.array([0, 0, 0, 1e-9]), ()).best == 10.0


class TestGap:
    """Columns (1, 0, 0), (≈1, 1e-3, 0), (≈1, 0, 1e-12): pivots 1, 1e-3 and 1e-12."""

    REGRESSOR = np.array([[1.0, 1.0, 1.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-12]])

    def test_of_one_matrix(self):
        assert base_parameters(self.REGRESSOR).gap == pytest.approx((1e-3, 1e-12), rel=1e-2)
        assert base_parameters(self.REGRESSOR[:, :2]).gap == pytest.approx((1e-3, 0.0), rel=1e-2)
        assert base_parameters(self.REGRESSOR, tolerance=1e-2).gap == pytest.approx((1.0, 1e-3), rel=1e-2)

    def test_of_a_recording(self):
        outer = base_parameters(np.eye(3))
        assert outer.gap == (1.0, 0.0)
        assert outer.then(base_parameters(self.REGRESSOR)).gap == pytest.approx((1e-3, 1e-12), rel=1e-2)

    def test_of_a_recording_that_determines_everything(self):
        """How clearly is up to the recording: the same motion, a tenth as large about one pose, is less clear."""
        samples = torque_data.exact_samples()
        small = Samples(*(0.1 * x for x in (samples.q, samples.v, samples.a)), samples.tau)
        gaps = [Problem(torque_data.torque_model(), motion).base.gap for motion in (samples, small)]
        structure = Problem(torque_data.torque_model(), samples).structure.base.gap
        assert gaps[1][0] < 0.01 * gaps[0][0]
        assert gaps[0][1] == gaps[1][1] == structure[1]
