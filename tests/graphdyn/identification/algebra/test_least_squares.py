"""Ordinary least squares: exact data, noise, conditioning, refusals."""

import numpy as np
import pytest

from graphdyn import InvalidInput
from graphdyn.identification import ordinary_least_squares

EXACT = 1e-13
"""A well-conditioned system of some tens of rows: a hundred eps."""

ROWS = 50


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture
def w(rng):
    return rng.normal(size=(ROWS, 4))


def test_recovers_parameters(w):
    x = np.array([1.0, -2.0, 0.5, 3.0])
    answer = ordinary_least_squares(w, w @ x)
    assert np.abs(answer.parameters - x).max() <= EXACT * np.abs(x).max()
    assert answer.residual_rms <= EXACT * np.abs(w @ x).max()


def test_residual_is_normal_to_the_columns(w, rng):
    """The defining property: Wᵀ (W x - τ) = 0; and the residual is what is reported."""
    torque = rng.normal(size=ROWS)
    answer = ordinary_least_squares(w, torque)
    residual = w @ answer.parameters - torque
    assert np.abs(w.T @ residual).max() <= EXACT * np.abs(w).max() * np.abs(torque).sum()
    assert answer.residual_rms == pytest.approx(np.sqrt(residual @ residual / ROWS), rel=EXACT)
    assert answer.residual_rms > 0


def test_columns_in_other_units(w):
    """Parameters in g instead of t: the scaled problem is the same."""
    units = np.array([1e-6, 1.0, 1e6, 1e3])
    x = np.array([1.0, -2.0, 0.5, 3.0])
    here, there = ordinary_least_squares(w, w @ x), ordinary_least_squares(w * units, w @ x)
    assert np.abs(there.parameters * units / x - 1).max() <= EXACT
    assert there.condition_number == pytest.approx(here.condition_number, rel=EXACT)
    assert there.column_scale == pytest.approx(here.column_scale * units, rel=EXACT)


def test_column_scale_and_condition_number():
    """Two unit columns at an angle: the singular values are sqrt(1 ± cos)."""
    angle = 0.3
    w = np.array([[3.0, np.cos(angle)], [0.0, np.sin(angle)], [0.0, 0.0]])
    answer = ordinary_least_squares(w, [1.0, 1.0, 1.0])
    assert answer.column_scale == pytest.approx([3.0, 1.0], rel=EXACT)
    expected = np.sqrt((1 + np.cos(angle)) / (1 - np.cos(angle)))
    assert answer.condition_number == pytest.approx(expected, rel=EXACT)


def test_better_than_normal_equations(rng):
    """A condition number of 1e7: squared it would leave no digit, as it is it leaves eight."""
    common = rng.normal(size=ROWS)
    w = np.column_stack([common, common + 1e-7 * rng.normal(size=ROWS)])
    x = np.array([1.0, 2.0])
    answer = ordinary_least_squares(w, w @ x)
    assert answer.condition_number > 1e6
    assert np.abs(answer.parameters - x).max() <= EXACT * answer.condition_number


def test_order_of_the_rows_does_not_matter(w, rng):
    torque, order = rng.normal(size=ROWS), rng.permutation(ROWS)
    here, there = ordinary_least_squares(w, torque), ordinary_least_squares(w[order], torque[order])
    assert np.abs(here.parameters - there.parameters).max() <= EXACT * np.abs(here.parameters).max()


def test_as_many_rows_as_columns(w):
    x = np.array([1.0, -2.0, 0.5, 3.0])
    answer = ordinary_least_squares(w[:4], w[:4] @ x)
    assert np.abs(answer.parameters - x).max() <= EXACT * answer.condition_number * np.abs(x).max()


def test_no_columns():
    """Nothing to identify: the residual is the torque."""
    answer = ordinary_least_squares(np.zeros((3, 0)), [3.0, 0.0, -3.0])
    assert answer.parameters.shape == (0,)
    assert answer.residual_rms == pytest.approx(np.sqrt(6.0), rel=EXACT)
    assert answer.condition_number == 1


class TestRefusals:
    @pytest.mark.parametrize(
        ("regressor", "torque"), [(np.ones(3), np.ones(3)), (np.ones((3, 1)), np.ones(2)), (np.eye(3), np.eye(3))]
    )
    def test_shapes(self, regressor, torque):
        with pytest.raises(InvalidInput) as caught:
            ordinary_least_squares(regressor, torque)
        message = str(caught.value)
        assert f"regressor has shape {regressor.shape}, torque {torque.shape}" in message
        assert "expected (rows, b) and (rows,)" in message

    def test_zero_column(self, w):
        w[:, 2] = 0
        with pytest.raises(InvalidInput, match="column 2 of the regressor is zero; keep independent columns only"):
            ordinary_least_squares(w, np.ones(ROWS))

    def test_dependent_columns(self, w):
        w[:, 3] = w[:, 0] - 2 * w[:, 1]
        with pytest.raises(InvalidInput, match="rank 3 of 4 columns; keep independent columns only"):
            ordinary_least_squares(w, np.ones(ROWS))

    def test_fewer_rows_than_columns(self, w):
        with pytest.raises(InvalidInput, match="rank 2 of 4 columns"):
            ordinary_least_squares(w[:2], np.ones(2))

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_not_finite(self, w, value):
        torque = np.ones(ROWS)
        torque[7] = value
        with pytest.raises(InvalidInput):
            ordinary_least_squares(w, torque)
        w[3, 1] = value
        with pytest.raises(InvalidInput):
            ordinary_least_squares(w, np.ones(ROWS))
