"""`graphdyn diff` as a report: how B is laid over A, what differs, and what that does to torques."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from crosscheck.commands.diff.pictures import overlay_picture, torque_bars
from crosscheck.commands.diff.record import record
from crosscheck.commands.diff.robots import ComparedRobots
from crosscheck.commands.diff.words import causes_in_words, changes_in_words, degrees, map_in_words, misplaced_names
from crosscheck.report.report import (
    Block,
    Column,
    Facts,
    Note,
    Notes,
    Report,
    Row,
    Section,
    State,
    Table,
    Verdict,
)
from graphdyn.aligning import VERDICTS, JointDifference, LinkDifference, ModelDifferences
from graphdyn.errors import counted
from graphdyn.model import unit_of

MAX_SHOWN_MAPS = 4
"""Other maps that are shown; the JSON file has all."""

STATES: dict[str, State] = dict(zip(VERDICTS, ("agrees", "undecided", "undecided", "disagrees"), strict=True))

OR_ELSE = Column("or", meaning="a change of this alone would explain it as well")

NUMBER: dict[str, Any] = {"kind": "number", "form": ".4g"}


def diff_report(compared: ComparedRobots) -> Report:
    """The report of a comparison."""
    found = compared.found
    why = reason(found)
    if misplaced_names(found.alignment):
        why += "; joints of the same name are at other places"
    verdict = Verdict(STATES[found.verdict], found.verdict, why, f"A and B: {found.verdict}.")
    names = [each.source for each in compared.robots]
    sections = (
        Section("alignment", "B laid over A", (*_alignment(compared), overlay_picture(found))),
        Section(
            "differences",
            "What differs",
            (*_kinematics(found), *_links(found), _frames(found), _settings(found), _unstated(found), _base(found)),
        ),
        Section("torques", "What shows in torque", (torque_table(found), torque_bars(found))),
    )
    return Report(f"{names[0]} (A) and {names[1]} (B)", verdict, sections, record=partial(record, compared))


def reason(found: ModelDifferences) -> str:
    """What decides, in a sentence."""
    if found.first_cause is not None:
        cause = found.first_cause
        flange = f"the flanges part by up to {found.flange.largest:.3g} m"
        differs = f"its {cause.kind} differs by {_size(cause)} in link '{cause.link}'"
        other = f", or {causes_in_words(cause.or_else)}" if cause.or_else else ""
        return f"{flange}, from joint '{cause.joint}' on: {differs}{other}"
    counting = [each for each in found.torques if each.counts]
    if counting:
        worst = max(counting, key=lambda each: abs(each.difference))
        return f"the {worst.term} term of joint '{worst.joint}' differs by up to {abs(worst.difference):.4g} " + (
            _units(found)
        )
    joints = dict.fromkeys(each.joint for each in found.settings if each.counts)
    if joints:
        return f"armature, damping, friction or limits of {counted(len(joints), 'joint')} differ"
    if found.frames:
        names = ", ".join(f"'{each.name}'" for each in found.frames)
        return f"joints and torques agree, but frames are elsewhere in their links: {names}"
    if found.links:
        return "inertias differ in what no joint torque shows"
    return f"nothing differs by more than {found.tolerance:g}"


def _size(one: JointDifference) -> str:
    return f"{one.value:.4g} m" if one.unit == "m" else f"{degrees(one.value)}°"


def _units(found: ModelDifferences) -> str:
    return unit_of(found.alignment.first.joints, "N m", "N")


def _alignment(compared: ComparedRobots) -> tuple[Block, ...]:
    found = compared.found
    done = changes_in_words(compared) or ["nothing had to be changed but link frames"]
    others = [map_in_words(found.alignment, each) for each in found.alignment.others[:MAX_SHOWN_MAPS]]
    more = len(found.alignment.others) - len(others)
    if more:
        others.append(f"and {more} more, in the JSON file")
    blocks: list[Block] = [Notes(tuple(map(Note, done)))]
    if compared.written is not None:
        update = compared.written
        links = ", ".join(update.changed) or "none"
        blocks.append(Facts((("written to", f"{update.path}: new inertials of {links}"),)))
        blocks.append(Notes(tuple(map(Note, update.notes))))
    blocks.append(Notes(tuple(map(Note, others)), title="Other maps of B that move the flange in the same way"))
    return tuple(blocks)


def _kinematics(found: ModelDifferences) -> tuple[Block, ...]:
    pose = ", ".join(f"{x:.4g}" for x in found.flange.q)
    facts = Facts(
        (("flange", f"parts by {found.flange.largest:.3g} m at most over {found.n_states} states, at q = {pose}"),)
    )
    columns = (Column("joint", "name"), Column("differs in"), Column("link before it", "name"), Column("by", "number"))
    cells = [(one.joint, one.kind, one.link, _size(one)) for one in found.joints]
    return facts, _caused("Kinematics", columns, cells, found.joints)


def _links(found: ModelDifferences) -> tuple[Block, ...]:
    columns = (
        Column("link", "name"),
        Column("differs in"),
        Column("by", **NUMBER),
        Column("unit"),
        Column("part", "number", "%", ".3g", meaning="of A's mass, of the reach, of A's largest entry"),
    )
    cells = [
        (one.link, one.kind, one.value, one.unit, None if np.isinf(one.relative) else 100 * one.relative)
        for one in found.links
    ]
    return (_caused("Links, in A's frames", columns, cells, found.links),)


def _caused(
    title: str,
    columns: tuple[Column, ...],
    cells: list[tuple[Any, ...]],
    of: Sequence[JointDifference | LinkDifference],
) -> Table:
    """A table with a further column where a difference may have other causes."""
    if any(one.or_else for one in of):
        columns = (*columns, OR_ELSE)
        cells = [(*row, causes_in_words(one.or_else)) for row, one in zip(cells, of, strict=True)]
    return Table(columns, tuple(map(Row, cells)), title=title, failures_first=False)


def _frames(found: ModelDifferences) -> Table:
    rows = tuple(Row((one.name, one.link, one.distance, degrees(one.angle))) for one in found.frames)
    columns = (
        Column("frame", "name"),
        Column("link", "name"),
        Column("moved by", unit="m", **NUMBER),
        Column("turned by", "number", "°"),
    )
    return Table(columns, rows, title="Frames of the same name", failures_first=False)


def _settings(found: ModelDifferences) -> Table:
    rows = tuple(Row((one.joint, one.name, one.first, one.second)) for one in found.settings if one.counts)
    columns = (Column("joint", "name"), Column("setting"), Column("A", **NUMBER), Column("B", **NUMBER))
    title = "Drives and limits, for A's positions"
    return Table(columns, rows, title=title, failures_first=False)


def _unstated(found: ModelDifferences) -> Notes:
    """Limits that one robot alone states."""
    joints: dict[tuple[str, str], list[str]] = {}
    for one in found.settings:
        if not one.counts:
            joints.setdefault(("B" if one.first is None else "A", one.name), []).append(one.joint)
    n = found.alignment.first.n_bodies
    words = {key: "all joints" if len(of) == n else ", ".join(of) for key, of in joints.items()}
    return Notes(
        tuple(Note(f"only {who} states limits of {name} ({of}): not counted") for (who, name), of in words.items())
    )


def _base(found: ModelDifferences) -> Table:
    rows = tuple(Row((one.name, one.first, one.second)) for one in found.base_parameters)
    columns = (Column("base parameter"), Column("A", **NUMBER), Column("B", **NUMBER))
    caption = "what of the inertias shows in torques; kg, kg m, kg m²"
    title = "Base parameters"
    return Table(columns, rows, caption=caption, title=title, failures_first=False, on=("page",), folded=True)


def torque_table(found: ModelDifferences) -> Table:
    """Term and joint by row, where they differ, with the position of the largest difference."""
    unit = _units(found)
    rows = [
        Row(
            (
                one.joint,
                one.term,
                one.difference,
                one.first,
                100 * one.relative,
                ", ".join(f"{x:.4g}" for x in one.q),
            ),
        )
        for one in found.torques
        if one.counts
    ]
    columns = (
        Column("joint", "name"),
        Column("term"),
        Column("B − A", unit=unit, **NUMBER),
        Column("A there", unit=unit, **NUMBER),
        Column("part", "number", "%", ".3g", meaning="of the largest torque of this term and joint"),
        Column("worst q", from_width=120, meaning="of A; v and a are in the JSON file"),
    )
    caption = f"largest of {found.n_states} states within A's limits; accelerations: the random v in one second"
    return Table(columns, tuple(rows), caption=caption, failures_first=False)
