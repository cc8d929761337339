"""The five multipliers of each joint, from its wrench (docs/notation.md)."""

import numpy as np
from textbook_codes.algebra import cross, turn
from textbook_codes.kinematics import poses
from textbook_codes.torques import newton_euler


def normals(axis):
    """t_1 and t_2 of a joint axis, in joint axes."""
    t1 = cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    t1 = t1 / np.linalg.norm(t1)
    return t1, cross(axis, t1)


def multipliers(arm, q, v, a):
    f, m = newton_euler(arm, q, v, a)
    R, _, _ = poses(arm, q)
    rows = []
    for j in range(arm.n):
        p = arm.axes[j]
        t1, t2 = normals(p)
        if arm.prismatic[j]:
            rows.append([t1 @ f[j], t2 @ f[j], t1 @ m[j], t2 @ m[j], p @ m[j]])
        else:
            moment = turn(p, q[j]) @ m[j]
            rows.append([*(R[j + 1] @ f[j]), t1 @ moment, t2 @ moment])
    return np.array(rows)
