"""`graphdyn diff`: whether two descriptions are of one robot, and what differs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from crosscheck.commands.program.console import warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, SeedOption, robot_names
from crosscheck.commands.program.output_files import OutputFile

EPILOG = f"""{EXAMPLES}  graphdyn diff ur5 ur5
  graphdyn diff maker.urdf menagerie.xml --html diff.html
  graphdyn diff arm.urdf arm_with_gripper.urdf --tip tool0 --tip flange
  graphdyn diff arm.urdf better.xml --use-inertials-of B --out better.urdf
"""


@dataclass(frozen=True, kw_only=True)
class DiffOptions(ReportOptions):
    """What `graphdyn diff` is asked for."""

    robots: Annotated[
        tuple[str, str],
        typer.Argument(
            metavar="A B",
            help="Names (`graphdyn robots`), URDF, .xacro or MJCF files, DH tables (.toml), or JSON files of "
            "`graphdyn export`.",
            autocompletion=robot_names,
        ),
    ]
    tip: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LINK",
            help="Compare the arm up to LINK alone, and lock what it carries, such as a gripper: a link of both "
            "robots; or twice, of A and then of B, where - stands for the whole robot.",
        ),
    ] = None
    tolerance: Annotated[
        float,
        typer.Option(
            metavar="X",
            help="Differences that do not count: parts of reach, mass, tensor and torque, and angles [rad].",
        ),
    ] = 1e-5
    samples: Annotated[int, typer.Option(min=1, metavar="N", help="Random states within A's limits.")] = 1000
    seed: SeedOption = 0
    use_inertials_of: Annotated[
        Literal["A", "B"] | None,
        typer.Option(help="The robot whose inertials the URDF file of the other one gets, in its own frames."),
    ] = None
    out: Annotated[
        OutputFile | None,
        typer.Option(metavar="FILE.urdf", parser=OutputFile.robot, help="Write the file of --use-inertials-of."),
    ] = None


def run(options: DiffOptions) -> None:
    """Say whether two files describe one robot, and what differs.

    B is laid over A first: senses and zeros of the joints, base, link frames. What had to be done is told. Then what is
    left is compared: lengths, angles and axes, each link's mass, center and tensor in A's frames, frames of the same
    name, torques of gravity, inertia and velocity over random states with the worst of them, armature, damping,
    friction and limits. Both robots are under A's gravity.

    Exit code 0: the same model; 1: something differs; 2: bad input.
    """
    if (options.use_inertials_of is None) != (options.out is None):
        raise typer.BadParameter("--use-inertials-of and --out belong together; give both, or neither")
    from crosscheck.commands.diff.inertials import with_inertials_of
    from crosscheck.commands.diff.report import diff_report
    from crosscheck.commands.diff.robots import ComparedRobots, robots_of
    from graphdyn.aligning import VERDICTS, differences

    with warnings_shown():
        robots = robots_of(options.robots, options.tip or ())
    found = differences(
        robots[0].model, robots[1].model, tolerance=options.tolerance, samples=options.samples, seed=options.seed
    )
    written = None
    if options.use_inertials_of is not None and options.out is not None:
        written = with_inertials_of(options.use_inertials_of, robots, found, options.out.path)
    compared = ComparedRobots(robots, found, options.seed, written)
    deliver(diff_report(compared), options)
    raise typer.Exit(AGREED if found.verdict == VERDICTS[0] else DISAGREED)
