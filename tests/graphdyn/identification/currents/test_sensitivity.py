"""What gains add to the deviations of base parameters, against solutions with other gains."""

import dataclasses

import numpy as np
import pytest
from identified.loaded_arm import LoadedArm, robot

from graphdyn.identification import Problem
from graphdyn.identification.algebra.compressed import solve, weighted_solution
from graphdyn.identification.currents import JointGains, gain_deviations


@pytest.fixture(scope="module")
def equations():
    rng = np.random.default_rng(0)
    arm = LoadedArm.of(robot(), rng)
    motion = arm.motion(rng, 10.0)
    noisy = dataclasses.replace(motion, tau=motion.tau + rng.normal(size=motion.tau.shape))
    return Problem(arm.torque_model, noisy).equations


def test_a_common_factor_is_one_of_all_parameters(equations):
    x = weighted_solution(equations)[0].x
    found = gain_deviations(equations, JointGains(np.ones(6), np.full((6, 6), 0.03**2)))
    np.testing.assert_allclose(found, 0.03 * np.abs(x), rtol=1e-6, atol=1e-9 * np.abs(x).max())


def test_one_gain_against_a_solution_with_another(equations):
    """The torques of one joint larger by 10 %, with the same weights."""
    solution, noise = weighted_solution(equations)
    factors = equations.factors.copy()
    factors[2, :, -1] *= 1.1
    other = solve(dataclasses.replace(equations, factors=factors), noise)
    covariance = np.zeros((6, 6))
    covariance[2, 2] = 0.1**2
    found = gain_deviations(equations, JointGains(np.ones(6), covariance))
    change = np.abs(other.x - solution.x)
    np.testing.assert_allclose(found, change, rtol=1e-6, atol=1e-9 * change.max())


def test_an_undetermined_gain_leaves_nothing_determined(equations):
    gains = JointGains(np.where(np.arange(6) == 5, np.nan, 1.0), np.diag([0.1] * 5 + [np.inf]))
    assert np.isinf(gain_deviations(equations, gains)).all()
