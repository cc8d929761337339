"""Mistakes in derivatives of torques, accelerations, wrenches and multipliers."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.torque_faults import OPPOSITE, OUT

WEIGHTLESS = ("arm, x", "arm.but(gravity=0 * arm.gravity), x")
GRAVITY = f"gravity.*{OUT}|derivative of (the )?gravity"
QUOTIENT = "difference"


def forward(name, which, step):
    """Forward differences of a function with respect to its argument number which."""

    def planted(arm, right, code):
        f = code(name, arm)

        def derivative(*x):
            def moved(e):
                return f(*(y + step * e if k == which else y for k, y in enumerate(x)))

            here = f(*x)
            return np.stack([(moved(e) - here) / step for e in np.eye(arm.n)], axis=-1)

        return derivative

    return planted


def with_gravity(name):
    """Columns by unit accelerations at v = 0, from which gravity is not subtracted."""

    def planted(arm, right, code):
        f = code(name, arm)
        return lambda q, v, a: np.stack([f(q, 0 * v, e) for e in np.eye(arm.n)], axis=-1)

    return planted


def last_out(D, *_):
    D = np.array(D)
    D[..., -1] = 0
    return D


TAU = (
    text("dtau_dq", "no gravity", "dtau_dq", *WEIGHTLESS, GRAVITY),
    text("dtau_dq", "gravity alone", "dtau_dq", "x, v, a), q)", "x, 0 * v, 0 * a), q)", f"(velocit|acceleration|inertia|Coriolis|\\bv\\b|\\ba\\b|M).*{OUT}|gravity alone|only.*gravity|gravity_torque"),
    answers("dtau_dq", "transposed", lambda D, *_: D.T, "transpos"),
    plant("dtau_dq", "coarse forward difference", forward("inverse_dynamics", 0, 1e-4), QUOTIENT),
    arguments("dtau_dq", "at a = 0", lambda q, v, a: (q, v, 0 * a), f"(acceleration|\\ba\\b|∂M).*{OUT}"),
    arguments("dtau_dq", "at v = 0", lambda q, v, a: (q, 0 * v, a), f"(velocit|\\bv\\b|Coriolis).*{OUT}"),
    numbers("dtau_dq", "mass of another variant", lambda arm: arm.one("masses", 2, lambda m: 1.2 * m), "mass.*<body 3>"),
    answers("dtau_dq", "last column missing", last_out, f"(column.*)?<joint n>.*{OUT}|{OUT}.*<joint n>|column"),
    text("dtau_dv", "C in place of 2 C", "dtau_dv", "2 * cor", "cor", "(0\\.5|half|halved|coriolis_matrix)"),
    text("dtau_dv", "damping added", "dtau_dv", "2 * coriolis_matrix(arm, q, v)", "2 * coriolis_matrix(arm, q, v) + 0.4 * np.eye(arm.n)", "(damping|viscous|friction|constant diagonal)"),
    answers("dtau_dv", "transposed", lambda D, *_: D.T, "transpos"),
    plant("dtau_dv", "coarse forward difference", forward("inverse_dynamics", 1, 1e-3), QUOTIENT),
    plant("dtau_dv", "1.5 C", lambda arm, right, code: lambda q, v, a: code("coriolis_matrix", arm)(q, v) * 1.5, "0\\.75"),
    text("dtau_dv", "last sign of the symbols", "coriolis_matrix", "- D[j, k, i]", "+ D[j, k, i]", f"(gradient|∂M_jk|∂M|last term|Christoffel).*{OPPOSITE}"),
    numbers("dtau_dv", "center of another variant", lambda arm: arm.one("centers", 2, lambda c: np.add(c, [0.03, 0.0, 0.02])), "center.*<body 3>|<body 3>.*center"),
)  # fmt: skip

ACCELERATION = (
    answers("da_dq", "sign", lambda D, *_: -D, OPPOSITE),
    text("da_dq", "M⁻¹ taken as constant", "da_dq", "    a = forward_dynamics(arm, q, v, tau)\n", "    a = 0 * q\n", f"(acceleration|\\ba\\b|∂M|mass matrix|M⁻¹).*({OUT}|constant)"),
    text("da_dq", "not solved for", "da_dq", "np.linalg.solve(mass_matrix(arm, q), dtau_dq(arm, q, v, a))", "dtau_dq(arm, q, v, a)", f"(M⁻¹|mass matrix|dtau_dq|∂τ).*|{OUT}"),
    text("da_dq", "no gravity", "dtau_dq", *WEIGHTLESS, GRAVITY),
    text("da_dq", "torques in place of accelerations", "da_dq", "a = forward_dynamics(arm, q, v, tau)", "a = tau", "(tau|torque|τ).*(acceleration|in place|as a|taken)"),
    plant("da_dq", "coarse forward difference", forward("forward_dynamics", 0, 1e-4), QUOTIENT, robots=("kr500", "kinova", "xarm7", "kr210_r2700_2")),
    text("da_dv", "C in place of 2 C", "dtau_dv", "2 * cor", "cor", "(0\\.5|half|halved)"),
    answers("da_dv", "sign", lambda D, *_: -D, OPPOSITE),
    answers("da_dv", "last column missing", last_out, f"(column.*)?<joint n>.*{OUT}|{OUT}.*<joint n>|column"),
    text("da_dv", "damping", "dtau_dv", "2 * coriolis_matrix(arm, q, v)", "2 * coriolis_matrix(arm, q, v) + 0.4 * np.eye(arm.n)", "(damping|viscous|friction|constant diagonal|M⁻¹)"),
)  # fmt: skip

REACTIONS = (
    text("dwrenches_dq", "no gravity", "dwrenches_dq", *WEIGHTLESS, GRAVITY),
    answers("dwrenches_dq", "last column missing", last_out, f"(column.*)?<joint n>.*{OUT}|{OUT}.*<joint n>|column"),
    numbers("dwrenches_dq", "a length", lambda arm: arm.one("translations", 2, lambda r: np.add(r, [0.02, 0, 0])), "(translation|place|length|origin).*<joint 3>"),
    text("dwrenches_dq", "r × f missing", "newton_euler", "R[j] @ m[j] + cross(r[j], push)", "R[j] @ m[j]", f"r × f.*{OUT}|without r"),
    answers("dwrenches_dv", "half", lambda D, *_: 0.5 * D, "(0\\.5|half|halved)"),
    text("dwrenches_dv", "ω × q̇ p missing", "newton_euler", "+ p * a[j] + cross(carried, p * v[j])", "+ p * a[j]", f"(ω × q̇ p|v × S q̇).*{OUT}"),
    plant("dwrenches_dv", "coarse forward difference", forward("joint_wrenches", 1, 1e-3), QUOTIENT),
    plant("dwrenches_da", "columns with gravity", with_gravity("joint_wrenches"), "gravity"),
    numbers("dwrenches_da", "point masses", lambda arm: arm.but(tensors=0 * arm.tensors), f"(tensor|inertia|J).*{OUT}|point mass"),
    answers("dwrenches_da", "moments first", lambda D, *_: np.roll(D, 3, axis=1), "(moment|angular).*first|order|exchang", options=(("conventions", {}),)),
    text("dmultipliers_dq", "no gravity", "dmultipliers_dq", *WEIGHTLESS, GRAVITY),
    text("dmultipliers_dq", "moment in link axes", "multipliers", "turn(p, q[j]) @ m[j]", "m[j]", "(moment|λ_4|λ_5|t_1).*(link axes|turn|axes)"),
    text("dmultipliers_dq", "axes held still", "multipliers", "R, _, _ = poses(arm, q)", "R, _, _ = poses(arm, np.real(q))", "(axes|rotation|R|force|turn).*(constant|held|not differentiated|left out|still|of the reaction)|(∂R|derivative of (the )?(R|rotation))"),
    answers("dmultipliers_dv", "sign", lambda D, *_: -D, f"{OPPOSITE}|inside body"),
    text("dmultipliers_dv", "t_1 and t_2 exchanged", "normals", "return t1, cross(axis, t1)", "return cross(axis, t1), t1", "t_1.*t_2|exchang|λ_4.*λ_5|row"),
    plant("dmultipliers_da", "columns with gravity", with_gravity("multipliers"), "gravity"),
    numbers("dmultipliers_da", "mass of another variant", lambda arm: arm.one("masses", 1, lambda m: 1.2 * m), "mass.*<body 2>"),
)  # fmt: skip

FAULTS = (*TAU, *ACCELERATION, *REACTIONS)
