"""Options of `graphdyn identify`, and what their texts mean."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from crosscheck.commands.program.options import robot_names
from crosscheck.commands.program.output_files import OutputFile

if TYPE_CHECKING:
    from crosscheck.identifying import HeldOut
    from crosscheck.recordings import ColumnMapping, Recording
    from crosscheck.recordings.preparation.derivatives import Cutoff

FUNCTION_FORM = "FILE.py:NAME"

LogsArgument = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="[LOG]...",
        help="Recordings: CSV, Parquet, .npz, .mat, ROS bags. With a mapping that names several files, as many LOGs in "
        "a row are one recording. Without any, the robot is simulated.",
    ),
]
RobotOption = Annotated[
    str | None,
    typer.Option("--robot", metavar="ROBOT", help="Name or URDF file; its inertials are the CAD values.",
                 autocompletion=robot_names),
]  # fmt: skip
MappingOption = Annotated[Path | None, typer.Option(metavar="FILE", help="TOML file that says what the columns are.")]
RateOption = Annotated[float | None, typer.Option(metavar="HZ", help="Samples per second, where no column has time.")]
DropOption = Annotated[
    list[str] | None, typer.Option(metavar="CODE", help="Drop the rows of a finding (docs/recordings.md). Repeatable.")
]
CutoffOption = Annotated[
    str,
    typer.Option(
        metavar="HZ|CHANNEL=HZ,…|residual|none",
        help="Zero-phase low-pass of q, v and τ, or of these; the regressor is filtered like τ.",
    ),
]
DerivedOption = Annotated[bool, typer.Option("--derive-velocity", help="Differentiate q even where v was recorded.")]
DecimateOption = Annotated[
    str | None, typer.Option(metavar="K,K,…", help="Lower the rate in these stages, torque and regressor alike.")
]
MinSpeedOption = Annotated[
    str, typer.Option(metavar="X|X,X,…", help="Rows of a joint slower than this are not fitted [rad/s or m/s].")
]
TermsOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME,…",
        help="What the drives add: viscous, coulomb, stribeck, load, smooth-coulomb, offset, rotor, "
        "asymmetric-viscous, asymmetric-coulomb, coupled-wrist, slip, spring; NAME*time and NAME*temperature for what "
        "drifts; none. Repeatable: torque models to compare. viscous,coulomb,offset if left out.",
    ),
]
ModelsOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="TOML file of torque models to compare (docs/identification.md), for --terms."),
]
WidthOption = Annotated[
    str | None,
    typer.Option(metavar="X|X,X,…", help="tanh(v/X) in place of the sign of v in friction [rad/s or m/s]."),
]
StribeckOption = Annotated[
    str | None,
    typer.Option(metavar="X|X,X,…", help="Speed at which Stribeck friction fades [rad/s or m/s], 0.1 if left out."),
]
StribeckExponentOption = Annotated[
    str | None, typer.Option(metavar="X|X,X,…", help="How Stribeck friction fades: exp(-|v / V|^X), 2 if left out.")
]
TermOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar=FUNCTION_FORM, help="A further term: a function without arguments that returns one. Repeatable."
    ),
]
KnownTorqueOption = Annotated[
    list[str] | None,
    typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → known torque (N, n), subtracted. Repeatable."),
]
ScaledTorqueOption = Annotated[
    list[str] | None,
    typer.Option(metavar=FUNCTION_FORM, help="The same, with an unknown factor: springs, counterbalances. Repeatable."),
]
KnownBodiesOption = Annotated[
    bool, typer.Option("--known-bodies", help="Take the links as in the URDF; identify drives and payload only.")
]
PayloadOption = Annotated[
    str | None,
    typer.Option(
        metavar="unknown|unknown@X,Y,Z|M@X,Y,Z",
        help="Load on the last link: ten unknowns, its mass alone with a known center, or a known point mass.",
    ),
]
PayloadLinkOption = Annotated[str | None, typer.Option(metavar="LINK", help="Link that carries the payload.")]
MethodsOption = Annotated[
    str | None,
    typer.Option(
        metavar="NAME,…|all",
        help="ols, wls, wls-pinocchio, gls, huber, tukey, ridge, essential, consistent, entropic, pullback, "
        "consistent-huber, entropic-huber, pullback-huber, log-cholesky, graph, tls, ml, iv, didim, cloe, clie, or "
        f"{FUNCTION_FORM} of your own. Without it: one of each kind.",
    ),
]
ValidateOption = Annotated[
    list[Path] | None, typer.Option(metavar="LOG", help="Predict this recording; it is not fitted. Repeatable.")
]
SplitOption = Annotated[
    tuple[str, str] | None,
    typer.Option(metavar="FIT PREDICT", help="Seconds of one recording, as 0:6 6:9."),
]
SplitRowsOption = Annotated[
    tuple[str, str] | None, typer.Option(metavar="FIT PREDICT", help="Rows of one recording, as 60:1700 1750:2400.")
]
FoldsOption = Annotated[
    int | None,
    typer.Option(
        min=2,
        metavar="N",
        help="Fit everything; predict each of N consecutive pieces from the others. Beside --validate or a split the "
        "pieces choose, and the other rows are a test.",
    ),
]
ChooseOption = Annotated[
    str | None, typer.Option(metavar="METHOD", help="Show and write this result instead of the recommended one.")
]
GravityOption = Annotated[
    tuple[float, float, float] | None, typer.Option(metavar="X Y Z", help="Gravity in world axes [m/s²].")
]
UrdfOption = Annotated[
    OutputFile | None,
    typer.Option("--urdf", metavar="OUT", parser=OutputFile.robot, help="Write the robot with new inertials."),
]
PosesOption = Annotated[int, typer.Option(min=1, metavar="N", help="Random poses to test the mass matrix in.")]
SecondsOption = Annotated[
    float | None, typer.Option(metavar="S", help="Length of the simulated recording [s], 20 if left out.")
]
SimulationSeedOption = Annotated[
    int | None, typer.Option("--seed", min=0, metavar="N", help="Seed of the simulated recording, 0 if left out.")
]


def cutoff_of(text: str) -> Cutoff:
    """--cutoff. Raises typer.BadParameter."""
    if text in ("none", "residual"):
        return None if text == "none" else "residual"
    try:
        if "=" not in text:
            return float(text)
        parts = [part.partition("=") for part in text.split(",")]
        cutoffs = {name.strip(): float(value) for name, _, value in parts}
        if len(cutoffs) < len(parts):
            raise typer.BadParameter(f"--cutoff {text}: a channel is given twice; give each once")
        return cutoffs
    except ValueError:
        raise typer.BadParameter(f"--cutoff {text}: give Hz, CHANNEL=HZ,…, residual or none") from None


def numbers(option: str, text: str) -> list[float]:
    """Numbers between commas. Raises typer.BadParameter."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{option} {text}: give numbers with commas between them") from None


def stages(text: str | None) -> tuple[int, ...]:
    """--decimate. Raises typer.BadParameter."""
    if text is None:
        return ()
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"--decimate {text}: give whole numbers with commas between them") from None


def interval(option: str, text: str) -> tuple[float, float]:
    """FIRST:LAST; either may be left out. Raises typer.BadParameter."""
    first, colon, last = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(first or 0), float(last or "inf")
    except ValueError:
        raise typer.BadParameter(f"{option} {text}: give FIRST:LAST, such as 0:6") from None


def held_out_of(
    validate: list[Recording] | None, split: tuple[str, str] | None, rows: tuple[str, str] | None, folds: int | None
) -> HeldOut | None:
    """The one that is given; with folds beside it, these choose. Raises typer.BadParameter for several."""
    from crosscheck.identifying import ByRows, ByTime, Folds, OtherRecordings

    given = {"--validate": validate, "--split": split, "--split-rows": rows}
    named = [option for option, value in given.items() if value]
    if len(named) > 1:
        raise typer.BadParameter(f"{' and '.join(named)} exclude each other; choose one way to keep rows aside")
    aside: HeldOut | None = None
    if split:
        aside = ByTime(*(interval("--split", text) for text in split))
    if rows:
        aside = ByRows(*(interval("--split-rows", text) for text in rows))
    if validate:
        aside = OtherRecordings(tuple(validate))
    return Folds(folds, aside) if folds else aside


def refuse_without_log(**given: object) -> None:
    """Raises typer.BadParameter for an option that only a recording gives a meaning."""
    for name, value in given.items():
        if value:
            raise typer.BadParameter(f"--{name.replace('_', '-')} needs a LOG; without one the robot is simulated")


def refuse_with_log(**given: object) -> None:
    """Raises typer.BadParameter for an option of the simulation."""
    for name, value in given.items():
        if value is not None:
            raise typer.BadParameter(f"--{name} is for the simulated robot; leave it out with a LOG")


def recordings(
    option: str,
    logs: list[Path],
    mapping: Path | None,
    joints: tuple[str, ...],
    rate: float | None,
    drop: list[str],
    advance: Callable[[str, int], None],
) -> list[Recording]:
    """The recordings of the files, as many files for each as the mapping names. Raises as crosscheck.load_recording."""
    from crosscheck.recordings import DROPPABLE, load_mapping, load_recording

    columns = load_mapping(mapping) if mapping is not None else None
    together = files_per_recording(columns)
    if len(logs) % together:
        raise typer.BadParameter(
            f"{option}: {len(logs)} files, but {mapping} makes each recording of {together}; give them in a row"
        )
    groups = [logs[k : k + together] for k in range(0, len(logs), together)]
    places = [tuple(sorted(str(path.resolve()) for path in group)) for group in groups]
    twice = next((group[0] for group, place in zip(groups, places, strict=True) if places.count(place) > 1), None)
    if twice is not None:
        raise typer.BadParameter(
            f"{option}: {twice} is given twice; rows that count twice look more certain than they are"
        )
    codes = DROPPABLE if "all" in drop else drop
    recordings = []
    for group in groups:
        advance(group[0].name, 0)
        recordings.append(load_recording(group, columns, joints=joints, rate=rate, drop=codes))
        advance(group[0].name, len(group))
    return recordings


def files_per_recording(mapping: ColumnMapping | None) -> int:
    """How many different files the columns of a mapping come from."""
    if mapping is None:
        return 1
    named = {channel.file for channel in mapping.channels.values()}
    named |= {mapping.time.file} if mapping.time is not None else set()
    return max(1, len(named))


def refuse_beside_models(**given: object) -> None:
    """Raises typer.BadParameter for an option that the file of --models has a place for."""
    for name, value in given.items():
        if value is not None:
            raise typer.BadParameter(
                f"--{name.replace('_', '-')} and --models exclude each other; write it in the file"
            )
