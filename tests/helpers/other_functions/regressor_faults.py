"""Mistakes in regressors and in derivatives with respect to parameters."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, plant, text
from other_functions.torque_faults import OPPOSITE, OUT

PARAMETERS = {
    "xx, xy, xz, yy, yz, zz": [0, 1, 2, 3, 4, 5, 7, 6, 8, 9],
    "xx, yy, zz, xy, xz, yz": [0, 1, 2, 3, 4, 6, 9, 5, 7, 8],
}
"""Other orders of the ten columns of a body."""

ORDER = "order|exchang|in place of|I_yy|grouped"


def columns(order):
    """The columns of each body in another order."""
    return lambda W, *_: W.reshape(*W.shape[:-1], -1, 10)[..., PARAMETERS[order]].reshape(W.shape)


def by_type(W, *_):
    return np.swapaxes(W.reshape(len(W), -1, 10), 1, 2).reshape(W.shape)


def scaled(factors):
    return lambda W, *_: (W.reshape(*W.shape[:-1], -1, 10) * factors).reshape(W.shape)


OFF = np.array([1, 1, 1, 1, 1, 2, 1, 2, 2, 1])
FIRST = np.array([1, -1, -1, -1, 1, 1, 1, 1, 1, 1])
NO_GRAVITY = ("body_regressor", "acc[j + 1] - arm.gravity", "acc[j + 1]")


def about_centers(arm, right, code):
    """Columns of the tensors about the centers of mass, and of m with known centers."""

    def f(q, v, a):
        W = np.array(right(q, v, a)).reshape(arm.n, arm.n, 10)
        for i, c in enumerate(arm.centers):
            x, y, z = c
            square = np.array([y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y])
            W[:, i, 0] += W[:, i, 4:] @ square
        return W.reshape(arm.n, -1)

    return f


TORQUE = (
    answers("joint_torque_regressor", "xx, xy, xz, yy, yz, zz", columns("xx, xy, xz, yy, yz, zz"), ORDER),
    answers("joint_torque_regressor", "xx, yy, zz, xy, xz, yz", columns("xx, yy, zz, xy, xz, yz"), ORDER),
    text("joint_torque_regressor", "no gravity", *NO_GRAVITY, f"gravity.*{OUT}"),
    answers("joint_torque_regressor", "by type", by_type, "group|type|order"),
    plant("joint_torque_regressor", "tensors about the centers", about_centers, "center"),
    text("joint_torque_regressor", "sign of the first moments", "body_regressor", "-hat(push)", "hat(push)", f"(first moment|m c|moment|c ×).*{OPPOSITE}"),
    answers("joint_torque_regressor", "shifted by one body", lambda W, *_: np.roll(W, 10, axis=1), "(bod|link|shift|order)"),
    answers("joint_torque_regressor", "products counted twice", scaled(OFF), "(product|I_xy|scaled|off).*(2|twice|doubl)?"),
    answers("joint_torque_regressor", "own joint alone", lambda W, q, v, a: (W.reshape(len(q), len(q), 10) * np.eye(len(q))[:, :, None]).reshape(W.shape), "own|diagonal|block|outer|other bod|other joint|passed on|Xᵀ of forces.*left out"),
    text("joint_torque_regressor", "gravity of the other sign", "body_regressor", "acc[j + 1] - arm.gravity", "acc[j + 1] + arm.gravity", f"gravity.*{OPPOSITE}"),
    answers("joint_torque_regressor", "negative first moments", scaled(FIRST), f"(first moment|m c|center|scaled).*{OPPOSITE}|(first moment|m c).*-1"),
    text("body_regressor", "no gravity", *NO_GRAVITY, f"gravity.*{OUT}"),
    answers("body_regressor", "xx, xy, xz, yy, yz, zz", columns("xx, xy, xz, yy, yz, zz"), ORDER),
    answers("body_regressor", "moment first", lambda Y, *_: np.roll(Y, 3, axis=1), "(moment|angular).*first|order|exchang"),
    text("body_regressor", "no ω × I ω", "body_regressor", " + hat(spin) @ tensor_rows(spin)", "", f"(ω × (J|I) ω|gyroscopic).*{OUT}"),
    text("body_regressor", "no ω × (ω × c)", "body_regressor", " + hat(spin) @ hat(spin)", "", f"(ω × \\(ω × (m )?c\\)|centripetal).*{OUT}"),
    text("body_regressor", "ω × I ω of the other sign", "body_regressor", "+ hat(spin) @ tensor_rows(spin)", "- hat(spin) @ tensor_rows(spin)", f"(ω × (J|I) ω|gyroscopic).*{OPPOSITE}"),
    text("body_regressor", "in world axes", "body_regressor", "B = R[j + 1].T", "B = np.eye(3)", "world|not turned"),
    answers("base_regressor", "one column missing", lambda W, *_: np.delete(W, 4, axis=1), "missing|lack|rank|fewer|determined", robots=("ur5", "kinova", "xarm7")),
    text("base_regressor", "no gravity", *NO_GRAVITY, f"gravity.*{OUT}", equal="no combination of", robots=("ur5", "kinova", "xarm7")),
    answers("base_regressor", "viscous friction in it", lambda W, q, v, a: np.column_stack([W, np.diag(v)[:, 0]]), "column", robots=("ur5", "kinova", "xarm7")),
)  # fmt: skip

ENERGY = (
    answers("momentum_regressor", "xx, xy, xz, yy, yz, zz", columns("xx, xy, xz, yy, yz, zz"), ORDER),
    text("momentum_regressor", "sign of ω × c", "momentum_regressor", "= hat(spin)", "= -hat(spin)", f"(first moment|m c|ω × c).*{OPPOSITE}"),
    text("momentum_regressor", "c × v missing", "momentum_regressor", "        Y[j, 3:, 1:4] = -hat(speed)\n", "", f"(first moment|m c|c × v|v).*{OUT}"),
    answers("momentum_regressor", "shifted by one body", lambda W, *_: np.roll(W, 10, axis=1), "(bod|link|shift|order)"),
    answers("kinetic_energy_regressor", "½ forgotten", lambda W, *_: 2 * W, "(2|½|twice|doubl)"),
    answers("kinetic_energy_regressor", "products halved", scaled(1 / OFF), "(product|I_xy|scaled|off).*(0\\.5|half|halved)"),
    text("kinetic_energy_regressor", "sign of m c", "kinetic_energy_regressor", "np.cross(speed, spin)", "np.cross(spin, speed)", f"(first moment|m c|center).*{OPPOSITE}|mc?_?.*-1"),
    answers("kinetic_energy_regressor", "xx, yy, zz, xy, xz, yz", columns("xx, yy, zz, xy, xz, yz"), ORDER),
    answers("potential_energy_regressor", "sign", lambda W, *_: -W, OPPOSITE),
    text("potential_energy_regressor", "not turned", "potential_energy_regressor", "-R[j + 1].T @ arm.gravity", "-arm.gravity", "(gravity|m c|first moment|center|R).*(not turned|world axes|axes|rotation)"),
    text("potential_energy_regressor", "heights missing", "potential_energy_regressor", "        Y[j, 0] = -arm.gravity @ o[j + 1]\n", "", f"(mass|column|height|\\bm\\b).*{OUT}"),
    text("potential_energy_regressor", "turned the wrong way", "potential_energy_regressor", "R[j + 1].T @ arm", "R[j + 1] @ arm", "(gravity|m c|first moment|center|R).*(wrong way|transposed|turned|axes)"),
    answers("forward_dynamics_parameter_derivatives", "sign", lambda W, *_: -W, OPPOSITE),
    text("forward_dynamics_parameter_derivatives", "no gravity", *NO_GRAVITY, f"gravity.*{OUT}"),
    answers("forward_dynamics_parameter_derivatives", "xx, xy, xz, yy, yz, zz", columns("xx, xy, xz, yy, yz, zz"), ORDER),
    text("forward_dynamics_parameter_derivatives", "not solved for", "forward_dynamics_parameter_derivatives", "np.linalg.solve(mass_matrix(arm, q), joint_torque_regressor(arm, q, v, a))", "joint_torque_regressor(arm, q, v, a)", "M⁻¹|mass matrix|regressor"),
    text("forward_dynamics_parameter_derivatives", "at a = 0", "forward_dynamics_parameter_derivatives", "a = forward_dynamics(arm, q, v, tau)", "a = 0 * q", f"(acceleration|\\ba\\b).*{OUT}"),
    text("forward_dynamics_parameter_derivatives", "torques in place of accelerations", "forward_dynamics_parameter_derivatives", "a = forward_dynamics(arm, q, v, tau)", "a = tau", "(tau|torque|τ).*(acceleration|in place|as a|taken)"),
)  # fmt: skip

FAULTS = (*TORQUE, *ENERGY)
