"""Mistakes in forward dynamics, bias, gravity, statics, power and wrenches."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from textbook_codes.algebra import cross
from textbook_codes.kinematics import poses

OUT = r"(left out|missing|not counted|omitted|ignored|zero|multiplied by -?0\b|by 0\b|is -?0\b|e-1\d kg|× 0\b)"
"""How a message may say that something is not there."""

AT_ORIGIN = "(center|inertial frame).*(link origin|xyz|ignored)"
"""Centers on the line of gravity that are not turned make the same torques as centers at the link origins (ur5)."""

OPPOSITE = r"(opposite|other way|reversed|negative|sign|multiplied by -1|× -1)"
"""How it may say that a sign is wrong."""


TOOL = "(mass|center|tensor|bod(y|ies)).*<body of the frame>|payload|tool"


def tool(arm):
    """A tool of 1.5 kg at the frame, as a point."""
    k, m = arm.frame_body - 1, 1.5
    total = arm.masses[k] + m
    center = (arm.masses[k] * arm.centers[k] + m * arm.frame_point) / total
    shift = [(arm.masses[k], arm.centers[k] - center), (m, arm.frame_point - center)]
    about = sum(x * (r @ r * np.eye(3) - np.outer(r, r)) for x, r in shift)
    arm = arm.one("tensors", k, lambda tensor: tensor + about)
    return arm.one("centers", k, lambda _: center).one("masses", k, lambda _: total)


def clipped(limit):
    return lambda q, v, tau: (q, v, np.clip(tau, -limit, limit))


def at_centers(arm, right, code):
    def f(q, v, a):
        answer = right(q, v, a)
        moments = [answer[j, 3:] - cross(arm.centers[j], answer[j, :3]) for j in range(arm.n)]
        return np.concatenate([answer[:, :3], np.array(moments)], axis=1)

    return f


def forces_in_world(arm, right, code):
    def f(q, v, a):
        answer, R = right(q, v, a), poses(arm, q)[0]
        return np.array([[*(R[j + 1] @ answer[j, :3]), *answer[j, 3:]] for j in range(arm.n)])

    return f


ABA = "articulated_accelerations"


def articulated(name, place, instead, named, **more):
    from textbook_codes.code import text_with

    changed = text_with(ABA, place, instead)
    return plant("forward_dynamics", f"ABA, {name}", lambda arm, _, code: code(ABA, arm, changed), named, **more)


FORWARD = (
    text("forward_dynamics", "no gravity", "bias_torque", "inverse_dynamics(arm, q", "inverse_dynamics(arm.but(gravity=0 * arm.gravity), q", f"gravity.*{OUT}"),
    text("forward_dynamics", "no velocity terms", "bias_torque", "q, v, np", "q, 0 * v, np", f"(velocit|Coriolis|c\\(q, v\\)|\\bv\\b).*{OUT}"),
    text("forward_dynamics", "bias added", "forward_dynamics", "tau - bias", "tau + bias", f"(bias|\\bh\\b|gravity|velocity).*{OPPOSITE}|(bias|\\bh\\b).*added"),
    text("forward_dynamics", "only gravity of the wrong sign", "bias_torque", "inverse_dynamics(arm, q", "inverse_dynamics(arm.but(gravity=-arm.gravity), q", f"gravity.*{OPPOSITE}"),
    text("forward_dynamics", "drives in M", "forward_dynamics", "mass_matrix(arm, q)", "mass_matrix(arm, q) + np.diag(0.02 * np.arange(1, arm.n + 1))", "(constant diagonal|rotor|armature).*mass matrix|mass matrix.*diagonal"),
    text("forward_dynamics", "viscous friction", "forward_dynamics", "tau - bias", "tau - 0.3 * v - bias", "viscous|damping|friction|proportional to v"),
    arguments("forward_dynamics", "torques limited", clipped(20.0), "(torque|tau|τ).*(clip|limit|cut|satur)|(clip|limit|cut|satur).*(torque|tau|τ)", robots=("ur5", "z1", "panda", "xarm7")),
    numbers("forward_dynamics", "mass of another variant", lambda arm: arm.one("masses", 2, lambda m: 1.2 * m), "mass.*<body 3>"),
    numbers("forward_dynamics", "tool on the flange", tool, TOOL, robots=("ur5", "kinova", "panda", "kr210_r2700_2")),
    articulated("no velocity product on the way out", "@ acc[arm.inside[j]] + c[j]", "@ acc[arm.inside[j]]", f"(v × S q̇|ω × q̇ p|velocity product|bias acceleration|\\bc\\b|c_j).*{OUT}"),
    articulated("no Ia c on the way back", "pA[j] + Ia @ c[j] +", "pA[j] +", f"(I.? ?(@ )?c|v × S q̇|velocity product|bias acceleration|\\bc\\b).*{OUT}"),
    articulated("force not turned back", "X[j].T @ pa", "X[j] @ pa", "(X|force|p).*(transposed|not turned|motions)"),
    articulated("gravity downwards", "[np.zeros(3), -arm.base", "[np.zeros(3), arm.base", f"gravity.*{OPPOSITE}"),
    articulated("inertia not reduced", "IA[j] - np.outer(U[j], U[j]) / d[j]", "IA[j]", "(U Uᵀ|U.*d|articulated|rank.one|reduc|seen through)"),
    articulated("no v ×* I v", "pA.append(-across(V[j + 1]).T @ IA[j] @ V[j + 1])", "pA.append(np.zeros(6))", f"(v ×\\* I v|bias force|gyroscopic|velocity).*{OUT}"),
)  # fmt: skip

STATICS = (
    text("bias_torque", "no gravity", "bias_torque", "inverse_dynamics(arm, q", "inverse_dynamics(arm.but(gravity=0 * arm.gravity), q", f"gravity.*{OUT}"),
    arguments("bias_torque", "velocities in degrees per second", lambda q, v: (q, np.rad2deg(v)), "degrees|180|57\\.29|3282"),
    text("bias_torque", "ω × q̇ p missing", "newton_euler", "+ p * a[j] + cross(carried, p * v[j])", "+ p * a[j]", f"(ω × q̇ p|v × S q̇).*{OUT}"),
    numbers("bias_torque", "mass of another variant", lambda arm: arm.one("masses", 3, lambda m: 0.8 * m), "mass.*<body 4>"),
    text("bias_torque", "velocity terms twice", "bias_torque", "q, v, np", "q, np.sqrt(2) * v, np", "(velocit|Coriolis|c\\(q, v\\)|\\bv\\b).*(2|1\\.414|doubl|twice)"),
    text("gravity_torque", "one weight missing", "gravity_torque", "- arm.masses[j] * J", "- (j != 2) * arm.masses[j] * J", f"(mass|weight).*<body 3>.*{OUT}"),
    text("gravity_torque", "sign", "gravity_torque", "tau = tau - ", "tau = tau + ", f"(gravity|torque).*{OPPOSITE}"),
    numbers("gravity_torque", "center of mass at the link origin", lambda arm: arm.one("centers", 1, lambda c: 0 * c), "center.*<body 2>|<body 2>.*center"),
    text("gravity_torque", "center not turned", "body_centers", "R[j + 1] @ arm.centers[j]", "arm.centers[j]", "(center|\\bc\\b).*(not turned|world axes|link axes|rotation)", equal=AT_ORIGIN),
    numbers("gravity_torque", "tool", tool, TOOL, robots=("ur5", "kinova", "panda", "kr210_r2700_2")),
    numbers("gravity_torque", "9.80", lambda arm: arm.but(gravity=arm.gravity * 0.99), "gravity.*(0\\.99|9\\.7)|0\\.99.*gravity|9\\.7\\d.*gravity", equal="weight.*0\\.99|masses? of (all|every).*0\\.99|torques?.*0\\.99"),
    arguments("gravity_torque", "zero of a joint", lambda q: (q + 0.5 * np.pi * (np.arange(len(q)) == 1),), "(zero|position).*<joint 2>|<joint 2>.*(90|1\\.57|zero|turned)"),
    text("static_torque", "loads of the other sign", "static_torque", "tau = tau - J[:3].T @ force - J[3:].T @ moment", "tau = tau + J[:3].T @ force + J[3:].T @ moment", f"external.*{OPPOSITE}"),
    text("static_torque", "moments missing", "static_torque", " - J[3:].T @ moment", "", f"moment.*external.*{OUT}|external.*moment.*{OUT}"),
    text("static_torque", "loads in world axes", "static_torque", "R[j + 1] @ external_wrenches[j, :3]\n        moment = R[j + 1] @ ", "external_wrenches[j, :3]\n        moment = ", "external.*world"),
    text("static_torque", "loads at the centers", "static_torque", "j + 1, o[j + 1])", "j + 1, body_centers(arm, q)[j])", "external.*center"),
    text("static_torque", "no gravity", "static_torque", "gravity_torque(arm, q)", "np.zeros(arm.n)", f"gravity.*{OUT}"),
    arguments("static_torque", "moment first", lambda q, w: (q, np.roll(w, 3, axis=1)), "moment.*(first|then)|moments? and forces?.*exchang|order"),
    text("static_torque", "load on the last body only", "static_torque", "for j in range(arm.n)", "for j in range(arm.n - 1, arm.n)", f"external.*{OUT}|external.*(only|last|<body n>)"),
    answers("power", "sign", lambda p, *_: -p, f"(power|torque|velocit|result|answer).*{OPPOSITE}"),
    text("power", "no gravity", "power", "inverse_dynamics(arm, q", "inverse_dynamics(arm.but(gravity=0 * arm.gravity), q", f"gravity.*{OUT}"),
    text("power", "velocity of the next joint", "power", ") * v", ") * np.roll(v, -1)", "(order|another joint|other joint|next|shift|v of)"),
    answers("power", "degrees per second", lambda p, *_: np.rad2deg(p), "degree|57\\.29|180"),
    answers("power", "regenerated power counted as supplied", lambda p, *_: np.abs(p), "(absolute|∣|magnitude|sign|always positive|never negative)"),
    answers("power", "brake: nothing regenerated", lambda p, *_: np.maximum(p, 0), "(clip|cut|negative|below|≥ 0|max)"),
)  # fmt: skip

WRENCHES = (
    plant("joint_wrenches", "moments about the centers of mass", at_centers, "center"),
    plant("joint_wrenches", "forces in world axes, moments in link axes", forces_in_world, "(force|linear).*world|world.*(force|linear)|mixed"),
    text("joint_wrenches", "no gravity", "newton_euler", "-arm.base_rotation.T @ arm.gravity", "np.zeros(3)", f"gravity.*{OUT}"),
    text("joint_wrenches", "r × f missing", "newton_euler", "R[j] @ m[j] + cross(r[j], push)", "R[j] @ m[j]", f"r × f.*{OUT}|without r"),
    numbers("joint_wrenches", "point masses", lambda arm: arm.but(tensors=0 * arm.tensors), f"(tensor|inertia|J).*{OUT}|point mass"),
    text("joint_wrenches", "c × F missing", "newton_euler", " + cross(c, f[j]))", ")", f"c × F.*{OUT}"),
    text("joint_wrenches", "last link not passed on", "newton_euler", "        i = arm.inside[j] - 1\n        if i >= 0:\n            push", "        i = arm.inside[j] - 1\n        if i >= 0 and j < arm.n - 1:\n            push", f"(<body n>|<joint n>).*(left out|passed)|mass.*<body n>|outer.*(<joint n>|<body n>).*{OUT}"),
    answers("joint_wrenches", "moments of the other sign", lambda f, *_: f * [1, 1, 1, -1, -1, -1], f"(moment|angular).*{OPPOSITE}"),
    answers("joint_wrenches", "row of one joint 2 % too large", lambda f, *_: f * np.where(np.arange(len(f)) == 2, 1.02, 1)[:, None], "<(body|joint) 3>|(<body 3>|<joint 3>).*1\\.02", equal="1\\.02"),
    text("multipliers", "moment in link axes", "multipliers", "turn(p, q[j]) @ m[j]", "m[j]", "(moment|λ_4|λ_5|t_1).*(link axes|turn|axes)"),
    text("multipliers", "forces in link axes", "multipliers", "R[j + 1] @ f[j]", "f[j]", "(force|λ_1).*(link axes|not turned|axes)"),
    text("multipliers", "forces in axes of the inside link", "multipliers", "R[j + 1] @ f[j]", "R[arm.inside[j]] @ f[j]", "(force|λ_1).*(inside|other|axes)"),
    text("multipliers", "t_1 and t_2 exchanged", "normals", "return t1, cross(axis, t1)", "return cross(axis, t1), t1", "t_1.*t_2|exchang|λ_4.*λ_5|row"),
    text("multipliers", "fifth of the other sign", "multipliers", "t2 @ moment]", "-t2 @ moment]", f"(λ_5|t_2|fifth|row|5).*{OPPOSITE}"),
    answers("multipliers", "reactions on the inside body", lambda x, *_: -x, f"inside body|{OPPOSITE}"),
    text("multipliers", "no gravity", "newton_euler", "-arm.base_rotation.T @ arm.gravity", "np.zeros(3)", f"gravity.*{OUT}"),
    numbers("multipliers", "a length", lambda arm: arm.one("translations", 2, lambda r: np.add(r, [0.01, 0, 0])), "(translation|place|length|origin).*<joint 3>"),
)  # fmt: skip

FAULTS = (*FORWARD, *STATICS, *WRENCHES)
