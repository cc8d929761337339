"""Faults planted in the textbook recursion, on six robots, and what a diagnosis has to say about each.

`CASES` is the table: name, robot, plant, the words that name the fault, the words that locate it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

import numpy as np
from diagnosis_files import FILE_PLANTS
from foreign_faults import PLANTS, one, shuffled
from scipy.spatial.transform import Rotation
from shared_data import ARMS

import urdf

ROBOTS = {
    **{name: name for name in ("ur5", "kr500", "kinova", "z1")},
    "vx300s": str(ARMS / "vx300s.urdf"),
    "kr210": str(ARMS / "kr210_r2700_2.urdf"),
}


@dataclass(frozen=True)
class Case:
    """A fault on a robot.

    plant: (arm, model) → a function, or (folder, path) → robot and arm, where the fault is in reading the file
    named: expressions that the messages of the diagnoses that hold must match, one each, and no other may hold
    located: expression that a part, a candidate or an unknown has to match to count as located
    function: which function is judged
    """

    name: str
    robot: str
    plant: Callable
    named: tuple[str, ...]
    located: str = ""
    function: str = "inverse_dynamics"
    from_file: bool = False

    def __str__(self):
        return f"{self.name}-{self.robot}"


def path_of(robot: str) -> Path:
    known = {entry.name: entry.path for entry in urdf.robots()}
    return Path(known.get(ROBOTS[robot], ROBOTS[robot]))


def of(code):
    """A plant from a changed arm."""
    return lambda arm, model: code(arm).inverse_dynamics


def after(change):
    """A plant whose torques are changed: change(tau, q, v, a)."""
    return lambda arm, model: lambda q, v, a: change(arm.inverse_dynamics(q, v, a), q, v, a)


def before(change):
    """A plant whose arguments are changed: change(q, v, a) → q, v, a."""
    return lambda arm, model: lambda q, v, a: arm.inverse_dynamics(*change(q, v, a))


def unit(k, n, value=1.0):
    return value * (np.arange(n) == k)


def scaled(x, k, factor):
    return np.where(np.arange(len(x)) == k, factor * x, x)


def factors(field, k, value):
    """A factor of the recursion at one joint alone."""
    return of(lambda arm: arm.but(**{field: 1 + unit(k, len(arm.masses), value - 1)}))


def mixed_signs(arm, model, s_q=1, s_v=1, s_a=1, s_tau=1, joints=(1,)):
    s = np.isin(np.arange(len(arm.masses)), joints)
    q_s, v_s, a_s, t_s = (np.where(s, x, 1) for x in (s_q, s_v, s_a, s_tau))
    return lambda q, v, a: t_s * arm.inverse_dynamics(q_s * q, v_s * v, a_s * a)


def coupled(k, i, *, torques):
    """Joint k also turns with joint i; the transmission's transpose on the torques or not."""

    def plant(arm, model):
        n = len(arm.masses)
        matrix = np.eye(n)
        matrix[k, i] = 1.0
        back = matrix.T if torques else np.eye(n)
        return lambda q, v, a: back @ arm.inverse_dynamics(matrix @ q, matrix @ v, matrix @ a)

    return plant


def stale(arm, model):
    """The kinematics of the call before."""
    seen = []

    def function(q, v, a):
        seen.append(np.array(q))
        return arm.inverse_dynamics(seen[-2] if len(seen) > 1 else q, v, a)

    return function


def scatter(size):
    def plant(arm, model):
        def function(q, v, a):
            tau = arm.inverse_dynamics(q, v, a)
            rng = np.random.default_rng(crc32(np.concatenate([q, v, a]).tobytes()))
            return tau + size * np.abs(tau).max() * rng.standard_normal(len(tau))

        return function

    return plant


def clipped(arm, model):
    effort = 0.25 * np.array([joint.limits.effort or np.inf for joint in model.joints])
    return lambda q, v, a: np.clip(arm.inverse_dynamics(q, v, a), -effort, effort)


def limit_spring(arm, model):
    upper = np.array([joint.limits.upper or np.inf for joint in model.joints])
    return lambda q, v, a: arm.inverse_dynamics(q, v, a) + 1e3 * np.maximum(0, q - upper + 0.1)


def equality(i, k):
    """A transmission that holds two joints at equal accelerations: the torque that this takes stays on."""

    def plant(arm, model):
        n = len(arm.masses)
        row = unit(i, n) + unit(k, n)

        def function(q, v, a):
            inverse = np.linalg.inv(arm.mass_matrix(q))
            force = row @ a / (row @ inverse @ row)
            return arm.inverse_dynamics(q, v, a) - force * row

        return function

    return plant


def triangle(arm, model):
    return lambda q: np.triu(arm.mass_matrix(q))


def tensor_entry(k, entry, change):
    """One entry of one tensor, symmetrically."""
    a, b = entry

    def code(arm):
        def changed(tensor):
            other = np.array(tensor)
            other[a, b] = other[b, a] = change(tensor[a, b])
            return other

        return one(arm, "tensors", k, changed)

    return of(code)


def reordered(tensor):
    """ixx, ixy, ixz, iyy, iyz, izz read as ixx, iyy, izz, ixy, ixz, iyz."""
    xx, xy, xz, yy, yz, zz = tensor[0, 0], tensor[0, 1], tensor[0, 2], tensor[1, 1], tensor[1, 2], tensor[2, 2]
    return np.array([[xx, yy, yz], [yy, xy, zz], [yz, zz, xz]])


def body_turned(k, turn):
    """The body k in other axes than the link's."""

    def code(arm):
        arm = one(arm, "centers", k, lambda c: turn @ c)
        return one(arm, "tensors", k, lambda tensor: turn @ tensor @ turn.T)

    return of(code)


def rounded_rpy(arm):
    """π/2 written as 1.57, π as 3.14."""
    angles = [Rotation.from_matrix(r).as_euler("xyz") for r in arm.rotations]
    return arm.but(rotations=np.stack([Rotation.from_euler("xyz", np.round(x, 2)).as_matrix() for x in angles]))


def regressor(change):
    def plant(arm, model):
        from graphdyn import joint_torque_regressor

        n = model.n_bodies
        return lambda q, v, a: change(joint_torque_regressor(model, q, v, a).reshape(n, n, 10)).reshape(n, 10 * n)

    return plant


def both(first, second):
    """Two changes of the arm."""
    return lambda arm, model: second(first(arm)).inverse_dynamics


def stribeck(v):
    return (2 + 3 * np.exp(-((v / 0.3) ** 2))) * np.tanh(v / 0.05)


QUARTER = Rotation.from_euler("z", 90, degrees=True).as_matrix()
HALF = Rotation.from_euler("z", 180, degrees=True).as_matrix()


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
    Case("a ignored", "kinova", before(lambda q, v, a: (q, v, 0 * a)), ("acceleration",)),
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
        "finger in millimetres",
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
    Case("contact at the limits", "ur5", limit_spring, ("limit",), "only torques of|only where"),
    Case("fingers held together", "vx300s", equality(7, 8), ("finger",), "finger|direction"),
    Case("M in one triangle", "kinova", triangle, ("triangle",), function="mass_matrix"),
]

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
        "columns by type", "ur5", regressor(lambda w: np.swapaxes(w, 1, 2)), ("by type|grouped",), function="regressor"
    ),
    Case(
        "bodies reversed",
        "kr210",
        regressor(lambda w: w[:, ::-1]),
        ("bodies.*order|order.*bodies|reversed",),
        function="regressor",
    ),
]

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

FILES = [Case(name, robot, plant, named, located, from_file=True) for name, robot, plant, named, located in FILE_PLANTS]


def coupled_rotors(n):
    matrix = np.diag(np.arange(1.0, n + 1))
    matrix[1, 2] = matrix[2, 1] = 0.5
    return matrix


CASES = [*DOCUMENTED, *TERMS, *SIGNS, *ANGLES, *GEARS, *BODIES, *PRECISION, *COLUMNS, *PAIRS, *FILES]
