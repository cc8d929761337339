"""Mistakes written without reading the judge."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.frame_faults import OFFSET, SLIDING, finger
from other_functions.regressor_faults import scaled
from other_functions.torque_faults import OPPOSITE, OUT, articulated
from scipy.spatial.transform import Rotation
from textbook_codes.code import TEXT, function_text
from textbook_codes.kinematics import frame_pose

CHAINS = ("ur5", "kr500", "kinova", "xarm7", "ur3", "kr210_r2700_2")
"""Arms without branches, all of whose joints turn."""

SKEWED = ("kinova", "z1", "panda", "xarm7", "kr210_r2700_2")
"""Arms with products of inertia."""

TENSOR = "(tensor|\\bJ\\b|\\bI\\b|inertia)"
WRONG_WAY = "(wrong way|transposed|Rᵀ|inverse|turned back|opposite direction)"
HELD = "(not differentiated|constant|held|derivative)"
TWICE = "(2\\b|twice|doubl|½)"
INSIDE = "(inside|before|previous|parent|another link|other link)"
OWN = "(own|only|alone)"


def many(function, name, where, edits, named, **more):
    """Several places of one function of the code written otherwise."""
    own = changed = function_text(where)
    for place, instead in edits:
        assert changed.count(place) == 1, (where, place)
        changed = changed.replace(place, instead)
    whole = TEXT.replace(own, changed)
    return plant(function, name, lambda arm, right, code: code(function, arm, whole), named, **more)


def scalar_first(T, q):
    """A quaternion w, x, y, z read as x, y, z, w."""
    T = np.array(T)
    T[:3, :3] = Rotation.from_quat(np.roll(Rotation.from_matrix(T[:3, :3]).as_quat(), 1)).as_matrix()
    return T


def turned_by(transposed):
    """Both parts of the answer turned by the rotation of the frame, or back."""

    def planted(arm, right, code):
        def f(q, *more):
            R = frame_pose(arm, q)[0]
            return np.kron(np.eye(2), R.T if transposed else R) @ right(q, *more)

        return f

    return planted


def mirrored_lever(arm, right, code):
    """Of the point at the world's origin, with p × ω in the wrong order."""

    def f(q):
        J = np.array(right(q))
        J[:3] -= np.cross(frame_pose(arm, q)[1], J[3:], axis=0)
        return J

    return f


def per_moved_mass(arm, right, code):
    """Column k is divided by the mass outside joint k, in place of all mass."""
    moved = [sum(arm.masses[j] for j in range(arm.n) if k in arm.path(j + 1)) for k in range(arm.n)]
    return lambda q: right(q) * arm.masses.sum() / moved


def steiner(arm):
    """Steiner's term subtracted from tensors that are about the centers of mass already."""
    points = [m * (c @ c * np.eye(3) - np.outer(c, c)) for m, c in zip(arm.masses, arm.centers, strict=True)]
    return arm.but(tensors=arm.tensors - np.array(points))


def no_inside_rows(D, *_):
    """Wrenches at joints inside of joint k taken as independent of q_k."""
    n = len(D)
    return D * (np.arange(n)[:, None] >= np.arange(n))[:, None, :]


def entry(k, x):
    """A factor x at entry k of an argument, 1 elsewhere."""
    return lambda y: np.where(np.arange(len(y)) == k, x, 1) * y


TORQUES = (
    text("inverse_dynamics", "no Coriolis acceleration of a sliding joint", "newton_euler", "acc_j + 2 * cross(carried, p * v[j]) + p", "acc_j + p", f"(2 ω ×|Coriolis|slid).*{OUT}", robots=SLIDING),
    text("inverse_dynamics", "c turned into the inside link", "newton_euler", "cross(c, f[j])", "cross(R[j] @ c, f[j])", "(c × F|\\bc\\b|center).*(turned|axes|inside)"),
    text("inverse_dynamics", "tensor acts on ω̇ of the inside link", "newton_euler", "J @ dw[-1]", "J @ (R[j].T @ dw[i])", f"(J ω̇|ω̇|angular acceleration).*({INSIDE}|{OUT})"),
    text("forward_dynamics", "gravity counted twice", "forward_dynamics", "tau - bias_torque(arm, q, v)", "tau - bias_torque(arm, q, v) - gravity_torque(arm, q)", f"gravity.*{TWICE}"),
    articulated("c with the inertia not yet reduced", "pA[j] + Ia @ c[j] +", "pA[j] + IA[j] @ c[j] +", "(Ia|I\\^a|Iᵃ|I.{0,3} c|v × S q̇|velocity product|\\bc\\b|articulated).*(not reduced|unreduced|in place|U Uᵀ|before|rank|whole|I\\^A|itself)"),
    articulated("c only added after the joint is solved for", "- U[j] @ before)", "- U[j] @ (before - c[j]))", f"(v × S q̇|velocity product|bias acceleration|\\bc\\b|c_j).*({OUT}|added later)"),
    articulated("Steiner's term of the other sign", "arm.tensors[j] - hat(h) @", "arm.tensors[j] + hat(h) @", f"(Steiner|parallel|m c|about|tensor|hat|c ×).*({OPPOSITE}|link origin|about|subtracted)"),
    text("bias_torque", "centripetal acceleration with the inside ω", "newton_euler", "cross(w[-1], cross(w[-1], c))\n", "cross(carried, cross(carried, c))\n", f"(ω × \\(ω × c\\)|centripetal|ω).*{INSIDE}"),
    text("bias_torque", "principal moments alone in the gyroscopic moment", "newton_euler", "cross(w[-1], J @ w[-1])", "cross(w[-1], np.diag(J) * w[-1])", "(product|I_xy|I_xz|I_yz|diagonal|principal)", robots=SKEWED),
    text("bias_torque", "moment in place of the force of a sliding joint", "inverse_dynamics", "f[j] if arm.prismatic[j] else m[j]", "m[j]", "(<joint 8>|<joint 9>|slid|prismatic).*(moment|torque|turn|revolute)|(revolute|moment).*(<joint 8>|<joint 9>|slid|prismatic)", robots=SLIDING),
    text("gravity_torque", "own link of each joint missing", "gravity_torque", "arm.masses[j] * J[:3].T @ arm.gravity", "(np.arange(arm.n) != j) * (arm.masses[j] * J[:3].T @ arm.gravity)", f"(\\bown\\b|its link|link itself|outer.*only|last column).*|{OUT}.*own"),
    arguments("gravity_torque", "elbow turns with the shoulder", lambda q: (q + q[1] * (np.arange(len(q)) == 2),), "<joint 3>.*<joint 2>|<joint 2>.*<joint 3>|coupl", robots=CHAINS),
    text("gravity_torque", "R taken twice", "body_centers", "R[j + 1] @ arm.centers[j]", "R[j + 1] @ R[j + 1] @ arm.centers[j]", f"(center|\\bc\\b).*(twice|turned|rotat|axes|{TWICE})"),
    text("static_torque", "force turned the wrong way", "static_torque", "R[j + 1] @ external_wrenches[j, :3]", "R[j + 1].T @ external_wrenches[j, :3]", f"(external|load).*{WRONG_WAY}|{WRONG_WAY}.*(external|load)"),
    text("static_torque", "loads at the origin of the inside link", "static_torque", "o[j + 1])", "o[arm.inside[j]])", f"(external|load).*{INSIDE}|(external|load).*(lever|point|applied|act)"),
    text("static_torque", "moments in world axes", "static_torque", "R[j + 1] @ external_wrenches[j, 3:]", "external_wrenches[j, 3:]", "(moments?.*external|external.*moment|load.*moment|moment.*load).*(world|not turned|axes)"),
    answers("power", "running sums", lambda p, *_: np.cumsum(p), "cumul|running|sums?\\b|joints? (before|inside)"),
    text("power", "mm/s of a sliding joint", "power", " * v", " * v * np.where(arm.prismatic, 1000, 1)", "(<joint 8>|<joint 9>|slid|prismatic).*(1000|milli)|(1000|milli).*(<joint 8>|<joint 9>|slid|prismatic)", robots=SLIDING),
    text("power", "speed without its sign", "power", " * v", " * np.abs(v)", "(∣v∣|absolute|magnitude|sign of (v|the velocity)|\\|v\\|)"),
)  # fmt: skip

WRENCHES = (
    text("joint_wrenches", "r × f in axes of the outer link", "newton_euler", "cross(r[j], push)", "R[j] @ cross(r[j], f[j])", "(r × f|lever|\\br\\b|\\bf\\b).*(axes|turned|too (early|late)|before|after)"),
    text("joint_wrenches", "levers from the center of mass of the inside link", "newton_euler", "cross(r[j], push)", "cross(r[j] - arm.centers[i], push)", "(r × f|lever|\\br\\b|r - c|moment).*(center|r - c)|center.*(r × f|lever|moment)"),
    many("joint_wrenches", "weight in world axes", "newton_euler", (("-arm.base_rotation.T @ arm.gravity", "np.zeros(3)"), ("arm.masses[j] * at_center", "arm.masses[j] * (at_center - arm.gravity)")), "(gravity|weight|m g).*(world|not turned|link axes|axes|rotat)"),
    text("multipliers", "moment turned the wrong way", "multipliers", "turn(p, q[j]) @ m[j]", "turn(p, -q[j]) @ m[j]", f"(moment|λ_4|λ_5|t_1).*({WRONG_WAY}|{OPPOSITE})"),
    text("multipliers", "moments about the centers of mass", "multipliers", "turn(p, q[j]) @ m[j]", "turn(p, q[j]) @ (m[j] - cross(arm.centers[j], f[j]))", "center"),
    text("multipliers", "t_1 from z, or x", "normals", "np.argmin(np.abs(axis))", "2 if abs(axis[2]) < 0.9 else 0", "t_1|t_2|normal|quarter|λ_4.*λ_5"),
)  # fmt: skip

MATRICES = (
    text("mass_matrix", "levers from the origin of the inside link", "point_jacobian", "point - o[k + 1]", "point - o[arm.inside[k]]", f"(lever|origin|\\bo\\b|\\br\\b|z ×|translation).*{INSIDE}"),
    text("mass_matrix", "own joint of each body missing", "point_jacobian", "arm.path(body)", "arm.path(body)[:-1]", f"\\bown\\b|(joint|column).*(itself|last of).*{OUT}"),
    text("mass_matrix", "tensor turned by the inside link", "mass_matrix", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "R[arm.inside[j]] @ arm.tensors[j] @ R[arm.inside[j]].T", f"{TENSOR}.*({INSIDE}|joint axes|turned)"),
    numbers("mass_matrix", "tensor of the neighbor", lambda arm: arm.one("tensors", 2, lambda J: arm.tensors[3]), f"{TENSOR}.*<body 3>|<body 3>.*({TENSOR}|<body 4>)"),
    text("mass_matrix", "a sliding joint taken as turning", "point_jacobian", "if arm.prismatic[k]", "if False", "(<joint 8>|<joint 9>|slid|prismatic).*(turn|revolute|hinge)|(revolute|turn).*(<joint 8>|<joint 9>|slid|prismatic)", robots=SLIDING),
    numbers("mass_matrix_inverse", "Steiner's term subtracted again", steiner, f"{TENSOR}.*(link origin|about|Steiner|center)"),
    answers("mass_matrix_inverse", "of the lower triangle", lambda X, q: np.linalg.inv(np.tril(np.linalg.inv(X))), "triangle|above the diagonal|upper", equal="Gauss-Seidel.*1 step"),
    text("coriolis_matrix", "derivative with respect to the wrong index", "coriolis_matrix", "D[i, k, j] - D[j, k, i]", "D[j, k, i] - D[i, k, j]", "transpos|(∂M|Christoffel|gradient).*(exchang|opposite|sign)"),
    text("coriolis_matrix", "velocity of the column", "coriolis_matrix", "* v[k]", "* v[j]", "(v_j|velocity|\\bv\\b|q̇_j).*(column|v_k|own|in place|another|index)|squares"),
    text("coriolis_matrix", "Ṁ less half a gradient", "coriolis_matrix", "0.5 * (D[i, j, k] + D[i, k, j] - D[j, k, i])", "(D[i, j, k] - 0.5 * D[j, k, i])", "skew"),
    text("coriolis_matrix", "last velocity missing", "coriolis_matrix", "for k in range(arm.n)", "for k in range(arm.n - 1)", f"(velocity|\\bv\\b|motion|q̇).*<joint n>.*{OUT}|<joint n>.*(velocity|\\bv\\b|motion|q̇).*{OUT}"),
)  # fmt: skip

FRAMES = (
    answers("frame_placement", "quaternion with w first read as with w last", scalar_first, "quaternion|scalar|\\bw\\b.*(first|last)"),
    text("frame_placement", "frame turned before the link", "frame_pose", "R[body] @ arm.frame_rotation", "arm.frame_rotation @ R[body]", "(rotation|placement|turn|\\bR\\b|frame).*(order|left|world|before|first|side|exchang)", robots=("ur5", "kinova", "panda", "ur3", "kr210_r2700_2")),
    text("frame_placement", "slide along world axes", "poses", "origin + axis * q[j]", "origin + arm.axes[j] * q[j]", "(slid|prismatic|axis|q p|z q|<joint 8>|<joint 9>).*(not turned|world|axes|turned)", **finger("vx300s")),
    text("frame_jacobian", "levers from the origin of the inside link", "point_jacobian", "point - o[k + 1]", "point - o[arm.inside[k]]", f"(lever|origin|\\bo\\b|\\br\\b|z ×|translation).*{INSIDE}"),
    plant("frame_jacobian", "turned by R in place of Rᵀ", turned_by(transposed=False), f"(\\bR\\b|rotation|axes|turned|reference).*({WRONG_WAY}|by R\\b)"),
    answers("frame_jacobian", "column per degree", lambda J, q: np.deg2rad(1) ** (np.arange(len(q)) == 2) * J, "<joint 3>.*(degree|0\\.0174|57\\.|180)|(degree|0\\.0174).*<joint 3>"),
    plant("frame_jacobian", "point at the world's origin, ω × p of the wrong sign", mirrored_lever, f"(world|origin|ω × p|p ×|lever|point).*({OPPOSITE}|{TWICE}|mirrored|wrong way)"),
    text("frame_jacobian", "joints beyond the frame counted", "point_jacobian", "for k in arm.path(body)", "for k in range(arm.n)", "(joint|column|path).*(beyond|outer|outside|between|behind|path|every|all|not move)", robots=("ur5", "ur3"), frame="forearm_link"),
    text("frame_jacobian_derivative", "axes turn with the last link", "frame_jacobian_derivative", "cross(w[k + 1], z[k])", "cross(w[arm.frame_body], z[k])", "(ω|ż|rate|axis|axes).*(of the frame|last|outermost|outer|another|<body of the frame>)"),
    text("frame_jacobian_derivative", "z × ṗ of the other sign", "frame_jacobian_derivative", "+ cross(z[k], speed", "- cross(z[k], speed", f"(z × ṗ|z × \\(ṗ|z ×|ṗ|velocity).*{OPPOSITE}"),
    plant("frame_jacobian_derivative", "Rᵀ J̇ as the derivative of Rᵀ J", turned_by(transposed=True), f"(Ṙ|ω × J|ω ×|derivative of (the )?(R|rotation)|\\bR\\b|axes).*({OUT}|{HELD})|product rule|Rᵀ J̇|local axes|axes of the frame|local"),
    text("frame_velocity", "offset in world axes", "frame_velocity", "r = R[b] @ arm.frame_point", "r = arm.frame_point", "(offset|point|\\br\\b|frame).*(not turned|world|link axes|axes)", robots=OFFSET),
    text("frame_velocity", "lever of the next origin with its own ω", "motions", "vel_j = vel[i] + cross(w[i], r)", "vel_j = vel[i] + cross(w[i] + (not arm.prismatic[j]) * z[j] * v[j], r)", "(ω × r|ω).*(outer|own|itself|outside|next|another|other link|of the link, not of the inside one)"),
    text("frame_acceleration", "no ω̇ × r between the links", "motions", "acc[i] + cross(dw[i], r) + cross", "acc[i] + cross", f"(ω̇ × r|tangential|Euler|α × r|angular acceleration).*{OUT}"),
    text("frame_acceleration", "classical made classical again", "frame_acceleration", "np.concatenate([linear, dw[b]])", "np.concatenate([linear + cross(w[b], frame_velocity(arm, q, v)[:3]), dw[b]])", "ω × (v|ṗ|ṙ)|(spatial|classical).*(twice|again|added)", equal=f"ω × r in the velocity of the link origin.*{OPPOSITE}"),
    arguments("frame_acceleration", "q̈ of one joint per degree", lambda q, v, a: (q, v, entry(1, 180 / np.pi)(a)), "<joint 2>.*(degree|57\\.|180)|(degree|57\\.).*<joint 2>"),
)  # fmt: skip

MASSES = (
    numbers("center_of_mass", "one center in millimeters", lambda arm: arm.one("centers", 2, lambda c: 1000 * c), "<body 3>.*(1000|milli)|center.*<body 3>|(1000|milli).*<body 3>"),
    text("center_of_mass", "centers turned by the inside link", "body_centers", "R[j + 1] @ arm.centers[j]", "R[arm.inside[j]] @ arm.centers[j]", f"(center|\\bc\\b).*({INSIDE}|turned|joint axes|axes)"),
    plant("center_of_mass_jacobian", "columns per moved mass", per_moved_mass, "(mass|divided|column).*(outer|outside|moved|moves|moving|subtree|carried)|(outer|moved|moves|moving|subtree).*mass", equal="column of a joint multiplied: '<joint 2>'", robots=CHAINS),
    numbers("center_of_mass_jacobian", "one mass in grams", lambda arm: arm.one("masses", 2, lambda m: 1000 * m), "mass.*<body 3>|<body 3>.*(1000|gram)"),
    text("center_of_mass_velocity", "c × ω", "center_velocities", "cross(w[j + 1], R[j + 1] @ arm.centers[j])", "cross(R[j + 1] @ arm.centers[j], w[j + 1])", f"(ω × c|center|\\bc\\b).*{OPPOSITE}"),
    text("center_of_mass_velocity", "velocity of the inside origin", "center_velocities", "vel[j + 1] +", "vel[arm.inside[j]] +", f"(velocity|\\bv\\b|ȯ|ṗ|ω × r).*({INSIDE}|{OUT})"),
    text("momentum", "c + com in place of c - com", "momentum", "c[j] - com", "c[j] + com", f"(center of mass|com|about|point|lever|total).*({OPPOSITE}|{TWICE}|minus|mirrored|added)", equal=f"\\bm\\b in the mass of all bodies.*{OPPOSITE}"),
    text("momentum", "about the mean of the centers", "momentum", "center_of_mass(arm, q)", "sum(body_centers(arm, q)) / arm.n", "mean|(about|center of mass|point).*(weight|equal|mass|another|other|not)"),
    text("momentum", "principal moments alone", "momentum", "R[j + 1] @ arm.tensors[j] @", "R[j + 1] @ np.diag(np.diag(arm.tensors[j])) @", f"(products? of inertia|I_xy).*{OUT}|diagonal|principal", robots=SKEWED),
    text("momentum", "R I R", "momentum", "@ R[j + 1].T\n", "@ R[j + 1]\n", f"{TENSOR}.*(turned|R I R|R J R|{WRONG_WAY}|second R|Rᵀ)"),
    many("momentum", "linear part of the link origins", "momentum", (("w, _, _, _ = motions", "w, _, vel, _ = motions"), ("linear = linear + p", "linear = linear + arm.masses[j] * vel[j + 1]")), f"linear.*(link origin|center|ω × c)|(link origin|center|ω × c).*linear|ω × c.*(force|m v).*{OUT}"),
    text("centroidal_map", "about the center of mass at q = 0", "centroidal_map", "center_of_mass(arm, q)", "center_of_mass(arm, 0 * q)", "(center of mass|com|about|point).*(q = 0|zero|pose|constant|another|other|held|fixed)", equal="translation of joint '<joint 1>' is off"),
    text("centroidal_map", "own joint of each body missing", "centroidal_map", "for k in range(arm.n)", "for k in range(j)", f"\\bown\\b|(joint|column).*(itself|last of).*{OUT}", equal="ω of the link at every body is that of the inside link"),
    text("kinetic_energy", "½ forgotten at the masses", "kinetic_energy", "0.5 * arm", "arm", f"(mass|translation|linear|v²|\\bv\\b|m v).*{TWICE}"),
    text("kinetic_energy", "own rate in place of ω", "kinetic_energy", "R[j + 1].T @ w[j + 1]", "arm.axes[j] * v[j]", f"(ω|spin|angular velocity).*({OWN}|inside.*{OUT})|inside.*ω.*{OUT}|ω.*inside", equal=f"constant diagonal|tensor of every body {OUT}", robots=CHAINS),
    text("potential_energy", "composite masses at the own centers", "potential_energy", "arm.masses[j] * arm", "arm.masses[j:].sum() * arm", "(outer|cumul|composite|sum).*mass|mass.*(outer|cumul|composite|sum|outside|carried)", robots=CHAINS),
    arguments("potential_energy", "degrees at one joint", lambda q: (entry(1, np.pi / 180)(q),), "<joint 2>.*(degree|0\\.0174|57\\.|180)|(degree|0\\.0174).*<joint 2>"),
)  # fmt: skip

DERIVATIVES = (
    many("dtau_dq", "R not differentiated on the way back", "newton_euler", (("push = R[j] @", "push = np.real(R[j]) @"), ("R[j] @ m[j]", "np.real(R[j]) @ m[j]")), f"(S ×\\*|∂R|∂X|derivative of (the )?(R|rotation|X|turn)|product rule)|(\\bR\\b|\\bX|rotation|turn|force|wrench|\\bf\\b).*{HELD}"),
    answers("dtau_dq", "symmetric part", lambda D, *_: 0.5 * (D + D.T), "symmetr|transpos"),
    text("dtau_dv", "C + Cᵀ in place of 2 C", "dtau_dv", "2 * coriolis_matrix(arm, q, v)", "coriolis_matrix(arm, q, v) + coriolis_matrix(arm, q, v).T", "Ṁ|C \\+ Cᵀ|symmetr|derivative of the mass matrix|∂M"),
    text("da_dq", "gravity of the other sign", "dtau_dq", "arm, x", "arm.but(gravity=-arm.gravity), x", f"gravity.*{OPPOSITE}"),
    text("da_dv", "M⁻¹ from the right", "da_dv", "np.linalg.solve(mass_matrix(arm, q), dtau_dv(arm, q, v, tau))", "(dtau_dv(arm, q, v, tau) @ np.linalg.inv(mass_matrix(arm, q)))", "M⁻¹.*(right|order|side|behind|after)|(order|exchang).*(matri|product|factor)"),
    answers("dwrenches_dq", "no change inside of the joint", no_inside_rows, "triangle|(bod|joint|link|wrench)\\w* (inside|before)|inside (bod|joint|link)|inside of", robots=CHAINS),
    text("dwrenches_dv", "product rule of ω × (ω × c)", "newton_euler", "cross(w[-1], cross(w[-1], c))\n", "cross(w[-1], cross(np.real(w[-1]), c))\n", "(ω × \\(ω × c\\)|ω × c|centripetal).*(half|0\\.5|product|inner|second|not differentiated|constant|held)|product rule"),
    text("dwrenches_da", "wrench of the own body alone", "newton_euler", "        if i >= 0:\n            push", "        if False:\n            push", f"(outer|passed on|outside|Xᵀ|accumul|propagat).*({OUT}|{OWN}|not)|\\bown\\b"),
    text("dmultipliers_dq", "turn of the moment not differentiated", "multipliers", "turn(p, q[j]) @ m[j]", "turn(p, np.real(q[j])) @ m[j]", f"(moment|turn|rotation|λ_4|λ_5|t_1).*{HELD}|product rule"),
    text("dmultipliers_dv", "no gyroscopic moment", "newton_euler", " + cross(w[-1], J @ w[-1])", "", f"(ω × (J|I) ω|gyroscopic).*{OUT}"),
    text("dmultipliers_da", "no ω̇ × c", "newton_euler", "acc[-1] + cross(dw[-1], c) +", "acc[-1] +", f"(ω̇ × c|α × c|tangential|Euler).*{OUT}"),
)  # fmt: skip

SIGNED = np.array([1, 1, 1, 1, 1, -1, 1, -1, -1, 1])
REGRESSORS = (
    answers("joint_torque_regressor", "products as ∫xy, not -∫xy", scaled(SIGNED), f"(product|I_xy|I_xz).*({OPPOSITE}|-1)"),
    text("joint_torque_regressor", "wrenches turned the wrong way", "projected", "B = R[i + 1]", "B = R[i + 1].T", f"(wrench|force|turned|\\bR\\b|\\bX).*{WRONG_WAY}|not turned back"),
    text("joint_torque_regressor", "wrenches at the origin of the inside link", "projected", "o[i + 1])", "o[arm.inside[i]])", f"(origin|lever|point|r × f|\\br\\b|wrench).*({INSIDE}|{OUT})"),
    text("body_regressor", "no ω̇ × c", "body_regressor", "hat(rate) + hat(spin)", "hat(spin)", f"(ω̇ × (m )?c|α × c|Euler|tangential).*{OUT}"),
    text("body_regressor", "acceleration of the inside origin", "body_regressor", "acc[j + 1] - arm", "acc[arm.inside[j]] - arm", f"(acceleration|\\ba\\b|ṗ|p̈).*{INSIDE}|(ω̇ × r|ω × \\(ω × r\\)).*{OUT}"),
    text("body_regressor", "no moment of m c", "body_regressor", "        Y[j, 3:, 1:4] = -hat(push)\n", "", f"(m c|first moment|c × |center).*{OUT}"),
    arguments("base_regressor", "at a = 0", lambda q, v, a: (q, v, 0 * a), f"(acceleration|\\ba\\b).*{OUT}|no combination of", robots=("ur5", "kinova", "xarm7")),
    answers("base_regressor", "last row missing", lambda W, *_: W * (np.arange(len(W)) < len(W) - 1)[:, None], "\\brow|<joint n>|no combination of", robots=("ur5", "kinova", "xarm7")),
    text("momentum_regressor", "ω in world axes", "momentum_regressor", "R[j + 1].T @ w[j + 1]", "w[j + 1]", "(ω|spin|angular velocity).*(world|not turned|axes)"),
    text("momentum_regressor", "velocity of the inside origin", "momentum_regressor", "R[j + 1].T @ vel[j + 1]", "R[j + 1].T @ vel[arm.inside[j]]", f"(velocity|\\bv\\b|ṗ|ȯ).*{INSIDE}|ω × r.*{OUT}"),
    text("kinetic_energy_regressor", "½ at m c, too", "kinetic_energy_regressor", "np.cross(speed, spin)", "0.5 * np.cross(speed, spin)", "(first moment|m c|center|mc_x|\\bm?c\\b).*(0\\.5|half|halved)"),
    text("kinetic_energy_regressor", "½ forgotten at m", "kinetic_energy_regressor", "0.5 * speed", "speed", f"(mass|\\bm\\b|v²|m v).*{TWICE}"),
    text("potential_energy_regressor", "heights of the inside links", "potential_energy_regressor", "@ o[j + 1]", "@ o[arm.inside[j]]", f"(height|origin|\\bo\\b|mass|\\bm\\b|\\br\\b).*{INSIDE}"),
    text("potential_energy_regressor", "sign at m alone", "potential_energy_regressor", "= -arm.gravity @ o", "= arm.gravity @ o", f"(mass|\\bm\\b|height|link origin).*({OPPOSITE}|-1)"),
    arguments("forward_dynamics_parameter_derivatives", "at v = 0", lambda q, v, tau: (q, 0 * v, tau), f"(velocit|\\bv\\b|Coriolis).*{OUT}"),
    text("forward_dynamics_parameter_derivatives", "M in place of M⁻¹", "forward_dynamics_parameter_derivatives", "np.linalg.solve(mass_matrix(arm, q), joint_torque_regressor(arm, q, v, a))", "mass_matrix(arm, q) @ joint_torque_regressor(arm, q, v, a)", "M.*(in place|not invert|M⁻¹)|M⁻¹.*(in place|inver)|mass matrix.*invert"),
)  # fmt: skip

FAULTS = (*TORQUES, *WRENCHES, *MATRICES, *FRAMES, *MASSES, *DERIVATIVES, *REGRESSORS)
