"""Options of the commands that judge or ask functions, and the functions that can be judged in words."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from crosscheck.commands.program.options import RobotArgument, SamplesOption, SeedOption
from crosscheck.commands.program.reading_options import ReadingOptions, pairs

if TYPE_CHECKING:
    from crosscheck.judging.setting import Setting

FUNCTION_LIST = "FUNCTIONS AFTER THEIR ARGUMENTS"
"""Note in the epilog of a command: where its help lists the functions."""


def function_list() -> str:
    """The functions that can be judged, after their arguments; shapes and units are in docs/judge.md."""
    from crosscheck.quantities import FUNCTIONS  # a second, which only this help takes

    names: dict[str, list[str]] = {}
    for name, function in FUNCTIONS.items():
        names.setdefault(", ".join(function.arguments), []).append(name)
    width = max(map(len, names)) + 4
    lines = ["\b", "Functions, after their arguments:"]
    for arguments, functions in names.items():
        first, *rest = wrap(" ".join(functions), 95 - width)
        lines += [f"  {arguments:{width - 2}}{first}", *(f"{'':{width}}{line}" for line in rest)]
    return "\n".join(lines)


FUNCTION_FORM = "FILE.py:NAME"

CONVENTION_PANEL = "Conventions and precision"

JointsOption = Annotated[
    str | None,
    typer.Option(
        metavar="NAME,NAME,…",
        rich_help_panel=CONVENTION_PANEL,
        show_default="that of the file",
        help="Joint order of the functions.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class SettingOptions(ReadingOptions):
    """The robot, and the states at which functions are asked."""

    PANEL: ClassVar[str] = "States"

    robot: RobotArgument
    samples: SamplesOption = 100
    seed: SeedOption = 0
    beyond_limits: Annotated[
        bool, typer.Option("--beyond-limits", help="Add states outside the limits of position and velocity.")
    ] = False
    frame: Annotated[str | None, typer.Option(metavar="LINK", help="Frame of the functions that refer to one.")] = None
    external_wrenches: Annotated[
        bool,
        typer.Option(
            "--external-wrenches",
            help="Torques, accelerations and reactions take wrenches on the links (n, 6) as their last argument.",
        ),
    ] = False

    @property
    def setting(self) -> Setting:
        from crosscheck.judging.setting import Setting

        return Setting(
            robot=self.robot,
            reading=self.reading,
            samples=self.samples,
            seed=self.seed,
            beyond_limits=self.beyond_limits,
            frame=self.frame,
            external_wrenches=self.external_wrenches,
        )


@dataclass(frozen=True, kw_only=True)
class ConventionOptions:
    """The conventions of the functions, and their precision."""

    PANEL: ClassVar[str] = CONVENTION_PANEL

    convention: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=WAY",
            show_default="detected",
            help="A convention that the functions must follow, such as reference=local. Repeatable.",
        ),
    ] = None
    precision: Annotated[
        Literal["double", "single"],
        typer.Option(help='Precision of the functions; with "single", errors up to 1e-5 count as agreement.'),
    ] = "double"

    @property
    def conventions(self) -> dict[str, str]:
        return dict(pairs("--convention", self.convention, "NAME=WAY"))


def names(text: str | None) -> list[str] | None:
    """NAME,NAME,… as a list; None where the option is left out."""
    return None if text is None else [name.strip() for name in text.split(",")]
