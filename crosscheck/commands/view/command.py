"""`graphdyn view`: robots in three dimensions, with the loads of their joints."""

from __future__ import annotations

import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from crosscheck.commands.program.console import out, progress, say, warned, warnings_shown
from crosscheck.commands.program.options import EXAMPLES, FACES, robot_names
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions, reading_arguments
from crosscheck.commands.program.recording_options import RecordingOptions, naming_recording_command, show_findings
from crosscheck.report.plain_text import printable
from graphdyn.errors import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from crosscheck.viewing.figures import Figure

EPILOG = f"""{EXAMPLES}  graphdyn view ur5
  graphdyn view ur5 --play run.parquet --html run.html
  graphdyn view arm.urdf --play measured.csv --play simulated.parquet
  graphdyn view ur5 ur10 --no-browser --port 8080
"""

MAX_PRINTED_NOTES = 6
"""Notes on a figure that are printed."""


@dataclass(frozen=True, kw_only=True)
class ViewOptions(ReadingOptions, RecordingOptions):
    """What `graphdyn view` is asked for."""

    robots: Annotated[
        list[str],
        typer.Argument(
            metavar="ROBOT...",
            help="Names (`graphdyn robots`), URDF, .xacro or MJCF files.",
            autocompletion=robot_names,
        ),
    ]
    play: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="RUN",
            help="Play a recording, or what `graphdyn simulate --out` wrote. Repeatable: several runs of one robot, or "
            "one run for each robot, side by side.",
        ),
    ] = None
    html_file: Annotated[
        OutputFile | None,
        typer.Option(
            "--html",
            metavar="FILE",
            parser=OutputFile,
            help="Write a page that needs neither server nor network to FILE, instead of serving it.",
        ),
    ] = None
    port: Annotated[
        int,
        typer.Option(min=0, max=65535, metavar="N", help="Port of 127.0.0.1 to serve at; 0 takes a free one."),
    ] = 0
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address; do not open a browser.")] = False
    faces: Annotated[int, typer.Option(min=1, metavar="N", help="Approximate number of triangles per robot.")] = FACES
    actuated: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT", help="Motorized joint of a robot with loops; joint loads depend on it. Repeatable."
        ),
    ] = None


def run(options: ViewOptions) -> None:
    """Show robots in three dimensions, and loads of joints.

    Joints can be moved by hand. Shown at choice: reaction forces and moments of the joints as arrows to scale, actuator
    torques, link frames, joint axes, centers of mass, inertia ellipsoids; torques, loads and multipliers as curves.

    Without --html the page is served at 127.0.0.1 until Ctrl-C, and robots can be let go to fall under gravity.
    """
    robots, runs, actuated, reading = options.robots, options.play or [], options.actuated, options.reading
    if runs and len(robots) not in (1, len(runs)):
        raise typer.BadParameter(
            f"{len(robots)} robots and {counted(len(runs), 'run')}; give one robot, or one for each run"
        )
    low_pass = options.low_pass
    import urdf
    from crosscheck.recordings import differentiated, load_recording
    from crosscheck.recordings.errors import RecordingFinding
    from crosscheck.viewing.figures import Figure
    from crosscheck.viewing.motions import closed_instant, recorded_motion
    from crosscheck.viewing.robots import shown_robot

    def figure(name: str, path: Path | None) -> Figure:
        robot = shown[name]
        if path is None:
            return Figure(Path(name).name, robot, *(closed_instant(robot.model) if robot.model.chords else ()))
        joints = robot.model.independent_joints
        with naming_recording_command([path], ("--robot", name, *reading_arguments(options)), options.mapping):
            recording = load_recording(path, options.mapping, joints=joints, rate=options.rate, drop=options.drop or ())
        findings.extend(recording.findings)
        if recording.v is None or recording.a is None:
            recording = differentiated(recording, low_pass)
        return Figure(f"{Path(name).name}: {path.name}", robot, *recorded_motion(robot.model, recording))

    shown, findings = {}, list[RecordingFinding]()
    names = robots * (len(runs) if len(robots) == 1 and runs else 1)
    with warnings_shown(), progress("view", len(robots) + len(names)) as advance:
        for name in robots:
            advance(f"reading {Path(name).name}", 0)
            model = urdf.load(name, reading=reading)
            shown[name] = shown_robot(
                name, model.with_actuated(actuated) if actuated else model, reading, options.faces
            )
            advance(name, 1)
        figures = []
        for name, path in zip_longest(names, runs):
            what = Path(name).name if path is None else str(path)
            advance(f"computing loads of {what}", 0)
            figures.append(figure(name, path))
            advance(what, 1)
    show_findings(findings)
    for each in figures:
        notes = (*each.notes, *each.robot.notes)
        for note in notes[:MAX_PRINTED_NOTES]:
            say(f"{each.name}: {note}")
        if len(notes) > MAX_PRINTED_NOTES:
            say(f"{each.name}: {len(notes) - MAX_PRINTED_NOTES} further notes, on the page")
    warnings = list(map(printable, warned))
    title = ", ".join(dict.fromkeys(each.name for each in figures))
    if options.html_file is not None:
        from crosscheck.viewing.page import page

        options.html_file.write(page(title, figures, warnings=warnings).encode())
    else:
        _serve(title, figures, warnings, options.port, options.no_browser)


def _serve(title: str, figures: Sequence[Figure], warnings: Sequence[str], port: int, no_browser: bool) -> None:
    """Serve until Ctrl-C."""
    from crosscheck.viewing.server import PageServer

    try:
        server = PageServer(title, figures, port, warnings)
    except OSError as error:
        raise typer.BadParameter(f"--port {port}: {error.strerror}; name another, or 0 for a free one") from None
    with server:
        out.print(f"{server.address}  (Ctrl-C ends)", soft_wrap=True)
        if not no_browser:
            webbrowser.open(server.address)
        with suppress(KeyboardInterrupt):
            server.serve_forever()
