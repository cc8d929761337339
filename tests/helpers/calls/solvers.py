"""Solvers that were stopped early."""

import numpy as np
from calls.planted import plant

import graphdyn

KIND = "solvers"


def conjugate_gradients(M, b, steps, scaled=False):
    x, r = np.zeros_like(b), b.copy()
    D = np.diag(M) if scaled else np.ones(len(b))
    z = r / D
    p = z.copy()
    for _ in range(steps):
        if not r.any():
            break
        Mp = M @ p
        alpha = (r @ z) / (p @ Mp)
        x = x + alpha * p
        new = r - alpha * Mp
        y = new / D
        p = y + (new @ y) / (r @ z) * p
        r, z = new, y
    return x


def jacobi(M, b, steps):
    x = np.zeros_like(b)
    for _ in range(steps):
        x = (b - (M @ x - np.diag(M) * x)) / np.diag(M)
    return x


def gauss_seidel(M, b, steps):
    x = np.zeros_like(b)
    for _ in range(steps):
        for i in range(len(b)):
            x[i] = (b[i] - M[i] @ x + M[i, i] * x[i]) / M[i, i]
    return x


def steepest_descent(M, b, steps):
    x = np.zeros_like(b)
    for _ in range(steps):
        r = b - M @ x
        if not r.any():
            break
        x = x + (r @ r) / (r @ M @ r) * r
    return x


def accelerations(solve):
    def build(model):
        def forward_dynamics(q, v, tau):
            return solve(graphdyn.mass_matrix(model, q), tau - graphdyn.bias_torque(model, q, v))

        return forward_dynamics

    return build


def inverse(solve):
    def build(model):
        def mass_matrix_inverse(q):
            M = graphdyn.mass_matrix(model, q)
            return np.stack([solve(M, e) for e in np.eye(len(q))], axis=1)

        return mass_matrix_inverse

    return build


for steps, aside in ((3, False), (5, False), (4, True)):
    plant(KIND, f"{steps} steps of conjugate gradients", "forward_dynamics", f"conjugate gradients.*{steps} steps",
          aside=aside)(accelerations(lambda M, b, k=steps: conjugate_gradients(M, b, k)))  # fmt: skip
    plant(KIND, f"{steps} steps of scaled conjugate gradients", "forward_dynamics",
          f"conjugate gradients.*{steps} steps", aside=aside)(
        accelerations(lambda M, b, k=steps: conjugate_gradients(M, b, k, scaled=True)))  # fmt: skip
    plant(KIND, f"{steps} steps of conjugate gradients", "mass_matrix_inverse", f"conjugate gradients.*{steps} steps",
          aside=aside)(inverse(lambda M, b, k=steps: conjugate_gradients(M, b, k)))  # fmt: skip
for steps, aside in ((10, False), (40, False), (25, True), (60, True)):
    plant(KIND, f"{steps} steps of Gauss-Seidel", "forward_dynamics", f"Gauss-Seidel.*{steps} steps",
          aside=aside)(accelerations(lambda M, b, k=steps: gauss_seidel(M, b, k)))  # fmt: skip
    plant(KIND, f"{steps} steps of Gauss-Seidel", "mass_matrix_inverse", f"Gauss-Seidel.*{steps} steps",
          aside=aside)(inverse(lambda M, b, k=steps: gauss_seidel(M, b, k)))  # fmt: skip
for steps, aside in ((1, False), (2, True), (7, False)):
    plant(KIND, f"{steps} steps of Jacobi", "forward_dynamics", f"Jacobi.*{steps} step", aside=aside)(
        accelerations(lambda M, b, k=steps: jacobi(M, b, k)))  # fmt: skip
    plant(KIND, f"{steps} steps of Jacobi", "mass_matrix_inverse", f"Jacobi.*{steps} step", aside=aside)(
        inverse(lambda M, b, k=steps: jacobi(M, b, k)))  # fmt: skip


def until(tolerance):
    def solve(M, b):
        for k in range(30):
            x = conjugate_gradients(M, b, k)
            if np.linalg.norm(b - M @ x) <= tolerance * np.linalg.norm(b):
                break
        return x

    return solve


def descend_until(tolerance):
    def solve(M, b):
        for k in range(300):
            x = steepest_descent(M, b, k)
            if np.linalg.norm(b - M @ x) <= tolerance * np.linalg.norm(b):
                break
        return x

    return solve


plant(KIND, "conjugate gradients to 1e-3", "forward_dynamics", "conjugate gradients")(accelerations(until(1e-3)))
plant(KIND, "conjugate gradients to 1e-4", "forward_dynamics", "conjugate gradients", aside=True)(
    accelerations(until(1e-4)))  # fmt: skip
plant(KIND, "steepest descent, 20 steps", "forward_dynamics", "steepest descent|residual", aside=True)(
    accelerations(lambda M, b: steepest_descent(M, b, 20)))  # fmt: skip
plant(KIND, "unknown method to 1e-5", "forward_dynamics", "residual", aside=True)(
    accelerations(lambda M, b: np.linalg.solve(M, b + 1e-5 * np.linalg.norm(b) * np.sin(1e3 * b))))  # fmt: skip
plant(KIND, "small singular values cut off", "forward_dynamics", "singular values", aside=True)(
    accelerations(lambda M, b: np.linalg.pinv(M, rcond=3e-3) @ b))  # fmt: skip
