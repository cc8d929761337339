"""The public verbs of the dynamics: torques and accelerations, alone or with all constraint forces.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import one_state
from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.arguments.choices import Method, with_keywords
from graphdyn.equations import projected
from graphdyn.equations.kinematics import bias_acceleration
from graphdyn.equations.loops.dynamics import closed
from graphdyn.equations.system.cardano import cardano_system
from graphdyn.equations.system.kkt import Coordinates, KKTSystem
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import ForwardDynamics, InverseDynamics
from graphdyn.verbs.table import Verbs


@with_keywords
def forward_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: ForwardDynamics | None = None,
) -> ForwardDynamics:
    """All accelerations and all constraint forces, given the actuator torques.

    q, v, tau: joint state and actuator torques             (…, n)     [rad or m, …/s, N m or N]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput; SingularMassMatrix where the torques do not determine the accelerations (massless bodies).
    """
    return Verbs.forward_dynamics(model, (q, v, tau), base, method, threads, check, out, external_wrenches)


@with_keywords
def inverse_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: InverseDynamics | None = None,
    actuated: Sequence[str] | None = None,
) -> InverseDynamics:
    """Actuator torques and all constraint forces, given the joint accelerations.

    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]
    actuated: of a robot with loops, the joints that have motors, where they differ from model.actuated; torques of the
        others are zero, and the smallest ones (least sum of squares, newtons and newton meters alike) where there are
        more motors than motions

    Raises InvalidInput, with loops also where motors leave a motion free; InconsistentState where a loop is open.
    """
    model = model if actuated is None else model.with_actuated(actuated)
    return Verbs.inverse_dynamics(model, (q, v, a), base, method, threads, check, out, external_wrenches)


@with_keywords
def solve_kkt(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: tuple[Array, Array] | None = None,
) -> tuple[Array, Array]:
    """The unknowns of Eq. (111), and nothing else: body_accelerations (…, n, 6) and multipliers (…, n, 5).

    Arguments, units and errors as in forward_dynamics, for any number of states; kkt_system shows the equations of one.
    """
    return Verbs.solve_kkt(model, (q, v, tau), base, method, threads, check, out, external_wrenches)


@with_keywords
def joint_torques(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """inverse_dynamics(…).tau alone (…, n), which takes a third of the time [N m or N].

    Arguments and errors are the same.
    """
    return Verbs.joint_torques(model, (q, v, a), base, method, threads, check, out, external_wrenches)


@with_keywords
def joint_accelerations(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """forward_dynamics(…).a alone (…, n), which takes a third of the time [rad/s² or m/s²].

    Arguments and errors are the same.
    """
    return Verbs.joint_accelerations(model, (q, v, tau), base, method, threads, check, out, external_wrenches)


@with_keywords
def bias_torque(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """h (…, n): τ = M a + h without external wrenches: velocity, gravity and base motion [N m or N].

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.
    """
    return Verbs.bias_torque(model, (q, v), base, method, threads, check, out)


@with_keywords
def gravity_torque(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """g (…, n): τ that holds the robot at rest against gravity, the gradient of its potential energy [N m or N].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput.
    """
    at_rest = base and BaseMotion(base.rotation, base.translation)
    return Verbs.gravity_torque(model, (q,), at_rest, method, threads, check, out)


@with_keywords
def static_torque(
    model: RobotModel,
    q: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """τ (…, n) that holds the robot at rest against gravity and external wrenches [N m or N].

    Without external wrenches it is gravity_torque.
    q: joint positions                                      (…, n)     [rad or m]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Of the motion of a base only the placement counts. Raises InvalidInput.
    """
    at_rest = base and BaseMotion(base.rotation, base.translation)
    return Verbs.static_torque(model, (q,), at_rest, method, threads, check, out, external_wrenches)


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
    """
    if coordinates not in ("twist", "cardano"):
        raise InvalidInput(f"coordinates is '{coordinates}'; use 'twist' or 'cardano'")
    x = one_state(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    if model.chords:
        closed(model, x["q"], x["v"])  # refuses open states
    state = projected.rooted_state(model, base, x["q"], x["v"])
    bias = bias_acceleration(model.rooted, x["q"], x["v"], state.ground)
    system = projected.kkt(state, x["tau"], x["external_wrenches"], bias)
    return system if coordinates == "twist" else cardano_system(state, system)
