"""The places of a report: the terminal, and if asked for a page, with robots in three dimensions, and a JSON file.

The figures are made of what each command has found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from crosscheck.commands.program.console import out, warned
from crosscheck.commands.program.options import FACES, JsonOptions, PageOptions, ReportOptions, command_line
from crosscheck.report.report import Report, with_stage

if TYPE_CHECKING:
    from crosscheck.exciting.excited import Excited
    from crosscheck.identifying import Identified
    from crosscheck.viewing.figures import Figure
    from graphdyn import RobotModel, Simulation
    from graphdyn.layout import Array
    from urdf import Reading


def deliver(
    report: Report, options: JsonOptions | None = None, figures: Callable[[], Sequence[Figure]] | None = None
) -> None:
    """Print a report; write the files that options name, each whole or not at all, also where the output is closed.

    figures: what --3d shows on the page

    Warnings of the command, which the terminal has already, are told on the page and in the JSON file.

    Raises OSError.
    """
    from crosscheck.report.text import renderables

    if figures is not None and isinstance(options, PageOptions) and options.three_d:
        report = with_stage(report, figures())
    try:
        for part in renderables(report, out.width):
            out.print(part)
    finally:
        _write(report, options)


def _write(report: Report, options: JsonOptions | None) -> None:
    if isinstance(options, ReportOptions) and options.html_file is not None:
        from crosscheck.report.html import page
        from crosscheck.report.records.record import taking_part

        told = replace(report, warnings=tuple(warned))
        options.html_file.write(page(told, command_line(), taking_part()).encode())
    if options is not None and options.json_file is not None and report.record is not None:
        options.json_file.write(json_content(report.record(command_line())))


def json_content(record: object) -> bytes:
    """A record as the text of its JSON file, with the warnings of the command where it has a place for them."""
    from crosscheck.report.records.record import as_bytes, plain

    data = plain(record)
    return as_bytes(data | {"warnings": list(warned)} if "warnings" in data else data)


def figure_at_rest(robot: str, model: RobotModel, reading: Reading, q: Array | None = None) -> Figure:
    """The robot at rest.

    q: where it stands (nv,), zero or the nearest position within limits if None; loops are closed [rad or m]
    """
    from crosscheck.viewing import figures, motions, robots

    motion, notes = motions.closed_instant(model) if model.chords and q is None else (None, ())
    return figures.Figure(Path(robot).name, robots.shown_robot(robot, model, reading, FACES), motion, notes, q)


def simulated(robot: str, motion: Simulation, reading: Reading) -> Figure:
    """The robot in a simulated motion."""
    from crosscheck.viewing import figures, motions, robots

    shown = robots.shown_robot(robot, motion.model, reading, FACES)
    return figures.Figure(Path(robot).name, shown, *motions.simulated_motion(motion))


def planned_figures(found: Excited) -> list[Figure]:
    """The robot in each of the planned motions."""
    from crosscheck.viewing import figures, motions, robots

    model = found.problem.torque_model.model
    shown, name = robots.shown_robot(found.robot, model, found.reading, FACES), Path(found.robot).name
    many = len(found.motions) > 1
    return [
        figures.Figure(
            f"{name}, motion {number}" if many else name, shown, *motions.planned_motion(model, motion.course)
        )
        for number, motion in enumerate(found.motions, start=1)
    ]


def recorded(found: Identified) -> Figure:
    """The robot of an identification, with the links of its file, in the motion of its first recording."""
    from crosscheck.viewing import figures, motions, robots

    subject, recording = found.subject, found.recordings[0]
    shown = robots.shown_robot(subject.name, subject.model, subject.reading, FACES)
    motion, notes = motions.recorded_motion(subject.model, found.preparation.differentiated(recording))
    which = f"{', '.join(recording.provenance.files)}, the motion as it was fitted"
    others = len(found.recordings) - 1
    told = f"{which}; {others} further recordings are not shown" if others else which
    return figures.Figure(Path(subject.name).name, shown, motion, (told, *notes))
