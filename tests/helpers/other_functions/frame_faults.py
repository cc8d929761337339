"""Mistakes in placements, Jacobians, velocities and accelerations of frames."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.torque_faults import OPPOSITE, OUT
from scipy.spatial.transform import Rotation
from textbook_codes.kinematics import frame_pose

OFFSET = ("ur5", "kinova", "panda", "z1", "vx300s", "kr210_r2700_2")
"""Arms whose frame is not at the origin of its link."""

POINT = r"(those of frame|frame '|link origin|another point|offset|point of the frame|origin of the link)"
SLIDING = ("panda", "vx300s")


def finger(robot):
    return {"robots": (robot,), "frame": {"panda": "panda_leftfinger", "vx300s": "vx300s/left_finger_link"}[robot]}


def local_angular(arm, right, code):
    def f(q, *more):
        answer = np.array(right(q, *more))
        answer[3:] = frame_pose(arm, q)[0].T @ answer[3:]
        return answer

    return f


def rates_of_angles(arm, right, code):
    """Roll, pitch, yaw, differentiated: as in a Jacobian of the task coordinates."""

    def angles(q):
        R = frame_pose(arm, q)[0]
        roll, pitch = np.arctan2(R[2, 1].real, R[2, 2].real), np.arcsin(-R[2, 0].real)
        return np.array([roll, pitch, np.arctan2(R[1, 0].real, R[0, 0].real)])

    def f(q):
        J = np.array(right(q))
        _, pitch, yaw = angles(q)
        z, y, x = np.eye(3)[2], [-np.sin(yaw), np.cos(yaw), 0], Rotation.from_euler("ZY", [yaw, pitch]).apply([1, 0, 0])
        J[3:] = np.linalg.solve(np.column_stack([x, y, z]), J[3:])
        return J

    return f


def transposed_placement(T, q):
    T = np.array(T)
    T[:3, :3] = T[:3, :3].T
    return T


def column_out(k):
    def change(J, *_):
        J = np.array(J)
        J[:, k] = 0
        return J

    return change


def by_difference(step):
    """J̇ v by a forward difference, in place of the acceleration's velocity part."""

    def planted(arm, right, code):
        J = code("frame_jacobian", arm)
        return lambda q, v, a: J(q) @ a + (J(q + step * v) - J(q)) @ v / step

    return planted


PLACEMENT = (
    numbers("frame_placement", "offset of the frame missing", lambda arm: arm.but(frame_point=0 * arm.frame_point), POINT, robots=OFFSET),
    answers("frame_placement", "rotation transposed", transposed_placement, "(rotation|R).*(transposed|inverse|inverted)"),
    answers("frame_placement", "world in the frame", lambda T, q: np.linalg.inv(T), "inver"),
    answers("frame_placement", "in millimeters", lambda T, q: T * [[1, 1, 1, 1000]] , "millimet|1000|mm"),
    numbers("frame_placement", "a length", lambda arm: arm.one("translations", 2, lambda r: np.add(r, [0, 0, 0.02])), "(translation|place|length|origin).*<joint 3>"),
    arguments("frame_placement", "zero of a joint", lambda q: (q + 0.5 * np.pi * (np.arange(len(q)) == 2),), "(zero|position).*<joint 3>|<joint 3>.*(90|1\\.57|zero|turned)"),
    arguments("frame_placement", "a joint the other way round", lambda q: (q * np.where(np.arange(len(q)) == 1, -1, 1),), f"<joint 2>.*{OPPOSITE}|{OPPOSITE}.*<joint 2>"),
    numbers("frame_placement", "axis of one joint", lambda arm: arm.one("axes", 3, lambda p: np.roll(p, 1)), "axis of (joint )?'?<joint 4>"),
    text("frame_placement", "r not turned", "poses", "o[i] + R[i] @ arm.translations[j]", "o[i] + arm.translations[j]", "(\\br\\b|translation).*(not turned|axes)"),
    answers("frame_placement", "zeros below, not one", lambda T, q: T * np.where(np.arange(16).reshape(4, 4) == 15, 0, 1), "(last row|bottom|lower|homogeneous|0, 0, 0, 1|row 4)"),
)  # fmt: skip

JACOBIAN = (
    plant("frame_jacobian", "linear in world axes, angular in those of the frame", local_angular, "(angular|ω).*(local|own axes|axes of the frame|frame's axes|link axes)|mixed|references?.*(linear|angular)"),
    plant("frame_jacobian", "rates of roll, pitch, yaw", rates_of_angles, "(roll|rpy|Euler|analytic|rates of)"),
    text("frame_jacobian", "z × p in place of z × (p - o)", "point_jacobian", "cross(z[k], point - o[k + 1])", "cross(z[k], point)", "(z × p|ż × p|world's origin|(\\bo\\b|origin).*(left out|missing|subtract)|lever|world)"),
    text("frame_jacobian", "(p - o) × z", "point_jacobian", "cross(z[k], point - o[k + 1])", "cross(point - o[k + 1], z[k])", f"(linear|z ×|cross|lever).*{OPPOSITE}|{OPPOSITE}.*linear|linear part is multiplied by -1"),
    numbers("frame_jacobian", "of the link origin", lambda arm: arm.but(frame_point=0 * arm.frame_point), POINT, robots=OFFSET),
    text("frame_jacobian", "a sliding joint taken as turning", "point_jacobian", "if arm.prismatic[k]", "if False", "(<joint 8>|sliding|prismatic).*(turn|revolute|slid|hinge)|(revolute|turn).*<joint 8>", **finger("panda")),
    text("frame_jacobian", "z × added for a sliding joint", "point_jacobian", "J[:3, k] = z[k]\n", "J[:3, k] = z[k]\n            J[3:, k] = z[k]\n", "(<joint 8>|<joint 9>|sliding|prismatic).*(turn|revolute|angular|slid)|angular.*(<joint 8>|<joint 9>|sliding|prismatic)", **finger("vx300s")),
    answers("frame_jacobian", "column missing", column_out(3), f"(column|joint).*<joint 4>.*{OUT}|<joint 4>.*{OUT}|{OUT}.*<joint 4>"),
    text("frame_jacobian", "axes in the inside link", "poses", "axis = joint @ arm.axes[j]", "axis = R[i] @ arm.axes[j]", "(axis|axes).*(inside|not turned|joint frame|parent|rotation|other axes)"),
    answers("frame_jacobian", "ω the other way round", lambda J, q: J * np.where(np.arange(6) < 3, 1, -1)[:, None], f"(angular|ω).*{OPPOSITE}|angular part (by|is multiplied by) -1"),
    text("frame_jacobian", "axes of the outer link of the joint before", "point_jacobian", "J[3:, k] = z[k]", "J[3:, k] = z[max(k - 1, 0)]", "(axis|axes|z|column).*(before|inside|previous|another|shift|next)"),
    answers("frame_jacobian", "in millimeters per radian", lambda J, q: J * np.where(np.arange(6) < 3, 1000, 1)[:, None], "millimet|1000|mm"),
    numbers("frame_jacobian", "a length", lambda arm: arm.one("translations", 3, lambda r: np.add(1.05 * r, [0, 0.01, 0])), "(translation|place|length|origin).*<joint 4>"),
    arguments("frame_jacobian", "zero of a joint", lambda q: (q + 0.25 * np.pi * (np.arange(len(q)) == 3),), "(zero|position).*<joint 4>|<joint 4>.*(45|0\\.785|zero|turned)"),
    text("frame_jacobian_derivative", "no z × ṗ", "frame_jacobian_derivative", " + cross(z[k], speed - vel[k + 1])", "", f"(z × ṗ|z ×|lever|velocity of|ṗ).*{OUT}"),
    text("frame_jacobian_derivative", "velocity of the joint not subtracted", "frame_jacobian_derivative", "speed - vel[k + 1]", "speed", "(ȯ|velocity|ṗ).*(joint|origin|subtract|left out)"),
    text("frame_jacobian_derivative", "axes do not move", "frame_jacobian_derivative", "cross(rate, point - o[k + 1]) + ", "", f"(ż|rate|ż × p|axis|axes).*{OUT}|(ż|rate|axis|axes).*(constant|do not move|fixed)"),
    text("frame_jacobian_derivative", "angular rows missing", "frame_jacobian_derivative", "            D[3:, k] = rate\n", "", f"angular.*{OUT}"),
    answers("frame_jacobian_derivative", "twice", lambda D, q, v: 2 * D, "(2|twice|doubl)"),
    text("frame_jacobian_derivative", "ż = z × ω", "frame_jacobian_derivative", "rate = cross(w[k + 1], z[k])", "rate = cross(z[k], w[k + 1])", f"(ż|rate|ω × z|axis|axes).*{OPPOSITE}"),
)  # fmt: skip

MOTION = (
    text("frame_velocity", "ω × r missing", "frame_velocity", "vel[b] + cross(w[b], r)", "vel[b]", POINT + "|ω × r.*left out", robots=OFFSET),
    text("frame_velocity", "r × ω", "frame_velocity", "cross(w[b], r)", "cross(r, w[b])", f"(ω × r|offset|point|frame).*{OPPOSITE}|ω × r", robots=OFFSET),
    plant("frame_velocity", "linear in world axes, angular in those of the frame", local_angular, "(angular|ω).*(local|own axes|axes of the frame|frame's axes|link axes)|mixed|references?.*(linear|angular)"),
    arguments("frame_velocity", "degrees per second", lambda q, v: (q, np.rad2deg(v)), "degree|57\\.29|180"),
    text("frame_velocity", "ω of the inside link missing", "motions", "w.append(w[i] + spin)", "w.append(spin)", f"(ω|angular velocity).*inside.*{OUT}|inside.*ω"),
    numbers("frame_velocity", "axis tilted", lambda arm: arm.one("axes", 2, lambda p: Rotation.from_rotvec([0.02, 0.02, 0.02]).apply(p)), "(axis|axes).*<joint 3>|<joint 3>.*(axis|turned|tilt)"),
    numbers("frame_velocity", "a length", lambda arm: arm.one("translations", 1, lambda r: np.add(r, [0.03, 0, 0])), "(translation|place|length|origin).*<joint 2>"),
    text("frame_acceleration", "gravity counted", "motions", "[np.zeros(3)], [np.zeros(3)], [np.zeros(3)], [np.zeros(3)]", "[np.zeros(3)], [np.zeros(3)], [np.zeros(3)], [-arm.gravity]", "gravity"),
    text("frame_acceleration", "gravity in an accelerometer's sense reversed", "motions", "[np.zeros(3)], [np.zeros(3)], [np.zeros(3)], [np.zeros(3)]", "[np.zeros(3)], [np.zeros(3)], [np.zeros(3)], [arm.gravity]", "gravity"),
    text("frame_acceleration", "no ω × (ω × r) of the frame", "frame_acceleration", " + cross(w[b], cross(w[b], r))", "", f"ω × \\(ω × r\\).*{OUT}|centripetal.*{OUT}", robots=OFFSET),
    text("frame_acceleration", "spatial where classical is asked for", "frame_acceleration", "np.concatenate([linear, dw[b]])", "np.concatenate([linear - cross(w[b], frame_velocity(arm, q, v)[:3]), dw[b]])", "spatial", options=(("conventions", {"acceleration": "classical"}),)),
    text("frame_acceleration", "no Coriolis acceleration of a sliding joint", "motions", "acc_j + 2 * cross(w[i], slide) + ", "acc_j + ", f"(2 ω ×|Coriolis|sliding|slide).*{OUT}", **finger("panda")),
    text("frame_acceleration", "half of the Coriolis acceleration of a sliding joint", "motions", "acc_j + 2 * cross(w[i], slide) + ", "acc_j + cross(w[i], slide) + ", "(2 ω ×|Coriolis|sliding|slide).*(0\\.5|half|halved|1)", **finger("vx300s")),
    arguments("frame_acceleration", "J a alone", lambda q, v, a: (q, 0 * v, a), f"(velocit|J̇ v|\\bv\\b).*{OUT}"),
    arguments("frame_acceleration", "J̇ v alone", lambda q, v, a: (q, v, 0 * a), f"(acceleration|J a|\\ba\\b).*{OUT}"),
    arguments("frame_acceleration", "J̇ v twice", lambda q, v, a: (q, np.sqrt(2) * v, a), "(velocit|J̇ v|\\bv\\b).*(2|1\\.414|twice|doubl)"),
    text("frame_acceleration", "ω × q̇ p missing", "motions", "dw[i] + z[j] * a[j] + cross(w[i], spin)", "dw[i] + z[j] * a[j]", f"(ω × q̇ p|v × S q̇|ω × ).*{OUT}"),
    text("frame_acceleration", "ω × q̇ p of the other sign", "motions", "+ cross(w[i], spin))", "- cross(w[i], spin))", f"(ω × q̇ p|v × S q̇|ω × ).*{OPPOSITE}"),
    plant("frame_acceleration", "J̇ v by a coarse forward difference", by_difference(1e-4), "difference"),
)  # fmt: skip

FAULTS = (*PLACEMENT, *JACOBIAN, *MOTION)
