"""Motions to be shown: recordings, thinned, with the loads of the joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crosscheck.recordings import Recording
from crosscheck.viewing.figures import LoadedMotion
from graphdyn import GraphDynError, RobotModel, Simulation, inverse_dynamics
from graphdyn.excitation import FiniteMotion
from graphdyn.layout import ANGULAR, LINEAR, Array

SHOWN_RATE = 50.0
"""Instants that are shown per second: what lies between two is a straight line [Hz]."""

MAX_INSTANTS = 6000
"""Largest number of instants of a motion; a longer one is shown at a lower rate."""


def recorded_motion(model: RobotModel, recording: Recording) -> tuple[LoadedMotion, tuple[str, ...]]:
    """The motion of a recording with q, v and a, and notes on how it is shown.

    Its joint wrenches are shown where it has them; else those that inverse dynamics gives.

    Raises InvalidInput where v or a is missing, or the joints are not those of the model.
    """
    rows = shown_rows(recording.t)
    q, v, a = (recording.channel(name)[rows] for name in ("q", "v", "a"))
    if recording.joint_wrenches is None:
        wrenches, source = _loads(model, q, v, a)
    else:
        wrenches, source = recording.joint_wrenches[rows], "loads as recorded"
    tau = None if recording.tau is None else recording.tau[rows]
    motion = _loaded(model, recording.t[rows], q, wrenches, tau)
    notes = [_told(recording.t, rows), *recording.provenance.steps, source]
    pieces = len(recording.block_slices)
    if pieces > 1:
        notes.append(f"{pieces} uninterrupted pieces, joined by straight lines")
    return motion, tuple(notes)


def planned_motion(model: RobotModel, course: FiniteMotion) -> tuple[LoadedMotion, tuple[str, ...]]:
    """A motion that is not made yet, with the loads of the bodies, and notes on how it is shown."""
    rate = min(SHOWN_RATE, MAX_INSTANTS / course.duration)
    times = np.linspace(0.0, course.duration, int(course.duration * rate) + 1)
    q, v, a, _ = course.motion(times)
    wrenches, source = _loads(model, q, v, a)
    return _loaded(model, times, q, wrenches), ("as planned", source)


def closed_instant(model: RobotModel, position: ArrayLike | None = None) -> tuple[LoadedMotion, tuple[str, ...]]:
    """A robot with loops at rest, as a motion of one instant, and notes on it.

    position: q (nv,) that closes the loops; the model's closed pose if None [rad or m]

    Raises InconsistentState where no pose closes the loops.
    """
    q = np.asarray(model.closed_pose if position is None else position)[None]
    wrenches, source = _loads(model, q, 0 * q, 0 * q)
    return _loaded(model, np.zeros(1), q, wrenches), ("the pose that closes the loops, at rest", source)


def simulated_motion(simulation: Simulation) -> tuple[LoadedMotion, tuple[str, ...]]:
    """The motion of a simulation, and notes on how it is shown."""
    rows = shown_rows(simulation.time)
    time, q, wrenches, tau = (
        values[rows] for values in (simulation.time, simulation.q, simulation.reactions.joint_wrenches, simulation.tau)
    )
    return _loaded(simulation.model, time, q, wrenches, tau), (_told(simulation.time, rows),)


def shown_rows(time: Array) -> NDArray[np.intp]:
    """The rows (K,) of increasing times (N,) [s] that are shown: the nearest to even steps, and the last."""
    duration = float(time[-1] - time[0])
    rate = min(SHOWN_RATE, MAX_INSTANTS / duration) if duration > 0 else SHOWN_RATE
    even = time[0] + np.arange(int(duration * rate * (1 + 1e-9)) + 1) / rate
    nearest = np.searchsorted((time[1:] + time[:-1]) / 2, even)
    return np.unique(np.append(nearest, len(time) - 1))


def _loads(model: RobotModel, q: Array, v: Array, a: Array) -> tuple[Array, str]:
    """Joint wrenches (N, n, 6), and where they come from. NaN where those of a loop do not follow from the motion."""
    try:
        return inverse_dynamics(model, q, v, a).joint_wrenches, "loads by inverse dynamics of q, v and a"
    except GraphDynError as error:
        if not model.chords:
            raise
        return np.full((len(q), model.n_bodies, 6), np.nan), f"no loads are shown: {error}"


def _told(time: Array, rows: NDArray[np.intp]) -> str:
    start = f" from {time[0]:g} s on" if time[0] else ""
    return f"{time[-1] - time[0]:.4g} s{start}, {len(rows)} of {len(time)} instants shown"


def _loaded(model: RobotModel, time: Array, q: Array, wrenches: Array, recorded: Array | None = None) -> LoadedMotion:
    """A motion, and the torques of its joint wrenches, in whose link axes the joint axes stand still."""
    parts = [wrenches[..., j, LINEAR if joint.is_prismatic else ANGULAR] for j, joint in enumerate(model.joints)]
    along = [part @ joint.axis for part, joint in zip(parts, model.joints, strict=True)]
    tau = np.stack(along, axis=-1) @ model.degrees_of_freedom.matrix
    return LoadedMotion(time, q, wrenches, tau, recorded)
