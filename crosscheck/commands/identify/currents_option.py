"""Recordings of motor currents: what is known of their gains, as it is typed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.program.console import warn
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.recording_options import numbers
from crosscheck.commands.program.settings import refuse
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.identifying import FittedCurrents, Preparation
    from crosscheck.recordings import Recording
    from graphdyn.identification.currents import JointGains, KnownLoad
    from graphdyn.identification.terms import Term
    from urdf import Reading

CAD, LOAD, GAINS = "cad", "payload=", "gains"
"""Forms of what is known."""


@dataclass(frozen=True, kw_only=True)
class CurrentsOptions:
    """What is known of the gains of recorded currents."""

    PANEL: ClassVar[str] = "Motor currents"

    currents: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE|K,K,…|cad|payload=M[@X,Y,Z]:LOADED",
            help="The LOGs hold currents. Their gains come from a .toml file of gains, from numbers (torque per unit), "
            "from the gravity of the links of the URDF, or from LOADED, a recording of the arm with M kg on its last "
            "link. Repeatable.",
        ),
    ] = None
    currents_error: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            show_default="0.05",
            help="Relative standard deviation of the numbers of --currents, or of each link with cad.",
        ),
    ] = None
    write_gains: Annotated[
        OutputFile | None,
        typer.Option(metavar="FILE", parser=OutputFile.mapping, help="Write the gains, for other recordings."),
    ] = None

    def check_currents(self) -> None:
        """Raises typer.BadParameter for options that need --currents, or a text of another form."""
        if not self.currents:
            refuse(self, ("currents_error", "write_gains"), "is for --currents; give it too")
        if self.currents_error is not None and not 0 < self.currents_error < 1:
            raise typer.BadParameter(
                f"--currents-error {self.currents_error:g}: give a relative deviation between 0 and 1, such as 0.05"
            )
        sources = [_kind(text) for text in self.currents or ()]
        twice = next((text for k, text in enumerate(self.currents or ()) if sources.index(sources[k]) < k), None)
        if twice is not None:
            raise typer.BadParameter(f"--currents {twice}: there are two of this kind; give one")

    @property
    def loaded(self) -> tuple[KnownLoad, Path] | None:
        """The known load, and the recording with it; None without one. Raises typer.BadParameter, InvalidInput."""
        from graphdyn.identification.currents import KnownLoad
        from urdf.document import finite_number

        text = next((text for text in self.currents or () if _kind(text) == LOAD), None)
        if text is None:
            return None
        load, colon, path = text.removeprefix(LOAD).partition(":")
        mass, at, place = load.partition("@")
        kilograms, center = finite_number(mass), numbers("--currents", place) if at else []
        if not colon or not path or kilograms is None or len(center) not in (0, 3):
            raise typer.BadParameter(f"--currents {text}: give payload=M:LOADED or payload=M@X,Y,Z:LOADED [kg, m]")
        return KnownLoad(kilograms, (center[0], center[1], center[2]) if center else None), Path(path)

    def gains(
        self,
        robot: str,
        recordings: Sequence[Recording],
        loaded: Sequence[Recording],
        *,
        terms: Sequence[Term],
        preparation: Preparation,
        reading: Reading,
    ) -> FittedCurrents:
        """The gains, which go to --write-gains too. Raises as gains_of and identify_gains.

        loaded: the recording with the known load, if there is one
        """
        from crosscheck.identifying import STATED_ERROR, identify_gains
        from graphdyn.identification.currents import TrustedGravity

        texts = {_kind(text): text for text in self.currents or ()}
        error = STATED_ERROR if self.currents_error is None else self.currents_error
        stated, is_file = texts.get(GAINS), texts.get(GAINS, "").endswith(".toml")
        found = identify_gains(
            robot,
            recordings,
            TrustedGravity(error) if CAD in texts else None,
            gains=gains_of(
                "--currents", stated, None if is_file else error, recordings[0].joint_names, files_of(recordings)
            ),
            known_load=self.loaded[0] if self.loaded else None,
            loaded=loaded[0] if loaded else None,
            terms=terms,
            preparation=preparation,
            reading=reading,
        )
        write_gains(self.write_gains, found)
        return found


def _kind(text: str) -> str:
    """Which of the forms a text has. Raises typer.BadParameter for none."""
    from urdf.document import finite_number

    if text == CAD:
        return CAD
    if text.startswith(LOAD):
        return LOAD
    if text.endswith(".toml") or all(finite_number(part.strip()) is not None for part in text.split(",")):
        return GAINS
    raise typer.BadParameter(
        f"--currents {text}: give cad, payload=M:LOADED, payload=M@X,Y,Z:LOADED, a .toml file of gains, or numbers"
    )


def write_gains(file: OutputFile | None, found: FittedCurrents) -> None:
    """The file of --write-gains, if it is wanted."""
    from crosscheck.identifying import gains_document

    if file is not None:
        source = f"{found.known}; {', '.join(found.names)}"
        file.write(gains_document(found.gains, found.joints, source, files_of(found.recordings)))


def files_of(recordings: Sequence[Recording]) -> list[str]:
    """Names of the files of recordings, without their folders."""
    return [Path(name).name for recording in recordings for name in recording.provenance.files]


def gains_of(
    option: str, text: str | None, error: float | None, joints: Sequence[str], files: Sequence[str]
) -> JointGains | None:
    """Gains of these joints. Raises typer.BadParameter for a text of another form; InvalidInput as load_gains.

    error: relative standard deviation of numbers
    files: names of the recordings that the gains are for; there is a warning if one of them gave the gains
    """
    import numpy as np

    from crosscheck.identifying import STATED_ERROR, load_gains
    from crosscheck.identifying.payload.gains_file import recordings_of_gains
    from graphdyn.identification.currents import JointGains

    if text is None:
        return None
    if text.endswith(".toml"):
        if error is not None:
            raise typer.BadParameter(f"{option} {text}: the file has deviations of its own; leave out {option}-error")
        found = load_gains(Path(text), joints)
        twice = [name for name in recordings_of_gains(Path(text)) if name in files]
        if twice:
            warn(
                f"{text}: a recording called {twice[0]} gave these gains; if it is the same, its errors count twice "
                "and deviations are too small: take another one, or find the gains in the same fit"
            )
        return found
    values = numbers(option, text)
    if len(values) not in (1, len(joints)) or not all(value > 0 for value in values):
        raise typer.BadParameter(
            f"{option} {text}: give a .toml file, one number above zero, or one for each of "
            f"{counted(len(joints), 'joint')}: {', '.join(joints)}"
        )
    relative = STATED_ERROR if error is None else error
    if not 0 < relative < 1:
        raise typer.BadParameter(
            f"{option}-error {relative:g}: give a relative deviation between 0 and 1, such as 0.05"
        )
    return JointGains.stated(np.array(values) * np.ones(len(joints)), relative)
