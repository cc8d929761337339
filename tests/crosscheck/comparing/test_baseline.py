"""Pinocchio's regressor as the independent baseline: the same estimators, the same answers."""

import numpy as np
import pytest
from identified import torque_data

import urdf
from crosscheck.comparing.baseline import PinocchioBodies, _terms
from crosscheck.quantities.scales import term_sizes
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import BaseMotion, InvalidInput, maximal_state
from graphdyn.equations import link_origins
from graphdyn.identification import (
    EssentialParameters,
    GeneralizedLeastSquares,
    OrdinaryLeastSquares,
    Problem,
    ReweightedLeastSquares,
    Ridge,
    Samples,
    TorqueModel,
    WeightedLeastSquares,
)

SAME = 1e-10
"""Difference of two estimates in units of torque, relative to the largest; measured below 1e-12."""

ESTIMATORS = [
    OrdinaryLeastSquares(),
    WeightedLeastSquares(),
    GeneralizedLeastSquares(),
    ReweightedLeastSquares(),
    Ridge(strength=1.0),
    EssentialParameters(),
]


def both(robot, samples):
    """The same problem with our regressor and with Pinocchio's."""
    theirs = PinocchioBodies(PinocchioModel.from_model(robot))
    return [Problem(TorqueModel(robot, (bodies, *torque_data.DRIVES)), samples) for bodies in (BODIES, theirs)]


BODIES = torque_data.torque_model().terms[0]


@pytest.fixture(scope="module")
def problems():
    return both(torque_data.robot(), torque_data.noisy_samples(size=300))


@pytest.mark.parametrize("estimator", ESTIMATORS, ids=lambda estimator: estimator.name)
def test_same_answer(estimator, problems):
    here, there = problems
    x, y = (here.base.values(estimator.estimate(problem).parameters) for problem in problems)
    scale = np.linalg.norm(here.equations.factors[..., :-1], axis=(0, 1))
    assert here.base.rank == there.base.rank == torque_data.RANK
    assert np.abs((x - y) * scale).max() <= SAME * np.abs(x * scale).max()
    assert np.abs(x * scale).max() > 0


def test_lengths_of_the_terms():
    """Each of the n rows of a state has a term of the size of its column, and a torque of the size of its wrench."""
    robot, rng = torque_data.robot(), np.random.default_rng(0)
    q, v = robot.random_state(rng, 7)
    a = rng.normal(size=q.shape)
    columns, torque = _terms(robot, q, v, a)
    state = maximal_state(robot, q, v, a)
    size = term_sizes(robot, v, a, link_origins(state), state.velocity, state.acceleration)
    rows = [np.repeat(part, robot.n_bodies) for part in (*size.regressor_columns, np.maximum(size.force, size.moment))]
    mass, first_moment, tensor, wrench = np.linalg.norm(rows, axis=1)
    assert columns.reshape(-1, 10) == pytest.approx(np.tile([mass, *[first_moment] * 3, *[tensor] * 6], (6, 1)))
    assert torque == pytest.approx(wrench)


def test_another_robot():
    """Read by its own name; bodies and order are those of the torque model."""
    robot = urdf.load("ur10")
    rng = np.random.default_rng(0)
    q, v = robot.random_state(rng, 100)
    here, there = both(robot, Samples(q, v, rng.normal(size=q.shape), rng.normal(size=q.shape)))
    w, w_there = (np.concatenate([rows.matrix for rows in problem.rows()]) for problem in (here, there))
    assert np.array_equal(here.base.independent, there.base.independent)
    assert np.abs(w - w_there).max() <= 1e-12 * np.abs(w).max()


def test_moving_base():
    robot = torque_data.robot()
    exact = torque_data.exact_samples()[:2]
    samples = Samples(exact.q, exact.v, exact.a, exact.tau, BaseMotion())
    with pytest.raises(InvalidInput, match="Pinocchio's regressor has a fixed base"):
        PinocchioBodies(PinocchioModel.from_model(robot)).rows(robot, samples)
