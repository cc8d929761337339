"""Mistakes in mass matrices, their inverse and Coriolis matrices."""

# ruff: noqa: E501 - one case a line

import numpy as np
from other_functions.fault import answers, arguments, numbers, plant, text
from other_functions.mass_faults import TURNED
from other_functions.torque_faults import OPPOSITE, OUT


def about_origins(arm):
    points = [m * (c @ c * np.eye(3) - np.outer(c, c)) for m, c in zip(arm.masses, arm.centers, strict=True)]
    return arm.but(tensors=arm.tensors + np.array(points))


def columns_with_gravity(arm, right, code):
    """Columns by inverse dynamics at v = 0, from which gravity is not subtracted."""
    tau = code("inverse_dynamics", arm)
    return lambda q: np.array([tau(q, 0 * q, e) for e in np.eye(arm.n)]).T


def permuted(order):
    return lambda M, q: M[np.ix_(order(len(q)), order(len(q)))]


TENSOR = "(tensor|J in|\\bJ\\b|inertia)"
MASS = (
    text("mass_matrix", "tensor not turned", "mass_matrix", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "arm.tensors[j]", f"{TENSOR}.*{TURNED}"),
    text("mass_matrix", "tensor turned the wrong way", "mass_matrix", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "R[j + 1].T @ arm.tensors[j] @ R[j + 1]", f"{TENSOR}.*{TURNED}"),
    text("mass_matrix", "tensor turned once", "mass_matrix", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "R[j + 1] @ arm.tensors[j]", f"{TENSOR}.*({TURNED}|second R)"),
    answers("mass_matrix", "half", lambda M, q: 0.5 * M, "0\\.5|half|halved"),
    numbers("mass_matrix", "tensors about the link origins", about_origins, "link origin"),
    text("mass_matrix", "last body missing", "mass_matrix", "for j in range(arm.n)", "for j in range(arm.n - 1)", f"(mass|bod|link|tensor).*<body n>|row.*<joint n>.*{OUT}", equal=f"I a at joint '<joint n>'.*{OUT}"),
    answers("mass_matrix", "diagonal alone", lambda M, q: np.diag(np.diag(M)), "diagonal"),
    answers("mass_matrix", "lower triangle", lambda M, q: np.tril(M), "triangle"),
    numbers("mass_matrix", "products of inertia of the other sign", lambda arm: arm.but(tensors=arm.tensors * (2 * np.eye(3) - 1)), f"products? of inertia.*{OPPOSITE}"),
    numbers("mass_matrix", "axis of one joint", lambda arm: arm.one("axes", 3, lambda p: np.roll(p, 1)), "axis of (joint )?'?<joint 4>"),
    answers("mass_matrix", "drives added", lambda M, q: M + np.diag(0.01 * np.arange(1, len(q) + 1)), "(constant diagonal|rotor|armature)"),
    text("mass_matrix", "masses at the link origins", "mass_matrix", "j + 1, c[j])", "j + 1, poses(arm, q)[1][j + 1])", f"(center|inertial frame).*({OUT}|link origin)"),
    answers("mass_matrix", "joints in the reverse order", permuted(lambda n: range(n)[::-1]), "(joints|order).*(revers|order)|order"),
    numbers("mass_matrix", "mass of another variant", lambda arm: arm.one("masses", 4, lambda m: 1.3 * m), "mass.*<body 5>"),
    numbers("mass_matrix", "a length", lambda arm: arm.one("translations", 2, lambda r: np.add(r, [0.01, 0, 0])), "(translation|place|length|origin).*<joint 3>"),
    plant("mass_matrix", "columns with gravity", columns_with_gravity, "gravity"),
    text("mass_matrix", "J_vᵀ J_v without mass", "mass_matrix", "arm.masses[j] * J[:3]", "J[:3]", "mass.*(are|is|as) (1 kg|left out|equal|one\\b)|without (m\\b|the mass)|\\bm\\b.*(left out|missing)|m J_vᵀ J_v.*(factor|without)"),
    arguments("mass_matrix_inverse", "zero of a joint", lambda q: (q + 0.5 * np.pi * (np.arange(len(q)) == 2),), "(zero|position).*<joint 3>|<joint 3>.*(90|1\\.57|zero|turned)"),
    text("mass_matrix_inverse", "damped", "mass_matrix_inverse", "mass_matrix(arm, q))", "mass_matrix(arm, q) + 1e-3 * np.eye(arm.n))", "constant (diagonal|matrix)|rotor|damp|regulari"),
    answers("mass_matrix_inverse", "of the diagonal", lambda X, q: np.diag(1 / np.diag(np.linalg.inv(X))), "diagonal"),
    text("mass_matrix_inverse", "not inverted", "mass_matrix_inverse", "np.linalg.inv(mass_matrix(arm, q))", "mass_matrix(arm, q)", "mass_matrix|mass matrix|not inverted|in place of its inverse"),
    numbers("mass_matrix_inverse", "no tensor at the third body", lambda arm: arm.one("tensors", 2, lambda J: 0 * J), "(tensor|inertia|I_).*<body 3>|<body 3>.*(tensor|inertia)"),
    plant("mass_matrix_inverse", "elementwise", lambda arm, right, code: lambda q: 1 / (np.linalg.inv(right(q)) + 1e-3), "(element|entry|entries)"),
)  # fmt: skip
LAST = "D[i, j, k] + D[i, k, j] - D[j, k, i]"
CORIOLIS = (
    answers("coriolis_matrix", "transposed", lambda C, *_: C.T, "transpos"),
    text("coriolis_matrix", "½ forgotten", "coriolis_matrix", "0.5 * (", "1.0 * (", "(2|½|twice|doubl)"),
    text("coriolis_matrix", "last sign", "coriolis_matrix", LAST, "D[i, j, k] + D[i, k, j] + D[j, k, i]", f"(gradient|∂M_jk|∂M|last term|Christoffel).*{OPPOSITE}"),
    text("coriolis_matrix", "last term missing", "coriolis_matrix", LAST, "D[i, j, k] + D[i, k, j]", f"(gradient|∂M_jk|∂M|last term|Christoffel).*{OUT}"),
    text("coriolis_matrix", "second term missing", "coriolis_matrix", LAST, "D[i, j, k] - D[j, k, i]", f"(gradient|∂M_ik|∂M|Ṁ|Christoffel).*({OUT}|0\\.5|half)"),
    text("coriolis_matrix", "Ṁ in place of C", "coriolis_matrix", f"0.5 * ({LAST})", "D[i, j, k]", f"Ṁ|derivative of the mass matrix|∂M|gradient of the kinetic energy.*{OUT}"),
    text("coriolis_matrix", "centrifugal terms alone", "coriolis_matrix", "* v[k]", "* v[k] * (j == k)", "(products?|squares?|centrifugal|v_j v_k|off)"),
    text("coriolis_matrix", "tensors not turned", "mass_matrix", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "arm.tensors[j]", f"{TENSOR}.*{TURNED}"),
    numbers("coriolis_matrix", "mass of another variant", lambda arm: arm.one("masses", 3, lambda m: 0.7 * m), "mass.*<body 4>"),
    answers("coriolis_matrix", "viscous friction on the diagonal", lambda C, q, v: C + 0.5 * np.eye(len(q)), "(viscous|friction|damping|constant diagonal|proportional)"),
    answers("coriolis_matrix", "last row missing", lambda C, *_: C * (np.arange(len(C)) < len(C) - 1)[:, None], f"row.*{OUT}|<joint n>.*{OUT}|{OUT}.*<joint n>"),
    plant("coriolis_matrix", "by a coarse forward difference", lambda arm, right, code: forward_christoffel(arm, code, 1e-3), "difference"),
)  # fmt: skip


def forward_christoffel(arm, code, step):
    M = code("mass_matrix", arm)

    def f(q, v):
        D = np.stack([(M(q + step * e) - M(q)) / step for e in np.eye(arm.n)], axis=-1)
        return 0.5 * (D @ v + np.einsum("ikj,k->ij", D, v) - np.einsum("jki,k->ij", D, v))

    return f


FAULTS = (*MASS, *CORIOLIS)
