"""`graphdyn judge`: foreign functions against graphdyn, Pinocchio and MuJoCo."""

from __future__ import annotations

from typing import Annotated

import typer

from crosscheck.cli.console import progress, warnings_shown
from crosscheck.cli.delivery import deliver
from crosscheck.cli.exits import AGREED, DISAGREED
from crosscheck.cli.foreign import foreign_function
from crosscheck.cli.options import (
    EXAMPLES,
    HtmlOption,
    JsonOption,
    LockOption,
    RobotArgument,
    SamplesOption,
    SeedOption,
    locked_joints,
)

EPILOG = f"""{EXAMPLES}  graphdyn judge ur5 --inverse-dynamics my_code.py:rnea
  graphdyn judge arm.urdf --forward-dynamics my_package.dynamics:aba --html verdict.html
"""

FUNCTION = "FILE.py:NAME"

InverseOption = Annotated[str | None, typer.Option(metavar=FUNCTION, help="(q, v, a) → τ, arrays of shape (n,).")]
ForwardOption = Annotated[str | None, typer.Option(metavar=FUNCTION, help="(q, v, τ) → a.")]
MassOption = Annotated[str | None, typer.Option(metavar=FUNCTION, help="q → M, shape (n, n).")]
RegressorOption = Annotated[str | None, typer.Option(metavar=FUNCTION, help="(q, v, a) → W, shape (n, 10n).")]
JointsOption = Annotated[
    str | None,
    typer.Option(metavar="NAME,NAME,…", help="Order of the joints in the functions; the file's if left out."),
]
ToleranceOption = Annotated[
    float | None, typer.Option(metavar="X", help="Largest relative error that is agreement; 1e-9 if left out.")
]


def run(
    robot: RobotArgument,
    inverse_dynamics: InverseOption = None,
    forward_dynamics: ForwardOption = None,
    mass_matrix: MassOption = None,
    regressor: RegressorOption = None,
    joint_names: JointsOption = None,
    samples: SamplesOption = 100,
    seed: SeedOption = 0,
    tolerance: ToleranceOption = None,
    lock: LockOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
) -> None:
    """Judge your own dynamics code, and say what is wrong with it.

    It is compared with graphdyn and Pinocchio at once.

    Functions are named as FILE.py:NAME or MODULE:NAME and called with one state at a time. Where one is wrong, the
    fault is looked for: gravity, velocity terms, a sign, an order, a frame, a unit, and more (docs/judge.md). MuJoCo
    takes part where it is installed.
    """
    given = {
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
        "regressor": regressor,
    }
    if not any(given.values()):
        options = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise typer.BadParameter(f"no function to judge; give at least one of {options}")
    functions = {
        name: foreign_function(f"--{name.replace('_', '-')}", text) for name, text in given.items() if text is not None
    }
    from crosscheck.judging.judge import judge
    from crosscheck.referee.tolerances import FOREIGN
    from crosscheck.report.commands.judge import judge_report

    with progress(robot) as advance, warnings_shown():
        judgement = judge(
            robot,
            **functions,  # type: ignore[arg-type]
            joint_names=None if joint_names is None else [name.strip() for name in joint_names.split(",")],
            samples=samples,
            seed=seed,
            tolerance=FOREIGN.bound if tolerance is None else tolerance,
            lock=locked_joints(lock) or None,
            progress=lambda what: advance(what, 1),
        )
    deliver(judge_report(judgement), html_file, json_file)
    raise typer.Exit(AGREED if judgement.agrees and judgement.decided else DISAGREED)
