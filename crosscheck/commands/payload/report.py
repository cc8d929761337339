"""`graphdyn payload` as a report: the load, the gains, and what is not determined."""

from __future__ import annotations

from functools import partial

from crosscheck.commands.identify.reports.gains_report import gains_section
from crosscheck.commands.payload.record import record
from crosscheck.identifying import IdentifiedPayload
from crosscheck.report.report import Block, Column, Facts, Note, Notes, Report, Row, Section, Table, Verdict

TENSOR = ((0, 0, "I_xx"), (0, 1, "I_xy"), (1, 1, "I_yy"), (0, 2, "I_xz"), (1, 2, "I_yz"), (2, 2, "I_zz"))


def payload_report(found: IdentifiedPayload) -> Report:
    """The report of a load and gains."""
    load = found.load
    mass = f"{load.mass:.4g} ± {load.mass_deviation:.2g} kg"
    if found.rejection_reasons:
        verdict = Verdict(
            "disagrees", "not determined", "; ".join(found.rejection_reasons), "The load is not determined."
        )
    elif found.mass_given:
        number = int(found.gains.determined.sum())
        words = f"{number} of {len(found.joints)} gains"
        verdict = Verdict("agrees", words, f"from a load of {load.mass:.4g} kg", f"{words} are determined.")
    else:
        verdict = Verdict("agrees", mass, f"carried by {found.link}", f"The load has a mass of {mass}.")
    facts = Facts((("recordings", ", ".join(found.names)), ("known", found.known)))
    sections = (
        Section("load", f"The load on {found.link}", (facts, _load(found), *_notes(found))),
        gains_section(found),
    )
    return Report(f"Payload of {found.subject.name}", verdict, sections, record=partial(record, found))


def _load(found: IdentifiedPayload) -> Table:
    load = found.load
    rows = [Row(("mass", load.mass, load.mass_deviation, "kg"))]
    places = zip("xyz", load.center_of_mass, load.center_deviations, strict=True)
    rows += [Row((f"center {axis}", float(value), float(sigma), "m")) for axis, value, sigma in places]
    tensor, deviations = load.inertia, load.inertia_deviations
    rows += [Row((name, float(tensor[i, j]), float(deviations[i, j]), "kg m²")) for i, j, name in TENSOR]
    return Table(
        (
            Column("", "name"),
            Column("value", "number", form=".5g"),
            Column("σ", "number", form=".2g", meaning="from time blocks; contains that of the gains"),
            Column("unit"),
        ),
        tuple(rows),
        caption=f"in the frame of {found.link}; the tensor about the center of mass",
        failures_first=False,
    )


def _notes(found: IdentifiedPayload) -> tuple[Block, ...]:
    notes = []
    if not found.load.consistent:
        notes.append(Note("no body has this tensor: the recordings determine it too roughly; use mass and center"))
    return (Notes(tuple(notes)),) if notes else ()
