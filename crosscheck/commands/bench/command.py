"""`graphdyn bench`: how fast graphdyn is beside other libraries."""

from __future__ import annotations

from typing import Annotated

import typer

from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, HtmlOption, JsonOption, SeedOption, robot_names

EPILOG = f"""{EXAMPLES}  graphdyn bench --quick --samples 1000 --threads 1
  graphdyn bench
  graphdyn bench --robot panda --samples 10000 --threads 1
  graphdyn bench --json bench.json --html bench.html
"""

RobotOption = Annotated[
    str,
    typer.Option(metavar="ROBOT", help="Name (`graphdyn robots`), URDF or .xacro file.", autocompletion=robot_names),
]
SamplesOption = Annotated[
    int,
    typer.Option(min=1, metavar="N", help="States per run; the identification and the largest batch take ten times N."),
]
ThreadsOption = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Threads to compare beside one; all cores if left out.")
]
QuickOption = Annotated[bool, typer.Option("--quick", help="Fewer repeats and points: less than a minute.")]


def run(
    robot: RobotOption = "ur5",
    samples: SamplesOption = 100_000,
    threads: ThreadsOption = None,
    seed: SeedOption = 0,
    quick: QuickOption = False,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
) -> None:
    """Measure graphdyn beside Pinocchio, MuJoCo and CasADi.

    All take turns in one run: medians, quartiles and ratios, with the accuracy of each against Pinocchio. Inverse and
    forward dynamics, all multipliers, regressors, derivatives, a Jacobian, matrices and energy, identification with its
    memory, steps of simulations, calls with few states, first calls, and curves over batch, bodies and threads, beside
    what this machine could do at best. MuJoCo and CasADi take part where they are installed
    (pip install 'graphdyn[peers]').
    """
    import urdf
    from crosscheck.bench.benchmark import N_PROGRESS_STEPS, benchmark
    from crosscheck.commands.bench.report import bench_report

    with warnings_shown():
        model = urdf.load(robot)
        with progress("bench", N_PROGRESS_STEPS) as advance:
            found = benchmark(robot, model, samples, seed, threads, quick, advance)
    deliver(bench_report(found), html_file, json_file)
    raise typer.Exit(AGREED if found.agrees else DISAGREED)
