"""A recording for identification: arrays of the joints over time, and their provenance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.errors import RecordingFinding
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.virtual import JOINT_UNITS
from graphdyn import InvalidInput, VirtualRecording
from graphdyn.display import Displayed
from graphdyn.errors import counted
from graphdyn.layout import Array
from graphdyn.tables import data_frame, joint_columns

if TYPE_CHECKING:
    import pandas

MOTION_CHANNELS = ("q", "v", "a", "tau")
RECORDED_JOINT_CHANNELS = (*MOTION_CHANNELS, "temperature")
OPTIONAL_CHANNELS = {"joint_wrenches": 6, "body_accelerations": 6}
"""Further channels, with their numbers per joint."""
NOISE_CHANNELS = ("q_noise", "v_noise")
NUMBERED_ROWS = ("block", "rows", "file")
ALL_CHANNELS = ("t", *RECORDED_JOINT_CHANNELS, *OPTIONAL_CHANNELS, *NOISE_CHANNELS, "torque_cutoff")


@dataclass(frozen=True)
class Provenance:
    """Origin of a recording.

    files: as given
    mapping: source of its columns: a mapping file, or "by name"
    steps: the operations on the numbers since, in order
    columns: the mapping itself; None for a recording from another source
    """

    files: tuple[str, ...] = ()
    mapping: str = ""
    steps: tuple[str, ...] = ()
    columns: ColumnMapping | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, eq=False, repr=False)
class Recording(Displayed):
    """N rows of a robot with n joints, at the joints (after the gears), SI units.

    joint_names, prismatic: names, and which joints slide         (n,)
    t: time, increasing inside a block                            (N,)       [s]
    q, v, a, tau: of the joints, None if not recorded             (N, n)     [rad or m, …/s, …/s², N m or N]
    temperature: of their drives, likewise                        (N, n)     [°C]
    joint_wrenches: force, then moment, of the inside body on body j, at O_j, link axes of j   (N, n, 6) [N, N m]
    body_accelerations: r̈ of the center of mass in world axes, then ω̇ in body axes            (N, n, 6)
    block: number of the uninterrupted piece of time, not decreasing   (N,); no filter crosses its borders
    rows: row in its file, from 0; after resampling, the nearest       (N,)
    file: number of the file in provenance.files                       (N,)
    torque_cutoff: of the low-pass still to be applied to tau, together with every column of the regressor
        (crosscheck.samples_of); infinite if it stays as it is         (N,)       [Hz]
    q_noise, v_noise: standard deviations of the measurements, before any low-pass; None if unknown
                                                             (N, n)     [rad or m, …/s]

    Arrays are copied and read-only. Raises InvalidInput, with channel and row, for wrong shapes, NaN or infinity, and
    times that do not increase inside a block.
    """

    joint_names: tuple[str, ...]
    t: Array
    q: Array
    v: Array | None = None
    a: Array | None = None
    tau: Array | None = None
    temperature: Array | None = None
    joint_wrenches: Array | None = None
    body_accelerations: Array | None = None
    prismatic: tuple[bool, ...] = ()
    block: NDArray[np.intp] = None  # type: ignore[assignment]  # __post_init__ fills it
    rows: NDArray[np.intp] = None  # type: ignore[assignment]  # __post_init__ fills it
    file: NDArray[np.intp] = None  # type: ignore[assignment]  # __post_init__ fills it
    torque_cutoff: Array = None  # type: ignore[assignment]  # __post_init__ fills it
    q_noise: Array | None = None
    v_noise: Array | None = None
    provenance: Provenance = Provenance()
    findings: tuple[RecordingFinding, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.joint_names)
        object.__setattr__(self, "prismatic", tuple(self.prismatic) or (False,) * n)
        if len(self.prismatic) != n:
            raise InvalidInput(
                f"prismatic has {counted(len(self.prismatic), 'entry', 'entries')} for {counted(n, 'joint')}"
            )
        count = np.asarray(self.t).size
        if count == 0:
            raise InvalidInput("the recording has no rows; give at least one")
        shapes: dict[str, tuple[int, ...]] = {"t": (count,)} | dict.fromkeys(
            (*RECORDED_JOINT_CHANNELS, *NOISE_CHANNELS), (count, n)
        )
        shapes |= {name: (count, n, width) for name, width in OPTIONAL_CHANNELS.items()}
        for name, shape in shapes.items():
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _checked(name, np.array(getattr(self, name), dtype=float), shape))
        for name in NUMBERED_ROWS:
            given, default = getattr(self, name), np.arange(count) if name == "rows" else np.zeros(count)
            labels = np.array(default if given is None else given, dtype=np.intp)
            object.__setattr__(self, name, _checked(name, labels, (count,)))
        cutoff = np.full(count, np.inf) if self.torque_cutoff is None else np.array(self.torque_cutoff, dtype=float)
        object.__setattr__(self, "torque_cutoff", _shaped("torque_cutoff", cutoff, (count,)))
        steps, same = np.diff(self.t), np.diff(self.block)
        if np.any(same < 0):
            raise InvalidInput("the blocks of a recording are not in order; number them in the order of the rows")
        back = np.flatnonzero((steps <= 0) & (same == 0))
        if back.size:
            raise InvalidInput(
                f"time {self.t[back[0] + 1]:g} s in row {back[0] + 1} does not increase inside its block"
            )

    def summary(self) -> str:
        """Files, rows, channels, and what was found."""
        files = ", ".join(self.provenance.files) or "recording"
        size = f"{counted(len(self.t), 'row')} of {counted(self.n_joints, 'joint')}"
        size += f" in {counted(len(self.block_slices), 'block')}"
        found = [f"{one.severity}: {one.message}" for one in self.findings]
        return "\n".join(
            [
                f"{files}: {size}, {self.t[0]:g} to {self.t[-1]:g} s",
                f"joints: {', '.join(self.joint_names)}",
                f"channels: {', '.join(self.recorded(ALL_CHANNELS))}",
                *self.provenance.steps,
                *found,
            ]
        )

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every time, with what was recorded of every joint, in columns such as "q shoulder", and its block.

        Raises ImportError where pandas is missing.
        """
        channels = {name: getattr(self, name) for name in RECORDED_JOINT_CHANNELS}
        return data_frame({"block": self.block, **joint_columns(channels, self.joint_names)}, self.t, "t")

    @property
    def n_joints(self) -> int:
        """Number of joints n."""
        return len(self.joint_names)

    @property
    def units(self) -> dict[str, tuple[str, ...]]:
        """Unit of each joint, per channel."""
        return {name: tuple(units[slides] for slides in self.prismatic) for name, units in JOINT_UNITS.items()}

    @property
    def block_slices(self) -> list[slice]:
        """The rows of each block."""
        borders = np.flatnonzero(np.diff(self.block)) + 1
        return [slice(int(a), int(b)) for a, b in zip([0, *borders], [*borders, len(self.t)], strict=True)]

    def recorded(self, names: Sequence[str]) -> list[str]:
        """The channels that it has."""
        return [name for name in names if getattr(self, name) is not None]

    def channel(self, name: str) -> Array:
        """A required channel. Raises InvalidInput, with the way to obtain it, if it is missing."""
        values = getattr(self, name)
        if values is None:
            remedy = (
                "derive it with crosscheck.differentiated" if name in ("v", "a") else "record it, or map its columns"
            )
            raise InvalidInput(f"{', '.join(self.provenance.files) or 'the recording'} has no {name}; {remedy}")
        return np.asarray(values)

    def take(self, rows: Any, step: str | None = None, **changed: Any) -> Recording:
        """The recording of these rows (mask, indices or slice), with other changes; step is added to its provenance."""
        taken = {name: getattr(self, name)[rows] for name in self.recorded((*ALL_CHANNELS, *NUMBERED_ROWS))}
        steps = (*self.provenance.steps, *([step] if step else []))
        return replace(self, **(taken | changed), provenance=replace(self.provenance, steps=steps))


def _checked(name: str, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    bad = np.argwhere(~np.isfinite(_shaped(name, array, shape)))
    if bad.size:
        raise InvalidInput(f"{name} is {array[tuple(bad[0])]} in row {bad[0][0]}; leave out the rows without numbers")
    return array


def _shaped(name: str, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    if array.shape != shape:
        raise InvalidInput(f"{name} has shape {array.shape}, expected {shape}")
    array.setflags(write=False)
    return array


def recording_of(recording: VirtualRecording) -> Recording:
    """The recording of a virtual experiment, with joint wrenches and angular accelerations in link axes."""
    into_body = np.swapaxes(recording.rotation, -1, -2)

    def turned(vectors: Array) -> Array:
        return np.asarray(np.einsum("...ab,...b->...a", into_body, vectors))

    wrenches = np.concatenate([turned(recording.joint_forces), turned(recording.joint_moments)], axis=-1)
    accelerations = np.concatenate([recording.acceleration, turned(recording.angular_acceleration)], axis=-1)
    return Recording(
        joint_names=recording.joint_names,
        prismatic=recording.prismatic,
        t=recording.time,
        **{name: getattr(recording, name) for name in MOTION_CHANNELS},
        joint_wrenches=wrenches,
        body_accelerations=accelerations,
        provenance=Provenance((recording.robot,), "virtual experiment"),
    )


def concatenated(recordings: Sequence[Recording]) -> Recording:
    """Recordings one after another, each in blocks of its own. Channels that one of them lacks are left out.

    Raises InvalidInput for an empty sequence, and for recordings of different joints.
    """
    if not recordings:
        raise InvalidInput("no recordings to concatenate; give at least one")
    first = recordings[0]
    for other in recordings[1:]:
        if (other.joint_names, other.prismatic) != (first.joint_names, first.prismatic):
            raise InvalidInput(
                f"{', '.join(other.provenance.files)} has the joints {', '.join(other.joint_names)}, "
                f"{', '.join(first.provenance.files)} {', '.join(first.joint_names)}; "
                "give recordings of the same joints"
            )
    joined: dict[str, Any] = {}
    for name in (*ALL_CHANNELS, "rows"):
        parts = [getattr(recording, name) for recording in recordings]
        joined[name] = np.concatenate(parts) if all(part is not None for part in parts) else None
    block: list[NDArray[np.intp]] = []
    file: list[NDArray[np.intp]] = []
    n_files = 0
    for recording in recordings:
        block.append(np.unique(recording.block, return_inverse=True)[1] + (block[-1][-1] + 1 if block else 0))
        file.append(recording.file + n_files)
        n_files += len(recording.provenance.files)
    provenance = Provenance(
        tuple(name for recording in recordings for name in recording.provenance.files),
        ", ".join(dict.fromkeys(recording.provenance.mapping for recording in recordings)),
        tuple(dict.fromkeys(step for recording in recordings for step in recording.provenance.steps)),
        first.provenance.columns,
    )
    return replace(
        first,
        **joined,
        block=np.concatenate(block),
        file=np.concatenate(file),
        provenance=provenance,
        findings=tuple(finding for recording in recordings for finding in recording.findings),
    )
