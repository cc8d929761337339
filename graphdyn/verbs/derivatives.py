"""The public verbs that answer derivatives in the joint positions, velocities, accelerations, torques and parameters.

Column k of a derivative belongs to joint k: ∂x_i/∂q_k is its entry (…, i, k). External wrenches are fixed in the axes
of their links. Leading dimensions of the arguments broadcast.
"""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.choices import VerbKeywords
from graphdyn.compiler.running import DERIVATIVES_WORTH_COMPILING
from graphdyn.equations import complex_steps, regressors
from graphdyn.equations.loops import derivatives as loop_derivatives
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import (
    ForwardDynamicsDerivatives,
    InverseDynamicsDerivatives,
    InverseDynamicsSecondDerivatives,
    ReactionDerivatives,
)
from graphdyn.verbs.single_state import OfTorques, SingleState
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "forward_dynamics_derivatives",
    "forward_dynamics_parameter_derivatives",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_second_derivatives",
    "reaction_derivatives",
]

DIFFERENCES = "take differences along closed motions (graphdyn.assemble)"


@verb(
    complex_steps.inverse_dynamics_derivatives,
    answer=InverseDynamicsDerivatives,
    closed=loop_derivatives.inverse_dynamics_derivatives,
    worth_compiling=DERIVATIVES_WORTH_COMPILING,
)
def inverse_dynamics_derivatives(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[InverseDynamicsDerivatives]],
) -> InverseDynamicsDerivatives:
    """∂τ/∂q, ∂τ/∂v and ∂τ/∂a = M of inverse_dynamics.

    The methods "projected" and "dense" differentiate those of inverse_dynamics by complex steps, "recursive" its
    recorded recursion by automatic differentiation.
    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, fixed in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.inverse_dynamics_derivatives(model, q, v, a=np.zeros(6))
    >>> found.dtau_dq.shape
    (6, 6)
    >>> bool(np.allclose(found.dtau_da, graphdyn.mass_matrix(model, q)))
    True
    """
    return computed(inverse_dynamics_derivatives, model, (q, v, a), keywords, external_wrenches)


@verb(
    complex_steps.inverse_dynamics_second_derivatives,
    answer=InverseDynamicsSecondDerivatives,
    remedy=DIFFERENCES,
    worth_compiling=DERIVATIVES_WORTH_COMPILING,
)
def inverse_dynamics_second_derivatives(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[InverseDynamicsSecondDerivatives]],
) -> InverseDynamicsSecondDerivatives:
    """∂²τ/∂q∂q, ∂²τ/∂q∂v, ∂²τ/∂q∂a and ∂²τ/∂v∂v of inverse_dynamics.

    The methods "projected" and "dense" take exact differences of the first derivatives: in each angle they are sums of
    sines and cosines up to the double angle, in slides and velocities polynomials. The program of "recursive" is
    interpreted where it takes seconds to compile: a robot of six joints.
    Arguments and errors as in inverse_dynamics_derivatives.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.inverse_dynamics_second_derivatives(model, q, v, a=np.zeros(6))
    >>> found.d2tau_dqdv.shape
    (6, 6, 6)
    """
    return computed(inverse_dynamics_second_derivatives, model, (q, v, a), keywords, external_wrenches)


@verb(
    complex_steps.forward_dynamics_derivatives,
    answer=ForwardDynamicsDerivatives,
    closed=loop_derivatives.forward_dynamics_derivatives,
    worth_compiling=DERIVATIVES_WORTH_COMPILING,
)
def forward_dynamics_derivatives(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[ForwardDynamicsDerivatives]],
) -> ForwardDynamicsDerivatives:
    """∂a/∂q, ∂a/∂v and ∂a/∂τ = M⁻¹ of forward_dynamics.

    The methods "projected" and "dense" differentiate those of forward_dynamics by complex steps; "recursive" computes
    -M⁻¹ ∂τ/∂q and -M⁻¹ ∂τ/∂v at the accelerations found.
    q, v, tau: joint state and actuator torques             (…, n)     [rad or m, …/s, N m or N]
    external_wrenches: force, moment on each body at O_j, fixed in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput; SingularMassMatrix as forward_dynamics does.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.forward_dynamics_derivatives(model, q, v, tau=np.zeros(6))
    >>> bool(np.allclose(found.da_dtau, graphdyn.mass_matrix_inverse(model, q)))
    True
    """
    return computed(forward_dynamics_derivatives, model, (q, v, tau), keywords, external_wrenches)


@verb(
    complex_steps.reaction_derivatives,
    answer=ReactionDerivatives,
    remedy=DIFFERENCES,
    worth_compiling=DERIVATIVES_WORTH_COMPILING,
)
def reaction_derivatives(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[ReactionDerivatives]],
) -> ReactionDerivatives:
    """Derivatives of the constraint forces of inverse_dynamics: multipliers and joint_wrenches, in q, v and a.

    Arguments, methods and errors as in inverse_dynamics_derivatives.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> graphdyn.reaction_derivatives(model, q, v, a=np.zeros(6)).dwrenches_dq.shape
    (6, 6, 6)
    """
    return computed(reaction_derivatives, model, (q, v, a), keywords, external_wrenches)


@verb(regressors.forward_dynamics_parameter_derivatives, remedy=DIFFERENCES)
def forward_dynamics_parameter_derivatives(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """∂a/∂π (…, n, 10n) of forward_dynamics, π = model.inertial_parameters [rad/s² or m/s² per parameter].

    -M⁻¹ W, with the joint_torque_regressor W at the accelerations found: M a + h = τ is linear in π. Those of inverse
    dynamics are W itself.
    q, v, tau: joint state and actuator torques             (…, n)     [rad or m, …/s, N m or N]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput; SingularMassMatrix as forward_dynamics does.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> graphdyn.forward_dynamics_parameter_derivatives(model, q, v, tau=np.zeros(6)).shape
    (6, 60)
    """
    return computed(forward_dynamics_parameter_derivatives, model, (q, v, tau), keywords, external_wrenches)


class DerivativeCalls:
    """The calls of a CompiledModel that answer derivatives."""

    forward_dynamics_parameter_derivatives: SingleState[OfTorques]
    """∂a/∂π (n, 10 n) [rad/s² or m/s² per parameter]"""
