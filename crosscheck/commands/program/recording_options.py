"""Options that say how recordings are read, the same in every command that reads some."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from shlex import join
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.program.console import Advance, say, warn
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.recordings import ColumnMapping, Recording
    from crosscheck.recordings.errors import RecordingFinding
    from crosscheck.recordings.preparation.derivatives import Cutoff


@dataclass(frozen=True, kw_only=True)
class ColumnOptions:
    """What the columns are, and how they are filtered."""

    PANEL: ClassVar[str] = "Reading the recordings"

    mapping: Annotated[
        Path | None, typer.Option(metavar="FILE", help="TOML file that describes the columns (docs/recordings.md).")
    ] = None
    drop: Annotated[
        list[str] | None,
        typer.Option(metavar="CODE", help="Drop the rows of a finding (docs/recordings.md). Repeatable."),
    ] = None
    cutoff: Annotated[
        str,
        typer.Option(
            metavar="HZ|CHANNEL=HZ,…|residual|none",
            help="Cutoff of the zero-phase low-pass filter of q, v and τ, or of each; the regressor is filtered "
            "like τ.",
        ),
    ] = "residual"

    @property
    def low_pass(self) -> Cutoff:
        """--cutoff. Raises typer.BadParameter."""
        from urdf.document import finite_number

        text = self.cutoff
        if text in ("none", "residual"):
            return None if text == "none" else "residual"
        pairs = [part.partition("=") for part in (text.split(",") if "=" in text else [f"={text}"])]
        names = [name.strip() for name, _, _ in pairs]
        values = [number for _, _, value in pairs if (number := finite_number(value.strip())) is not None]
        if len(values) < len(pairs):
            raise typer.BadParameter(f"--cutoff {text}: give Hz, CHANNEL=HZ,…, residual or none")
        if len(set(names)) < len(names):
            raise typer.BadParameter(f"--cutoff {text}: a channel is given twice; give each once")
        return dict(zip(names, values, strict=True)) if "=" in text else values[0]

    def recordings(
        self,
        option: str,
        logs: list[Path],
        joints: tuple[str, ...],
        advance: Advance,
        robot: Sequence[str],
        rate: float | None = None,
        *,
        torques: bool = True,
        currents: bool = False,
    ) -> list[Recording]:
        """The recordings of the files, as many files for each as the mapping names. Raises as load_recording.

        robot: arguments that name it and say how it is read, for the command that a refusal names
        torques: whether they are needed; currents: as for load_recording
        """
        from crosscheck.recordings import DROPPABLE, load_mapping, load_recording

        columns = load_mapping(self.mapping) if self.mapping is not None else None
        together = files_per_recording(columns)
        if len(logs) % together:
            raise typer.BadParameter(
                f"{option}: {counted(len(logs), 'file')}, but {self.mapping} makes each recording of {together}; "
                "give them in a row"
            )
        groups = [logs[k : k + together] for k in range(0, len(logs), together)]
        places = [tuple(sorted(str(path.resolve()) for path in group)) for group in groups]
        twice = next((group[0] for group, place in zip(groups, places, strict=True) if places.count(place) > 1), None)
        if twice is not None:
            raise typer.BadParameter(
                f"{option}: {twice} is given twice; rows that count twice look more certain than they are"
            )
        drop = self.drop or []
        codes = DROPPABLE if "all" in drop else drop
        recordings = []
        for group in groups:
            advance(group[0].name, 0)
            with naming_recording_command(logs, robot, self.mapping):
                recording = load_recording(group, columns, joints=joints, rate=rate, drop=codes, currents=currents)
                if torques and not currents:
                    _refuse_without_torques(recording)
                recordings.append(recording)
            advance(group[0].name, len(group))
        return recordings


@dataclass(frozen=True, kw_only=True)
class RecordingOptions(ColumnOptions):
    """The columns, and their rate."""

    PANEL: ClassVar[str] = "Reading the recordings"

    rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Samples per second, for files without a column of time.")
    ] = None


@contextmanager
def naming_recording_command(logs: Sequence[Path], robot: Sequence[str], mapping: Path | None) -> Iterator[None]:
    """Without a mapping, whatever is refused for want of one names the command that writes one.

    robot: arguments that name it and say how it is read
    """
    from crosscheck.recordings import AmbiguousColumns, BadMapping

    try:
        yield
    except (AmbiguousColumns, BadMapping) as error:
        if mapping is not None:
            raise
        together = logs if len(logs) <= MOST_FILES_OF_A_LOG else logs[:1]
        command = ["graphdyn", "recording", *map(str, together), *robot, "--write-mapping", "columns.toml"]
        raise BadMapping(f"{error}; `{join(command)}` shows what is recognized, and writes one") from error


def _refuse_without_torques(recording: Recording) -> None:
    """Raise BadMapping for a recording without torques, saying where it has currents."""
    from crosscheck.recordings import BadMapping

    if recording.tau is None:
        found = (finding.message for finding in recording.findings if finding.code == "current-without-gain")
        reason = next(found, "no columns are recognized as torques")
        raise BadMapping(f"{', '.join(recording.provenance.files)}: {reason}")


MOST_FILES_OF_A_LOG = 4
"""Number of files up to which those of a command may hold the columns of one log."""


def show_findings(findings: Iterable[RecordingFinding]) -> None:
    """What is odd in the files, one line each; all but notes is a warning."""
    for finding in findings:
        if finding.severity == "note":
            say(f"note: {finding.text}")
        else:
            warn(finding.text, severity=finding.severity)


def files_per_recording(mapping: ColumnMapping | None) -> int:
    """How many different files the columns of a mapping come from."""
    if mapping is None:
        return 1
    named = {channel.file for channel in mapping.channels.values()}
    named |= {mapping.time.file} if mapping.time is not None else set()
    return max(1, len(named))


def numbers(option: str, text: str, *, whole: bool = False) -> list[float]:
    """Numbers between commas. Raises typer.BadParameter."""
    from urdf.document import finite_number

    found = [finite_number(part.strip()) for part in text.split(",")]
    if not all(number is not None and (number.is_integer() or not whole) for number in found):
        raise typer.BadParameter(f"{option} {text}: give {'whole ' * whole}numbers with commas between them")
    return [number for number in found if number is not None]
