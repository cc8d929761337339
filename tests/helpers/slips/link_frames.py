"""Newton-Euler in link axes, as a student writes it, and slips: a place of the text, and what stands there instead."""

TEXT = """
def inverse_dynamics(arm, q, v, a, BAD):
    n = len(q)
    w, dw, acc = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    acc[0] = -arm.gravity
    R, P, F, N = [None] * n, [None] * n, [None] * n, [None] * n
    for j in range(n):
        i, z, slides = arm.inside[j], arm.axes[j], arm.prismatic[j]
        R[j] = arm.rotations[j] if slides else arm.rotations[j] @ Rotation.from_rotvec(q[j] * z).as_matrix()
        P[j] = arm.translations[j] + (arm.rotations[j] @ z * q[j] if slides else 0)
        T = R[j].T
        tangential = np.cross(dw[i], P[j])
        normal = np.cross(w[i], np.cross(w[i], P[j]))
        acc[j + 1] = T @ acc[i] + T @ tangential + T @ normal
        if slides:
            w[j + 1] = T @ w[i]
            dw[j + 1] = T @ dw[i]
            acc[j + 1] += 2 * np.cross(w[j + 1], z * v[j]) + z * a[j]
        else:
            w[j + 1] = T @ w[i] + z * v[j]
            dw[j + 1] = T @ dw[i] + np.cross(T @ w[i], z * v[j]) + z * a[j]
        c, J, m, o, do = arm.centers[j], arm.tensors[j], arm.masses[j], w[j + 1], dw[j + 1]
        acc_c = acc[j + 1] + np.cross(do, c) + np.cross(o, np.cross(o, c))
        F[j] = m * acc_c
        N[j] = J @ do + np.cross(o, J @ o)
    f, mom, tau = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
    for j in range(n - 1, -1, -1):
        f[j] += F[j]
        mom[j] += N[j] + np.cross(arm.centers[j], F[j])
        tau[j] = arm.axes[j] @ (f[j] if arm.prismatic[j] else mom[j])
        i = arm.inside[j] - 1
        if i >= 0:
            f[i] += R[j] @ f[j]
            mom[i] += R[j] @ mom[j] + np.cross(P[j], R[j] @ f[j])
    return tau
"""

SLIPS = (
    ("T @ tangential", "0 * z", "ω̇ × r.*left out|without r"),
    ("T @ tangential", "tangential", "ω̇ × r.*not turned"),
    ("T @ tangential", "-T @ tangential", "ω̇ × r.*opposite"),
    ("T @ normal", "0 * z", "ω × \\(ω × r\\).*(left out|zero)"),
    ("T @ normal", "normal", "ω × \\(ω × r\\).*not turned"),
    ("T @ normal", "-T @ normal", "ω × \\(ω × r\\).*opposite"),
    ("np.cross(w[i], np.cross(w[i], P[j]))", "np.cross(w[i], P[j])", "ω × \\(ω × r\\).*one ω"),
    ("T @ acc[i]", "acc[i]", "acceleration.*not turned|acceleration.*without its rotation"),
    ("T @ acc[i]", "R[j] @ acc[i]", "acceleration.*wrong way"),
    ("T @ w[i] + z * v[j]", "w[i] + z * v[j]", "ω of the inside link.*not turned"),
    ("T @ w[i] + z * v[j]", "R[j] @ w[i] + z * v[j]", "ω of the inside link.*wrong way"),
    ("T @ dw[i] + np.cross", "dw[i] + np.cross", "ω̇ of the inside link.*not turned"),
    ("T @ dw[i] + np.cross", "R[j] @ dw[i] + np.cross", "ω̇ of the inside link.*wrong way"),
    ("np.cross(T @ w[i], z * v[j])", "np.cross(w[i], z * v[j])", "ω × q̇ p.*not turned"),
    ("np.cross(T @ w[i], z * v[j])", "0 * z", "ω × q̇ p.*left out|v × S q̇"),
    ("np.cross(T @ w[i], z * v[j])", "np.cross(z * v[j], T @ w[i])", "ω × q̇ p.*opposite"),
    ("z * a[j]\n        c,", "0 * z\n        c,", "q̈ p.*left out|acceleration.*(ignored|zero)|a.*ignored"),
    ("np.cross(do, c)", "0 * c", "ω̇ × c.*left out"),
    ("np.cross(do, c)", "np.cross(c, do)", "ω̇ × c.*opposite"),
    ("np.cross(do, c)", "np.cross(dw[i], c)", "ω̇ × c.*inside"),
    ("np.cross(o, np.cross(o, c))", "0 * c", "ω × \\(ω × c\\).*left out"),
    ("np.cross(o, np.cross(o, c))", "np.cross(o, c)", "ω × \\(ω × c\\).*one ω"),
    ("np.cross(o, np.cross(o, c))", "np.cross(w[i], np.cross(w[i], c))", "ω × \\(ω × c\\).*inside"),
    ("J @ do", "0 * c", "J ω̇.*left out|tensor"),
    ("np.cross(o, J @ o)", "0 * c", "ω × (J|I) ω.*left out"),
    ("np.cross(o, J @ o)", "np.cross(J @ o, o)", "ω × (J|I) ω.*opposite"),
    ("np.cross(arm.centers[j], F[j])", "0 * F[j]", "c × F.*left out"),
    ("np.cross(arm.centers[j], F[j])", "np.cross(F[j], arm.centers[j])", "c × F.*opposite"),
    ("f[i] += R[j] @ f[j]", "f[i] += f[j]", "f of the outer.*not turned"),
    ("f[i] += R[j] @ f[j]", "f[i] += R[j].T @ f[j]", "f of the outer.*wrong way"),
    ("f[i] += R[j] @ f[j]", "f[i] += 0 * f[j]", "f of the outer.*left out|passed on"),
    ("R[j] @ mom[j]", "mom[j]", "n of the outer.*not turned"),
    ("R[j] @ mom[j]", "R[j].T @ mom[j]", "n of the outer.*wrong way"),
    ("R[j] @ mom[j]", "0 * mom[j]", "n of the outer.*left out"),
    ("np.cross(P[j], R[j] @ f[j])", "np.cross(P[j], f[j])", "r × f.*not turned"),
    ("np.cross(P[j], R[j] @ f[j])", "np.cross(R[j] @ f[j], P[j])", "r × f.*opposite|opposite r"),
    ("np.cross(P[j], R[j] @ f[j])", "0 * f[j]", "r × f.*left out|without r"),
    ("np.cross(P[j], R[j] @ f[j])", "np.cross(P[j], R[j].T @ f[j])", "r × f.*wrong way"),
    ("np.cross(P[j], R[j] @ f[j])", "np.cross(P[j], F[i])", "r × f.*force of the inside"),
)
"""(place, what stands there, an expression that the message must match)."""
