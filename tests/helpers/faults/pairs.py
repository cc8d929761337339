"""Cases of two faults at once."""

import numpy as np
from faults.case import Case
from faults.plants import after, both, scaled, unit
from faults.textbook_faults import one, shuffled

PAIRS = [
    Case(
        "gravity reversed, no gyroscopic moments",
        "ur5",
        both(lambda arm: arm.but(gravity=-arm.gravity), lambda arm: arm.but(gyroscopic=0.0)),
        ("gravity", "gyroscopic"),
    ),
    Case(
        "axis 3 reversed, mass of body 2",
        "kr210",
        both(lambda arm: one(arm, "axes", 2, np.negative), lambda arm: one(arm, "masses", 1, lambda m: 1.3 * m)),
        ("axis.*joint_3", "mass.*link_2"),
    ),
    Case(
        "gravity 9.7, center of body 2 missing",
        "kinova",
        both(lambda arm: arm.but(gravity=arm.gravity * 9.7 / 9.81), lambda arm: one(arm, "centers", 1, np.zeros_like)),
        ("gravity", "center of mass.*link_2"),
    ),
    Case(
        "viscous friction, spring on joint 2",
        "ur5",
        after(lambda tau, q, v, a: tau + 0.5 * v + unit(1, len(q), 3.0) * q),
        ("viscous", "spring.*lift"),
    ),
    Case(
        "products reversed, ω × q̇ p missing at joint 4",
        "z1",
        both(
            lambda arm: arm.but(tensors=2 * np.einsum("iaa,ab->iab", arm.tensors, np.eye(3)) - arm.tensors),
            lambda arm: arm.but(cross=1 - unit(3, 7)),
        ),
        ("products", "ω × q̇ p.*joint4"),
    ),
    Case(
        "rotors, torque of joint 2 reversed",
        "kr500",
        after(lambda tau, q, v, a: scaled(tau, 1, -1.0) + 20.0 * a),
        ("torque.*2", "diagonal|rotor"),
    ),
    Case(
        "order of joints, gravity left out",
        "ur5",
        lambda arm, m: shuffled(arm.but(gravity=0 * arm.gravity).inverse_dynamics, [0, 2, 1, 3, 4, 5]),
        ("order", "gravity"),
    ),
    Case(
        "two masses",
        "vx300s",
        both(
            lambda arm: one(arm, "masses", 1, lambda m: 1.2 * m), lambda arm: one(arm, "masses", 3, lambda m: 0.7 * m)
        ),
        ("mass.*upper_arm", "mass.*forearm_link"),
    ),
    Case(
        "single precision, gravity reversed",
        "kr210",
        lambda arm, m: arm.but(gravity=-arm.gravity).in_single_precision().inverse_dynamics,
        ("gravity.*opposite",),
    ),
]
