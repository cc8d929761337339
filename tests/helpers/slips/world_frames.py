"""Newton-Euler in world axes, about the centers of mass, and slips in it."""

TEXT = """
def inverse_dynamics(arm, q, v, a, BAD):
    n = len(q)
    A, o = [np.eye(3)] + [None] * n, [np.zeros(3)] + [None] * n
    w, dw, acc = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    acc[0] = -arm.gravity
    z, C, F, N = [None] * n, [None] * n, [None] * n, [None] * n
    for j in range(n):
        i, p, slides = arm.inside[j], arm.axes[j], arm.prismatic[j]
        own = arm.rotations[j] if slides else arm.rotations[j] @ Rotation.from_rotvec(q[j] * p).as_matrix()
        B = A[i]
        A[j + 1] = B @ own
        A_j = A[j + 1]
        z[j] = A_j @ p
        local = arm.translations[j] + (arm.rotations[j] @ p * q[j] if slides else 0)
        r = B @ local
        o[j + 1] = o[i] + B @ local
        acc[j + 1] = acc[i] + np.cross(dw[i], r) + np.cross(w[i], np.cross(w[i], r))
        if slides:
            w[j + 1], dw[j + 1] = w[i], dw[i]
            acc[j + 1] += 2 * np.cross(w[i], z[j] * v[j]) + z[j] * a[j]
        else:
            w[j + 1] = w[i] + z[j] * v[j]
            dw[j + 1] = dw[i] + z[j] * a[j] + np.cross(w[i], z[j] * v[j])
        s = A_j @ arm.centers[j]
        C[j] = o[j + 1] + A_j @ arm.centers[j]
        I = A_j @ arm.tensors[j] @ A_j.T
        W, D = w[j + 1], dw[j + 1]
        F[j] = arm.masses[j] * (acc[j + 1] + np.cross(D, s) + np.cross(W, np.cross(W, s)))
        N[j] = I @ D + np.cross(W, I @ W)
    tau = np.zeros(n)
    force, moment = np.zeros((n, 3)), np.zeros((n, 3))
    for j in range(n - 1, -1, -1):
        force[j] += F[j]
        moment[j] += N[j] + np.cross(C[j] - o[j + 1], F[j])
        tau[j] = z[j] @ (force[j] if arm.prismatic[j] else moment[j])
        i = arm.inside[j]
        if i > 0:
            lever = o[j + 1] - o[i]
            force[i - 1] += force[j]
            moment[i - 1] += moment[j] + np.cross(lever, force[j])
    return tau
"""

SLIPS = (
    ("np.cross(dw[i], r)", "0 * r", "ω̇ × r.*left out|without r"),
    ("np.cross(dw[i], r)", "np.cross(r, dw[i])", "ω̇ × r.*opposite|opposite r"),
    ("np.cross(w[i], np.cross(w[i], r))", "0 * r", "ω × \\(ω × r\\).*left out"),
    ("np.cross(w[i], np.cross(w[i], r))", "np.cross(w[i], r)", "ω × \\(ω × r\\).*one ω"),
    ("acc[i] + np.cross(dw", "np.cross(dw", "acceleration of the inside.*left out"),
    ("r = B @ local", "r = local", "r of the joint.*not turned"),
    ("r = B @ local", "r = A_j @ local", "r of the joint.*outer link"),
    ("z[j] = A_j @ p", "z[j] = p", "axis in world axes.*not turned"),
    ("z[j] = A_j @ p", "z[j] = B @ p", "axis in world axes.*inside"),
    ("z[j] = A_j @ p", "z[j] = A_j.T @ p", "axis in world axes.*wrong way"),
    ("np.cross(w[i], z[j] * v[j])\n        s", "0 * r\n        s", "ω × q̇ p.*left out|v × S q̇"),
    ("np.cross(w[i], z[j] * v[j])\n        s", "np.cross(z[j] * v[j], w[i])\n        s", "ω × q̇ p.*opposite"),
    ("dw[i] + z[j] * a[j]", "z[j] * a[j]", "ω̇ of the inside link.*left out"),
    ("w[i] + z[j] * v[j]\n", "z[j] * v[j]\n", "ω of the inside link.*left out|angular velocity of the inside"),
    ("I = A_j @ arm.tensors[j] @ A_j.T", "I = arm.tensors[j]", "the tensor in world axes.*not turned"),
    ("I = A_j @ arm.tensors[j] @ A_j.T", "I = A_j.T @ arm.tensors[j] @ A_j", "the tensor in world axes.*wrong way"),
    ("I = A_j @ arm.tensors[j] @ A_j.T", "I = A_j @ arm.tensors[j]", "the tensor in world axes.*second R"),
    ("I = A_j @ arm.tensors[j] @ A_j.T", "I = B @ arm.tensors[j] @ B.T", "the tensor in world axes.*inside"),
    ("s = A_j @ arm.centers[j]\n", "s = arm.centers[j]\n", "c in world axes.*not turned"),
    ("s = A_j @ arm.centers[j]\n", "s = B @ arm.centers[j]\n", "c in world axes.*inside"),
    ("np.cross(D, s)", "0 * s", "ω̇ × c.*left out"),
    ("np.cross(D, s)", "np.cross(dw[i], s)", "ω̇ × c.*inside"),
    ("np.cross(W, np.cross(W, s))", "0 * s", "ω × \\(ω × c\\).*left out"),
    ("np.cross(W, np.cross(W, s))", "-np.cross(W, np.cross(W, s))", "ω × \\(ω × c\\).*opposite"),
    ("np.cross(W, I @ W)", "0 * s", "ω × (J|I) ω.*left out"),
    ("np.cross(W, I @ W)", "np.cross(I @ W, W)", "ω × (J|I) ω.*opposite"),
    ("np.cross(C[j] - o[j + 1], F[j])", "0 * F[j]", "c × F.*left out"),
    ("np.cross(C[j] - o[j + 1], F[j])", "-np.cross(C[j] - o[j + 1], F[j])", "c × F.*opposite"),
    ("force[i - 1] += force[j]", "force[i - 1] += 0 * force[j]", "f of the outer.*left out|passed on"),
    ("moment[j] + np.cross(lever", "np.cross(lever", "n of the outer.*left out"),
    ("np.cross(lever, force[j])", "0 * lever", "r × f.*left out|without r"),
    ("np.cross(lever, force[j])", "np.cross(force[j], lever)", "r × f.*opposite|opposite r"),
    ("np.cross(lever, force[j])", "np.cross(lever, F[i - 1])", "r × f.*force of the inside"),
)
"""(place, what stands there, an expression that the message must match)."""
