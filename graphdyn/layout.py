"""Layout of the stacked vectors: 6 rows per body, 5 per joint.

The only module that knows these sizes.

Bodies and joints are numbered as in the paper: 1 … n, with vertex 0 the ground. Joint j is the inside joint of body j.
Per body: the linear part first (world axes), then the angular part (body axes).
"""

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ANGULAR",
    "BODY_DOF",
    "BODY_PARAMETERS",
    "JOINT_CONSTRAINTS",
    "LINEAR",
    "Array",
    "block_diagonal",
    "body_rows",
    "constraint_row_names",
    "joint_rows",
    "parameter_columns",
    "per_body",
    "per_joint",
    "stacked",
    "stacked_rows",
]

Array = NDArray[np.float64]

BODY_DOF = 6
JOINT_CONSTRAINTS = 5
BODY_PARAMETERS = 10  # m, m c, and I_xx, I_xy, I_yy, I_xz, I_yz, I_zz

LINEAR = slice(0, 3)
ANGULAR = slice(3, 6)


def body_rows(i: int) -> slice:
    """Rows of body i (1 … n) in a vector of length 6 n."""
    return slice(BODY_DOF * (i - 1), BODY_DOF * i)


def joint_rows(j: int) -> slice:
    """Rows of joint j (1 … n) in a vector of length 5 n."""
    return slice(JOINT_CONSTRAINTS * (j - 1), JOINT_CONSTRAINTS * j)


def parameter_columns(i: int) -> slice:
    """Columns of body i (1 … n) in a vector of 10 n inertial parameters."""
    return slice(BODY_PARAMETERS * (i - 1), BODY_PARAMETERS * i)


def constraint_row_names(n: int) -> tuple[str, ...]:
    """Names of the 5 n constraint rows as the paper writes them: phi_11 … phi_65 (Eq. 75-104)."""
    return tuple(
        f"phi_{j}{k}" if n < 10 else f"phi_{j},{k}" for j in range(1, n + 1) for k in range(1, JOINT_CONSTRAINTS + 1)
    )


def per_body(stacked: Array) -> Array:
    """(…, 6 n) seen as (…, n, 6)."""
    return stacked.reshape(*stacked.shape[:-1], stacked.shape[-1] // BODY_DOF, BODY_DOF)


def per_joint(stacked: Array) -> Array:
    """(…, 5 n) seen as (…, n, 5)."""
    return stacked.reshape(*stacked.shape[:-1], stacked.shape[-1] // JOINT_CONSTRAINTS, JOINT_CONSTRAINTS)


def stacked(blocks: Array) -> Array:
    """(…, n, k) seen as (…, n k): the inverse of per_body and per_joint."""
    return blocks.reshape(*blocks.shape[:-2], blocks.shape[-2] * blocks.shape[-1])


def stacked_rows(blocks: Array) -> Array:
    """(…, n, k, m) seen as (…, n k, m): the rows of one matrix."""
    *batch, n, k, m = blocks.shape
    return blocks.reshape(*batch, n * k, m)


def block_diagonal(blocks: Array) -> Array:
    """(…, n, k, l) blocks on the diagonal of a (…, n k, n l) matrix (Eq. 39)."""
    *batch, n, k, width = blocks.shape
    matrix = np.zeros((*batch, n, k, n, width))
    diagonal = np.arange(n)
    matrix[..., diagonal, :, diagonal, :] = np.moveaxis(blocks, -3, 0)
    return matrix.reshape(*batch, n * k, n * width)
