"""The format `graphdyn diff 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import urdf
from crosscheck.commands.diff.robots import ComparedRobots
from crosscheck.commands.diff.words import changes_in_words
from crosscheck.report.records.record import CommandRecord, Count, Number, Numbers, Record, attribute, written
from graphdyn.aligning import (
    Cause,
    JointDifference,
    JointMap,
    LinkDifference,
    ModelDifferences,
    SettingDifference,
    TorqueDifference,
)


class JointMapRecord(Record, of=JointMap, only=("signs", "zeros")):
    """How q of B follows from q of A: q_B = signs q_A + zeros.

    base_rotation: R of B's ground frame: a point with coordinates x in it has R x + t in A's ground frame (3, 3)
    base_translation: t (3,) [m]
    tool_rotation: R of B's last link frame, in A's at q = 0 (3, 3)
    tool_translation: t (3,) [m]
    """

    signs: Numbers
    zeros: Numbers
    base_rotation: Sequence[Numbers] = attribute("base.rotation")
    base_translation: Numbers = attribute("base.translation")
    tool_rotation: Sequence[Numbers] = attribute("tool.rotation")
    tool_translation: Numbers = attribute("tool.translation")


class CauseRecord(Record, of=Cause):
    """One change that alone would explain what differs at a joint or a link."""


class JointDifferenceRecord(Record, of=JointDifference):
    """One thing that is different at a joint of A.

    unit: of the value
    or_else: other changes, each of which would explain it as well
    """

    unit: str = attribute()
    or_else: Sequence[CauseRecord] = attribute()


class LinkDifferenceRecord(Record, of=LinkDifference):
    """One thing that is different in the inertia of a link.

    unit: of the value
    or_else: other changes, each of which would explain it as well
    """

    relative: Number
    unit: str = attribute()
    or_else: Sequence[CauseRecord] = attribute()


class TorqueDifferenceRecord(Record, of=TorqueDifference):
    """The largest difference of one term of the torque of one joint.

    relative: the difference as a part of the largest torque of this term and joint
    """

    q: Numbers
    v: Numbers
    a: Numbers
    relative: Number = attribute()


class SettingDifferenceRecord(Record, of=SettingDifference):
    """Another armature, damping, friction or limit of a joint.

    counts: false for a limit of velocity or effort that one robot does not state
    """

    counts: bool = attribute()


class UpdateRecord(Record, of=urdf.Update):
    """The URDF file that was written.

    path: of the file
    """

    path: str


class DiffRecord(
    CommandRecord,
    of=ModelDifferences,
    only=("verdict", "tolerance", "n_states", "frames", "base_parameters"),
    format="graphdyn diff 1",
):
    """What differs between robots A and B, after B is laid over A.

    robots: A and B as given; seed: of the random states
    joint_names: of A, then of B, in the order of positions
    held: joints of A, then of B, that are held at 0, because the other robot has none of their names
    changes: what the map does, in sentences
    map: the map that was taken; other_maps: those that move the flange in the same way
    flange_distance: the largest one [m]; flange_q: where, of A (n,)
    joints: lengths, angles and axes that differ, from the base outward
    links: masses, centers of mass and tensors that differ
    torques: of every term and joint the largest difference, and its state
    inertials_written: what --use-inertials-of wrote, null without it
    """

    robots: Sequence[str]
    seed: Count
    joint_names: Sequence[Sequence[str]]
    held: Sequence[Sequence[str]]
    changes: Sequence[str]
    map: JointMapRecord = attribute("alignment.map")
    other_maps: Sequence[JointMapRecord] = attribute("alignment.others")
    flange_distance: float = attribute("flange.largest")
    flange_q: Numbers = attribute("flange.q")
    joints: Sequence[JointDifferenceRecord] = attribute()
    links: Sequence[LinkDifferenceRecord] = attribute()
    torques: Sequence[TorqueDifferenceRecord] = attribute()
    settings: Sequence[SettingDifferenceRecord] = attribute()
    inertials_written: UpdateRecord | None


def record(compared: ComparedRobots, command: Sequence[str]) -> dict[str, Any]:
    found = compared.found
    update = compared.written
    return written(
        DiffRecord,
        found,
        command=command,
        robots=[each.source for each in compared.robots],
        seed=compared.seed,
        joint_names=[found.alignment.first.joint_names, found.alignment.second.joint_names],
        held=[each.held for each in compared.robots],
        changes=changes_in_words(compared),
        inertials_written=None if update is None else written(UpdateRecord, update, path=str(update.path)),
    )
