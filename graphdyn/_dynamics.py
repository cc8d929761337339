"""The public verbs of the dynamics.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
Keywords, where a verb has them:

base: prescribed motion of the base; the mass matrix does not depend on it
method: "dense" solves Eq. (111) as it stands, the specification; "projected" eliminates the multipliers with the null
    space of φ_q (NᵀAN a = …) and reads them off the path matrix; "recursive" eliminates body after body, compiled for
    this robot (graphdyn.kernels). Same answer up to rounding, each faster than the one before. "auto" is "recursive"
    for 1000 samples and more, or with out, and "projected" for fewer, which are not worth compiling for
threads: how many the recursive method may use, None for as many as there are cores; the answer does not depend on it,
    nor on the samples beside one, bit for bit (but where a pivot is so small that the projected method decides)
check: refuse NaN and infinity, naming argument and row; with False the recursive method does not look, and what depends
    on them comes out as NaN, in their samples only
out: memory for the answer, recursive method only: C-contiguous float64 arrays of the shapes of the answer
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import ArrayLike

from graphdyn import _projected as projected
from graphdyn import _recursive as recursive
from graphdyn._answers import ForwardDynamics, InverseDynamics
from graphdyn._arrays import joint_arrays, one_state, refuse_non_finite
from graphdyn._base_motion import BaseMotion
from graphdyn._cardano import cardano_system
from graphdyn._errors import InvalidInput
from graphdyn._kkt import Coordinates, KKTSystem
from graphdyn._methods import Method, is_recursive
from graphdyn._model import RobotModel
from graphdyn.kernels.batch import Options
from graphdyn.layout import Array

UNKNOWNS = ("body_accelerations", "multipliers")
"""Of Eq. (111), as ForwardDynamics calls them."""


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
    base, method, threads, check, out: see the head of graphdyn._dynamics

    Raises SingularMassMatrix where the torques do not determine the accelerations (massless bodies).
    """
    x = _arguments(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    if is_recursive(method, x, out):
        options = Options(threads, check)
        return ForwardDynamics(
            **recursive.answers(
                model, "forward_dynamics", _names(ForwardDynamics), x, base, options, _memory(ForwardDynamics, out)
            )
        )
    return projected.forward_dynamics(model, _checked(model, x), base, dense=method == "dense")


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
) -> InverseDynamics:
    """Actuator torques and all constraint forces, given the joint accelerations.

    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]
    base, method, threads, check, out: see the head of graphdyn._dynamics
    """
    x = _arguments(model, base, q=q, v=v, a=a, external_wrenches=external_wrenches)
    if is_recursive(method, x, out):
        options = Options(threads, check)
        return InverseDynamics(
            **recursive.answers(
                model, "inverse_dynamics", _names(InverseDynamics), x, base, options, _memory(InverseDynamics, out)
            )
        )
    return projected.inverse_dynamics(model, _checked(model, x), base, dense=method == "dense")


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

    As in forward_dynamics, for any number of states; kkt_system shows the equations of one.
    """
    x = _arguments(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    if is_recursive(method, x, out):
        if out is not None and (not isinstance(out, tuple) or len(out) != len(UNKNOWNS)):
            raise InvalidInput(f"out is {type(out).__name__}; give a pair of arrays, for {' and '.join(UNKNOWNS)}")
        given = None if out is None else dict(zip(UNKNOWNS, out, strict=True))
        arrays = recursive.answers(model, "forward_dynamics", UNKNOWNS, x, base, Options(threads, check), given)
        return arrays["body_accelerations"], arrays["multipliers"]
    answer = projected.forward_dynamics(model, _checked(model, x), base, dense=method == "dense")
    return answer.body_accelerations, answer.multipliers


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
    """forward_dynamics(…).a alone (…, n), which takes a third of the time [rad/s² or m/s²]."""
    x = _arguments(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    if is_recursive(method, x, out):
        given = None if out is None else {"a": out}
        return recursive.answers(model, "forward_dynamics", ("a",), x, base, Options(threads, check), given)["a"]
    return projected.forward_dynamics(model, _checked(model, x), base, dense=method == "dense").a


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
    """inverse_dynamics(…).tau alone (…, n), which takes a third of the time [N m or N]."""
    x = _arguments(model, base, q=q, v=v, a=a, external_wrenches=external_wrenches)
    if is_recursive(method, x, out):
        given = None if out is None else {"tau": out}
        return recursive.answers(model, "inverse_dynamics", ("tau",), x, base, Options(threads, check), given)["tau"]
    return projected.inverse_dynamics(model, _checked(model, x), base, dense=method == "dense").tau


def mass_matrix(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """M = NᵀAN (…, n, n) [kg m², kg m, kg]. The motion of a base does not change it; all verbs take the keyword."""
    x = _arguments(model, base, q=q)
    if is_recursive(method, x, out):
        return recursive.single_array(model, "mass_matrix", x, None, Options(threads, check), out)
    return projected.mass_matrix(model, _checked(model, x), base)


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
    """h (…, n): τ = M a + h without external wrenches: velocity, gravity and base motion [N m or N]."""
    x = _arguments(model, base, q=q, v=v)
    if is_recursive(method, x, out):
        return recursive.single_array(model, "bias_torque", x, base, Options(threads, check), out)
    return inverse_dynamics(model, q, v, np.zeros(model.n_bodies), base=base, method=method).tau


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
    """Eq. (111) at ONE state: matrix (11n, 11n), right side, rank, condition number, solution, residuals.

    q, v, tau: (n,); external_wrenches: (n, 6); base: prescribed motion of the base at that state
    coordinates: "twist" (r̈, ω̇), regular in every pose; "cardano" (r̈, θ̈) as the paper writes it, rows times Dᵀ

    Raises InvalidInput for more than one state; GimbalLock for Cardano coordinates at |cos β| below 1e-4.
    """
    if coordinates not in ("twist", "cardano"):
        raise InvalidInput(f"coordinates is '{coordinates}'; use 'twist' or 'cardano'")
    x = one_state(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    state = projected.rooted_state(model, base, x["q"], x["v"])
    system = projected.kkt(state, x["tau"], x["external_wrenches"])
    return system if coordinates == "twist" else cardano_system(state, system)


def _arguments(
    model: RobotModel, base: BaseMotion | None, external_wrenches: ArrayLike | None = None, **joints: ArrayLike
) -> dict[str, Array]:
    given = {} if external_wrenches is None else {"external_wrenches": external_wrenches}
    return joint_arrays(model, base, check=False, **joints, **given)


def _checked(model: RobotModel, x: projected.Arguments) -> projected.Arguments:
    """The arguments of the projected verbs: finite, and with external wrenches."""
    refuse_non_finite(model, x)
    return {"external_wrenches": np.zeros((*x["q"].shape, 6)), **x}


def _names(answer: type) -> tuple[str, ...]:
    return tuple(field.name for field in fields(answer))


def _memory(answer: type, out: object) -> dict[str, Array] | None:
    """The arrays of out, an answer whose arrays may be written to. Raises InvalidInput for anything else."""
    if out is None:
        return None
    if not isinstance(out, answer):
        raise InvalidInput(f"out is {type(out).__name__}; give {answer.__name__} with an array for each of its fields")
    return {name: getattr(out, name) for name in _names(answer)}
