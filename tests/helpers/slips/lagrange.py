"""Lagrange's equations as in a textbook on control: M by Jacobians, Christoffel symbols, weights, and slips in it."""

TEXT = """
def inverse_dynamics(arm, q, v, a, BAD):
    n = len(q)

    def terms(q):
        M, g = np.zeros((n, n), complex), np.zeros(n, complex)
        A, o, z, above = [np.eye(3)], [np.zeros(3)], [], []
        for j in range(n):
            i, p, slides = arm.inside[j], arm.axes[j], arm.prismatic[j]
            turn = np.eye(3) + np.sin(q[j]) * hat(p) + (1 - np.cos(q[j])) * hat(p) @ hat(p)
            R = A[i] @ arm.rotations[j] if slides else A[i] @ arm.rotations[j] @ turn
            r = arm.translations[j] + (arm.rotations[j] @ p * q[j] if slides else 0)
            A.append(R)
            o.append(o[i] + A[i] @ r)
            z.append(R @ p)
            above.append([*(above[i - 1] if i else []), j])
            center = o[-1] + R @ arm.centers[j]
            lever = center
            Jv, Jw = np.zeros((3, n), complex), np.zeros((3, n), complex)
            for k in above[j]:
                Jv[:, k] = z[k] if arm.prismatic[k] else np.cross(z[k], lever - o[k + 1])
                Jw[:, k] = 0 if arm.prismatic[k] else z[k]
            I = R @ arm.tensors[j] @ R.T
            M += arm.masses[j] * Jv.T @ Jv + Jw.T @ I @ Jw
            g -= arm.masses[j] * Jv.T @ arm.gravity
        return M, g

    D = np.array([terms(q + 1e-30j * e)[0].imag / 1e-30 for e in np.eye(n)])  # k, i, j
    M, tau = terms(q + 0j)
    M, tau = M.real, tau.real
    C = np.zeros((n, n))
    for j in range(n):
        for l in range(n):
            C[j, l] = 0.5 * sum((D[k, j, l] + D[l, j, k] - D[j, l, k]) * v[k] for k in range(n))
    return M @ a + C @ v + tau
"""

SLIPS = (
    ("- D[j, l, k]) * v[k]", "+ D[j, l, k]) * v[k]", "∂M_jk/∂q_i.*opposite|gradient.*opposite"),
    ("- D[j, l, k]) * v[k]", ") * v[k]", "∂M_jk/∂q_i.*left out|gradient.*left out"),
    ("D[l, j, k] - D", "0 - D", "∂M_i[jk]/∂q_[kj].*left out|Ṁ v.*0.5"),
    ("I = R @ arm.tensors[j] @ R.T", "I = arm.tensors[j]", "the tensor in world axes.*not turned"),
    ("I = R @ arm.tensors[j] @ R.T", "I = R.T @ arm.tensors[j] @ R", "the tensor in world axes.*wrong way"),
    ("I = R @ arm.tensors[j] @ R.T", "I = R @ arm.tensors[j]", "the tensor in world axes.*second R"),
    ("center = o[-1] + R @ arm.centers[j]", "center = o[-1] + arm.centers[j]", "c in world axes.*not turned"),
    (
        "center = o[-1] + R @ arm.centers[j]",
        "center = o[-1] - R @ arm.centers[j]",
        "c in world.*opposite|center of mass",
    ),
    ("arm.masses[j] * Jv.T @ Jv +", "", "m J_vᵀ J_v.*left out"),
    ("Jw.T @ I @ Jw", "0 * Jw.T @ I @ Jw", "J_ωᵀ J J_ω.*left out|tensor"),
    ("Jw.T @ I @ Jw", "0.5 * Jw.T @ I @ Jw", "J_ωᵀ J J_ω.*0.5|tensor"),
    ("arm.masses[j] * Jv.T @ arm.gravity", "0 * Jv.T @ arm.gravity", "weight.*left out|gravity.*left out"),
    ("z.append(R @ p)", "z.append(p)", "joint axis.*not turned"),
    ("z.append(R @ p)", "z.append(A[i] @ p)", "joint axis.*inside"),
    ("o.append(o[i] + A[i] @ r)", "o.append(o[i] + r)", "r of the joint.*not turned"),
    ("o.append(o[i] + A[i] @ r)", "o.append(o[i] + R @ r)", "r of the joint.*outer"),
)
"""(place, what stands there, an expression that the message must match)."""
