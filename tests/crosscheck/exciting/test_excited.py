"""What an exciting motion is compared with: random motions, one after the other, and recordings."""

from types import SimpleNamespace

import numpy as np
from planting import mixed_tree

from crosscheck.exciting.excited import random_plans, recorded_information
from graphdyn.excitation import (
    ExcitationProblem,
    FourierBasis,
    JointMotion,
    MotionLimits,
    log_det,
    random_trajectory,
)
from graphdyn.identification import Samples, TorqueModel
from graphdyn.identification.problem.torque_model import structure
from graphdyn.identification.terms import RigidBodies, Viscous

ROUNDING = 1e-9


def problem_of():
    model = mixed_tree()
    limits = MotionLimits.of_model(model, lower=-2.0, upper=2.0, velocity=2.0)
    noise = np.array([0.5, 2.0, 0.1])
    return ExcitationProblem(TorqueModel(model, (RigidBodies(), Viscous())), limits, FourierBasis(3.0, 2), noise, 50.0)


def test_random_motions_know_those_before_them():
    """The best of three beside the best before it, and beside the median before it the median."""
    problem, known = problem_of(), {0: 0.0, 1: 0.0}
    model = problem.torque_model.model
    for number in range(2):
        rng = np.random.default_rng([number, 2])
        courses = [random_trajectory(model, problem.limits, (), problem.basis, rng) for _ in range(3)]
        alone = [problem.total_information(course) for course in courses]
        for place, before in known.items():
            totals = sorted((before + information for information in alone), key=lambda total: log_det(total)[0])
            known[place] = totals[place]
    best, median = random_plans(problem, 2, 3, None)
    np.testing.assert_allclose(best.information, known[0], rtol=ROUNDING, atol=ROUNDING * known[0].max())
    np.testing.assert_allclose(median.information, known[1], rtol=ROUNDING, atol=ROUNDING * known[1].max())


def test_information_of_recordings_is_the_sum_over_their_rows():
    """By the regressor of the torque model, each joint's rows divided by its noise."""
    problem, rng = problem_of(), np.random.default_rng(0)
    parts = [dict(zip("qva", rng.normal(size=(3, rows, 3)), strict=True)) for rows in (1500, 7)]
    found, rows = recorded_information(problem, [SimpleNamespace(channel=part.get) for part in parts])
    q, v, a = (np.concatenate([part[name] for part in parts]) for name in "qva")
    independent = structure(problem.torque_model).base.independent
    w = problem.torque_model.rows(Samples(q, v, a, np.zeros_like(q)), independent) / problem.noise[:, None]
    expected = np.einsum("tjk,tjl->kl", w, w)
    assert rows == 1507
    twice = problem.information.matrix(JointMotion(q, v, a, 0 * q), 3014.0)
    np.testing.assert_allclose(twice, 2 * expected, rtol=ROUNDING, atol=ROUNDING * expected.max())
    np.testing.assert_allclose(found, expected, rtol=ROUNDING, atol=ROUNDING * expected.max())
