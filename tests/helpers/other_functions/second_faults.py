"""A second set of mistakes written without reading the judge, and which were written without reading the judge."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.frame_faults import OFFSET, finger
from other_functions.fresh_faults import CHAINS, HELD, INSIDE, TENSOR, TWICE, WRONG_WAY, many
from other_functions.torque_faults import OPPOSITE, OUT, articulated
from textbook_codes.code import TEXT, function_text

SIDEWAYS = ("ur5", "ur3", "z1", "so100", "kr500")
"""Arms with joint axes other than z."""

AXES = "(not turned|axes|turned|rotat|too (early|late))"
SHIFTED = "(shift|next|body after|another|other bod|other link|before|previous|order|exchang)"
BASED = ("ur5", "kinova", "xarm7")
"""Arms on which base regressors are planted."""


def several(function, name, edits, named, **more):
    """Places of several functions of the code written otherwise."""
    whole = TEXT
    for where, place, instead in edits:
        own = function_text(where)
        assert own.count(place) == 1, (where, place)
        whole = whole.replace(own, own.replace(place, instead))
    return plant(function, name, lambda arm, right, code: code(function, arm, whole), named, **more)


def rows_of_the_center(arm, right, code):
    """Linear rows that give the velocity of the center of mass, in place of the momentum."""
    return lambda q: right(q) * np.where(np.arange(6) < 3, 1 / arm.masses.sum(), 1)[:, None]


def from_upper_triangle(M, q):
    """Filled in by symmetry, the diagonal twice."""
    return np.triu(M) + np.triu(M).T


def sign(k):
    """A factor -1 at entry k of an argument, 1 elsewhere."""
    return lambda x: np.where(np.arange(len(x)) == k, -1, 1) * x


TORQUES = (
    text("inverse_dynamics", "third component, whatever the axis", "inverse_dynamics", "arm.axes[j] @ (f[j] if arm.prismatic[j] else m[j])", "(f[j] if arm.prismatic[j] else m[j])[2]", "(torque|moment|τ|project).*(\\bz\\b|component|axis|axes)|(axis|axes|component).*(\\bz\\b|another|other)", robots=SIDEWAYS),
    text("inverse_dynamics", "ω of the inside link not turned in ω × q̇ p", "newton_euler", "a[j] + cross(carried, p * v[j])", "a[j] + cross(w[i], p * v[j])", f"(ω × q̇ p|v × S q̇|ω × p).*({AXES}|{INSIDE})"),
    articulated("torques not passed on", "Ia @ c[j] + U[j] * u[j] / d[j]", "Ia @ c[j]", f"(U u|U D⁻¹ u|u / d|U.*u\\b|torque|drive|joint force).*({OUT}|not passed|outer)"),
    text("bias_torque", "(ω × r) × ω", "newton_euler", "cross(w[i], cross(w[i], r[j]))", "cross(cross(w[i], r[j]), w[i])", f"(ω × \\(ω × r\\)|centripetal).*{OPPOSITE}"),
    arguments("gravity_torque", "positions shifted by one joint", lambda q: (np.roll(q, 1),), "order|shift|position.*(another|next|before|other) joint|exchang"),
    arguments("static_torque", "first row taken for the base", lambda q, w: (q, np.vstack([w[1:], 0 * w[:1]])), f"(external|load).*{SHIFTED}|{SHIFTED}.*(external|load)"),
    text("power", "torques at v = 0", "power", "inverse_dynamics(arm, q, v, a)", "inverse_dynamics(arm, q, 0 * v, a)", f"(velocit|Coriolis|c\\(q, v\\)|\\bv\\b).*{OUT}|centripetal.*{OUT}.*ω × q̇ p.*{OUT}.*ω × I ω.*{OUT}"),
    text("joint_wrenches", "moment of the outer link not turned", "newton_euler", "m[i] + R[j] @ m[j]", "m[i] + m[j]", "(moment|\\bm\\b|\\bn\\b|\\bM\\b|\\bμ\\b).*(not turned|axes)"),
    text("multipliers", "moment in axes of the inside link", "multipliers", "turn(p, q[j]) @ m[j]", "arm.rotations[j] @ turn(p, q[j]) @ m[j]", f"(moment|λ_4|λ_5|t_1|t_2).*({AXES}|{INSIDE})"),
)  # fmt: skip

MATRICES = (
    answers("mass_matrix", "diagonal twice where the other triangle is filled in", from_upper_triangle, f"diagonal.*{TWICE}|{TWICE}.*diagonal"),
    numbers("mass_matrix", "center of one link mirrored", lambda arm: arm.one("centers", 2, lambda c: c * [1, -1, 1]), "(center|\\bc_y|\\bc\\b).*<body 3>|<body 3>.*(center|c_y)"),
    text("mass_matrix_inverse", "tensors shifted by one body", "mass_matrix", "arm.tensors[j]", "arm.tensors[j - 1]", f"{TENSOR}.*{SHIFTED}|{SHIFTED}.*{TENSOR}"),
    text("coriolis_matrix", "½ on the first term alone", "coriolis_matrix", "0.5 * (D[i, j, k] + D[i, k, j] - D[j, k, i])", "(0.5 * D[i, j, k] + D[i, k, j] - D[j, k, i])", "(∂M|gradient|Ṁ|Christoffel|symbols).*(1\\.5|2\\b|twice|doubl|½|0\\.5|half)|skew"),
)  # fmt: skip

FRAMES = (
    text("frame_placement", "the joint turns before its placement", "poses", "R.append(joint @ turn(arm.axes[j], q[j]))", "R.append(R[i] @ turn(arm.axes[j], q[j]) @ arm.rotations[j])", "(axis|axes).*(inside|not turned|parent|placement|other axes)|(rotation|placement|turn|\\bR\\b).*(order|before|first|exchang|inside|side|left)"),
    answers("frame_jacobian", "rates of the vector part of a quaternion", lambda J, q: J * np.where(np.arange(6) < 3, 1, 0.5)[:, None], "(angular|ω).*(0\\.5|half|halved)"),
    text("frame_jacobian", "of the center of mass of the last link", "frame_jacobian", "_, point = frame_pose(arm, q)", "point = body_centers(arm, q)[arm.frame_body - 1]", "center|another point|point of (the )?(frame|body|link)|offset|translation of (the )?(frame|link|tool)"),
    text("frame_jacobian_derivative", "ṗ of the link origin", "frame_jacobian_derivative", "speed = frame_velocity(arm, q, v)[:3]", "speed = vel[arm.frame_body]", f"(ṗ|velocity|speed).*(link|origin|offset|ω × r)|ω × r.*{OUT}", robots=OFFSET),
    text("frame_velocity", "no velocity of a sliding joint", "motions", "vel_j + slide", "vel_j", f"(<joint 8>|slid|prismatic|p q̇|q̇ p|z q̇).*{OUT}", **finger("panda")),
    text("frame_acceleration", "r × ω̇ between the links", "motions", "acc[i] + cross(dw[i], r)", "acc[i] + cross(r, dw[i])", f"(ω̇ × r|tangential|Euler|α × r).*{OPPOSITE}"),
)  # fmt: skip

MASSES = (
    numbers("center_of_mass", "masses shifted by one body", lambda arm: arm.but(masses=np.roll(arm.masses, 1)), f"mass.*{SHIFTED}"),
    text("center_of_mass_jacobian", "levers to the center of the whole robot", "center_of_mass_jacobian", "j + 1, c[j])", "j + 1, center_of_mass(arm, q))", "(center|lever|point|\\bc\\b).*(whole|total|all bod|all links|robot|outer|outside|moved|carried)"),
    text("center_of_mass_velocity", "ω in link axes, c in world axes", "center_velocities", "cross(w[j + 1], R[j + 1]", "cross(R[j + 1].T @ w[j + 1], R[j + 1]", f"(ω × c|ω|angular velocity).*({AXES}|{WRONG_WAY})"),
    text("momentum", "lever times velocity, without mass", "momentum", "cross(c[j] - com, p)", "cross(c[j] - com, rates[j])", f"(mass|\\bm\\b).*({OUT}|1 kg|without|\\bone\\b)|without.*(mass|\\bm\\b)"),
    text("momentum", "spin with the ω of the outer link", "momentum", "I @ w[j + 1]", "I @ w[min(j + 2, arm.n)]", "(ω|spin|angular velocity).*(outer|next|another|shift|other link|outside)", robots=CHAINS),
    plant("centroidal_map", "linear rows are those of the center's velocity", rows_of_the_center, "(linear|force).*(mass|factor|multiplied|divided)|divided by.*mass|center_of_mass_jacobian"),
    many("kinetic_energy", "about the link origins, without the mixed term", "kinetic_energy", (("w, _, _, _ = motions", "w, _, vel, _ = motions"), ("rates = center_velocities(arm, q, v)", "rates = vel[1:]"), ("arm.tensors[j] @ spin", "(arm.tensors[j] - arm.masses[j] * hat(arm.centers[j]) @ hat(arm.centers[j])) @ spin")), f"(first moment|m c\\b|v × ω|ω × c|center|mixed).*({OUT}|link origin)"),
    numbers("potential_energy", "one mass in pounds", lambda arm: arm.one("masses", 2, lambda m: m / 0.45359237), "(mass|weight).*<body 3>|<body 3>.*(mass|weight|pound)"),
)  # fmt: skip

DERIVATIVES = (
    answers("dtau_dq", "columns shifted by one joint", lambda D, *_: np.roll(D, 1, axis=1), "(column|joint|position).*(order|shift|another|next|before|exchang)|(order|shift).*(column|joint)"),
    several("dtau_dv", "product rule of ω × J ω", (("dtau_dv", "2 * coriolis_matrix(arm, q, v)", "gradient(lambda x: inverse_dynamics(arm, q, x, a), v)"), ("newton_euler", "cross(w[-1], J @ w[-1])", "cross(w[-1], J @ np.real(w[-1]))")), f"(ω × (J|I) ω|gyroscopic|J ω|I ω).*({HELD}|half|0\\.5|product)|product rule"),
    arguments("da_dq", "at v = 0", lambda q, v, tau: (q, 0 * v, tau), f"(velocit|\\bv\\b|Coriolis).*{OUT}"),
    text("da_dv", "diagonal of M alone", "da_dv", "np.linalg.solve(mass_matrix(arm, q), ", "np.linalg.solve(np.diag(np.diag(mass_matrix(arm, q))), ", "diagonal"),
    text("dwrenches_dq", "R of accelerations not differentiated", "newton_euler", "acc_j = R[j].T @", "acc_j = np.real(R[j].T) @", f"(acceleration|\\ba\\b|gravity|rotation|\\bR\\b|Rᵀ|\\bX\\b|turn).*{HELD}|product rule|∂X a|a × S"),
    text("dwrenches_dv", "ω of the inside link not differentiated in ω × q̇ p", "newton_euler", "+ cross(carried, p * v[j])", "+ cross(np.real(carried), p * v[j])", f"(ω × q̇ p|v × S q̇|ω × p).*({HELD}|half|0\\.5|product)|product rule"),
    text("dwrenches_da", "no ω̇ × r", "newton_euler", " + cross(dw[i], r[j])", "", f"(ω̇ × r|tangential|α × r|Euler).*{OUT}"),
    text("dmultipliers_dq", "force turned the wrong way", "multipliers", "R[j + 1] @ f[j]", "R[j + 1].T @ f[j]", f"(force|λ_1|\\bf\\b).*{WRONG_WAY}"),
    answers("dmultipliers_dv", "moments first", lambda D, *_: np.roll(D, 2, axis=1), "(moment|λ_4|λ_5|row).*(order|exchang|first|shift)|order"),
)  # fmt: skip

REGRESSORS = (
    text("joint_torque_regressor", "gravity in world axes", "body_regressor", "B @ (acc[j + 1] - arm.gravity)", "B @ acc[j + 1] - arm.gravity", "(gravity|weight|m g).*(not turned|world|axes|rotat)"),
    text("joint_torque_regressor", "no moment of the weight", "body_regressor", "-hat(push)", "-hat(B @ acc[j + 1])", f"(gravity|weight|m g).*(moment|m c|center|c ×|{OUT})|(moment|m c|c ×).*(gravity|weight|m g)"),
    arguments("base_regressor", "a joint moves the other way round", lambda *x: tuple(map(sign(1), x)), f"<joint 2>.*{OPPOSITE}|{OPPOSITE}.*<joint 2>|no combination of", robots=BASED),
    text("body_regressor", "c × ω̇", "body_regressor", "hat(rate) + hat(spin)", "-hat(rate) + hat(spin)", f"(ω̇ × (m )?c|α × c|tangential|Euler).*{OPPOSITE}"),
    text("momentum_regressor", "momenta at the centers of mass", "projected", "i + 1, o[i + 1])", "i + 1, o[i + 1] + R[i + 1] @ arm.centers[i])", "(center|lever|point|origin)"),
    text("kinetic_energy_regressor", "½ forgotten at I", "kinetic_energy_regressor", "0.5 * spin", "spin", f"(tensor|inertia|\\bI\\b|I_xx|\\bJ\\b|spin|ω).*{TWICE}"),
    text("potential_energy_regressor", "g forgotten at m c", "potential_energy_regressor", "-R[j + 1].T @ arm.gravity", "-R[j + 1].T @ np.sign(arm.gravity)", "(m c|first moment|center|mc_x|\\bmc).*(gravity|\\bg\\b|0\\.10|9\\.8|factor|multiplied|scaled|divided)"),
    text("forward_dynamics_parameter_derivatives", "accelerations without bias", "forward_dynamics_parameter_derivatives", "a = forward_dynamics(arm, q, v, tau)", "a = np.linalg.solve(mass_matrix(arm, q), tau)", f"(bias|\\bh\\b|gravity|velocity|Coriolis).*({OUT}|not subtracted)"),
)  # fmt: skip

FAULTS = (*TORQUES, *MATRICES, *FRAMES, *MASSES, *DERIVATIVES, *REGRESSORS)
