"""`graphdyn paper`: the tables and results of the paper beside the corrected model, as a report."""

from __future__ import annotations

from functools import partial

from crosscheck.commands.errata.report import MEANINGS, distributions, effects_table, missing_rank, towards_lock
from crosscheck.commands.paper.arm_poses import arm_pose
from crosscheck.commands.paper.identification_report import identification_section
from crosscheck.commands.paper.multipliers_report import corrected_section, over_time_section, printed_section
from crosscheck.commands.paper.record import record
from crosscheck.commands.paper.texts import BODY_TABLE_COLUMNS
from crosscheck.paper.checks import EXPERIMENT_NOTE, WHY_ERRATA, Check
from crosscheck.paper.printed import POSE_TIMES
from crosscheck.paper.reproduction import Reproduction
from crosscheck.paper.tables import WHY_TABLE_2, GeometryTable, joint_motion, rail
from crosscheck.report.report import (
    WIDE_LINE_CHARACTERS,
    Block,
    Column,
    Picture,
    Prose,
    Report,
    Row,
    Section,
    Table,
    Verdict,
)

REFERENCE_NOTE = "Pinocchio is the judge. Labels such as B5 are the numbers of docs/deviations.md."
BODY_AXES_NOTE = (
    "At every joint ○ O1 … O6: the body axes e_1 (full), e_2 (dashed), e_3 (dotted), and the joint axis (dash-dotted)."
)


def paper_report(found: Reproduction) -> Report:
    return Report(
        "The paper beside the corrected model",
        _verdict(found.checks),
        (
            Section("holds", "What holds", (_checks(found.checks),)),
            Section("table-2", "Table 2: geometry and density", (Prose(WHY_TABLE_2), _geometry(found.geometry))),
            Section("experiment", "The experiment of section 3.1", (Prose(EXPERIMENT_NOTE), *_poses())),
            identification_section(found.identification),
            printed_section(found),
            corrected_section(found.corrected),
            over_time_section(found.over_time),
            _errata(found),
        ),
        record=partial(record, found),
    )


def _verdict(checks: tuple[Check, ...]) -> Verdict:
    wrong = sum(not check.agrees for check in checks)
    if not wrong:
        words = "Every number that the text determines is reproduced within its bound."
        return Verdict("agrees", "every check holds", f"{words} {REFERENCE_NOTE}")
    words = "Not every number is within its bound: see What holds."
    return Verdict("disagrees", f"{wrong} of {len(checks)} checks DO NOT HOLD", f"{words} {REFERENCE_NOTE}")


def _checks(checks: tuple[Check, ...]) -> Table:
    holds, fails = Verdict("agrees", "holds"), Verdict("disagrees", "DOES NOT HOLD")
    return Table(
        (
            Column("where", "name"),
            Column("verdict", "verdict"),
            Column("what"),
            Column("measured", "number", form=".2g"),
            Column("bound", "number"),
            Column("why this bound", from_width=WIDE_LINE_CHARACTERS),
        ),
        tuple(
            Row(
                (
                    check.where,
                    holds if check.agrees else fails,
                    check.what,
                    check.measured,
                    f"{'≥' if check.at_least else '≤'} {check.bound:.3g}",
                    check.why,
                ),
                "agrees" if check.agrees else "disagrees",
            )
            for check in checks
        ),
        caption="Each number with its bound and the reason for the bound",
    )


def _geometry(found: GeometryTable) -> Table:
    rows = []
    for name, printed, ours in zip(found.rows, found.printed, found.texts, strict=True):
        rows += [
            Row((name, "printed", *(number.text for number in printed)), rule=True),
            Row(("", "graphdyn", *ours)),
        ]
    return Table(
        (Column("parameter", "name"), Column("source", "name"), *BODY_TABLE_COLUMNS),
        tuple(rows),
        caption="As printed, and from 7801 kg/m³ with the cylinder formula",
        repeated=2,
        compact=True,
    )


def _poses() -> tuple[Block, ...]:
    pictures = (
        Picture(
            partial(
                arm_pose, title=f"{title}, {time:g} s", q=joint_motion(time)[0], travel=float(rail(time).translation[0])
            ),
            f"{title}: {time:g} s",
            wide=False,
            on=("page",),
        )
        for title, time in POSE_TIMES.items()
    )
    return *pictures, Prose(BODY_AXES_NOTE, soft=True, on=("page",))


def _errata(found: Reproduction) -> Section:
    blocks = (
        Prose(WHY_ERRATA),
        MEANINGS,
        Picture(
            partial(distributions, effects=found.effects),
            "Histograms of the relative error over the states (A6: over the six masses); line: the bound of the "
            "corrected form, ▲: the largest.",
            title="A1, A4, A5, A6: how large the errors are",
        ),
        Picture(
            partial(towards_lock, effects=found.effects),
            "Cardano angles lose digits as |cos β| falls; the same equations in the twist do not.",
            title="A3: towards gimbal lock",
        ),
        Picture(
            partial(missing_rank, effects=found.effects),
            "The area of a dot is the share of the states.",
            title="A2: rows that are missing",
        ),
        effects_table(found.effects, found.samples, found.seed),
    )
    return Section("errata", "What the printed errors do", blocks)
