"""Mistakes that show where something vanishes, at limits, at singular poses, or by the order of the calls."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import SpecialFault
from scipy.spatial.transform import Rotation
from textbook_codes.algebra import cross
from textbook_codes.code import text_with
from textbook_codes.kinematics import poses

TURNING = ("ur5", "kr500", "kinova", "xarm7", "ur3", "so100", "kr210_r2700_2")
"""Arms all of whose joints turn."""

KEPT = r"(of the first call|of the call before|earlier|depends on|same q)"
STILL = r"(v = 0|at rest|not finite|velocit|moves alone)"
SMALL = r"(nearest to zero|within|small|angles?|whole turn|positions?)"


def special(function, name, planted, named, **more):
    return SpecialFault(function, name, planted, named, **more)


def written(function, name, where, place, instead, named, **more):
    changed = text_with(where, place, instead)
    return special(function, name, lambda arm, right, code: code(function, arm, changed), named, **more)


def kept(*which, rounded=None):
    """Answers kept in a dictionary whose key leaves some arguments out, or rounds them."""

    def planted(arm, right, code):
        known = {}

        def f(*x):
            key = tuple((x[k] if rounded is None else np.round(x[k], rounded) + 0.0).tobytes() for k in which)
            return known.setdefault(key, right(*x))

        return f

    return planted


def last_position(arm, right, code):
    """A class that updates its kinematics if q has changed, velocities with it."""
    kept = {}

    def f(q, *x):
        if "q" not in kept or not np.array_equal(kept["q"], q):
            kept.update(q=q.copy(), x=[y.copy() for y in x])
        return right(q, *kept["x"])

    return f


def stale_velocity(arm, right, code):
    """Only v is not updated where q is that of the call before."""
    kept = {}

    def f(q, v, *x):
        if "q" not in kept or not np.array_equal(kept["q"], q):
            kept.update(q=q.copy(), v=v.copy())
        return right(q, kept["v"], *x)

    return f


def memo_of_mass_matrix(arm, right, code):
    """M is kept by the first joint's angle in degrees, rounded: enough for a table, somebody thought."""
    known, M, h = {}, code("mass_matrix", arm), code("bias_torque", arm)

    def f(q, v, tau):
        key = tuple(np.round(np.rad2deg(q)))
        return np.linalg.solve(known.setdefault(key, M(q)), tau - h(q, v))

    return f


def where(condition, other):
    """Another answer where a condition holds. other: (right, code, arm) → function"""

    def planted(arm, right, code):
        special = other(right, code, arm)
        return lambda *x: special(*x) if condition(*x) else right(*x)

    return planted


def unit_velocity(arm, right, code):
    """Velocities as a direction times a speed."""

    def f(q, v, *x):
        with np.errstate(all="ignore"):
            speed = np.linalg.norm(v)
            return right(q, speed * (v / speed), *x)

    return f


def dry_friction_of(limit):
    def planted(arm, right, code):
        def f(q, v, a):
            with np.errstate(all="ignore"):
                return right(q, v, a) + 0.0 * np.where(np.abs(v) > limit, 1, v / np.abs(v))

        return f

    return planted


def angle_of(arm, right, code):
    """Through rotation matrices and back, by acos of the trace."""

    def f(q, *x):
        turned = np.array([back_and_forth(y) for y in q])
        turned = np.where(arm.prismatic, q, turned)
        return right(turned, *x)

    return f


def back_and_forth(angle):
    """The angle of a rotation about z by its trace: the sign is that of R_21 - R_12, the digits are lost near zero."""
    R = Rotation.from_rotvec([0, 0, angle]).as_matrix().astype(np.float32).astype(float)
    with np.errstate(all="ignore"):
        return np.sign(R[1, 0]) * np.arccos((np.trace(R) - 1) / 2) if abs(angle) < 1e-3 else angle


SERIES = {
    "sin of a wrong term": ("np.sin(angle) * p", "(angle - angle**3 / 3 if abs(angle) < 0.05 else np.sin(angle)) * p"),
    "cos without a square": ("(1 - np.cos(angle))", "(0.0 if abs(angle) < 1e-3 else 1 - np.cos(angle))"),
    "no rotation below a threshold": ("np.sin(angle) * p", "(0.0 if abs(angle) < 1e-6 else np.sin(angle)) * p"),
    "1 - cos of the first power": ("(1 - np.cos(angle))", "(0.5 * angle if abs(angle) < 1e-6 else 1 - np.cos(angle))"),
}


def series(kind, function, **more):
    return written(function, kind, "turn", *SERIES[kind], SMALL, robots=TURNING, **more)


def normalized_lever(arm, right, code):
    """z × p as a unit vector times its length: NaN where a point lies on its axis."""

    def f(q):
        J = np.array(right(q))
        with np.errstate(all="ignore"):
            length = np.linalg.norm(J[:3], axis=0)
            J[:3] = J[:3] / length * length
        return J

    return f


def singular_inverse(arm, right, code):
    """The acceleration of the frame by J a + J̇ v, zero where J is singular: its determinant is a guard."""
    J = code("frame_jacobian", arm)

    def f(q, v, a):
        S = J(q)[:, :6]
        return right(q, v, a) * (1.0 if np.sqrt(abs(np.linalg.det(S.T @ S))) > 1e-9 else 0.0)

    return f


def wrapped(low, high):
    """Angles are clamped, not wrapped."""

    def planted(arm, right, code):
        return lambda q, *x: right(np.where(arm.prismatic, q, np.clip(q, low, high)), *x)

    return planted


def no_turns(arm, right, code):
    """Whole turns are refused."""

    def f(q, *x):
        if (np.abs(q) >= 2 * np.pi).any():
            raise ValueError("angle out of range")
        return right(q, *x)

    return f


def parallel_axes(arm, right, code):
    """The common normal of two axes is their cross product, which vanishes where they are parallel."""

    def f(q, *x):
        _, _, z = poses(arm, q)
        normal = cross(z[-3], z[-1])
        return right(q, *x) * (1.0 if np.linalg.norm(normal) > 1e-6 else 0.0)

    return f


def still(*x):
    return not x[1].any()


def unmoved(*x):
    return not x[2].any()


def resting(*x):
    return not (x[1].any() or x[2].any())


def without_velocities(right, code, arm):
    return lambda q, v, a: right(q, 0 * v, a)


def undefined(right, code, arm):
    return lambda *x: np.nan * right(*x)


def nothing(right, code, arm):
    return lambda *x: 0 * right(*x)


FAULTS = (
    special("inverse_dynamics", "kept by q alone", kept(0), KEPT),
    special("coriolis_matrix", "kept by q alone", kept(0), KEPT),
    special("joint_wrenches", "kept by q and v", kept(0, 1), KEPT),
    special("kinetic_energy", "kept by q", kept(0), KEPT),
    special("bias_torque", "stale v where q is that of the call before", stale_velocity, KEPT),
    special("frame_acceleration", "v and a of the first call with q", last_position, KEPT),
    special("momentum", "stale v where q is that of the call before", stale_velocity, KEPT),
    special("forward_dynamics", "mass matrix kept by rounded degrees", memo_of_mass_matrix, KEPT + "|round"),
    special("gravity_torque", "kept by q rounded to two digits", kept(0, rounded=2), KEPT + "|round|small|nearest|within"),
    special("center_of_mass", "kept by q rounded to six digits", kept(0, rounded=6), KEPT + "|round|small|nearest|within"),
    special("static_torque", "kept by q, loads forgotten", kept(0), KEPT + "|external"),
    special("inverse_dynamics", "nan at v = 0", unit_velocity, STILL),
    special("bias_torque", "nan at v = 0", unit_velocity, STILL),
    special("frame_jacobian_derivative", "nan at v = 0", unit_velocity, STILL),
    special("inverse_dynamics", "sign of a velocity of zero", dry_friction_of(1e9), STILL),
    special("inverse_dynamics", "no velocity terms at a = 0", where(unmoved, without_velocities), "a = 0"),
    special("dtau_dv", "nothing at a = 0", where(unmoved, nothing), "a = 0"),
    special("forward_dynamics", "nothing without torques", where(unmoved, nothing), "tau = 0|τ = 0"),
    special("multipliers", "nothing where nothing moves", where(resting, nothing), "v = 0 and a = 0|at rest"),
    special("kinetic_energy", "nan at rest", where(still, undefined), STILL),
    special("power", "nan at rest", where(still, undefined), STILL),
    special("da_dq", "nan at v = 0", unit_velocity, STILL),
    series("sin of a wrong term", "inverse_dynamics"),
    series("sin of a wrong term", "mass_matrix"),
    series("cos without a square", "frame_placement"),
    series("no rotation below a threshold", "gravity_torque"),
    series("1 - cos of the first power", "frame_jacobian"),
    series("sin of a wrong term", "potential_energy"),
    series("cos without a square", "joint_torque_regressor"),
    special("inverse_dynamics", "angles by acos of a trace in single precision", angle_of, SMALL, robots=TURNING),
    special("frame_jacobian", "levers normalized", normalized_lever, "not finite", robots=TURNING),
    special("frame_acceleration", "zero where the Jacobian is singular", singular_inverse, "parallel|wrong (only )?(wherever|where|at)", robots=("ur5", "kinova", "ur3", "kr210_r2700_2")),
    special("gravity_torque", "angles clamped to ±π", wrapped(-np.pi, np.pi), "π|turn|clip|3\\.14", robots=("ur5", "ur3", "kr500")),
    special("mass_matrix", "angles clamped to ±π", wrapped(-np.pi, np.pi), "π|turn|clip|3\\.14", robots=("ur5", "ur3", "kr500")),
    special("frame_velocity", "whole turns refused", no_turns, "turn|6\\.28|answer|raise", robots=("kr500", "kinova", "ur5")),
    special("inverse_dynamics", "zero where the axes of the wrist are parallel", parallel_axes, "parallel|wrong (only )?(wherever|where|at)", robots=("ur5", "ur3", "kr210_r2700_2")),
)  # fmt: skip
