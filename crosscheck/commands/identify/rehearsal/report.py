"""A rehearsal as a report: what will be found within which deviation, in sentences and tables."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from crosscheck.commands.identify.rehearsal.record import record
from crosscheck.identifying import Outcome, Rehearsal
from crosscheck.report.report import Block, Column, Facts, Note, Notes, Prose, Report, Row, Section, Table, Verdict
from graphdyn.errors import counted
from graphdyn.model import unit_of

DEVIATION: dict[str, Any] = {"kind": "number", "form": ".2g"}

MAX_PARAMETER_NAMES = 6
"""Largest number of parameters that the terminal lists."""


def rehearsal_report(found: Rehearsal) -> Report:
    """The report of a rehearsal."""
    told = found.identifiability
    missing = told.structural_rank - told.rank
    if missing:
        verdict = Verdict(
            "disagrees",
            f"{missing} of {told.structural_rank} base parameters stay unknown",
            f"{found.motion} does not determine them; {_remedy(found)}",
            f"{missing} of {told.structural_rank} base parameters stay unknown.",
        )
    elif not found.outcomes:
        verdict = Verdict(
            "disagrees", "no method has a result", "; ".join(found.failures.values()), "No method has a result."
        )
    else:
        words, reason = f"all {told.rank} base parameters", f"are determined by {found.motion}"
        verdict = Verdict("agrees", words, reason, f"The motion determines {words}.")
    sections = (
        Section("links", "What will be known of the links", (_facts(found), *_links(found))),
        Section("parameters", "What will be known of the base parameters", tuple(_parameters(found))),
    )
    return Report(
        f"Rehearsal of {found.motion} by {found.subject.name}", verdict, sections, record=partial(record, found)
    )


def _remedy(found: Rehearsal) -> str:
    if found.still_joints:
        return f"it does not move {', '.join(found.still_joints)}"
    return "move all joints at several speeds, and over more of their range"


def _facts(found: Rehearsal) -> Facts:
    conditions = found.conditions
    residual = f"{100 * conditions.torque_noise:g} % of each joint's torque, "
    residual += f"correlated over {conditions.noise_time:g} s" if conditions.noise_time else "white"
    return Facts(
        (
            ("motion", f"{found.motion}, {found.duration:g} s, recorded at {conditions.rate:g} Hz"),
            ("residual", residual),
            ("positions", f"noise of {conditions.position_noise:g} {unit_of(found.subject.model.joints, 'rad', 'm')}"),
            ("friction", f"each parameter {100 * conditions.friction:g} % of the torque of its joint, ± 50 %"),
            (
                "file",
                f"masses right to ± {100 * conditions.cad_error:g} %, centers of mass to as much of their link's size",
            ),
            ("low-pass", _cutoff(found)),
            ("runs", f"{conditions.runs} robots, each with another truth; σ: root mean square of the errors"),
            *((f"prior of {name}", f"{_range(x)}, by cross-validation") for name, x in found.strengths.items()),
        )
    )


def _range(strengths: Sequence[float]) -> str:
    least, most = min(strengths), max(strengths)
    return f"strength {least:g}" + (f" to {most:g}" if most > least else "")


def _cutoff(found: Rehearsal) -> str:
    if found.cutoffs:
        return f"{min(found.cutoffs):.3g} to {max(found.cutoffs):.3g} Hz, by residual analysis"
    cutoff = found.preparation.cutoff
    return "none" if cutoff is None else f"{cutoff:.3g} Hz" if isinstance(cutoff, float) else str(cutoff)


def _links(found: Rehearsal) -> list[Block]:
    if found.best_of_links is None:
        return [Notes((Note("no method found physically consistent links in every run", state="undecided"),))]
    best = found.outcomes[found.best_of_links]
    notes = [Note(_sentence(found, best, k)) for k in range(len(found.link_names))]
    real = {name: outcome for name, outcome in found.outcomes.items() if outcome.consistent}
    columns = [
        Column("link", "name"),
        Column("mass", "number", "kg", ".4g", "in the file"),
        *(Column(f"σ {name}", unit="kg", **DEVIATION) for name in ("file", *real)),
        *(Column(f"σ center {name}", unit="mm", **DEVIATION) for name in ("file", *real)),
    ]
    outcomes = (found.file, *real.values())
    rows = [
        Row((
            name, float(found.masses[k]), *(float(x.mass_deviations[k]) for x in outcomes),
            *(1000 * _distance(x, k) for x in outcomes),
        ))
        for k, name in enumerate(found.link_names)
    ]  # fmt: skip
    caption = "σ center: of all three components together; methods with physically consistent links in every run"
    table = Table(tuple(columns), tuple(rows), caption=caption, failures_first=False)
    return [Notes(tuple(notes), title=f"With {found.best_of_links}"), table]


def _sentence(found: Rehearsal, outcome: Outcome, k: int) -> str:
    """What will be known of a link."""
    before, after = float(found.file.mass_deviations[k]), float(outcome.mass_deviations[k])
    far, near = 1000 * _distance(found.file, k), 1000 * _distance(outcome, k)
    mass = _known(found, after, before, "kg")
    return (
        f"{found.link_names[k]}: its mass of {found.masses[k]:.3g} kg will be known to {mass}, its center of mass to "
        f"{_known(found, near, far, 'mm')}"
    )


def _known(found: Rehearsal, after: float, before: float, unit: str) -> str:
    """Two deviations after the recording, and before."""
    known = f"± {_short(2 * after)} {unit}"
    if not found.learned(after, before):
        return f"{known} only (the file: ± {_short(2 * before)} {unit})"
    return f"{known} (2 σ) in place of ± {_short(2 * before)} {unit}"


def _short(value: float) -> str:
    """Two digits without an exponent."""
    return f"{float(f'{value:.2g}'):g}"


def _distance(outcome: Outcome, k: int) -> float:
    return float(np.linalg.norm(outcome.center_deviations[k]))


def _parameters(found: Rehearsal) -> list[Block]:
    told, outcomes = found.identifiability, found.outcomes
    blocks: list[Block] = []
    notes = [Note(f"{name} has no result: {why}", state="disagrees") for name, why in found.failures.items()]
    if found.best is not None:
        few = found.hardly_told(outcomes[found.best])
        names = [name for name, little in zip(told.base_names, few, strict=True) if little]
        words = f"{found.best} is the most certain: median σ {100 * found.share(found.best):.0f} % of that of the file"
        notes.append(Note(words))
        little = f"Told hardly better than by the file: {counted(len(names), 'base parameter')}"
        blocks += _listed(little, names)
    for name, outcome in outcomes.items():
        if np.isfinite(outcome.covered):
            share = f"{100 * outcome.covered:.0f} %"
            words = (
                f"{name} states σ of its own, from time blocks; twice that contained the truth in {share} of the cases"
            )
            notes.append(Note(words))
    blocks = [Notes(tuple(notes)), *_listed("Not determined individually by this motion", told.lost), *blocks]
    stated = [name for name, outcome in outcomes.items() if outcome.stated is not None]
    columns = [
        Column("base parameter", "name"),
        Column("unit"),
        Column("file", "number", form=".4g"),
        *(Column(f"σ {name}", **DEVIATION) for name in ("file", *outcomes)),
        *(Column(f"σ stated by {name}", **DEVIATION) for name in stated),
    ]
    rows = [
        Row((
            name, told.base_units[k], float(found.prior_base_values[k]), float(found.file.base_deviations[k]),
            *(float(outcome.base_deviations[k]) for outcome in outcomes.values()),
            *(float(outcomes[one].stated[k]) for one in stated),  # type: ignore[index]
        ))
        for k, name in enumerate(told.base_names)
    ]  # fmt: skip
    caption = "file: its values, zero for drives; σ: root mean square errors over the runs; σ stated: from time blocks"
    blocks.append(Table(tuple(columns), tuple(rows), caption=caption, failures_first=False))
    return blocks


def _listed(title: str, names: Sequence[str]) -> list[Block]:
    """A list of parameters: its beginning on the terminal, all of it on the page."""
    if not names:
        return []
    more = f" and {len(names) - MAX_PARAMETER_NAMES} more" if len(names) > MAX_PARAMETER_NAMES else ""
    return [
        Prose(f"{title}: {'; '.join(names[:MAX_PARAMETER_NAMES])}{more}", on=("text",)),
        Prose("; ".join(names), title=title, on=("page",)),
    ]
