"""Rounded angles: parameters that only they show are named and left out."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

import graphdyn
from graphdyn.identification import Problem, Samples, TorqueModel, WeightedLeastSquares, compare_methods
from graphdyn.identification.problem.exact_angles import MAX_ANGLE_ROUNDING, with_exact_angles
from graphdyn.identification.problem.torque_model import structure
from graphdyn.identification.terms import RigidBodies, RotorInertia
from graphdyn.model import rotation_about

TERMS = (RigidBodies(), RotorInertia())
"""Rotors show what links alone do not: each has a column of its own beside those of the moments about parallel axes."""

ROUNDED = {"1.5708": 1.5708 - np.pi / 2, "1.571": 1.571 - np.pi / 2, "3.14": np.pi - 3.14}


def tilted(model, angle, joint=1, way=(0.0, 0.0, 1.0)):
    """The same robot, with one joint turned in its parent's link by a small angle."""
    joints = list(model.joints)
    placement = joints[joint].placement
    turned = rotation_about(np.array(way), angle) @ placement.rotation
    joints[joint] = replace(joints[joint], placement=replace(placement, rotation=turned))
    return replace(model, joints=tuple(joints))


def axes_at_zero(model):
    """World axes of the joints at q = 0, by products of rotations."""
    rotations = [np.eye(3)]
    for joint in model.joints:
        rotations.append(rotations[joint.inside] @ joint.placement.rotation)
    return [rotation @ joint.axis for rotation, joint in zip(rotations[1:], model.joints, strict=True)]


@pytest.fixture(scope="module")
def exact():
    return graphdyn.kr500()


def samples(model, n=400, noise=0.0):
    rng = np.random.default_rng(0)
    q, v = model.random_state(rng, n)
    a = rng.uniform(-3, 3, q.shape)
    tau = graphdyn.joint_torques(model, q, v, a) + 100 * a
    return Samples(q, v, a, tau + noise * rng.normal(size=q.shape))


@pytest.mark.parametrize("angle", ROUNDED.values(), ids=ROUNDED)
def test_rank_of_the_exact_robot(exact, angle):
    rounded = tilted(exact, angle)
    as_given = structure(TorqueModel(rounded, TERMS, exact_angles=False))
    found, wanted = (structure(TorqueModel(model, TERMS)) for model in (rounded, exact))
    assert as_given.base.rank > wanted.base.rank
    assert as_given.nearly_undetermined.size == wanted.nearly_undetermined.size == 0
    assert found.base.rank == wanted.base.rank
    assert len(found.nearly_undetermined) == as_given.base.rank - wanted.base.rank
    assert not set(found.nearly_undetermined) & set(found.base.independent)


def test_noise_does_not_become_parameters(exact):
    """As large as one likes: with the rounding the largest deviation is a thousand times as large, or more."""
    rounded = tilted(exact, ROUNDED["1.5708"])
    largest = {}
    for keep in (True, False):
        problem = Problem(TorqueModel(rounded, TERMS, exact_angles=keep), samples(rounded, noise=1.0))
        found = compare_methods(problem, [WeightedLeastSquares()], poses=1)
        result = found.of("WLS")
        largest[keep] = result.standard_deviations.max()
        names = found.nearly_undetermined
        assert (len(names) > 0) == keep
        assert set(names) <= set(found.names)
        assert result.training.everything.relative.max() < 0.01
    assert largest[False] > 1000 * largest[True]


def test_axes_become_parallel_or_perpendicular(exact):
    rng = np.random.default_rng(1)
    wanted, rounded = axes_at_zero(exact), exact
    for joint in range(6):
        rounded = tilted(rounded, rng.uniform(0.2, 0.7) * MAX_ANGLE_ROUNDING, joint, _unit(rng))
    found = axes_at_zero(with_exact_angles(rounded))
    for one, other in pairwise(found):
        assert min(abs(one @ other), np.linalg.norm(np.cross(one, other))) < 1e-14
    assert_allclose(found, wanted, atol=6 * MAX_ANGLE_ROUNDING)
    for joint in with_exact_angles(rounded).joints:
        assert_allclose(joint.placement.rotation @ joint.placement.rotation.T, np.eye(3), atol=1e-15)


def _unit(rng):
    way = rng.normal(size=3)
    return way / np.linalg.norm(way)


def test_the_ground_and_gravity_count_too(exact):
    """A first axis along gravity, on a base that is turned anyhow."""
    turn = Rotation.from_euler("xyz", (0.3, -0.7, 0.2)).as_matrix()
    base = replace(exact.base, rotation=turn)
    mounted = tilted(exact.with_base(base).with_gravity(turn @ exact.gravity), 1e-5, joint=0, way=(0.6, 0.8, 0.0))
    (first, *_) = axes_at_zero(with_exact_angles(mounted))
    assert np.linalg.norm(np.cross(turn @ first, mounted.gravity)) < 1e-13
    assert axes_at_zero(with_exact_angles(mounted.with_gravity((0, 0, 0))))[0] @ first < 1


@pytest.mark.parametrize("angle", [0.0, 1e-14, 1.01 * MAX_ANGLE_ROUNDING, 0.3])
def test_exact_and_oblique_axes_stay(exact, angle):
    model = tilted(exact, angle)
    assert with_exact_angles(model) is model
