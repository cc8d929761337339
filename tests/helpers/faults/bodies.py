"""Cases of wrong inertial parameters and wrong geometry, body by body and joint by joint."""

import numpy as np
from faults.case import Case
from faults.plants import HALF, body_turned, both, of, reordered, tensor_entry
from faults.textbook_faults import one
from scipy.spatial.transform import Rotation

BODIES = [
    Case("I_zz of body 1", "ur5", tensor_entry(0, (2, 2), lambda x: 1.2 * x + 0.01), ("shoulder_link",)),
    Case("I_xx of body 6", "kinova", tensor_entry(5, (0, 0), lambda x: 1.3 * x), ("I_xx.*link_6",), "link_6"),
    Case(
        "mass of body 6",
        "kinova",
        of(lambda arm: one(arm, "masses", 5, lambda m: 1.1 * m)),
        ("mass.*link_6",),
        "link_6",
    ),
    Case(
        "center of mass of body 6",
        "kinova",
        of(lambda arm: one(arm, "centers", 5, lambda c: c + np.array([0, 0.01, 0.02]))),
        ("center of mass.*link_6",),
        "link_6",
    ),
    Case(
        "center of mass of body 2",
        "vx300s",
        of(lambda arm: one(arm, "centers", 1, lambda c: c + np.array([0.01, 0, 0]))),
        ("center of mass.*upper_arm",),
        "upper_arm",
    ),
    Case(
        "mass of body 2", "kr210", of(lambda arm: one(arm, "masses", 1, lambda m: m + 3.7)), ("mass.*link_2",), "link_2"
    ),
    Case(
        "mass and center of body 3",
        "ur5",
        both(
            lambda arm: one(arm, "masses", 2, lambda m: 1.31 * m),
            lambda arm: one(arm, "centers", 2, lambda c: c + np.array([0.01, 0.05, -0.02])),
        ),
        ("forearm",),
    ),
    Case(
        "tool turned by π",
        "kinova",
        body_turned(5, HALF),
        ("link_6.*(turned|180|π|axes)|(turned|180|π|axes).*link_6",),
        "link_6",
    ),
    Case(
        "tool turned by π/2",
        "ur5",
        body_turned(5, Rotation.from_euler("y", 90, degrees=True).as_matrix()),
        ("wrist_3",),
    ),
    Case(
        "tensor of body 2 in another order",
        "kr210",
        of(lambda arm: one(arm, "tensors", 1, reordered)),
        ("order.*link_2|link_2.*order",),
        "link_2",
    ),
    Case(
        "tensors in another order",
        "vx300s",
        of(lambda arm: arm.but(tensors=np.stack([reordered(x) for x in arm.tensors]))),
        ("order",),
    ),
    Case(
        "I_yy and I_zz of body 3 exchanged",
        "z1",
        of(
            lambda arm: one(
                arm,
                "tensors",
                2,
                lambda x: (
                    x[np.ix_([0, 2, 1], [0, 2, 1])] * 0 + np.diag([x[0, 0], x[2, 2], x[1, 1]]) + x - np.diag(np.diag(x))
                ),
            )
        ),
        ("exchanged.*link03|link03.*exchanged",),
        "link03",
    ),
    Case(
        "upper arm 1 cm longer",
        "ur5",
        of(lambda arm: one(arm, "translations", 2, lambda r: r + np.array([0, 0, 0.01]))),
        ("translation.*elbow|elbow.*translation",),
        "elbow",
    ),
    Case(
        "joint 4 moved",
        "kr210",
        of(lambda arm: one(arm, "translations", 3, lambda r: r + np.array([0.02, 0, -0.03]))),
        ("translation.*joint_4",),
        "joint_4",
    ),
    Case(
        "axis of joint 2 tilted",
        "z1",
        of(lambda arm: one(arm, "axes", 1, lambda p: Rotation.from_euler("x", 0.05).as_matrix() @ p)),
        ("axis.*joint2|joint2.*axis",),
        "joint2",
    ),
]
