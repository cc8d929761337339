"""`graphdyn judge`: foreign functions against graphdyn, Pinocchio and MuJoCo."""

from __future__ import annotations

import typer

from crosscheck.cli.console import progress, warnings_shown
from crosscheck.cli.delivery import deliver
from crosscheck.cli.exits import AGREED, DISAGREED
from crosscheck.cli.foreign import foreign_function
from crosscheck.cli.judge_options import (
    FUNCTIONS_HELP,
    BatchedOption,
    BeyondLimitsOption,
    ConventionOption,
    ExternalWrenchesOption,
    ForwardOption,
    FrameOption,
    FunctionOption,
    GravityOption,
    InverseOption,
    JointsOption,
    MassOption,
    PrecisionOption,
    RegressorOption,
    ToleranceOption,
    pairs,
)
from crosscheck.cli.options import (
    EXAMPLES,
    ChainOption,
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
  graphdyn judge arm.urdf --function gravity_torque=my_code.py:g --function coriolis_matrix=my_code.py:C
  graphdyn judge ur5 --function frame_jacobian=my_code.py:J --frame tool0 --convention reference=local

{FUNCTIONS_HELP}
"""


def run(
    robot: RobotArgument,
    inverse_dynamics: InverseOption = None,
    forward_dynamics: ForwardOption = None,
    mass_matrix: MassOption = None,
    regressor: RegressorOption = None,
    function: FunctionOption = None,
    frame: FrameOption = None,
    convention: ConventionOption = None,
    external_wrenches: ExternalWrenchesOption = False,
    batched: BatchedOption = False,
    joint_names: JointsOption = None,
    samples: SamplesOption = 100,
    seed: SeedOption = 0,
    precision: PrecisionOption = "double",
    tolerance: ToleranceOption = None,
    beyond_limits: BeyondLimitsOption = False,
    lock: LockOption = None,
    chain: ChainOption = None,
    gravity: GravityOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
) -> None:
    """Judge your own dynamics code, and say what is wrong with it.

    It is compared with graphdyn and Pinocchio at once.

    Functions are named as FILE.py:NAME or MODULE:NAME and called with one state at a time. Where one is wrong, the
    fault is looked for: gravity, velocity terms, a sign, an order, a frame, a unit, and more (docs/judge.md). Where
    codes differ rightly, as in the reference of a Jacobian, it is found out and said which convention yours follows.
    MuJoCo takes part where it is installed.
    """
    given = {
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
        "regressor": regressor,
    }
    named = {name: (f"--{name.replace('_', '-')}", text) for name, text in given.items() if text is not None}
    for name, text in pairs("--function", function, "NAME=FILE.py:FUNCTION"):
        if name in named:
            raise typer.BadParameter(f"--function {name}={text}: {name} is given twice")
        named[name] = f"--function {name}", text
    if not named:
        options = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise typer.BadParameter(f"no function to judge; give at least one of {options}, --function")
    functions = {name: foreign_function(option, text) for name, (option, text) in named.items()}
    from crosscheck.judging.judge import judge
    from crosscheck.report.commands.judge import judge_report

    with progress(robot) as advance, warnings_shown():
        judgement = judge(
            robot,
            **functions,  # type: ignore[arg-type]
            frame=frame,
            conventions=dict(pairs("--convention", convention, "NAME=WAY")),
            external_wrenches=external_wrenches,
            batched=batched,
            joint_names=None if joint_names is None else [name.strip() for name in joint_names.split(",")],
            samples=samples,
            seed=seed,
            precision=precision,
            tolerance=tolerance,
            beyond_limits=beyond_limits,
            lock=locked_joints(lock) or None,
            chain=chain,
            gravity=gravity,
            progress=lambda what: advance(what, 1),
        )
    deliver(judge_report(judgement), html_file, json_file)
    raise typer.Exit(AGREED if judgement.agrees and judgement.decided else DISAGREED)
