"""The page of `graphdyn paper`: every table and result of the paper beside the corrected model."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from crosscheck.report.pages.rendering import render
from crosscheck.report.pages.time_curves import joint_curves
from crosscheck.report.pictures.arm_poses import arm_pose
from crosscheck.report.pictures.errata_pictures import distributions, missing_rank, towards_lock
from crosscheck.report.pictures.identification_errors import identification_errors
from crosscheck.report.versions import versions
from crosscheck.studies.errata import ERRATA
from crosscheck.studies.paper import why
from crosscheck.studies.paper.identification import WHY_TABLE_3
from crosscheck.studies.paper.instant import joint_motion, rail
from crosscheck.studies.paper.multipliers import KINDS, WHY_PRINTED, printed_ratios
from crosscheck.studies.paper.printed import POSES, TABLE_3, TABLE_4
from crosscheck.studies.paper.reproduction import Reproduction
from crosscheck.studies.paper.tables import WHY_TABLE_2
from crosscheck.studies.paper.texts import error_text, multiplier_text, value_text


def paper_page(found: Reproduction, command: Sequence[str]) -> str:
    """One page. The same arguments and versions give the same characters.

    command: the arguments that made it
    """
    return render(
        "paper.html",
        found=found,
        identification=found.identification,
        table_3=TABLE_3,
        table_4=TABLE_4,
        ratios=printed_ratios(),
        kinds=KINDS,
        ERRATA=ERRATA,
        why=why,
        why_table_2=WHY_TABLE_2,
        why_table_3=WHY_TABLE_3,
        why_printed=WHY_PRINTED,
        value_text=value_text,
        error_text=error_text,
        multiplier_text=multiplier_text,
        poses=[
            (
                title,
                time,
                arm_pose(f"pose-{k}", f"{title}, {time:g} s", joint_motion(time)[0], float(rail(time).translation[0])),
            )
            for k, (title, time) in enumerate(POSES.items(), start=1)
        ],
        errors=identification_errors("identification", found.identification),
        curves=[joint_curves(f"joint-{j}", found.over_time, j) for j in range(1, 7)],
        distributions=distributions("distributions", found.effects),
        lock=towards_lock("lock", found.effects),
        ranks=missing_rank("rank", found.effects),
        command=shlex.join(command),
        versions=versions(),
    )
