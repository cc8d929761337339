"""Faults as changes of the textbook recursion: of its arm, its arguments or its torques."""

from zlib import crc32

import numpy as np
from faults.textbook_faults import one
from scipy.spatial.transform import Rotation


def of(code):
    """A plant from a changed arm."""
    return lambda arm, model: code(arm).inverse_dynamics


def after(change):
    """A plant whose torques are changed: change(tau, q, v, a)."""
    return lambda arm, model: lambda q, v, a: change(arm.inverse_dynamics(q, v, a), q, v, a)


def before(change):
    """A plant whose arguments are changed: change(q, v, a) → q, v, a."""
    return lambda arm, model: lambda q, v, a: arm.inverse_dynamics(*change(q, v, a))


def both(first, second):
    """Two changes of the arm."""
    return lambda arm, model: second(first(arm)).inverse_dynamics


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


HALF = Rotation.from_euler("z", 180, degrees=True).as_matrix()


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


def stribeck(v):
    return (2 + 3 * np.exp(-((v / 0.3) ** 2))) * np.tanh(v / 0.05)


def coupled_rotors(n):
    matrix = np.diag(np.arange(1.0, n + 1))
    matrix[1, 2] = matrix[2, 1] = 0.5
    return matrix
