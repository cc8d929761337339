"""The accumulator: the same answer as dense QR, however the rows arrive."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from graphdyn import InvalidInput
from graphdyn.identification import Accumulator
from graphdyn.identification.algebra.compressed import solve

EPS = np.finfo(float).eps

QR_ERROR = 30 * EPS
"""Relative error of the solution, in units of the condition number; measured 0.01 to 3 eps (dense QR the same)."""

GRAM_ERROR = 30 * EPS
"""The same in units of its square; measured 0.004 to 4 eps."""

ROWS, GROUPS, COLUMNS = 700, 3, 8


def equations(condition=1.0, rows=ROWS, seed=0):
    """W (N, g, p) with singular values from 1 to 1 / condition, and the right side of known parameters."""
    rng = np.random.default_rng(seed)
    u, _ = np.linalg.qr(rng.normal(size=(rows * GROUPS, COLUMNS)))
    v, _ = np.linalg.qr(rng.normal(size=(COLUMNS, COLUMNS)))
    w = (u * np.geomspace(1.0, 1.0 / condition, COLUMNS)) @ v.T
    x = v @ np.ones(COLUMNS)
    return w.reshape(rows, GROUPS, COLUMNS), (w @ x).reshape(rows, GROUPS), x


def accumulated(w, right, sizes=(ROWS,), **options):
    accumulator = Accumulator(COLUMNS, GROUPS, **options)
    start = 0
    for size in sizes:
        accumulator.add(w[start : start + size], right[start : start + size])
        start += size
    assert start == len(right)
    return accumulator


def solution(accumulator):
    """Unit column scaling, as everywhere."""
    r, z = accumulator.compressed.weighted(np.ones(GROUPS))
    scale = np.linalg.norm(r, axis=0)
    return np.linalg.lstsq(r / scale, z, rcond=0)[0] / scale


def products(accumulator):
    """FᵀF, which both methods give to rounding; the factor of a Gram matrix itself is good to the root of eps."""
    return np.swapaxes(accumulator.factors, 1, 2) @ accumulator.factors


def relative(x, reference):
    return np.linalg.norm(x - reference) / np.linalg.norm(reference)


class TestAccuracy:
    @pytest.mark.parametrize("condition", [1.0, 1e2, 1e5, 1e9])
    def test_qr(self, condition):
        w, right, x = equations(condition)
        dense = np.linalg.lstsq(w.reshape(-1, COLUMNS), right.reshape(-1), rcond=0)[0]
        found = solution(accumulated(w, right, [100] * 7))
        assert relative(found, x) <= QR_ERROR * condition
        assert relative(found, dense) <= 2 * QR_ERROR * condition

    @pytest.mark.parametrize("condition", [1.0, 1e2, 1e5])
    def test_gram(self, condition):
        w, right, x = equations(condition)
        assert relative(solution(accumulated(w, right, [100] * 7, method="gram")), x) <= GRAM_ERROR * condition**2

    def test_gram_loses_what_qr_keeps(self):
        """A condition number of 1e7, squared, is near the end of double precision."""
        w, right, x = equations(1e7)
        qr, gram = (relative(solution(accumulated(w, right, method=method)), x) for method in ("qr", "gram"))
        assert qr <= QR_ERROR * 1e7
        assert gram > 1e3 * qr

    @pytest.mark.parametrize("method", ["qr", "gram"])
    def test_factors_keep_lengths(self, method):
        """‖F_g [x; -1]‖ = ‖W_g x - τ_g‖ for any x; the diagonal is not negative."""
        w, right, _ = equations()
        accumulator = accumulated(w, right, method=method)
        x = np.random.default_rng(1).normal(size=COLUMNS)
        expected = np.sum((w @ x - right) ** 2, axis=0)
        assert accumulator.compressed.residual_squares(x) == pytest.approx(expected, rel=1e-12)
        assert np.array_equal(accumulator.factors, np.triu(accumulator.factors))
        assert np.all(np.diagonal(accumulator.factors, axis1=1, axis2=2) >= 0)
        assert list(accumulator.counts) == [ROWS] * GROUPS


class TestOrder:
    def test_same_blocks_same_bits(self):
        w, right, _ = equations()
        here, there = (accumulated(w, right, [300, 400]).factors for _ in range(2))
        assert np.array_equal(here, there)

    @pytest.mark.parametrize(
        "sizes", [[1] * ROWS, [7] * 100, [3, 697], [0, 700]], ids=["ones", "sevens", "two", "empty"]
    )
    def test_other_blocks_differ_by_rounding(self, sizes):
        w, right, _ = equations(1e3)
        whole, cut = accumulated(w, right).factors, accumulated(w, right, sizes).factors
        assert np.abs(whole - cut).max() <= 100 * EPS * np.linalg.norm(whole)

    @pytest.mark.parametrize("method", ["qr", "gram"])
    def test_merging_is_associative(self, method):
        w, right, _ = equations(1e3)
        a, b, c = (
            accumulated(w[k], right[k], [len(right[k])], method=method)
            for k in (slice(0, 100), slice(100, 350), slice(350, ROWS))
        )
        left, other = a.merge(b).merge(c), a.merge(b.merge(c))
        whole = accumulated(w, right, method=method)
        size = np.linalg.norm(products(whole))
        assert np.abs(products(left) - products(other)).max() <= 100 * EPS * size
        assert np.abs(products(left) - products(whole)).max() <= 100 * EPS * size
        assert list(left.counts) == list(whole.counts) == [ROWS] * GROUPS
        assert list(a.counts) == [100] * GROUPS  # the parts are as before


class TestCompressed:
    """What the factors say, against the rows themselves."""

    def told(self):
        """Equations with noise and prior knowledge; their rows [W τ] / σ (N, g, p + 1); σ (g,); further rows."""
        w, right, _ = equations()
        rng = np.random.default_rng(3)
        right = right + rng.normal(size=right.shape) * [0.1, 1.0, 3.0]
        expected, sigma = rng.normal(size=(5, COLUMNS + 1)), np.array([0.5, 2.0, 7.0])
        told = replace(accumulated(w, right).compressed, expected=expected)
        return told, np.concatenate([w, right[..., None]], axis=-1) / sigma[:, None], sigma, expected

    def test_sums_of_the_rows(self):
        """[R z]ᵀ[R z] of the weighted rows, and with the rows of prior knowledge, which have weights of their own."""
        told, rows, sigma, expected = self.told()
        for found, further in ((told.weighted(sigma), expected[:0]), (told.informed(sigma), expected)):
            every = np.concatenate([rows.reshape(-1, COLUMNS + 1), further])
            whole = np.column_stack(found)
            np.testing.assert_allclose(whole.T @ whole, every.T @ every, rtol=0, atol=1e-12 * np.sum(every**2))

    def test_solution_of_the_rows(self):
        """By SciPy, with the inverse of the normal matrix, and with some columns only."""
        told, rows, sigma, expected = self.told()
        for columns in (np.arange(COLUMNS), np.array([6, 1, 3])):
            chosen = told.selected(columns)
            found = solve(chosen, sigma)
            every = np.concatenate([rows.reshape(-1, COLUMNS + 1), expected])
            w, right = every[:, columns], every[:, -1]
            assert found.x == pytest.approx(scipy.linalg.lstsq(w, right)[0], rel=1e-10)
            assert found.inverse == pytest.approx(np.linalg.inv(w.T @ w), rel=1e-10)
            assert found.condition_number == pytest.approx(np.linalg.cond(w / np.linalg.norm(w, axis=0)))
            left = rows[..., columns] @ found.x - rows[..., -1]
            squares = np.sum(left**2, axis=0) * sigma**2
            assert chosen.residual_squares(found.x) == pytest.approx(squares)

    def test_the_unit_regressor_weighs_groups_by_their_torques(self):
        told, rows, sigma, _ = self.told()
        size = np.sqrt(np.mean((rows[..., -1] * sigma) ** 2, axis=0))
        w = (rows[..., :-1] * (sigma / size)[:, None]).reshape(-1, COLUMNS)
        unit = w / np.linalg.norm(w, axis=0)
        assert told.unit_regressor.T @ told.unit_regressor == pytest.approx(unit.T @ unit, abs=1e-12)
        assert told.measured_squares == pytest.approx(ROWS * size**2)


class TestOptions:
    def test_left_out_and_weighted_equations(self):
        w, right, _ = equations()
        rng = np.random.default_rng(2)
        kept, weights = rng.random(right.shape) < 0.6, rng.uniform(0.1, 2.0, right.shape)
        accumulator = Accumulator(COLUMNS, GROUPS)
        accumulator.add(w, right, kept=kept, weights=weights)
        for g in range(GROUPS):
            k = kept[:, g]
            block = np.column_stack([w[k, g], right[k, g]]) * weights[k, g, None]
            factor = accumulator.factors[g]
            assert factor.T @ factor == pytest.approx(block.T @ block, abs=1e-12)
        assert list(accumulator.counts) == list(kept.sum(axis=0))

    def test_columns_outside_the_support_are_not_read(self):
        w, right, _ = equations()
        support = np.ones((GROUPS, COLUMNS), dtype=bool)
        support[2, :5] = False
        w[:, 2, :5] = 0.0
        whole, fewer = products(accumulated(w, right)), products(accumulated(w, right, support=support))
        assert np.abs(whole - fewer).max() <= 100 * EPS * np.linalg.norm(whole)
        accumulator = Accumulator(COLUMNS, GROUPS, support=support)
        w[:, 2, :5] = np.nan
        accumulator.add(w, right)
        assert np.array_equal(products(accumulator), fewer)

    def test_memory_does_not_grow(self):
        """A hundred times the rows, the same memory."""

        def peak(blocks):
            accumulator = Accumulator(COLUMNS, GROUPS)
            w, right, _ = equations(rows=200)
            accumulator.add(w, right)
            tracemalloc.start()
            for _ in range(blocks):
                accumulator.add(w, right)
            size = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            return size

        assert peak(200) < 1.5 * peak(2)


class TestRefusals:
    def test_method(self):
        with pytest.raises(InvalidInput, match="method is 'cholesky'; use one of qr, gram"):
            Accumulator(3, 2, method="cholesky")

    def test_support(self):
        with pytest.raises(InvalidInput, match=r"support has shape \(3,\), expected \(2, 3\)"):
            Accumulator(3, 2, support=[True, True, True])

    @pytest.mark.parametrize("name", ["rows", "kept", "weights"])
    def test_shapes(self, name):
        arguments = {"rows": np.ones((5, 2, 3)), "kept": None, "weights": None} | {name: np.ones((5, 1))}
        with pytest.raises(InvalidInput, match=rf"{name} has shape \(5, 1\), expected \(5, 2"):
            Accumulator(3, 2).add(right=np.ones((5, 2)), **arguments)

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_not_finite(self, value):
        """And the factors are as before."""
        w, right, _ = equations()
        accumulator = accumulated(w, right)
        before = accumulator.factors
        w[7, 1, 2] = value
        with pytest.raises(InvalidInput, match="group 1: NaN or infinity in row 7 of the block; leave the sample out"):
            accumulator.add(w, right)
        assert np.array_equal(accumulator.factors, before)
        assert list(accumulator.counts) == [ROWS] * GROUPS

    def test_merging_others(self):
        with pytest.raises(InvalidInput, match=r"accumulators of 2 × 3 \(qr\) and 2 × 4 \(qr\) columns"):
            Accumulator(3, 2).merge(Accumulator(4, 2))
        with pytest.raises(InvalidInput, match=r"2 × 3 \(qr\) and 2 × 3 \(gram\)"):
            Accumulator(3, 2).merge(Accumulator(3, 2, method="gram"))
