"""Placements, Jacobians, velocities and accelerations of a frame: of its origin, in world axes."""

import numpy as np
from textbook_codes.algebra import cross, turn


def poses(arm, q):
    """Rotations and origins of the links (base first) and joint axes, in the world."""
    R, o, z = [arm.base_rotation], [arm.base_origin], []
    for j in range(arm.n):
        i = arm.inside[j]
        joint = R[i] @ arm.rotations[j]
        origin = o[i] + R[i] @ arm.translations[j]
        axis = joint @ arm.axes[j]
        if arm.prismatic[j]:
            R.append(joint)
            o.append(origin + axis * q[j])
        else:
            R.append(joint @ turn(arm.axes[j], q[j]))
            o.append(origin)
        z.append(axis)
    return R, o, z


def frame_pose(arm, q):
    R, o, _ = poses(arm, q)
    body = arm.frame_body
    return R[body] @ arm.frame_rotation, o[body] + R[body] @ arm.frame_point


def frame_placement(arm, q):
    rotation, point = frame_pose(arm, q)
    T = np.eye(4)
    T[:3, :3] = rotation
    T[:3, 3] = point
    return T


def point_jacobian(arm, q, body, point):
    """Of a point of a body, linear first."""
    _, o, z = poses(arm, q)
    J = np.zeros((6, arm.n), np.result_type(*z, float))
    for k in arm.path(body):
        if arm.prismatic[k]:
            J[:3, k] = z[k]
        else:
            J[:3, k] = cross(z[k], point - o[k + 1])
            J[3:, k] = z[k]
    return J


def frame_jacobian(arm, q):
    _, point = frame_pose(arm, q)
    return point_jacobian(arm, q, arm.frame_body, point)


def motions(arm, q, v, a):
    """ω, ω̇, velocity and acceleration of the link origins, base first, in world axes."""
    _, o, z = poses(arm, q)
    w, dw, vel, acc = [np.zeros(3)], [np.zeros(3)], [np.zeros(3)], [np.zeros(3)]
    for j in range(arm.n):
        i = arm.inside[j]
        r = o[j + 1] - o[i]
        vel_j = vel[i] + cross(w[i], r)
        acc_j = acc[i] + cross(dw[i], r) + cross(w[i], cross(w[i], r))
        if arm.prismatic[j]:
            slide = z[j] * v[j]
            w.append(w[i])
            dw.append(dw[i])
            vel.append(vel_j + slide)
            acc.append(acc_j + 2 * cross(w[i], slide) + z[j] * a[j])
        else:
            spin = z[j] * v[j]
            w.append(w[i] + spin)
            dw.append(dw[i] + z[j] * a[j] + cross(w[i], spin))
            vel.append(vel_j)
            acc.append(acc_j)
    return w, dw, vel, acc


def frame_velocity(arm, q, v):
    R, _, _ = poses(arm, q)
    w, _, vel, _ = motions(arm, q, v, 0 * v)
    b = arm.frame_body
    r = R[b] @ arm.frame_point
    return np.concatenate([vel[b] + cross(w[b], r), w[b]])


def frame_acceleration(arm, q, v, a):
    R, _, _ = poses(arm, q)
    w, dw, _, acc = motions(arm, q, v, a)
    b = arm.frame_body
    r = R[b] @ arm.frame_point
    linear = acc[b] + cross(dw[b], r) + cross(w[b], cross(w[b], r))
    return np.concatenate([linear, dw[b]])


def frame_jacobian_derivative(arm, q, v):
    _, o, z = poses(arm, q)
    w, _, vel, _ = motions(arm, q, v, 0 * v)
    _, point = frame_pose(arm, q)
    speed = frame_velocity(arm, q, v)[:3]
    D = np.zeros((6, arm.n))
    for k in arm.path(arm.frame_body):
        rate = cross(w[k + 1], z[k])
        if arm.prismatic[k]:
            D[:3, k] = rate
        else:
            D[:3, k] = cross(rate, point - o[k + 1]) + cross(z[k], speed - vel[k + 1])
            D[3:, k] = rate
    return D
