"""Of `graphdyn excite`: which links were kept from hitting each other."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.exciting.excited import Excited
from crosscheck.report.report import Column, Note, Notes, Row, Section, Table
from graphdyn.excitation.optimising import CHECK_RATE

MOST = 3
"""Links without shapes that are named, of either kind."""


def collisions_text(found: Excited) -> str:
    """One line on what was checked, and what was found."""
    known = found.collisions
    if known is None:
        return "not looked at (--no-collisions)"
    if not known.meshes:
        return "not looked at: no shapes of links can be read"
    poses = sum(motion.poses for motion in found.motions)
    checked = f"{len(known.meshes)} links, {len(known.pairs)} pairs, {poses} poses at 1 kHz"
    near = f" nearer than {1000 * known.margin:g} mm" if known.margin else ""
    hits = ", ".join(f"{hit.name} in {hit.poses} poses" for hit in found.hits)
    bare = [*known.missing, *known.without_shapes]
    passed = f"; links without shapes pass unchecked: {_some(bare, ', ')}" if bare else ""
    near += f", but for {len(known.near)} pairs that always are," if known.near else ""
    return f"{hits or 'none'}{near} on the meshes ({checked}){passed}"


def collision_sections(found: Excited) -> tuple[Section, ...]:
    """What was left out, and what collides; nothing where all was checked and nothing found."""
    known = found.collisions
    if known is None:
        return ()
    notes = [
        Note(f"{words}: {', '.join(names)}")
        for words, names in (
            (f"Kept from touching alone, because they are always nearer than {1000 * known.margin:g} mm", known.near),
            ("Not checked, because they always collide", known.touching),
            ("Not checked, because the SRDF file disables them", known.disabled),
        )
        if names
    ]
    if known.missing:
        told = [f"{link} ({reason})" for link, reason in known.missing.items()]
        notes.append(Note(f"Not checked, because their shapes cannot be read: {_some(told, '; ')}"))
    if known.without_shapes:
        notes.append(Note(f"Not checked, because the file gives them no shapes: {_some(known.without_shapes, ', ')}"))
    rows = tuple(Row((hit.name, hit.poses, hit.first / CHECK_RATE), "disagrees") for hit in found.hits)
    columns = (Column("links", "name"), Column("poses", "number"), Column("first", "number", "s", ".3f"))
    blocks = (*((Table(columns, rows),) if rows else ()), *((Notes(tuple(notes)),) if notes else ()))
    return (Section("collisions", "Collisions of links", blocks),) if blocks else ()


def _some(told: Sequence[str], between: str) -> str:
    others = [f"and {len(told) - MOST} others"] if len(told) > MOST else []
    return between.join([*told[:MOST], *others])
