"""`graphdyn bench`: how fast graphdyn is beside other libraries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, RobotOption, SeedOption
from crosscheck.commands.program.reading_options import ReadingOptions

EPILOG = f"""{EXAMPLES}  graphdyn bench --quick --samples 1000 --threads 1
  graphdyn bench
  graphdyn bench --robot panda --mimic independent --samples 10000 --threads 1
  graphdyn bench --native --quick
  graphdyn bench --json bench.json --html bench.html
"""


@dataclass(frozen=True, kw_only=True)
class BenchOptions(ReadingOptions, ReportOptions):
    """What `graphdyn bench` is asked for."""

    robot: RobotOption = "ur5"
    samples: Annotated[
        int,
        typer.Option(
            min=1, metavar="N", help="States per run; the identification and the largest batch take ten times N."
        ),
    ] = 100_000
    threads: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", show_default="all cores", help="Threads to compare with one thread."),
    ] = None
    seed: SeedOption = 0
    native: Annotated[
        bool,
        typer.Option(
            "--native", help="Pinocchio in C++ too, compiled here in half a minute: needs a C++ compiler and Eigen."
        ),
    ] = False
    quick: Annotated[bool, typer.Option("--quick", help="Fewer repeats and points: about a minute.")] = False


def run(options: BenchOptions) -> None:
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
        model = urdf.load(options.robot, reading=options.reading)
        with progress("bench", N_PROGRESS_STEPS) as advance:
            found = benchmark(
                options.robot,
                model,
                options.samples,
                options.seed,
                options.threads,
                options.quick,
                options.native,
                advance,
            )
    deliver(bench_report(found), options)
    raise typer.Exit(AGREED if found.agrees else DISAGREED)
