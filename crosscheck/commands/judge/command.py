"""`graphdyn judge`: foreign functions against graphdyn, Pinocchio and MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import typer

from crosscheck.commands.judge.answers import AnswersOption, FurtherOption, warn_of_unused, write_further
from crosscheck.commands.judge.programs import (
    CommandOption,
    LibraryOption,
    ProtocolOption,
    RestartOption,
    TimeLimitOption,
    foreign_programs,
)
from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED, PENDING
from crosscheck.commands.program.functions import foreign_function
from crosscheck.commands.program.judged_functions import (
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
    names,
    pairs,
)
from crosscheck.commands.program.options import (
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
from crosscheck.commands.program.three_d import ThreeDOption, refuse_without_page, standing

EPILOG = f"""{EXAMPLES}  graphdyn judge ur5 --inverse-dynamics my_code.py:rnea
  graphdyn judge arm.urdf --forward-dynamics my_package.dynamics:aba --html verdict.html
  graphdyn judge arm.urdf --function gravity_torque=my_code.py:g --function coriolis_matrix=my_code.py:C
  graphdyn judge ur5 --function frame_jacobian=my_code.py:J --frame tool0 --convention reference=local
  graphdyn judge arm.urdf --command 'inverse_dynamics=./my_rnea --model arm'
  graphdyn judge arm.urdf --library inverse_dynamics=libarm.so:rnea
  graphdyn judge arm.urdf --answers answers.csv

{FUNCTIONS_HELP}
"""


def run(
    robot: RobotArgument,
    inverse_dynamics: InverseOption = None,
    forward_dynamics: ForwardOption = None,
    mass_matrix: MassOption = None,
    regressor: RegressorOption = None,
    function: FunctionOption = None,
    command: CommandOption = None,
    protocol: ProtocolOption = "plain",
    time_limit: TimeLimitOption = 30.0,
    restart_after: RestartOption = None,
    library: LibraryOption = None,
    answers: AnswersOption = None,
    further: FurtherOption = None,
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
    three_d: ThreeDOption = False,
) -> None:
    """Judge your own dynamics code, and say what is wrong with it.

    It is compared with graphdyn and Pinocchio at once.

    Functions in Python are named as FILE.py:NAME or MODULE:NAME and called with one state at a time; those in other
    languages by --command, --library or --answers (docs/languages.md). Where one is wrong, the fault is looked for:
    gravity, velocity terms, a sign, an order, a frame, a unit, and more (docs/judge.md). Where codes differ rightly, as
    in the reference of a Jacobian, it is found out and said which convention yours follows. MuJoCo takes part where it
    is installed.
    """
    refuse_without_page(three_d, html_file)
    given = {
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
        "regressor": regressor,
    }
    with foreign_programs(command, library, protocol, time_limit, restart_after) as programs:
        functions: dict[str, Any] = {**_in_python(given, function, programs, bool(answers)), **programs}
        from crosscheck.commands.judge.report import judge_report
        from crosscheck.judging.exchange.answer_files import read_answers
        from crosscheck.judging.exchange.replay import AnswersPending
        from crosscheck.judging.exchange.rounds import judge_answers
        from crosscheck.judging.setting import Setting
        from crosscheck.report.report import with_stage
        from urdf import Reading

        setting = Setting(
            robot=robot,
            joint_names=names(joint_names),
            samples=samples,
            seed=seed,
            beyond_limits=beyond_limits,
            reading=Reading(lock=locked_joints(lock) or None, chain=chain, gravity=gravity),
            frame=frame,
            external_wrenches=external_wrenches,
            conventions=dict(pairs("--convention", convention, "NAME=WAY")),
            batched=batched,
            precision=precision,
            tolerance=tolerance,
        )
        try:
            with progress(robot) as advance, warnings_shown():
                judgment, unused = judge_answers(
                    setting,
                    read_answers(answers or []),
                    functions,
                    lambda what: advance(what, 1),
                )
        except AnswersPending as pending:
            write_further(further, pending, setting, answers or [])
            raise typer.Exit(PENDING) from None
    if unused:
        warn_of_unused(unused)
    report = judge_report(judgment)
    if three_d:
        report = with_stage(report, [standing(robot, judgment.model, judgment.reading)])
    deliver(report, html_file, json_file)
    raise typer.Exit(AGREED if judgment.agrees and judgment.decided else DISAGREED)


def _in_python(
    given: Mapping[str, str | None], more: list[str] | None, programs: Mapping[str, object], answered: bool
) -> dict[str, Callable[..., Any]]:
    """given: texts of the options of their own, more: of --function, by the names of the functions
    answered: whether there are files of answers

    Raises typer.BadParameter where there is no function at all, or one is named twice.
    """
    options = {name: f"--{name.replace('_', '-')}" for name in given}
    named = {name: (options[name], text) for name, text in given.items() if text is not None}
    for name, text in pairs("--function", more, "NAME=FILE.py:FUNCTION"):
        if name in named:
            raise typer.BadParameter(f"--function {name}={text}: {name} is given twice")
        named[name] = f"--function {name}", text
    if not named and not programs and not answered:
        known = ", ".join([*options.values(), "--function", "--command", "--library"])
        raise typer.BadParameter(f"no function to judge; give at least one of {known}, --answers")
    for name in programs:
        if name in named:
            raise typer.BadParameter(f"{name} is named by {named[name][0]} and by --command or --library; name it once")
    return {name: foreign_function(option, text) for name, (option, text) in named.items()}
