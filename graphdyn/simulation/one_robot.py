"""One robot in motion: the public function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats, one_state
from graphdyn.equations.loops.dynamics import closed, refuse_massless_motions
from graphdyn.equations.projected import refuse_singular
from graphdyn.errors import InvalidInput
from graphdyn.experiments.experiment import BaseMotionLaw
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.simulation.equations import LoopEquations, refuse_dry_friction
from graphdyn.simulation.integration.adaptive import adaptive
from graphdyn.simulation.integration.events import Event, InitialValueProblem, SimulatedCourse
from graphdyn.simulation.integration.fixed import fixed
from graphdyn.simulation.integration.loop_adaptive import loop_adaptive
from graphdyn.simulation.integration.maximal import Stabilization, maximal
from graphdyn.simulation.integration.steps import FIXED_STEPS
from graphdyn.simulation.plant import (
    Friction,
    JointStops,
    PlantConstants,
    Wrenches,
    make_plant,
    position_limits,
    refuse_loops,
)
from graphdyn.simulation.result import Simulation
from graphdyn.simulation.torques import QUOTIENT_TOLERANCE, Controller, TorqueFunction, torques
from graphdyn.verbs.matrices import mass_matrix

Method = Literal["dop853", "rk8", "rk4", "euler"]
RTOL, ATOL = 1e-10, 1e-10
"""Tolerances of method "dop853" by default; the absolute one in rad or m, and …/s."""


def simulate(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    duration: float,
    *,
    torque: TorqueFunction | Controller | ArrayLike | None = None,
    external_wrenches: Wrenches | ArrayLike | None = None,
    base: BaseMotionLaw | Sequence[BaseMotionLaw] = (),
    method: Method = "dop853",
    step: float | None = None,
    rtol: float = RTOL,
    atol: float = ATOL,
    at: ArrayLike | None = None,
    friction: Friction | Literal["model"] | None = None,
    rotor_inertia: ArrayLike | None = None,
    limits: JointStops | Literal["stop"] | None = None,
    torque_limits: ArrayLike | Literal["model"] | None = None,
    events: Event | Sequence[Event] = (),
    coordinates: Literal["joint", "maximal"] = "joint",
    stabilization: Stabilization = "projection",
    progress: Callable[[float], None] | None = None,
) -> Simulation:
    """The motion of a robot from a state on, under the torques given.

    q, v: the state at time zero                            (n,)  [rad or m, …/s]
    duration: [s]
    torque: of the actuators: None for none; (n,), constant; (K, n), each held for a K-th of the duration; PDControl or
        ComputedTorqueControl; or a function of t, q and v that answers (n,)  [N m or N]. Fixed steps run in compiled
        code, hundreds of times faster than with a function, which is Python and asked at every stage
    external_wrenches: force, moment on each body at O_j, in link axes: (n, 6), or a function of t, q and v  [N, N m]
    base: motion of the moving base: rails and turntable, as in graphdyn.simulate_recording
    method: "dop853" adapts its steps to rtol and atol; "rk8", "rk4" and "euler" take steps of equal width
    step: width of fixed steps, which must divide the duration; method "dop853" has none   [s]
    at: times of the result, increasing; those of fixed steps must be multiples of the step. None for all steps   [s]
    friction: a Friction, or "model" for damping and friction of the file. Dry friction holds a joint at rest exactly
    rotor_inertia: of rotors and gears as seen at the joints, without gyroscopic effects   () or (n,)  [kg m² or kg]
    limits: "stop" ends the simulation at a position limit of the model; JointStops are springs beyond; None: no limits
    torque_limits: largest torques () or (n,), or "model" for the efforts of the file   [N m or N]
    events: functions whose changes of sign are found, and may stop the simulation
    coordinates: "joint", or "maximal": the equations of all bodies as they stand, with fixed steps, for teaching and
        checks; they know torques, but neither friction nor limits, events, or a base that moves
    stabilization: of maximal coordinates, "projection", "baumgarte" or "none"
    progress: called with the time reached, from time to time   [s]

    Work that the friction takes, and what actuators do, is integrated beside the motion (Simulation.energy). Contact
    with the surroundings, inverse kinematics and flexible joints are not simulated.

    Robots with loops start closed; positions and velocities are closed again after every step, also past singular
    poses (docs/simulation.md). q, v and the torques are those of the joints that no others drive.

    Angles are accurate up to 1e6 rad.

    Raises InvalidInput; InconsistentState where loops are open; SingularMassMatrix where the torques do not determine
    the accelerations (massless bodies); IntegrationFailed where the numbers do not stay finite.

    >>> import graphdyn, numpy as np
    >>> motion = graphdyn.simulate(graphdyn.kr500(), q=np.full(6, 0.3), v=np.zeros(6), duration=0.1)
    >>> motion.q.shape[1], bool(motion.energy.drift < 1e-6)
    (6, True)
    """
    check_model(model)
    x = one_state(model, q=q, v=v)
    start = (x["q"].copy(), x["v"].copy())
    _check_times(duration, method, step)
    plant = make_plant(
        model,
        friction=friction,
        rotor_inertia=rotor_inertia,
        limits=limits,
        torque_limits=torque_limits,
        external_wrenches=external_wrenches,
        base=base,
    )
    refuse_dry_friction(plant)
    mass = mass_matrix(model, start[0], method="reproducible") + np.diag(plant.rotor)
    if model.chords:
        refuse_massless_motions(model, closed(model, *start).spaces, mass)
        start = LoopEquations(plant).started(*start)
    else:
        refuse_singular(model, mass)
    times = _times(at, duration)
    checked = (events,) if isinstance(events, Event) else tuple(events)
    if limits == "stop":
        _refuse_outside(model, start[0])
    if coordinates == "maximal":
        _refuse_in_maximal(plant, method, limits, checked)
    elif coordinates != "joint":
        raise InvalidInput(f"coordinates is '{coordinates}'; use 'joint' or 'maximal'")
    source, report = torques(torque, model, duration), progress or (lambda time: None)
    problem = InitialValueProblem(plant, start, duration, source, times, checked, limits == "stop", report)
    if method == "dop853":
        for name, value in (("rtol", rtol), ("atol", atol)):
            if not value > 0:
                raise InvalidInput(f"{name} is {value!r}; give a tolerance above zero")
        return simulation(plant, (loop_adaptive if model.chords else adaptive)(problem, rtol, atol))
    assert step is not None
    if coordinates == "maximal":
        course, bodies = maximal(problem, method, step, stabilization)
        return replace(simulation(plant, course), _bodies=bodies)
    return simulation(plant, fixed(problem, method, step))


def simulation(plant: PlantConstants, course: SimulatedCourse) -> Simulation:
    """The result of a course."""
    columns = course.columns
    return Simulation(
        model=plant.model,
        time=course.time,
        q=columns["q"],
        v=columns["v"],
        a=columns["a"],
        tau=columns["tau"],
        passive=columns["passive"],
        occurrences=course.occurrences,
        ended=course.ended,
        _plant=plant,
        _work=columns["work"][:, 0],
        _loss=columns["loss"][:, 0],
    )


def _check_times(duration: float, method: str, step: float | None) -> None:
    if not (duration > 0 and np.isfinite(duration)):
        raise InvalidInput(f"duration is {duration!r}; give seconds above zero")
    if method == "dop853":
        if step is not None:
            raise InvalidInput("method 'dop853' chooses its steps; leave out step, or take 'rk8', 'rk4' or 'euler'")
    elif method not in FIXED_STEPS:
        raise InvalidInput(f"method is '{method}'; use one of dop853, {', '.join(FIXED_STEPS)}")
    elif step is None or not (step > 0 and np.isfinite(step)):
        raise InvalidInput(f"step is {step!r}; method '{method}' takes steps of fixed width: give seconds above zero")


def _refuse_in_maximal(plant: PlantConstants, method: str, limits: object, events: Sequence[Event]) -> None:
    given = {
        "friction": plant.has_friction,
        "rotor_inertia": "rotor" in plant.constants,
        "limits": limits is not None,
        "events": bool(events),
        "base": bool(plant.base),
    }
    refused = [name for name, there in given.items() if there]
    refuse_loops("coordinates='maximal'", plant.model, "use joint coordinates")
    if plant.model.couplings:
        raise InvalidInput(
            f"maximal coordinates do not know the couplings of robot '{plant.model.name}'; use joint coordinates"
        )
    if refused:
        raise InvalidInput(f"maximal coordinates do not know {', '.join(refused)}; omit it, or use joint coordinates")
    if method == "dop853":
        raise InvalidInput(
            "maximal coordinates take steps of fixed width; give method 'rk8', 'rk4' or 'euler', and step"
        )


def _times(at: ArrayLike | None, duration: float) -> Array | None:
    if at is None:
        return None
    times = np.atleast_1d(as_floats("at", at))
    increasing = times.ndim == 1 and times.size > 0 and bool(np.all(np.diff(times) > 0))
    if not increasing or not times[0] >= 0 or not times[-1] <= duration * (1 + QUOTIENT_TOLERANCE):
        raise InvalidInput(f"at must be increasing times (N,) between 0 and the duration, {duration:g} s")
    return np.minimum(times, duration)


def _refuse_outside(model: RobotModel, q: Array) -> None:
    lower, upper = position_limits(model)
    q = model.joint_positions(q)
    for j in np.flatnonzero((q < lower) | (q > upper)).tolist():
        raise InvalidInput(
            f"joint '{model.joint_names[j]}' starts at {q[j]:g}, outside its limits {lower[j]:g} … {upper[j]:g}; "
            "start inside, or omit limits='stop'"
        )
