"""The recursion with 6 × 6 matrices of Featherstone, angular parts first, and slips in it."""

TEXT = """
def inverse_dynamics(arm, q, v, a, BAD):
    n = len(q)
    vel, acc = [np.zeros(6)] + [None] * n, [np.concatenate([np.zeros(3), -arm.gravity])] + [None] * n
    X, S, f = [None] * n, [None] * n, [None] * n
    for j in range(n):
        i, p, slides = arm.inside[j], arm.axes[j], arm.prismatic[j]
        R = arm.rotations[j] if slides else arm.rotations[j] @ Rotation.from_rotvec(q[j] * p).as_matrix()
        r = arm.translations[j] + (arm.rotations[j] @ p * q[j] if slides else 0)
        E = R.T
        X[j] = np.block([[E, O3], [-E @ hat(r), E]])
        S[j] = np.concatenate([0 * p, p] if slides else [p, 0 * p])
        Xv, Xa = X[j], X[j]
        vel[j + 1] = Xv @ vel[i] + S[j] * v[j]
        V = vel[j + 1]
        acc[j + 1] = Xa @ acc[i] + S[j] * a[j] + crm(V) @ (S[j] * v[j])
        m, c = arm.masses[j], arm.centers[j]
        I = np.block([[arm.tensors[j] + m * hat(c) @ hat(c).T, m * hat(c)], [m * hat(c).T, m * np.eye(3)]])
        h = I @ V
        f[j] = I @ acc[j + 1] + crf(V) @ h
    tau = np.zeros(n)
    for j in range(n - 1, -1, -1):
        tau[j] = S[j] @ f[j]
        i = arm.inside[j] - 1
        if i >= 0:
            f[i] = f[i] + X[j].T @ f[j]
    return tau
"""

SLIPS = (
    ("Xv, Xa = X[j], X[j]", "Xv, Xa = np.block([[E, O3], [E @ hat(r), E]]), X[j]", "X of velocities.*opposite r"),
    ("Xv, Xa = X[j], X[j]", "Xv, Xa = X[j], np.block([[E, O3], [E @ hat(r), E]])", "X of accelerations.*opposite r"),
    ("Xv, Xa = X[j], X[j]", "Xv, Xa = X[j], np.block([[E, O3], [O3, E]])", "X of acc.*without r|ω̇ × r.*left out"),
    ("Xv, Xa = X[j], X[j]", "Xv, Xa = np.block([[E, O3], [O3, E]]), X[j]", "X of velocities.*without r"),
    (
        "X[j] = np.block([[E, O3], [-E @ hat(r), E]])",
        "X[j] = np.block([[E, O3], [-hat(r) @ E, E]])",
        "transform X.*-r× E",
    ),
    (
        "X[j] = np.block([[E, O3], [-E @ hat(r), E]])",
        "X[j] = np.block([[E, O3], [E @ hat(r), E]])",
        "transform X.*opposite r|translation",
    ),
    (
        "X[j] = np.block([[E, O3], [-E @ hat(r), E]])",
        "X[j] = np.block([[R, O3], [-R @ hat(r), R]])",
        "transform X.*transposed|rotation.*transposed",
    ),
    (
        "X[j] = np.block([[E, O3], [-E @ hat(r), E]])",
        "X[j] = np.block([[E, -E @ hat(r)], [O3, E]])",
        "transform X.*blocks exchanged",
    ),
    ("crm(V) @ (S[j] * v[j])", "0 * V", "v × S q̇.*left out"),
    ("crm(V) @ (S[j] * v[j])", "-crm(V) @ (S[j] * v[j])", "v × S q̇.*opposite"),
    ("crm(V) @ (S[j] * v[j])", "crf(V) @ (S[j] * v[j])", "v × S q̇.*×\\*"),
    ("crf(V) @ h", "0 * h", "v ×\\* I v.*left out"),
    ("crf(V) @ h", "-crf(V) @ h", "v ×\\* I v.*opposite"),
    ("crf(V) @ h", "crm(V) @ h", "v ×\\* I v.*that of motions"),
    ("crf(V) @ h", "crm(V).T @ h", "v ×\\* I v.*opposite"),
    ("crf(V) @ h", "np.concatenate([np.cross(V[:3], h[:3]), np.cross(V[:3], h[3:])])", "v ×\\* I v.*without v × f"),
    ("arm.tensors[j] + m * hat(c) @ hat(c).T", "arm.tensors[j]", "m c× c×.*left out|tensor"),
    ("arm.tensors[j] + m * hat(c) @ hat(c).T", "arm.tensors[j] - m * hat(c) @ hat(c).T", "m c× c×.*opposite|tensor"),
    ("arm.tensors[j] + m * hat(c) @ hat(c).T", "arm.tensors[j] + hat(c) @ hat(c).T", "m c× c×.*without m"),
    ("arm.tensors[j] + m * hat(c) @ hat(c).T", "arm.tensors[j] + m * np.outer(c, c)", "m c× c×.*m c cᵀ"),
    ("m * hat(c)]", "m * hat(c).T]", "upper right.*opposite"),
    ("m * hat(c)]", "O3]", "upper right.*left out"),
    ("[m * hat(c).T", "[m * hat(c)", "lower left.*opposite"),
    ("[m * hat(c).T", "[O3", "lower left.*left out"),
    ("X[j].T @ f[j]", "X[j] @ f[j]", "Xᵀ of forces.*not transposed"),
    ("X[j].T @ f[j]", "np.linalg.inv(X[j]) @ f[j]", "Xᵀ of forces.*that of motions"),
    ("X[j].T @ f[j]", "0 * f[j]", "Xᵀ of forces.*left out"),
    ("X[j].T @ f[j]", "np.kron(np.eye(2), X[j][:3, :3].T) @ f[j]", "Xᵀ of forces.*without r|r × f.*left out"),
    ("X[j].T @ f[j]", "(2 * np.kron(np.eye(2), X[j][:3, :3]) - X[j]).T @ f[j]", "Xᵀ.*opposite r|r × f.*opposite"),
    ("Xa @ acc[i]", "0 * acc[i]", "X of accelerations.*left out"),
    ("Xv @ vel[i]", "0 * vel[i]", "X of velocities.*left out"),
)
"""(place, what stands there, an expression that the message must match)."""
