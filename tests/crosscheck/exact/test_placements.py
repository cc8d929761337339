"""Placements of frames: what half an ulp of the constants causes."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import urdf

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

from crosscheck.exact import HALF_ULP, half_ulp_of_placements


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_what_half_an_ulp_causes(name):
    """The sum of ∣differences∣ by every entry of every constant, in the product of all placements."""
    model = urdf.load(name)
    frame = model.frames[-1]
    q = model.random_state(np.random.default_rng(4))[0]
    last = frame.body
    constants = [model.base, *(joint.placement for joint in model.joints[:last]), frame.placement]
    known = [homogeneous(x.rotation, x.translation) for x in constants]

    def product(known, q):
        vectors = [angle * joint.axis for angle, joint in zip(q, model.joints, strict=True)]
        turned = [homogeneous(Rotation.from_rotvec(vector).as_matrix(), [0] * 3) for vector in vectors]
        steps = [known[0]]
        for matrix, turn in zip(known[1:], [*turned[:last], np.eye(4)], strict=True):
            steps += [matrix, turn]
        return np.linalg.multi_dot(steps)

    expected, step = np.zeros((4, 4)), 1e-5
    for k, matrix in enumerate(known):
        for row, column in np.ndindex(3, 4):
            changed = [x.copy() for x in known]
            changed[k][row, column] += step
            size = 1 if column < 3 else np.linalg.norm(matrix[:3, 3])
            expected += size * np.abs(product(changed, q) - product(known, q)) / step
    for k, angle in enumerate(q):
        apart = product(known, q + step * np.eye(len(q))[k]) - product(known, q - step * np.eye(len(q))[k])
        expected += abs(angle) * np.abs(apart) / (2 * step)
    found = half_ulp_of_placements(model, q[None], frame.name)[0]
    np.testing.assert_allclose(found / HALF_ULP, expected, rtol=1e-7, atol=1e-7)


def homogeneous(rotation, translation):
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation, translation
    return found
