"""A third set of mistakes, written without reading the code of the judge; whole formulations come first."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.frame_faults import OFFSET, SLIDING
from other_functions.fresh_faults import CHAINS, HELD, INSIDE, OWN, SKEWED, TENSOR, TWICE, many
from other_functions.mass_faults import TOOLED
from other_functions.regressor_faults import scaled
from other_functions.second_faults import AXES, BASED, SHIFTED, several
from other_functions.torque_faults import OPPOSITE, OUT, TOOL, articulated, tool
from textbook_codes.algebra import cross
from textbook_codes.code import text_with
from textbook_codes.kinematics import frame_pose, motions, poses
from textbook_codes.masses import body_centers, center_of_mass

HALVED = "(0\\.5|half|halved|½)"
FINGER = "(<joint 8>|<joint 9>|<body 8>|<body 9>|slid|prismatic|finger)"
DRIVES = "(sign|driv|brak|positive|negative|supplied|regenerat|power)"
EFFICIENCY = "(0\\.9\\b|1\\.11|efficien)"
CENTRIPETAL = "(ω × \\(ω × (r|c|m c)\\)|centripetal)"


def helper(function, form, where, name, place, instead, named, **more):
    """One place, in a function that another code of this function calls, written otherwise."""
    changed = text_with(where, place, instead)
    return plant(function, name, lambda arm, right, code: code(form, arm, changed), named, **more)


def formulation(function, form, name, place, instead, named, **more):
    """The same in the other code itself."""
    return helper(function, form, form, name, place, instead, named, **more)


def last_without_mass(arm):
    return arm.one("masses", arm.n - 1, lambda m: 0 * m)


def half_way(arm):
    """Every center of mass half way to the next joint."""
    centers = np.array(arm.centers)
    for j, i in enumerate(arm.inside):
        if i > 0:
            centers[i - 1] = 0.5 * arm.translations[j]
    return arm.but(centers=centers)


def halved_products(arm):
    return arm.but(tensors=arm.tensors * (0.5 + 0.5 * np.eye(3)))


def unit_torques(arm, right, code):
    """Columns of M⁻¹ by articulated bodies, gravity left on."""
    accelerations = code("articulated_accelerations", arm)
    return lambda q: np.array([accelerations(q, 0 * q, e) for e in np.eye(arm.n)]).T


def cholesky_exchanged(X, q):
    """L⁻¹ L⁻ᵀ in place of L⁻ᵀ L⁻¹."""
    L = np.linalg.inv(np.linalg.cholesky(np.linalg.inv(X)))
    return L @ L.T


def inverse_of_placement(T, q):
    """[Rᵀ, -p]: the translation is not turned."""
    T = np.array(T)
    T[:3, :3], T[:3, 3] = T[:3, :3].T, -T[:3, 3]
    return T


def transported_as_wrench(arm, right, code):
    """From the world's origin to the frame as a wrench is: the linear rows stay, the angular ones get p × them."""

    def f(q):
        J, p = np.array(right(q)), frame_pose(arm, q)[1]
        J[:3] += np.cross(p, J[3:], axis=0)
        J[3:] -= np.cross(p, J[:3], axis=0)
        return J

    return f


def local_derivative(arm, right, code):
    """d(Rᵀ J)/dt as Rᵀ (J̇ + ω × J)."""

    def f(q, v):
        J, D, R = code("frame_jacobian", arm)(q), right(q, v), frame_pose(arm, q)[0]
        w = motions(arm, q, v, 0 * v)[0][arm.frame_body]
        rows = [D[part] + np.cross(w, J[part], axis=0) for part in (slice(0, 3), slice(3, 6))]
        return np.concatenate([R.T @ x for x in rows])

    return f


def twist_of_two_points(arm, right, code):
    """Velocity of the link origin, taken to the world's origin with the position of the frame."""

    def f(q, v):
        found = np.array(right(q, v))
        R, p = poses(arm, q)[0], frame_pose(arm, q)[1]
        found[:3] += cross(p + R[arm.frame_body] @ arm.frame_point, found[3:])
        return found

    return f


def accelerometer(arm, right, code):
    """Acceleration in axes of the frame, from which gravity in world axes is subtracted."""

    def f(q, v, a):
        found, R = right(q, v, a), frame_pose(arm, q)[0]
        return np.concatenate([R.T @ found[:3] - arm.gravity, R.T @ found[3:]])

    return f


def mean_of_pairs(arm, right, code):
    """The mean of what there is and the next body, one body after another."""

    def f(q):
        found, *others = body_centers(arm, q)
        for c in others:
            found = 0.5 * (found + c)
        return found

    return f


def with_link_inside(arm, right, code):
    """Every joint moves the link inside of it, too."""

    def f(q):
        J, c = np.array(right(q)), body_centers(arm, q)
        _, o, z = poses(arm, q)
        for k, i in enumerate(arm.inside):
            if i > 0:
                moved = z[k] if arm.prismatic[k] else cross(z[k], c[i - 1] - o[k + 1])
                J[:, k] += arm.masses[i - 1] * moved / arm.masses.sum()
        return J

    return f


def in_first_link(arm, right, code):
    return lambda q, v: poses(arm, q)[0][1].T @ right(q, v)


def shifted_without_mass(arm, right, code):
    """From the world's origin to the center of mass with its velocity, not with the linear momentum."""

    def f(q, v):
        found, com = np.array(right(q, v)), center_of_mass(arm, q)
        found[3:] += cross(com, found[:3]) * (1 - 1 / arm.masses.sum())
        return found

    return f


def diagonal_energy(arm, right, code):
    M = code("mass_matrix", arm)
    return lambda q, v: 0.5 * np.diag(M(q)) @ v**2


TORQUES = (
    formulation("inverse_dynamics", "torques_in_world_axes", "world axes, tensors as at q = 0", "R[b] @ arm.tensors[j] @ R[b].T", "poses(arm, 0 * q)[0][b] @ arm.tensors[j] @ poses(arm, 0 * q)[0][b].T", f"{TENSOR}.*(q = 0|zero|constant|pose|not turned|world axes|axes)"),
    formulation("inverse_dynamics", "torques_in_world_axes", "world axes, moments about the world's origin", " - cross(o[j + 1], force[j])", "", "(moment|torque p · n|o × F|r × f|\\bo\\b|lever|p ×).*(world|origin|left out|missing)"),
    formulation("inverse_dynamics", "torques_in_world_axes", "world axes, ω of the inside link across J ω", "cross(w[b], I @ w[b])", "cross(w[arm.inside[j]], I @ w[b])", f"(ω × (J|I) ω|gyroscopic|\\bω\\b).*{INSIDE}"),
    formulation("inverse_dynamics", "torques_in_world_axes", "world axes, torque about the axis of the next joint", "z[j] @ (force", "z[min(j + 1, arm.n - 1)] @ (force", f"(axis|axes|\\bz\\b|project).*({SHIFTED}|outer)|({SHIFTED}|outer).*(axis|axes)", robots=CHAINS),
    formulation("inverse_dynamics", "torques_in_world_axes", "world axes, moments handed on before they are complete", "    for j in range(arm.n - 1, -1, -1):", "    for j in range(arm.n):", f"(outer|outside|passed on|handed on|accumul|beyond).*({OUT}|{OWN}|not|beyond|order)|order of"),
    formulation("inverse_dynamics", "spatial_torques", "spatial vectors, v ×* S q̇", "across(V[j + 1]) @ S[j] * v[j]", "-across(V[j + 1]).T @ S[j] * v[j]", "(v × S q̇|velocity product|\\bc\\b|v ×).*(force|×\\*|dual|transposed|motion|linear|left out)"),
    formulation("inverse_dynamics", "spatial_torques", "spatial vectors, v × I v", "- across(V[j + 1]).T @ inertia", "+ across(V[j + 1]) @ inertia", "(v ×\\* I v|bias force|I v|v ×).*(motion|v × I v|dual|transposed|in place|not)"),
    helper("inverse_dynamics", "spatial_torques", "rigid_inertia", "spatial vectors, off-diagonal blocks of the inertia exchanged", "m * c], [-m * c", "-m * c], [m * c", f"(center|m c|first moment|\\bc\\b|\\bh\\b).*({OPPOSITE}|transposed|exchanged|other side)"),
    helper("inverse_dynamics", "spatial_torques", "joint_transforms", "spatial vectors, R in place of Rᵀ in the lower block", "-R.T @ hat(r)", "-R @ hat(r)", f"(ω × r|ω̇ × r|r ×|\\br\\b|\\bX\\b|lever|translation).*({AXES}|wrong way|transposed|Rᵀ|Eᵀ r×)"),
    formulation("inverse_dynamics", "spatial_torques", "spatial vectors, inertial force without acceleration of the joint", "inertia @ A[j + 1] - across", "inertia @ (A[j + 1] - S[j] * a[j]) - across", f"(S q̈|p q̈|\\ba\\b|q̈|acceleration|ω̇).*({OWN}|{OUT}|{INSIDE})|I a .*without S q̈"),
    formulation("inverse_dynamics", "lagrange_torques", "Lagrange, gradient of vᵀ M v without ½", "- 0.5 * np.einsum", "- np.einsum", f"(gradient|∂M|kinetic energy|∂T).*{TWICE}"),
    formulation("inverse_dynamics", "lagrange_torques", "Lagrange, weights at the link origins", "slope = gradient(lambda x: potential_energy(arm, x), q)", "slope = gradient(lambda x: potential_energy(arm.but(centers=0 * arm.centers), x), q)", "(gravity|weight|m g).*(center|link origin|c ×|m c)|(center|link origin|c ×|m c).*(gravity|weight|m g)"),
    formulation("inverse_dynamics", "torques_by_products", "Lagrange, every pair of velocities counted once", "2 * symbol", "symbol", f"(products?|pairs?|v_j v_k|q̇_j q̇_k|Coriolis).*{HALVED}|{HALVED}.*products?"),
    answers("inverse_dynamics", "rotor inertias with the acceleration of the next joint", lambda tau, q, v, a: tau + 0.05 * np.roll(a, -1), "(rotor|armature|constant).*(matrix|diagonal|next|another)|added to M|(q̈|acceleration).*(next|another joint)"),
    text("forward_dynamics", "Coulomb friction that drives", "forward_dynamics", "tau - bias", "tau + 0.8 * np.sign(v) - bias", "(friction|Coulomb|sign v|sign\\(v)"),
    formulation("forward_dynamics", "composite_accelerations", "composite bodies, tool's mass only in M", "spatial_torques(arm, q, v, 0 * v)", "spatial_torques(arm.but(masses=arm.masses * (np.arange(arm.n) < arm.n - 1)), q, v, 0 * v)", "(mass|weight|bod|center).*<body n>|<body n>.*(mass|weight|left out)", robots=CHAINS),
    helper("forward_dynamics", "composite_accelerations", "composite_mass_matrix", "composite bodies, only the next link counted", "    for j in range(arm.n - 1, -1, -1):\n        i =", "    for j in range(arm.n):\n        i =", f"(composite|outer|outside|bod|inertia).*({OUT}|{OWN}|next|one|not|order)"),
    articulated("U and d of the own link alone", "U[j] = IA[j] @ S[j]", "U[j] = rigid_inertia(arm, j) @ S[j]", f"(U|\\bd\\b|S I|I S|articulated|I\\^A|Iᴬ).*({OWN}|rigid|outer|link|{OUT})"),
    articulated("handed to the joint before, not to the link inside", "i = arm.inside[j] - 1", "i = j - 1", f"{FINGER}|branch|{INSIDE}|sibling", robots=SLIDING),
    articulated("v ×* I v without the rate of the joint", "-across(V[j + 1]).T @ IA[j] @ V[j + 1]", "-across(V[j + 1] - S[j] * v[j]).T @ IA[j] @ (V[j + 1] - S[j] * v[j])", f"(v ×\\* I v|bias force|\\bω\\b|\\bv\\b|gyroscopic).*({INSIDE}|{OWN}|{OUT}|without S q̇)"),
    text("bias_torque", "-ω² r in place of ω × (ω × r)", "newton_euler", "cross(w[i], cross(w[i], r[j]))", "-(w[i] @ w[i]) * r[j]", f"{CENTRIPETAL}|ω²|ω · r"),
)  # fmt: skip

STATICS = (
    numbers("gravity_torque", "mass of the last body left out", last_without_mass, "(mass|weight|bod|center|link).*<body n>|<body n>.*(mass|weight|left out)", robots=CHAINS),
    text("gravity_torque", "levers from the next origin", "point_jacobian", "point - o[k + 1]", "point - o[min(k + 2, arm.n)]", f"(lever|origin|\\bo\\b|\\br\\b|z ×|translation|p - o).*(outer|outside|{SHIFTED})", robots=CHAINS),
    text("static_torque", "loads act on the link inside", "static_torque", "j + 1, o[j + 1])", "arm.inside[j], o[j + 1])", f"(external|load).*({INSIDE}|{SHIFTED})"),
    text("power", "torques at a = 0", "power", "inverse_dynamics(arm, q, v, a)", "bias_torque(arm, q, v)", f"(acceleration|M a|\\ba\\b|inertia).*{OUT}"),
    answers("power", "efficiency of the gears by the sign of the power", lambda p, *_: np.where(p > 0, p / 0.9, 0.9 * p), f"{EFFICIENCY}.*{DRIVES}|{DRIVES}.*{EFFICIENCY}"),
    text("joint_wrenches", "r × f with the sum of the inside link", "newton_euler", "cross(r[j], push)", "cross(r[j], f[i])", f"(r × f|lever|\\bf\\b|moment).*({INSIDE}|{OWN}|both|sum|total|whole|own)"),
    text("joint_wrenches", "force of the outer link not turned", "newton_euler", "push = R[j] @ f[j]", "push = f[j]", f"(\\bf\\b|force|\\bF\\b|r × f).*{AXES}"),
    text("multipliers", "turned by the position of the joint before", "multipliers", "turn(p, q[j]) @ m[j]", "turn(p, q[j - 1]) @ m[j]", "(position|\\bq\\b|angle|turn).*(before|previous|another joint|other joint|shift|next|inside|wrong)"),
)  # fmt: skip

MATRICES = (
    formulation("mass_matrix", "composite_mass_matrix", "composite bodies, columns end at the link inside", "while arm.inside[k] > 0:", "if arm.inside[k] > 0:", f"band|tridiagonal|neighbor|(entr|column|row|beyond|far|passed on|handed on|inside|between).*({OUT}|{OWN}|not)"),
    formulation("mass_matrix", "composite_mass_matrix", "composite bodies, r × f left out between the joints", "force = X[k].T @ force", "force = np.kron(np.eye(2), X[k][:3, :3].T) @ force", f"(r × f|lever|moment of|\\br\\b).*{OUT}"),
    answers("mass_matrix_inverse", "factors of Cholesky in the other order", cholesky_exchanged, "Cholesky|L⁻¹|factor.*order|order.*factor|triangular"),
    plant("mass_matrix_inverse", "columns by unit torques, with gravity", unit_torques, "gravity|weight"),
    text("coriolis_matrix", "only on and above the diagonal", "coriolis_matrix", "        for j in range(arm.n):\n", "        for j in range(i, arm.n):\n", "triangle|below the diagonal|lower"),
)  # fmt: skip

FRAMES = (
    numbers("frame_placement", "offset of the frame twice", lambda arm: arm.but(frame_point=2 * arm.frame_point), f"(offset|point|frame|tool|translation).*({TWICE}|off by|\\bis off|wrong|another)", robots=OFFSET),
    answers("frame_placement", "inverse whose translation is not turned", inverse_of_placement, "inver|(rotation|\\bR\\b).*transposed.*(translation|\\bp\\b).*(opposite|sign|not turned)"),
    text("frame_jacobian", "offset turned with the link inside", "frame_pose", "R[body] @ arm.frame_point", "R[arm.inside[body - 1]] @ arm.frame_point", f"(offset|point|frame|lever|\\br\\b).*({INSIDE}|{AXES})", robots=OFFSET),
    plant("frame_jacobian", "taken to the frame as a wrench is", transported_as_wrench, "wrench|dual|force|(angular|moment).*(p ×|lever|linear)|transform|adjoint|Ad\\b"),
    answers("frame_jacobian", "R Ṙᵀ without ½", lambda J, q: J * np.where(np.arange(6) < 3, 1, 2)[:, None], f"(angular|ω).*{TWICE}"),
    text("frame_jacobian_derivative", "speed against the link inside", "frame_jacobian_derivative", "speed - vel[k + 1]", "speed - vel[arm.inside[k]]", f"(ȯ|velocity|ṗ|speed|z ×).*({INSIDE}|origin)"),
    text("frame_jacobian_derivative", "ż × p in place of ż × (p - o)", "frame_jacobian_derivative", "cross(rate, point - o[k + 1])", "cross(rate, point)", f"(ż|rate|\\bo\\b|lever|p - o).*(origin|world|{OUT}|subtract)|ż × p"),
    plant("frame_jacobian_derivative", "local, ω × J of the other sign", local_derivative, f"(Ṙ|ω × J|ω ×|derivative of (the )?R).*({OPPOSITE}|{TWICE})"),
    plant("frame_velocity", "at the world's origin, from two points", twist_of_two_points, "offset|another point|point of (the )?(frame|body|link)|link origin|lever|translation of (the )?(frame|link|tool)|ω × r|p × ω", robots=OFFSET),
    text("frame_acceleration", "ω × velocity of the link inside", "motions", "cross(w[i], cross(w[i], r))", "cross(w[i], vel[i])", f"{CENTRIPETAL}|ω × (v|ṗ|ȯ)|velocity.*({INSIDE}|place)"),
    plant("frame_acceleration", "in axes of the frame, gravity in those of the world", accelerometer, "gravity"),
)  # fmt: skip

MASSES = (
    plant("center_of_mass", "mean of pairs, body after body", mean_of_pairs, "masses|mass of (all|every|<|.?body)|weights?\\b|\\bmean|average|equal"),
    plant("center_of_mass_jacobian", "every joint moves the link inside of it, too", with_link_inside, f"(bod|link|path|moves).*({INSIDE}|moves|moved)"),
    plant("center_of_mass_velocity", "in axes of the first link", in_first_link, f"{AXES}|reference", equal="angle.*<joint 1>.*zero"),
    plant("momentum", "shifted to the center of mass without the mass", shifted_without_mass, "(about|lever|shift|transport|c ×).*(mass|another point|other point|divided|factor|origin|velocity)|(mass|1 kg).*(lever|shift|about|c ×)", equal="panda_link1' alone explain all numbers"),
    text("centroidal_map", "each column about its joint", "centroidal_map", "cross(c[j] - com, p)", "cross(c[j] - poses(arm, q)[1][k + 1], p)", "(about|lever|center of mass|com|point|c - ).*(joint|origin|link)|(joint|origin).*(about|lever)"),
    plant("kinetic_energy", "½ Σ M_jj v_j²", diagonal_energy, "diagonal|(products?|mixed|off).*(left out|missing)|squares"),
    numbers("kinetic_energy", "½ at the products of inertia, too", halved_products, f"(product|I_xy|I_xz|I_yz|off).*{HALVED}", robots=SKEWED),
    numbers("potential_energy", "centers half way to the next joint", half_way, "center|\\bc\\b"),
    answers("potential_energy", "spring of a balancer added", lambda U, q: U + 15 * q[1] ** 2, "spring|<joint 2>.*(quadratic|q²|square)"),
)  # fmt: skip

DERIVATIVES = (
    text("dtau_dq", "R of ω not differentiated", "newton_euler", "carried = R[j].T @ w[i]", "carried = np.real(R[j]).T @ w[i]", f"(ω|\\bR\\b|Rᵀ|velocity|\\bX\\b|turn).*{HELD}|product rule|∂X v"),
    text("dtau_dq", "place of a sliding joint not differentiated", "newton_euler", "@ p * q[j])", "@ p * np.real(q[j]))", f"({FINGER}|translation|\\br\\b|p q|column).*({HELD}|{OUT})", robots=SLIDING),
    several("dtau_dv", "product rule of ω × (ω × r)", (("dtau_dv", "2 * coriolis_matrix(arm, q, v)", "gradient(lambda x: inverse_dynamics(arm, q, x, a), v)"), ("newton_euler", "cross(w[i], cross(w[i], r[j]))", "cross(np.real(w[i]), cross(w[i], r[j]))")), f"({CENTRIPETAL}|ω × r).*({HELD}|half|0\\.5|product)|product rule"),
    text("da_dq", "∂M a of the other sign", "da_dq", "    a = forward_dynamics(arm, q, v, tau)\n", "    a = -forward_dynamics(arm, q, v, tau)\n", f"(acceleration|\\ba\\b|∂M|mass matrix).*{OPPOSITE}"),
    text("da_dq", "accelerations without gravity", "da_dq", "forward_dynamics(arm, q, v, tau)", "forward_dynamics(arm.but(gravity=0 * arm.gravity), q, v, tau)", f"(gravity|weight).*{OUT}"),
    text("da_dv", "M at q = 0", "da_dv", "np.linalg.solve(mass_matrix(arm, q), ", "np.linalg.solve(mass_matrix(arm, 0 * q), ", "(M⁻¹|\\bM\\b|mass matrix|inverse).*(q = 0|zero|another|constant|pose|position)"),
    many("dwrenches_dq", "weight not differentiated", "newton_euler", (("-arm.base_rotation.T @ arm.gravity", "np.zeros(3)"), ("arm.masses[j] * at_center", "arm.masses[j] * (at_center - np.real(poses(arm, q)[0][j + 1]).T @ arm.gravity)")), f"(gravity|weight|m g).*({HELD}|{OUT})"),
    text("dwrenches_dv", "J ω × ω", "newton_euler", "cross(w[-1], J @ w[-1])", "cross(J @ w[-1], w[-1])", f"(ω × (J|I) ω|gyroscopic).*{OPPOSITE}"),
    text("dwrenches_da", "no c × F", "newton_euler", " + cross(c, f[j]))", ")", f"c × F.*{OUT}"),
    numbers("dmultipliers_dq", "tool", tool, TOOL, robots=TOOLED),
    text("dmultipliers_dv", "ω × q̇ p missing", "newton_euler", "+ p * a[j] + cross(carried, p * v[j])", "+ p * a[j]", f"(ω × q̇ p|v × S q̇).*{OUT}"),
    answers("dmultipliers_da", "rows of two joints exchanged", lambda D, *_: D[[1, 0, *range(2, len(D))]], "<joint 1>.*<joint 2>|<joint 2>.*<joint 1>|(row|joint).*another|order|exchang"),
)  # fmt: skip

REGRESSORS = (
    text("joint_torque_regressor", "ω̇ in world axes", "body_regressor", "B @ dw[j + 1]", "dw[j + 1]", f"(ω̇|angular acceleration|\\bα\\b).*(world|{AXES})"),
    answers("joint_torque_regressor", "tensors in kg cm²", scaled(np.array([1, 1, 1, 1, *[1e-4] * 6])), "(tensor|I_xx|inertia|column).*(0\\.0001|1e-0?4|10000|cm)|(0\\.0001|1e-0?4|cm).*(tensor|I_xx)"),
    arguments("base_regressor", "degrees per second", lambda q, v, a: (q, np.rad2deg(v), a), "degree|57\\.29|180|no combination of", robots=BASED),
    text("body_regressor", "ω ωᵀ without ω² 1", "body_regressor", "hat(spin) @ hat(spin)", "np.outer(spin, spin)", f"{CENTRIPETAL}|ω ωᵀ|ω²"),
    text("body_regressor", "I_xz and I_yz exchanged in one row", "tensor_rows", "[0, x, y, 0, z, 0]", "[0, x, y, z, 0, 0]", "I_xz|I_yz|products? of inertia|(column|parameter).*(order|exchang)"),
    text("momentum_regressor", "v × c", "momentum_regressor", "-hat(speed)", "hat(speed)", f"(m c|first moment|c × v|c × m v|center|\\bv\\b).*{OPPOSITE}"),
    text("kinetic_energy_regressor", "velocity in world axes, spin in link axes", "kinetic_energy_regressor", "R[j + 1].T @ vel[j + 1]", "vel[j + 1]", f"(\\bv\\b|velocity|ȯ|ṗ).*(world|{AXES})"),
    text("potential_energy_regressor", "gravity in axes of the link inside", "potential_energy_regressor", "-R[j + 1].T @ arm.gravity", "-R[arm.inside[j]].T @ arm.gravity", f"(gravity|m c|first moment|center|\\bR\\b).*({INSIDE}|{AXES})"),
    text("forward_dynamics_parameter_derivatives", "accelerations without gravity", "forward_dynamics_parameter_derivatives", "forward_dynamics(arm, q, v, tau)", "forward_dynamics(arm.but(gravity=0 * arm.gravity), q, v, tau)", f"(gravity|weight).*{OUT}"),
)  # fmt: skip

FAULTS = (*TORQUES, *STATICS, *MATRICES, *FRAMES, *MASSES, *DERIVATIVES, *REGRESSORS)
