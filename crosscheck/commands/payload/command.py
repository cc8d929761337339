"""`graphdyn payload`: a load, and the gains of the motors, from recordings without and with it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.identify.currents_option import files_of, gains_of, write_gains
from crosscheck.commands.identify.models import DEFAULT_TERMS
from crosscheck.commands.identify.options import PreparationOptions
from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, RobotOption
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions, reading_arguments
from crosscheck.commands.program.recording_options import numbers, show_findings
from crosscheck.commands.program.settings import refuse

if TYPE_CHECKING:
    from crosscheck.identifying import IdentifiedPayload
    from graphdyn.identification.currents import KnownLoad, TrustedGravity

EPILOG = f"""{EXAMPLES}  graphdyn payload empty.csv gripper.csv --robot arm.urdf --gains 11.2 --gains-error 0.03
  graphdyn payload empty.csv weight.csv --robot arm.urdf --mass 4 --write-gains gains.toml
  graphdyn payload empty2.csv gripper.csv --robot arm.urdf --gains gains.toml
  graphdyn payload empty.csv gripper.csv --robot arm.urdf --calibration weight.csv --mass 4
"""


@dataclass(frozen=True, kw_only=True)
class KnownOptions:
    """What gives torques their size; by default they are right as recorded, to 5 %."""

    PANEL: ClassVar[str] = "What is known (by default torques as recorded, right to 5 %)"

    mass: Annotated[
        float | None,
        typer.Option(metavar="KG", help="Mass of the load of LOADED, or of --calibration; it gives the gains."),
    ] = None
    center: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Its center of mass, in the frame of the link [m].")
    ] = None
    calibration: Annotated[
        Path | None, typer.Option(metavar="LOG", help="Recording with the load of --mass; that of LOADED is unknown.")
    ] = None
    gains: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|K,K,…",
            help="Torque per unit of the recorded column: a file that --write-gains wrote, one number, or one per "
            "joint.",
        ),
    ] = None
    gains_error: Annotated[
        float | None,
        typer.Option(metavar="X", show_default="0.05", help="Relative standard deviation of the numbers of --gains."),
    ] = None
    trust: Annotated[
        float | None,
        typer.Option(metavar="X", help="Trust masses and centers of the URDF up to this relative error of each link."),
    ] = None

    @property
    def known_load(self) -> KnownLoad | None:
        """Raises typer.BadParameter for a center of another form, or without a mass."""
        from graphdyn.identification.currents import KnownLoad

        if self.mass is None:
            for option, value in (("--center", self.center), ("--calibration", self.calibration)):
                if value is not None:
                    raise typer.BadParameter(f"{option} {value}: say with --mass how heavy this load is")
            return None
        if self.center is None:
            return KnownLoad(self.mass)
        place = numbers("--center", self.center)
        if len(place) != 3:
            raise typer.BadParameter(f"--center {self.center}: give three numbers, X,Y,Z [m]")
        return KnownLoad(self.mass, (place[0], place[1], place[2]))

    @property
    def trusted_gravity(self) -> TrustedGravity | None:
        from graphdyn.identification.currents import TrustedGravity

        return None if self.trust is None else TrustedGravity(self.trust)


@dataclass(frozen=True, kw_only=True)
class PayloadOptions(KnownOptions, PreparationOptions, ReadingOptions, ReportOptions):
    """What `graphdyn payload` is asked for."""

    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="EMPTY LOADED",
            help="A recording without the load and one with it, as for `graphdyn identify`; torques may be currents.",
        ),
    ]
    robot: RobotOption
    payload_on: Annotated[
        str | None, typer.Option(metavar="LINK", show_default="the last", help="Link that carries the load.")
    ] = None
    terms: Annotated[
        str, typer.Option(metavar="NAME,…", help="Friction, as for `graphdyn identify`; each recording has its own.")
    ] = DEFAULT_TERMS
    write_gains: Annotated[
        OutputFile | None,
        typer.Option(
            metavar="FILE", parser=OutputFile.mapping, help="Write the gains, for --gains of other recordings."
        ),
    ] = None


def run(options: PayloadOptions) -> None:
    """Find a load, or gains of motors, from two recordings.

    The torques may be currents, or any other signal that is proportional to the torque of its joint: gains, links,
    friction and load are fitted together, with the errors on the side of the currents. The URDF gives the geometry; the
    masses of its links are not used, unless --trust says so. Currents alone determine no gain, because gains, links and
    loads scale together. One of them must be known: --mass is a load that gives gains; --gains and --trust give the
    load. Standard deviations come from time blocks, and contain those of what is known.

    Exit code 0: the load, or with --mass gains, are determined; 1: they are not, and why; 2: bad input.
    """
    import urdf
    from crosscheck.commands.payload.report import payload_report

    found = _found(options, urdf.load(options.robot, reading=options.reading).independent_joints)
    deliver(payload_report(found), options)
    write_gains(options.write_gains, found)
    raise typer.Exit(DISAGREED if found.rejection_reasons else AGREED)


def _found(options: PayloadOptions, joints: tuple[str, ...]) -> IdentifiedPayload:
    """The recordings read and fitted."""
    from crosscheck.identifying import friction_terms, identify_payload

    if options.gains is None:
        refuse(options, ("gains_error",), "is the error of --gains; give them too")
    known_load = options.known_load
    names = [] if options.terms == "none" else [name.strip() for name in options.terms.split(",")]
    named = ("--robot", options.robot, *reading_arguments(options))
    extra = [] if options.calibration is None else [options.calibration]
    with warnings_shown(), progress("read", len(options.logs) + len(extra)) as advance:
        recordings = options.recordings(
            "EMPTY LOADED", options.logs, joints, advance, named, options.rate, currents=True
        )
        known = options.recordings("--calibration", extra, joints, advance, named, options.rate, currents=True)
        if len(recordings) != 2:
            raise typer.BadParameter(f"EMPTY LOADED: {len(recordings)} recordings are given; give two")
        show_findings(finding for recording in [*recordings, *known] for finding in recording.findings)
        files = files_of([*recordings, *known])
        gains = gains_of("--gains", options.gains, options.gains_error, joints, files)
        return identify_payload(
            options.robot,
            recordings[0],
            recordings[1],
            known_load=known_load,
            calibration=known[0] if known else None,
            gains=gains,
            trusted=options.trusted_gravity,
            link=options.payload_on,
            terms=friction_terms(names),
            preparation=options.preparation,
            reading=options.reading,
        )
