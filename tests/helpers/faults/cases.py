"""Faults planted in the textbook recursion, on six robots, and what a diagnosis has to say: the table `CASES`."""

import numpy as np
from faults.bodies import BODIES
from faults.case import Case
from faults.files import FILE_PLANTS
from faults.pairs import PAIRS
from faults.plants import (
    after,
    before,
    clipped,
    coupled,
    coupled_rotors,
    equality,
    factors,
    limit_spring,
    mixed_signs,
    of,
    regressor,
    rounded_rpy,
    scaled,
    scatter,
    stale,
    stribeck,
    triangle,
    unit,
)
from faults.textbook_faults import PLANTS, one

WORDS = {
    "gravity": "gravity",
    "coriolis": "velocity terms|ω",
    "sign": "opposite sign|other way|other side",
    "joint_order": "order",
    "frame": "rotation|rpy|translation|axis|axes",
    "inertia_point": "tensor",
    "unit": "degrees|1e|milli",
    "continuous_joint": "angle",
    "friction": "friction",
    "rotor_inertia": "diagonal|rotor",
    "inertial_parameters": "mass|inertial|tensor|exchanged",
}
"""Of the documented kinds: what their messages say."""

ON = {
    "gravity": ("ur5", "kr500", "kinova", "z1"),
    "coriolis": ("kr210", "vx300s", "ur5", "kr500", "z1"),
    "sign": ("kinova", "z1", "kr210", "vx300s", "ur5"),
    "joint_order": ("kr500", "kinova", "ur5", "kr210"),
    "frame": ("kr210", "kr210", "kinova", "kinova", "kinova"),
    "inertia_point": ("ur5", "kr210", "z1"),
    "unit": ("kinova", "kr500", "ur5", "z1", "kr210", "vx300s"),
    "continuous_joint": ("kr500", "kr500", "ur5"),
    "friction": ("z1", "ur5", "vx300s"),
    "rotor_inertia": ("kinova",),
    "inertial_parameters": ("kr210", "z1", "ur5", "kinova"),
}
"""The robots of the documented variants, in their order."""

DOCUMENTED = [
    Case(variant, robot, plant, (WORDS[kind],))
    for kind, robots in ON.items()
    for robot, (variant, plant) in zip(robots, PLANTS[kind].items(), strict=True)
]

TERMS = [
    Case("weight of body 3 left out", "ur5", factors("weight", 2, 0), ("gravity.*forearm",)),
    Case("weight of body 2 twice", "kr210", factors("weight", 1, 2), ("gravity.*link_2",)),
    Case("no gyroscopic moment of body 3", "kinova", factors("gyroscopic", 2, 0), ("ω × I ω.*link_3",)),
    Case("no gyroscopic moment of body 5", "kr500", factors("gyroscopic", 4, 0), ("ω × I ω.*5",)),
    Case("inside body's ω missing at joint 3", "ur5", factors("carried", 2, 0), ("elbow",)),
    Case("no ω × q̇ p at joint 4", "kr210", factors("cross", 3, 0), ("ω × q̇ p.*joint_4",)),
    Case("ω × q̇ p reversed at joint 5", "z1", factors("cross", 4, -1), ("ω × q̇ p.*joint5",)),
    Case("no ω × (ω × r) at joint 3", "ur5", factors("centripetal", 2, 0), ("ω × \\(ω × r\\).*(elbow|forearm)",)),
    Case("a ignored", "kinova", before(lambda q, v, a: (q, v, 0 * a)), ("acceleration|takes no a\\b",)),
    Case("v and a exchanged", "ur5", before(lambda q, v, a: (q, a, v)), ("exchanged",)),
    Case("kinematics of the call before", "z1", stale, ("calls? before|earlier|repeat|keeps|kept",)),
]

SIGNS = [
    Case("position alone reversed", "vx300s", lambda arm, m: mixed_signs(arm, m, s_q=-1), ("position.*shoulder",)),
    Case(
        "s·ID(q, s v, s a)",
        "z1",
        lambda arm, m: mixed_signs(arm, m, s_v=-1, s_a=-1, s_tau=-1),
        ("velocit.*joint2",),
    ),
    Case(
        "s·ID(q, s v, s a) at three joints",
        "kr210",
        lambda arm, m: mixed_signs(arm, m, s_v=-1, s_a=-1, s_tau=-1, joints=(0, 3, 5)),
        ("velocit.*joint_1.*joint_4.*joint_6",),
    ),
    Case("velocity reversed", "kr500", lambda arm, m: mixed_signs(arm, m, s_v=-1), ("velocit",)),
    Case(
        "products of inertia of body 2 reversed",
        "kr210",
        lambda arm, m: PLANTS["sign"]["products of inertia"](one(arm, "tensors", 1, np.array), m),
        ("products of inertia",),
    ),
]

ANGLES = [
    Case(
        "zero of joint 3 off by 0.1",
        "ur5",
        before(lambda q, v, a: (q + unit(2, len(q), 0.1), v, a)),
        ("zero.*elbow.*0\\.1|0\\.1.*elbow",),
    ),
    Case(
        "zero of joint 2 off by π/2",
        "kr210",
        before(lambda q, v, a: (q - unit(1, len(q), np.pi / 2), v, a)),
        ("joint_2",),
    ),
    Case(
        "joint 4 in degrees",
        "kinova",
        before(lambda q, v, a: tuple(scaled(x, 3, np.pi / 180) for x in (q, v, a))),
        ("joint_4.*degrees",),
    ),
    Case(
        "finger in millimeters",
        "vx300s",
        before(lambda q, v, a: tuple(scaled(x, 7, 1e-3) for x in (q, v, a))),
        ("finger.*milli",),
    ),
    Case("joint 3 turns with joint 2", "kr210", coupled(2, 1, torques=True), ("joint_3.*joint_2|joint_2.*joint_3",)),
    Case(
        "joint 3 turns with joint 2, not the torques", "ur5", coupled(2, 1, torques=False), ("elbow.*lift|lift.*elbow",)
    ),
    Case("rpy 1.57 for π/2", "kr210", of(rounded_rpy), ("1\\.57|rounded",)),
    Case("rpy 1.57 for π/2", "ur5", of(rounded_rpy), ("1\\.57|rounded",)),
]

GEARS = [
    Case("gear of 101 on joint 2", "z1", after(lambda tau, q, v, a: scaled(tau, 1, 1 / 101)), ("torque.*joint2",)),
    Case("torque of joint 5 doubled", "kr500", after(lambda tau, q, v, a: scaled(tau, 4, 2.0)), ("torque.*5",)),
    Case(
        "offset of all torques",
        "ur5",
        after(lambda tau, q, v, a: tau + np.arange(1, len(tau) + 1)),
        ("constant|offset",),
    ),
    Case(
        "offset of one torque",
        "kr210",
        after(lambda tau, q, v, a: tau + unit(1, len(tau), 30.0)),
        ("(constant|offset).*joint_2|joint_2.*(constant|offset)",),
    ),
    Case(
        "spring on joint 2",
        "kr210",
        after(lambda tau, q, v, a: tau + unit(1, len(tau), 500.0) * q),
        ("spring.*joint_2",),
    ),
    Case(
        "spring on joint 3",
        "ur5",
        after(lambda tau, q, v, a: tau + unit(2, len(tau), 3.0) * (q - 0.2)),
        ("spring.*elbow",),
    ),
    Case("tanh friction", "ur5", after(lambda tau, q, v, a: tau + 3.0 * np.tanh(v / 0.1)), ("tanh",)),
    Case(
        "Stribeck friction", "kinova", after(lambda tau, q, v, a: tau + stribeck(v)), ("Stribeck",), "friction|velocity"
    ),
    Case("friction of 0.5", "kr210", after(lambda tau, q, v, a: tau + 0.5 * v), ("viscous",)),
    Case(
        "rotors coupled", "kr500", after(lambda tau, q, v, a: tau + coupled_rotors(len(a)) @ a), ("mass matrix|rotor",)
    ),
    Case(
        "constant added to M",
        "ur5",
        after(lambda tau, q, v, a: tau + coupled_rotors(len(a)) @ a),
        ("mass matrix|rotor",),
    ),
    Case("torque clipped at a quarter of the effort limit", "ur5", clipped, ("clipped|limit",)),
    Case("contact at the limits", "ur5", limit_spring, ("limit",), "only torques of|only where|position of joint"),
    Case("fingers held together", "vx300s", equality(7, 8), ("finger",), "finger|direction"),
    Case("M in one triangle", "kinova", triangle, ("triangle",), function="mass_matrix"),
]

PRECISION = [
    Case(
        "single precision",
        "ur5",
        lambda arm, m: lambda q, v, a: arm.in_single_precision().inverse_dynamics(q, v, a),
        ("single precision",),
    ),
    Case("scatter of 1e-4", "kr210", scatter(1e-4), ("scatter|repeat|noise",)),
    Case("scatter of 1e-7", "kinova", scatter(1e-7), ("scatter|repeat|noise",)),
]

COLUMNS = [
    Case(
        "columns by type",
        "ur5",
        regressor(lambda w: np.swapaxes(w, 1, 2)),
        ("by type|grouped",),
        function="joint_torque_regressor",
    ),
    Case(
        "bodies reversed",
        "kr210",
        regressor(lambda w: w[:, ::-1]),
        ("bodies.*order|order.*bodies|reversed",),
        function="joint_torque_regressor",
    ),
]

FILES = [Case(name, robot, plant, named, located, from_file=True) for name, robot, plant, named, located in FILE_PLANTS]
CASES = [*DOCUMENTED, *TERMS, *SIGNS, *ANGLES, *GEARS, *BODIES, *PRECISION, *COLUMNS, *PAIRS, *FILES]
