"""Every estimator: exact data give the exact answer, noise the stated standard deviations."""

import numpy as np
import pytest
import torque_data

from graphdyn.identification import OrdinaryLeastSquares, WeightedLeastSquares

EXACT = 1e-8
"""Relative error of every base parameter from data without noise."""

ESTIMATORS = [OrdinaryLeastSquares(), WeightedLeastSquares()]


@pytest.fixture(params=ESTIMATORS, ids=lambda estimator: estimator.name)
def estimator(request):
    return request.param


def test_exact_data(estimator):
    problem = torque_data.exact_problem()
    true = problem.base.values(torque_data.true_parameters())
    estimate = estimator.estimate(problem)
    assert problem.base.rank == torque_data.RANK
    assert np.abs(problem.base.values(estimate.parameters) / true - 1).max() <= EXACT


def test_says_what_it_is(estimator):
    assert all(len(text) > 2 for text in (estimator.name, estimator.reference, estimator.assumptions, estimator.needs))
