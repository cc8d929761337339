"""Robots in three dimensions on the page of a report: `--3d`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from crosscheck.commands.program.options import FACES

if TYPE_CHECKING:
    from crosscheck.exciting.excited import Excited
    from crosscheck.identifying import Identified
    from crosscheck.viewing.figures import Figure
    from graphdyn import RobotModel, Simulation
    from graphdyn.layout import Array
    from urdf import Reading


def figure_at_rest(robot: str, model: RobotModel, reading: Reading, q: Array | None = None) -> Figure:
    """The robot at rest.

    q: where it stands (nv,), zero or the nearest position within limits if None; loops are closed [rad or m]
    """
    from crosscheck.viewing.figures import Figure
    from crosscheck.viewing.motions import closed_instant
    from crosscheck.viewing.robots import shown_robot

    motion, notes = closed_instant(model) if model.chords and q is None else (None, ())
    return Figure(Path(robot).name, shown_robot(robot, model, reading, FACES), motion, notes, q)


def simulated(robot: str, motion: Simulation, reading: Reading) -> Figure:
    """The robot in a simulated motion."""
    from crosscheck.viewing.figures import Figure
    from crosscheck.viewing.motions import simulated_motion
    from crosscheck.viewing.robots import shown_robot

    return Figure(Path(robot).name, shown_robot(robot, motion.model, reading, FACES), *simulated_motion(motion))


def planned_figures(found: Excited) -> list[Figure]:
    """The robot in each of the planned motions."""
    from crosscheck.viewing.figures import Figure
    from crosscheck.viewing.motions import planned_motion
    from crosscheck.viewing.robots import shown_robot

    model = found.problem.torque_model.model
    shown, name = shown_robot(found.robot, model, found.reading, FACES), Path(found.robot).name
    many = len(found.motions) > 1
    return [
        Figure(f"{name}, motion {number}" if many else name, shown, *planned_motion(model, motion.course))
        for number, motion in enumerate(found.motions, start=1)
    ]


def recorded(found: Identified) -> Figure:
    """The robot of an identification, with the links of its file, in the motion of its first recording."""
    from crosscheck.viewing.figures import Figure
    from crosscheck.viewing.motions import recorded_motion
    from crosscheck.viewing.robots import shown_robot

    subject, recording = found.subject, found.recordings[0]
    shown = shown_robot(subject.name, subject.model, subject.reading, FACES)
    motion, notes = recorded_motion(subject.model, found.preparation.differentiated(recording))
    which = f"{', '.join(recording.provenance.files)}, the motion as it was fitted"
    others = len(found.recordings) - 1
    told = f"{which}; {others} further recordings are not shown" if others else which
    return Figure(Path(subject.name).name, shown, motion, (told, *notes))
