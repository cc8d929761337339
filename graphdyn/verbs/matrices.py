"""The public verbs that answer a matrix of the equations of motion.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
"""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.choices import VerbKeywords
from graphdyn.compiler.running import DERIVATIVES_WORTH_COMPILING, REGRESSORS_WORTH_COMPILING
from graphdyn.equations import complex_steps, projected, regressors
from graphdyn.equations.loops import dynamics as loops
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.single_state import OfMotion, OfPositions, OfState, SingleState
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "body_regressor",
    "coriolis_matrix",
    "joint_torque_regressor",
    "mass_matrix",
    "mass_matrix_inverse",
    "momentum_regressor",
]


@verb(projected.mass_matrix)
def mass_matrix(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """M = NᵀAN (…, n, n) [kg m², kg m, kg].

    q: joint positions (…, n) [rad or m]. The motion of a base does not change M; all verbs take the keyword.

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> matrix = graphdyn.mass_matrix(model, q)
    >>> bool(np.allclose(matrix, matrix.T) and (np.linalg.eigvalsh(matrix) > 0).all())
    True
    """
    return computed(mass_matrix, model, (q,), keywords)


@verb(projected.mass_matrix_inverse, remedy="joint_accelerations says what torques do")
def mass_matrix_inverse(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """M⁻¹ (…, n, n): the accelerations that unit torques give [1/(kg m²), 1/(kg m), 1/kg].

    q: joint positions (…, n) [rad or m]. The motion of a base does not change M.

    Raises InvalidInput; SingularMassMatrix where M has no inverse (massless bodies).

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> bool(np.allclose(graphdyn.mass_matrix(model, q) @ graphdyn.mass_matrix_inverse(model, q), np.eye(6)))
    True
    """
    return computed(mass_matrix_inverse, model, (q,), keywords)


@verb(complex_steps.coriolis_matrix, worth_compiling=DERIVATIVES_WORTH_COMPILING)
def coriolis_matrix(model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """C (…, n, n): C v is the part of the bias torque that velocities cause, and Ṁ - 2C is skew [N m s, N s, kg/s].

    C = ½ (Ṁ + B - Bᵀ) with B = ∂(M v)/∂q, the matrix of the Christoffel symbols (Siciliano et al., Robotics, 2009,
    section 7.2). The base must be at rest: a moving one adds to the bias torque what is not of this form.
    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput, also for a base that moves.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> graphdyn.coriolis_matrix(model, q, v).shape
    (6, 6)
    """
    if (base := keywords.get("base")) and base.moves:
        raise InvalidInput("coriolis_matrix takes a base at rest: C v is not what a moving base adds to bias_torque")
    return computed(coriolis_matrix, model, (q, v), keywords)


@verb(
    regressors.joint_torque_regressor,
    closed=loops.at_motors(regressors.joint_torque_regressor),
    worth_compiling=REGRESSORS_WORTH_COMPILING,
)
def joint_torque_regressor(
    model: RobotModel, q: ArrayLike, v: ArrayLike, a: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]
) -> Array:
    """W (…, n, 10n) with τ = W π, π = model.inertial_parameters [N m or N].

    The body regressors projected onto the joints, as the null space projects the body wrenches. The method "dense" is
    "projected" here.
    q, v, a: joint state and accelerations (…, n) [rad or m, …/s, …/s²]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> regressor = graphdyn.joint_torque_regressor(model, q, v, a=np.zeros(6))
    >>> torques = graphdyn.joint_torques(model, q, v, a=np.zeros(6))
    >>> bool(np.allclose(regressor @ model.inertial_parameters, torques))
    True
    """
    return computed(joint_torque_regressor, model, (q, v, a), keywords)


@verb(regressors.body_regressor, worth_compiling=REGRESSORS_WORTH_COMPILING)
def body_regressor(
    model: RobotModel, q: ArrayLike, v: ArrayLike, a: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]
) -> Array:
    """Y (…, n, 6, 10): Y_i π_i = inertial minus gravity wrench of body i, at O_i, in link axes [N, N m].

    The Newton-Euler equations (22), (23) moved from the center of mass to the link origin, where they are linear
    in m, m c and I. The identification matrix of Eq. (49) is its counterpart with known centers of mass. The method
    "dense" is "projected" here.
    q, v, a: joint state and accelerations (…, n) [rad or m, …/s, …/s²]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> graphdyn.body_regressor(model, q, v, a=np.zeros(6)).shape
    (6, 6, 10)
    """
    return computed(body_regressor, model, (q, v, a), keywords)


@verb(regressors.momentum_regressor, worth_compiling=REGRESSORS_WORTH_COMPILING)
def momentum_regressor(model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """(…, n, 10n): M v = it @ π, π = model.inertial_parameters [kg m²/s or kg m/s].

    The momenta of the joints, ∂T/∂v on a base at rest. Their rate is τ + ∂T/∂q - ∂U/∂q: with energy_regressor, an
    identification without accelerations. The motion of a base does not change M v. The method "dense" is "projected"
    here.
    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> regressor = graphdyn.momentum_regressor(model, q, v)
    >>> bool(np.allclose(regressor @ model.inertial_parameters, graphdyn.mass_matrix(model, q) @ v))
    True
    """
    return computed(momentum_regressor, model, (q, v), keywords)


class MatrixCalls:
    """The calls of a CompiledModel that answer matrices."""

    mass_matrix: SingleState[OfPositions]
    """M (n, n) [kg m², kg m, kg]"""

    mass_matrix_inverse: SingleState[OfPositions]
    """M⁻¹ (n, n) [1/(kg m²), 1/(kg m), 1/kg]"""

    coriolis_matrix: SingleState[OfState]
    """C (n, n) [N m s, N s, kg/s]"""

    joint_torque_regressor: SingleState[OfMotion]
    """W (n, 10 n) [N m or N per parameter]"""

    body_regressor: SingleState[OfMotion]
    """Y (n, 6, 10) [N, N m per parameter]"""

    momentum_regressor: SingleState[OfState]
    """Momentum regressor of M v (n, 10 n) [kg m²/s or kg m/s per parameter]"""
