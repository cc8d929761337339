"""Left and right links that are mirror images, and those that are not."""

import numpy as np
import pytest
from inspected.sample import changed
from urdf_text import joint, link

import urdf
from urdf.document.numbers import rotation_from_rpy

TURN = rotation_from_rpy(0.5, 0.3, -0.2)
TENSOR = TURN @ np.diag([0.02, 0.05, 0.06]) @ TURN.T
CENTER = np.array([0.1, -0.04, 0.2])
MIRROR = np.diag([1.0, -1.0, 1.0])


def told(center, tensor):
    """What is said of a left hand beside the right one."""
    parts = []
    for side, place, moments in (("left", CENTER, TENSOR), ("right", center, tensor)):
        xyz, entries = (" ".join(repr(float(x)) for x in each) for each in (place, moments[np.triu_indices(3)]))
        parts += [link(f"{side}_hand", 1.5, xyz=xyz, tensor=entries), joint(side, "fore", f"{side}_hand")]
    report = urdf.inspect(changed("</robot>", f"{''.join(parts)}</robot>"))
    return [one.message for one in report.findings if one.code == "unlike-twin"]


@pytest.mark.parametrize(
    "axes",
    [np.eye(3), MIRROR, np.diag([-1.0, -1.0, 1.0]), np.eye(3)[[2, 0, 1]], MIRROR[[1, 0, 2]]],
    ids=["copied", "mirrored", "turned", "axes exchanged", "both"],
)
def test_mirror_images(axes):
    assert told(axes @ CENTER, axes @ TENSOR @ axes.T) == []
    assert told(1.001 * axes @ CENTER, axes @ TENSOR @ axes.T) == []


def test_a_tensor_that_is_not_mirrored():
    apart = np.linalg.norm(MIRROR @ TENSOR @ MIRROR - TENSOR) / np.trace(TENSOR)
    assert told(MIRROR @ CENTER, TENSOR) == [
        "no mirror image of 'right_hand': masses, moments and centers of mass are alike, and the tensors differ by "
        f"{100 * apart:.2g} %"
    ]


def test_a_center_elsewhere():
    center = CENTER + np.array([0, 0, 0.03])
    assert told(MIRROR @ center, MIRROR @ TENSOR @ MIRROR) == [
        "no mirror image of 'right_hand': the center of mass lies 0.03 m beside that of any"
    ]
