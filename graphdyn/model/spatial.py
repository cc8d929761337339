"""Matrices and vectors with leading batch dimensions.

Rotations: Cardano angles θ = (α, β, γ), their rate matrix D, and the axis-angle form.

R = R_x(α) R_y(β) R_z(γ) maps body axes to world axes: the paper's A^(0i) (Eq. 29). ω is in body axes, ω = D θ̇.

Placement of one frame in another: an element of SE(3).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.display import short_repr
from graphdyn.errors import InvalidModel
from graphdyn.layout import Array

_EYE = np.eye(3)
_NEXT, _AFTER_NEXT = np.array([1, 2, 0]), np.array([2, 0, 1])

MANY_ROWS = 80
"""Vectors from which on components are multiplied one by one, rather than gathered in the order of the product."""


def cross(a: Array, b: Array) -> Array:
    """a × b over the last dimension, with the bits of np.cross. (…, 3), (…, 3) → (…, 3).

    Of small batches np.cross spends nine tenths of its time on the choice of axes, and of single vectors NumPy spends
    more time on each operation than Python's own numbers take for all.
    """
    if a.ndim == b.ndim == 1 and a.dtype == b.dtype == float:
        (x, y, z), (u, v, w) = a.tolist(), b.tolist()
        return np.array([y * w - z * v, z * u - x * w, x * v - y * u])
    if max(a.size, b.size) < 3 * MANY_ROWS:
        small: Array = a.take(_NEXT, -1) * b.take(_AFTER_NEXT, -1) - a.take(_AFTER_NEXT, -1) * b.take(_NEXT, -1)
        return small
    (x, y, z), (u, v, w) = _split(a), _split(b)
    first = y * w - z * v
    product = np.empty((*first.shape, 3), dtype=first.dtype)
    product[..., 0], product[..., 1], product[..., 2] = first, z * u - x * w, x * v - y * u
    return product


def apply(matrix: Array, vector: Array) -> Array:
    """(…, k, l), (…, l) → (…, k)."""
    return (matrix @ vector[..., None])[..., 0]


def solve(matrix: Array, vector: Array) -> Array:
    """x with matrix x = vector, by LU factorization. (…, k, k), (…, k) → (…, k)."""
    x: Any = np.linalg.solve(matrix, vector[..., None])[..., 0]
    return np.asarray(x)


def skew(a: ArrayLike) -> Array:
    """Matrix ã of the cross product, ã b = a × b. (…, 3) → (…, 3, 3). Eq. (31)."""
    a = np.asarray(a, dtype=float)
    a1, a2, a3 = a[..., 0], a[..., 1], a[..., 2]
    zero = np.zeros_like(a1)
    return _matrix([[zero, -a3, a2], [a3, zero, -a1], [-a2, a1, zero]])


def rotation_about(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Rotation by angle [rad] about a unit axis (Rodrigues). axis (3,), angle (…) → (…, 3, 3)."""
    p = np.asarray(axis, dtype=float)
    return turned(angle, skew(p), np.outer(p, p))


def rotation_vector(rotation: Array) -> Array:
    """The shortest turn (…, 3) [rad] of rotations (…, 3, 3): axis times angle, by their quaternions.

    Shuster, "A survey of attitude representations", Journal of the Astronautical Sciences 41(4), 1993.
    """
    r = rotation
    trace = np.trace(r, axis1=-2, axis2=-1)[..., None]
    diagonal = np.diagonal(r, axis1=-2, axis2=-1)
    # 4 q qᵀ: column k is 4 q_k q; the largest diagonal entry is at least 1
    outer = np.empty((*r.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1 + trace[..., 0]
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        outer[..., 0, k + 1] = outer[..., k + 1, 0] = r[..., b, a] - r[..., a, b]
        outer[..., a + 1, b + 1] = outer[..., b + 1, a + 1] = r[..., a, b] + r[..., b, a]
        outer[..., k + 1, k + 1] = 1 + 2 * diagonal[..., k] - trace[..., 0]
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)[..., None, None]
    quaternion = np.take_along_axis(outer, best, axis=-1)[..., 0]
    quaternion = quaternion * np.where(quaternion[..., :1] < 0, -1.0, 1.0)
    sine = np.linalg.norm(quaternion[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, quaternion[..., :1])
    vector: Array = quaternion[..., 1:] / np.where(sine > 0, sine, 1.0) * angle
    return vector


def turned(angle: ArrayLike, across: Array, along: Array) -> Array:
    """rotation_about of a known axis p. angle (…); across, along: p̃ and p pᵀ (3, 3) → (…, 3, 3)."""
    angle = np.asarray(angle)[..., None, None]
    c, s = np.cos(angle), np.sin(angle)
    rotation: Array = c * _EYE + s * across + (1.0 - c) * along
    return rotation


def cardano_matrix(theta: ArrayLike) -> Array:
    """R of the Cardano angles θ = (α, β, γ) [rad]. (…, 3) → (…, 3, 3). Eq. (29)."""
    theta = np.asarray(theta, dtype=float)
    (sa, sb, sg), (ca, cb, cg) = _split(np.sin(theta)), _split(np.cos(theta))
    return _matrix(
        [
            [cb * cg, -cb * sg, sb],
            [ca * sg + sa * sb * cg, ca * cg - sa * sb * sg, -sa * cb],
            [sa * sg - ca * sb * cg, sa * cg + ca * sb * sg, ca * cb],
        ]
    )


def cardano_angles(rotation: ArrayLike) -> Array:
    """θ = (α, β, γ) [rad] of R, β in [-π/2, π/2]. (…, 3, 3) → (…, 3). Inverse of Eq. (29).

    γ is taken from R_x(-α) R, so that α and γ belong together: R(θ) returns the matrix to rounding even in gimbal
    lock, where α alone is arbitrary.
    """
    r = np.asarray(rotation, dtype=float)
    alpha = np.arctan2(-r[..., 1, 2], r[..., 2, 2])
    beta = np.arctan2(r[..., 0, 2], np.hypot(r[..., 0, 0], r[..., 0, 1]))
    sa, ca = np.sin(alpha), np.cos(alpha)
    gamma = np.arctan2(ca * r[..., 1, 0] + sa * r[..., 2, 0], ca * r[..., 1, 1] + sa * r[..., 2, 1])
    return np.stack([alpha, beta, gamma], axis=-1)


def cos_beta(rotation: ArrayLike) -> Array:
    """|cos β| = |det D| of each rotation, without the cancellation of sqrt(1 - sin²β). (…, 3, 3) → (…)."""
    r = np.asarray(rotation, dtype=float)
    cosines: Array = np.hypot(r[..., 1, 2], r[..., 2, 2])
    return cosines


def cardano_rate_matrix(theta: ArrayLike) -> Array:
    """D with ω = D θ̇, ω in body axes. (…, 3) → (…, 3, 3). Eq. (33); det D = cos β."""
    theta = np.asarray(theta, dtype=float)
    (_, sb, sg), (_, cb, cg) = _split(np.sin(theta)), _split(np.cos(theta))
    zero, one = np.zeros_like(sb), np.ones_like(sb)
    return _matrix([[cb * cg, sg, zero], [-cb * sg, cg, zero], [sb, zero, one]])


def cardano_rate_matrix_derivative(theta: ArrayLike, theta_dot: ArrayLike) -> Array:
    """Ḋ. (…, 3), (…, 3) → (…, 3, 3). Eq. (34) with entry (3,3) = 0: D_33 is constant (docs/deviations.md, A4)."""
    theta, theta_dot = np.asarray(theta, dtype=float), np.asarray(theta_dot, dtype=float)
    (_, sb, sg), (_, cb, cg) = _split(np.sin(theta)), _split(np.cos(theta))
    _, bd, gd = _split(theta_dot)
    zero = np.zeros_like(sb)
    return _matrix(
        [
            [-bd * sb * cg - gd * cb * sg, gd * cg, zero],
            [bd * sb * sg - gd * cb * cg, -gd * sg, zero],
            [bd * cb, zero, zero],
        ]
    )


def _split(a: Array) -> tuple[Array, Array, Array]:
    return a[..., 0], a[..., 1], a[..., 2]


def _matrix(rows: list[list[Array]]) -> Array:
    entries = np.stack([entry for row in rows for entry in row], axis=-1)
    return entries.reshape(*entries.shape[:-1], 3, 3)


ROTATION_TOLERANCE = 1e-9
"""Largest entry of RᵀR - E that still counts as a rotation. A product of some hundred rotations stays below 1e-13."""


@dataclass(frozen=True, eq=False)
@short_repr
class Placement:
    """Frame b in frame a: a point with coordinates x in b has R x + t in a.

    rotation: R, columns are the axes of b in a             (3, 3)
    translation: t, the origin of b in a                    (3,)  [m]

    Raises InvalidModel for wrong shapes, NaN or infinity, or a matrix that is not a proper rotation.
    """

    rotation: Array = field(default_factory=lambda: np.eye(3))
    translation: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name, shape in (("rotation", (3, 3)), ("translation", (3,))):
            try:
                value = np.array(getattr(self, name), dtype=float)
            except (TypeError, ValueError) as error:
                raise InvalidModel(f"{name} is not numeric: {getattr(self, name)!r}") from error
            if value.shape != shape:
                raise InvalidModel(f"{name} has shape {value.shape}, expected {shape}")
            if not np.all(np.isfinite(value)):
                raise InvalidModel(f"{name} contains NaN or infinity: {value.tolist()}")
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        defect = np.abs(self.rotation.T @ self.rotation - np.eye(3)).max()
        if defect > ROTATION_TOLERANCE or np.linalg.det(self.rotation) < 0:
            raise InvalidModel(f"rotation is not a proper rotation matrix (|RᵀR - E| = {defect:.1e})")

    def __matmul__(self, other: Placement) -> Placement:
        """Frame c in a, from b in a (self) and c in b (other)."""
        return Placement(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)

    def inverse(self) -> Placement:
        """Frame a in b."""
        return Placement(self.rotation.T, -self.rotation.T @ self.translation)
