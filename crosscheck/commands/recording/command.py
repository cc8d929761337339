"""`graphdyn recording`: what the columns of a log are, and a mapping for the other commands."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from shlex import join
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, RobotOption, command_line
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions, reading_arguments
from crosscheck.commands.program.recording_options import numbers

if TYPE_CHECKING:
    from crosscheck.recordings import Untold

EPILOG = f"""{EXAMPLES}  graphdyn recording log.csv --robot ur5 --write-mapping columns.toml
  graphdyn recording bag/ --robot arm.urdf --html columns.html
  graphdyn recording rtde.csv --robot ur10 --gain 13.3,13.3,9.4,9.5,9.5,9.5 --write-mapping columns.toml
  graphdyn recording pos.csv cur.csv --robot arm.urdf --rate 1000 --ratio 100,100,-80 --write-mapping columns.toml
"""

MAPPING_NAME = "columns.toml"
"""Name of the mapping in the commands that are printed, where none was given."""


@dataclass(frozen=True, kw_only=True)
class UntoldOptions:
    """What a log does not tell."""

    PANEL: ClassVar[str] = "What the log does not tell"

    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Samples per second, where no column tells.")] = None
    ratio: Annotated[
        str | None,
        typer.Option(metavar="R,R,…", help="Ratios of the gears, one per joint: positions or torques of the motors."),
    ] = None
    gain: Annotated[
        str | None, typer.Option(metavar="G,G,…", help="Gains of currents or other units, one per joint [N m/…].")
    ] = None
    unit: Annotated[
        list[str] | None,
        typer.Option(metavar="QUANTITY=UNIT", help="Unit of time, q, v or tau, such as q=deg. Repeatable."),
    ] = None
    take: Annotated[
        list[str] | None,
        typer.Option(metavar="QUANTITY=COLUMNS", help="Which of several to take, such as 'q=q_enc_*'. Repeatable."),
    ] = None
    topic: Annotated[str | None, typer.Option(metavar="NAME", help="Topic of a bag with several.")] = None

    @property
    def untold(self) -> Untold:
        """Raises typer.BadParameter for texts of another form."""
        from crosscheck.recordings import Untold

        if self.rate is not None and not self.rate > 0:
            raise typer.BadParameter(f"--rate {self.rate:g}: give Hz above zero")
        return Untold(
            self.rate,
            () if self.ratio is None else tuple(numbers("--ratio", self.ratio)),
            () if self.gain is None else tuple(numbers("--gain", self.gain)),
            dict(_pair("--unit", text) for text in self.unit or ()),
            dict(_pair("--take", text) for text in self.take or ()),
        )


@dataclass(frozen=True, kw_only=True)
class RecognitionOptions(UntoldOptions, ReadingOptions, ReportOptions):
    """What `graphdyn recording` is asked for."""

    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG...", help="The file of one log, or files with columns of the same rows."),
    ]
    robot: RobotOption
    write_mapping: Annotated[
        OutputFile | None,
        typer.Option(
            metavar="FILE",
            parser=OutputFile.mapping,
            help="Write the mapping; what is left to be said is in it as comments.",
        ),
    ] = None


def run(options: RecognitionOptions) -> None:
    """Recognize the columns of a log, and write their mapping.

    Time, positions, velocities, torques or currents, temperatures. Names tell first: of joints, quantities, units,
    sides of the gears. Then the numbers: a clock increases by equal steps, the sum of a velocity is the change of
    its position, positions keep the limits of the robot, and torques are those that its motion needs. Columns
    without names are recognized by the numbers alone. Where one reading is possible, it is taken, and said; where
    several are, they are listed with the options that choose.

    Exit code 0: the mapping is complete; 1: something is left to be said; 2: bad input.
    """
    import urdf
    from crosscheck.commands.recording.report import recording_report
    from crosscheck.recordings import recognize

    untold = options.untold
    model = urdf.load(options.robot, reading=options.reading)
    found = recognize(options.logs, model, untold, topic=options.topic)
    name = options.write_mapping.name if options.write_mapping else MAPPING_NAME
    following = ["graphdyn", "identify", *found.files, "--robot", options.robot, "--mapping", name]
    lines = [join([*following, *reading_arguments(options)])]
    if options.write_mapping is None:
        lines.insert(0, join([*command_line(), "--write-mapping", name]))
    deliver(recording_report(found, "\n".join(lines)), options)
    if options.write_mapping is not None:
        options.write_mapping.write(found.mapping.encode())
    raise typer.Exit(AGREED if found.complete else DISAGREED)


QUANTITIES = ("time", "q", "v", "tau")


def _pair(option: str, text: str) -> tuple[str, str]:
    quantity, equals, value = text.partition("=")
    if quantity not in QUANTITIES or not equals or not value:
        raise typer.BadParameter(f"{option} {text}: give QUANTITY=…, with one of {', '.join(QUANTITIES)}")
    return quantity, value
