"""The public verbs of the dynamics: torques and accelerations, alone or with all constraint forces.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import one_state
from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.arguments.choices import VerbKeywords
from graphdyn.equations import projected
from graphdyn.equations.kinematics import bias_acceleration
from graphdyn.equations.loops import dynamics as loops
from graphdyn.equations.specification import Arguments
from graphdyn.equations.system.kkt import Coordinates, KKTSystem, cardano_system
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.assembly import infinitesimal_refusal
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import ForwardDynamics, InverseDynamics
from graphdyn.verbs.single_state import OfMotion, OfPositions, OfState, OfTorques, SingleState
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "bias_torque",
    "forward_dynamics",
    "gravity_torque",
    "inverse_dynamics",
    "joint_accelerations",
    "joint_torques",
    "kkt_system",
    "solve_kkt",
    "static_torque",
]


@verb(projected.forward_dynamics, answer=ForwardDynamics, closed=loops.forward_dynamics)
def forward_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[ForwardDynamics]],
) -> ForwardDynamics:
    """All accelerations and all constraint forces, given the actuator torques.

    q, v, tau: joint state and actuator torques             (…, n)     [rad or m, …/s, N m or N]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput; SingularMassMatrix where the torques do not determine the accelerations (massless bodies).

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.forward_dynamics(model, q, v, tau=graphdyn.bias_torque(model, q, v))
    >>> found.multipliers.shape  # five components at each of six joints
    (6, 5)
    >>> bool(abs(found.a).max() < 1e-9)  # these torques keep the velocities
    True
    """
    return computed(forward_dynamics, model, (q, v, tau), keywords, external_wrenches)


@verb(projected.inverse_dynamics, answer=InverseDynamics, closed=loops.inverse_dynamics)
def inverse_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    actuated: Sequence[str] | None = None,
    **keywords: Unpack[VerbKeywords[InverseDynamics]],
) -> InverseDynamics:
    """Actuator torques and all constraint forces, given the joint accelerations.

    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]
    actuated: of a robot with loops, the joints that have motors, where they differ from model.actuated; torques of the
        others are zero, and the smallest ones (least sum of squares, newtons and newton meters alike) where there are
        more motors than motions

    Raises InvalidInput, with loops also where motors leave a motion free; InconsistentState where a loop is open.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.inverse_dynamics(model, q, v, a=np.zeros(6))
    >>> found.tau[1:4].round(1)  # about O2, O3 and O4
    array([-36857.9, -22899.3,    231.5])
    >>> found.joint_wrenches.shape  # force and moment at each of six joints
    (6, 6)
    """
    model = model if actuated is None else model.with_actuated(actuated)
    return computed(inverse_dynamics, model, (q, v, a), keywords, external_wrenches)


@verb(
    projected.forward_dynamics,
    recursion="forward_dynamics",
    outputs=("body_accelerations", "multipliers"),
    closed=loops.forward_dynamics,
)
def solve_kkt(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[tuple[Array, Array]]],
) -> tuple[Array, Array]:
    """The unknowns of Eq. (111), and nothing else: body_accelerations (…, n, 6) and multipliers (…, n, 5).

    Arguments, units and errors as in forward_dynamics, for any number of states; kkt_system shows the equations of one.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> body_accelerations, multipliers = graphdyn.solve_kkt(model, q, v, tau=np.zeros(6))
    >>> body_accelerations.size + multipliers.size
    66
    """
    return computed(solve_kkt, model, (q, v, tau), keywords, external_wrenches)


@verb(projected.inverse_dynamics, recursion="inverse_dynamics", outputs=("tau",), closed=loops.inverse_dynamics)
def joint_torques(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """inverse_dynamics(…).tau alone (…, n), which takes a third of the time [N m or N].

    Arguments and errors are the same.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> states = np.tile(q, (100, 1))  # any leading dimensions
    >>> graphdyn.joint_torques(model, states, v, a=np.zeros(6)).shape
    (100, 6)
    """
    return computed(joint_torques, model, (q, v, a), keywords, external_wrenches)


@verb(projected.forward_dynamics, recursion="forward_dynamics", outputs=("a",), closed=loops.forward_dynamics)
def joint_accelerations(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """forward_dynamics(…).a alone (…, n), which takes a third of the time [rad/s² or m/s²].

    Arguments and errors are the same.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> a = graphdyn.joint_accelerations(model, q, v, tau=np.zeros(6))
    >>> bool(abs(graphdyn.joint_torques(model, q, v, a)).max() < 1e-6)
    True
    """
    return computed(joint_accelerations, model, (q, v, tau), keywords, external_wrenches)


@verb(projected.bias_torque, closed=loops.at_motors(projected.bias_torque))
def bias_torque(model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """h (…, n): τ = M a + h without external wrenches: velocity, gravity and base motion [N m or N].

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> h = graphdyn.bias_torque(model, q, v)
    >>> bool(np.allclose(h, graphdyn.coriolis_matrix(model, q, v) @ v + graphdyn.gravity_torque(model, q)))
    True
    """
    return computed(bias_torque, model, (q, v), keywords)


@verb(projected.gravity_torque, closed=loops.at_motors(projected.gravity_torque))
def gravity_torque(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """g (…, n): τ that holds the robot at rest against gravity, the gradient of its potential energy [N m or N].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> graphdyn.gravity_torque(model, q)[1:4].round(1)  # about O2, O3 and O4
    array([-36714.2, -22953. ,    234.9])
    """
    return computed(gravity_torque, model, (q,), _at_rest(keywords))


@verb(projected.static_torque, closed=loops.at_motors(projected.static_torque))
def static_torque(
    model: RobotModel, q: ArrayLike, external_wrenches: ArrayLike | None = None, **keywords: Unpack[VerbKeywords[Array]]
) -> Array:
    """τ (…, n) that holds the robot at rest against gravity and external wrenches [N m or N].

    Without external wrenches it is gravity_torque.
    q: joint positions                                      (…, n)     [rad or m]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Of the motion of a base only the placement counts. Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> wrenches = np.zeros((6, 6))
    >>> wrenches[-1, 0] = 100.0  # 100 N along the first axis of the last link
    >>> graphdyn.static_torque(model, q, wrenches).shape
    (6,)
    """
    return computed(static_torque, model, (q,), _at_rest(keywords), external_wrenches)


def _at_rest(keywords: VerbKeywords[Array]) -> VerbKeywords[Array]:
    """The keywords with the base where it is, without its motion."""
    base = keywords.get("base")
    return {**keywords, "base": base and BaseMotion(base.rotation, base.translation)}


def kkt_system(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    coordinates: Coordinates = "twist",
) -> KKTSystem:
    """Eq. (111) at ONE state: matrix, right side, rank, condition number, solution, residuals.

    q, v, tau: (n,); external_wrenches: (n, 6); base: prescribed motion of the base at that state
    coordinates: "twist" (r̈, ω̇), regular in every pose; "cardano" (r̈, θ̈) as the paper writes it, rows times Dᵀ

    Raises InvalidInput for more than one state; InconsistentState where a loop is open; GimbalLock for
    Cardano coordinates at |cos β| below 1e-4.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> system = graphdyn.kkt_system(model, q, v, tau=np.zeros(6))
    >>> system.matrix.shape, int(system.rank())
    ((66, 66), 66)
    """
    if coordinates not in ("twist", "cardano"):
        raise InvalidInput(f"coordinates is '{coordinates}'; use 'twist' or 'cardano'")
    x = one_state(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    if model.chords:
        loops.closed(model, x["q"], x["v"], moving=False)  # refuses open states
    state = Arguments(model, x, base).rooted_state()
    bias = bias_acceleration(model.rooted, x["q"], x["v"], state.ground)
    system = projected.kkt(state, x["tau"], x["external_wrenches"], bias)
    if coordinates == "cardano":
        system = cardano_system(state, system)
    if not model.chords:
        return system
    return replace(system, refusal=infinitesimal_refusal(f"robot '{model.name}'", model.loops, x["q"]))


class DynamicsCalls:
    """The calls of a CompiledModel that answer torques and accelerations."""

    joint_torques: SingleState[OfMotion]
    """τ (n,) [N m or N]"""

    joint_accelerations: SingleState[OfTorques]
    """a (n,) [rad/s² or m/s²]"""

    bias_torque: SingleState[OfState]
    """h (n,) [N m or N]"""

    gravity_torque: SingleState[OfPositions]
    """g (n,) [N m or N]"""

    static_torque: SingleState[OfPositions]
    """g (n,), without external wrenches [N m or N]"""
