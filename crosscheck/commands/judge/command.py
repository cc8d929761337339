"""`graphdyn judge`: functions under test against graphdyn, Pinocchio and MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from crosscheck.commands.judge.answers import AnswerOptions, warn_of_unused, write_further
from crosscheck.commands.judge.programs import ProgramOptions, user_programs
from crosscheck.commands.judge.time_limit import NoAnswerInTime, limited
from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import figure_at_rest
from crosscheck.commands.program.exits import PENDING
from crosscheck.commands.program.finding_options import FindingOptions, deliver_findings
from crosscheck.commands.program.functions import place_of, user_function
from crosscheck.commands.program.judged_functions import (
    FUNCTION_FORM,
    FUNCTION_LIST,
    ConventionOptions,
    JointsOption,
    SettingOptions,
    names,
)
from crosscheck.commands.program.options import EXAMPLES, PageOptions
from crosscheck.commands.program.reading_options import pairs

if TYPE_CHECKING:
    from crosscheck.judging.exchange.program import ProgramFunction
    from crosscheck.judging.setting import Setting
    from crosscheck.quantities.tested_function import TestedFunction
    from crosscheck.viewing.figures import Figure

EPILOG = f"""{EXAMPLES}  graphdyn judge ur5 --inverse-dynamics my_code.py:rnea
  graphdyn judge arm.urdf --forward-dynamics my_package.dynamics:aba --html verdict.html
  graphdyn judge arm.urdf --function gravity_torque=my_code.py:g --function coriolis_matrix=my_code.py:C
  graphdyn judge ur5 --function frame_jacobian=my_code.py:J --frame tool0 --convention reference=local
  graphdyn judge arm.urdf --command 'inverse_dynamics=./my_rnea --model arm'
  graphdyn judge arm.urdf --library inverse_dynamics=libarm.so:rnea
  graphdyn judge arm.urdf --answers answers.csv
  graphdyn judge arm.urdf --inverse-dynamics my_code.py:rnea --exact

{FUNCTION_LIST}
"""


NAMED_FUNCTIONS = ("inverse_dynamics", "forward_dynamics", "mass_matrix", "joint_torque_regressor")
"""Functions that have an option of their own."""


@dataclass(frozen=True, kw_only=True)
class JudgeOptions(ProgramOptions, AnswerOptions, ConventionOptions, SettingOptions, FindingOptions, PageOptions):
    """What `graphdyn judge` is asked for."""

    inverse_dynamics: Annotated[
        str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → τ, arrays of shape (n,).")
    ] = None
    forward_dynamics: Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, τ) → a.")] = None
    mass_matrix: Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="q → M, shape (n, n).")] = None
    joint_torque_regressor: Annotated[
        str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → W, shape (n, 10n).")
    ] = None
    function: Annotated[
        list[str] | None,
        typer.Option(metavar=f"NAME={FUNCTION_FORM}", help="Any function of the list below, by its name. Repeatable."),
    ] = None
    joint_names: JointsOption = None
    batched: Annotated[
        bool,
        typer.Option(
            "--batched",
            rich_help_panel=ConventionOptions.PANEL,
            help="The functions take all states at once, arrays (N, n).",
        ),
    ] = False
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            rich_help_panel=ConventionOptions.PANEL,
            show_default="by --precision",
            help="Relative error that counts as agreement.",
        ),
    ] = None

    exact: Annotated[
        bool,
        typer.Option(
            "--exact",
            rich_help_panel=ConventionOptions.PANEL,
            help="Exact values at all states decide, in place of the bound: what is off by more than rounding explains "
            "is wrong, by proof. Extra 'exact'.",
        ),
    ] = False

    @property
    def setting(self) -> Setting:
        return replace(
            super().setting,
            joint_names=names(self.joint_names),
            conventions=self.conventions,
            batched=self.batched,
            precision=self.precision,
            tolerance=self.tolerance,
            exact=self.exact,
        )

    def functions(
        self, programs: Mapping[str, ProgramFunction]
    ) -> tuple[dict[str, TestedFunction], dict[str, tuple[str, int]]]:
        """The functions in Python, and those of programs; files and lines where the former are defined.

        Raises typer.BadParameter for none, and one named twice.
        """
        options = {name: f"--{name.replace('_', '-')}" for name in NAMED_FUNCTIONS}
        given = {name: getattr(self, name) for name in NAMED_FUNCTIONS}
        named: dict[str, tuple[str, str]] = {
            name: (options[name], text) for name, text in given.items() if text is not None
        }
        for name, text in pairs("--function", self.function, "NAME=FILE.py:FUNCTION"):
            if name in named:
                raise typer.BadParameter(f"--function {name}={text}: {name} is given twice")
            named[name] = f"--function {name}", text
        if not named and not programs and not self.answers:
            known = ", ".join([*options.values(), "--function", "--command", "--library"])
            raise typer.BadParameter(f"no function to judge; give at least one of {known}, --answers")
        for name in programs:
            if name in named:
                option = named[name][0]
                raise typer.BadParameter(f"{name} is named by {option} and by --command or --library; name it once")
        in_python = {name: user_function(option, text) for name, (option, text) in named.items()}
        found: dict[str, Any] = {
            name: limited(function, " ".join(named[name]), self.time_limit) for name, function in in_python.items()
        }
        places = {name: place for name, function in in_python.items() if (place := place_of(function)) is not None}
        return found | dict(programs), places


def run(options: JudgeOptions) -> None:
    """Judge your own dynamics code, and say what is wrong with it.

    It is compared with graphdyn and Pinocchio at once.

    Functions in Python are named as FILE.py:NAME or MODULE:NAME and called with one state at a time; those in other
    languages by --command, --library or --answers (docs/languages.md). Where one is wrong, the fault is looked for:
    gravity, velocity terms, a sign, an order, a frame, a unit, and more (docs/judge.md). Where several conventions are
    valid, such as the reference frame of a Jacobian, the one your code follows is detected and reported. MuJoCo takes
    part where it is installed.
    """
    robot, answers, setting = options.robot, options.answers or [], options.setting
    accepted = options.accepted("judge")
    with user_programs(options) as programs:
        functions, places = options.functions(programs)
        from crosscheck.commands.judge.checks import judge_checks
        from crosscheck.commands.judge.report import judge_report
        from crosscheck.judging.exchange.answer_files import read_answers
        from crosscheck.judging.exchange.rounds import AnswersPending, judge_answers

        try:
            with progress(robot) as advance, warnings_shown():
                judgment, unused = judge_answers(
                    setting, read_answers(answers), functions, lambda what: advance(what, 1)
                )
        except NoAnswerInTime as late:
            raise late.ended() from None
        except AnswersPending as pending:
            write_further(options.further, pending, setting, answers)
            raise typer.Exit(PENDING) from None
    if unused:
        warn_of_unused(unused)
    checks = judge_checks(judgment, places)

    def figures() -> list[Figure]:
        return [figure_at_rest(robot, judgment.model, judgment.reading)]

    raise typer.Exit(deliver_findings("judge", checks, judge_report(judgment), options, accepted, figures))
