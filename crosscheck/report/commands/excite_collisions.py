"""Of `graphdyn excite`: which links were kept from hitting each other."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.exciting.excited import Excited
from crosscheck.report.report import Column, Note, Notes, Row, Section, Table

MOST = 3
"""Links without shapes that are named."""


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
    return f"{hits or 'none'}{near} on the meshes ({checked})"


def collision_sections(found: Excited) -> tuple[Section, ...]:
    """What was left out, and what collides; nothing where all was checked and nothing found."""
    known = found.collisions
    if known is None:
        return ()
    notes = [
        Note(f"{words}: {', '.join(names)}")
        for words, names in (
            ("Not checked, because they always collide", known.touching),
            ("Not checked, because the SRDF file disables them", known.disabled),
        )
        if names
    ]
    if known.missing:
        notes.append(Note(_missing_text(list(known.missing.items()))))
    rows = tuple(Row((hit.name, hit.poses, hit.first / 1000), "disagrees") for hit in found.hits)
    columns = (Column("links", "name"), Column("poses", "number"), Column("first", "number", "s", ".3f"))
    blocks = (*((Table(columns, rows),) if rows else ()), *((Notes(tuple(notes)),) if notes else ()))
    return (Section("collisions", "Collisions of links", blocks),) if blocks else ()


def _missing_text(missing: Sequence[tuple[str, str]]) -> str:
    told = "; ".join(f"{link} ({reason})" for link, reason in missing[:MOST])
    others = f"; and {len(missing) - MOST} others" if len(missing) > MOST else ""
    return f"Not kept from collisions, because their shapes cannot be read: {told}{others}"
