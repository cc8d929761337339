"""What `graphdyn repair` has changed, or could change, as a report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import urdf
from crosscheck.commands.repair.record import record
from crosscheck.report.report import Block, Code, Note, Notes, Report, Section, Verdict
from graphdyn.errors import counted

MAX_LISTED = 6
"""Changes of one repair that are listed before they are made; all are told once they are."""


def repair_report(robot: str, done: urdf.RepairedFile) -> Report:
    """Every change that was made, and what was left."""
    if done.changes:
        number = counted(len(done.changes), "change")
        verdict = Verdict("agrees", f"{number}, written to {done.path}", "Every other byte is as it was")
    else:
        verdict = Verdict("undecided", "nothing to repair", "Nothing of what is asked for is there")
    return _report(robot, done, verdict, [_notes(done.changes)])


def list_report(robot: str, found: Mapping[str, urdf.RepairedFile], command: str) -> Report:
    """found: by the name of the repair, the surest first; command: what makes all of these changes"""
    changes = tuple(change for each in found.values() for change in each.changes)
    together = urdf.RepairedFile(None, changes, tuple(one for each in found.values() for one in each.candidates))
    doubtful = counted(len(together.candidates), "inertial is", "inertials are")
    if changes:
        verdict = Verdict("plain", f"{counted(len(changes), 'change')} possible", "Nothing is written")
    elif together.candidates:
        verdict = Verdict("undecided", "no sure change", f"{doubtful} doubtful, see below")
    else:
        verdict = Verdict("undecided", "nothing to repair", "No repair finds anything to change")
    return _report(robot, together, verdict, list(_listed(found, command)))


def _listed(found: Mapping[str, urdf.RepairedFile], command: str) -> Iterator[Block]:
    if command:
        yield Code(command, title="Written by")
    for name, each in found.items():
        if each.changes:
            more = len(each.changes) - MAX_LISTED
            rest = (f"and {more} more",) if more > 0 else ()
            title = f"--take {name}: {counted(len(each.changes), 'change')}"
            yield _notes((*each.changes[:MAX_LISTED], *rest), title)


def _notes(texts: tuple[str, ...], title: str = "") -> Notes:
    return Notes(tuple(Note(text) for text in texts), title=title)


def _report(robot: str, found: urdf.RepairedFile, verdict: Verdict, blocks: list[Block]) -> Report:
    if found.candidates:
        blocks.append(_notes(found.candidates, "Doubtful, and left as it is, because it is not clear what is right"))
    return Report(
        f"Repairs of {robot}", verdict, (Section("changes", "", tuple(blocks)),), record=lambda _: record(robot, found)
    )
