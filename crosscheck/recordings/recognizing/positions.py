"""Positions of the joints, their unit and side of the gears, and the velocities that are their rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from crosscheck.recordings.mapping.units import TURNING_UNITS
from crosscheck.recordings.recognizing.blocks import ColumnBlock
from crosscheck.recordings.recognizing.limits import beyond, reaches, units_within
from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock
from crosscheck.recordings.recognizing.together import CLEAR_FACTOR, rate_factor, unit_of_rate
from crosscheck.recordings.recognizing.torques import fit_of, is_likely
from crosscheck.recordings.recognizing.work import LogWork, how_told
from graphdyn.layout import Array

EXPLAINED = 0.3
"""Unexplained part of the torque up to which the positions that explain it are taken to be right: gears and zeros that
are wrong leave more."""


def positions(
    work: LogWork, found: Sequence[ColumnBlock], torques: Sequence[ColumnBlock], rate: float | None
) -> list[RecognizedBlock]:
    if not found:
        question = "no columns are recognized as positions of the joints"
        lines = ('[q] columns = ["…"]', 'unit = "rad"')
        work.open.append(OpenChoice("q", question, work.take("q"), lines))
        return []
    chosen, blocks = work.chosen("q", found)
    if chosen is None:
        return blocks
    values = work.values(chosen)
    unit, side, why = _unit_of_position(work, chosen, values)
    block = work.block(chosen, "q", unit, side, why)
    if not side and not unit:
        block = _in_degrees_or_of_motors(work, block, torques, rate)
    elif not unit:
        block = _turning_as_torques_say(work, block, torques, rate)
    return [block, *blocks]


def _in_degrees_or_of_motors(
    work: LogWork, block: RecognizedBlock, torques: Sequence[ColumnBlock], rate: float | None
) -> RecognizedBlock:
    """Positions beyond the limits in rad: in degrees, if these explain a torque; or an open choice."""
    degrees = replace(block, unit="deg", side="joint")
    fitting = "deg" in units_within(work, block.values)
    fits = [fit for one in torques if fitting and (fit := fit_of(work, degrees, one, rate)) is not None]
    least = min((fit.residual for fit in fits if is_likely(fit.gain)), default=np.inf)
    if least <= EXPLAINED:
        told = f"deg: within the limits of the robot, and {100 * least:.2g} % of the torque unexplained"
        return replace(degrees, why=f"{block.why}; {told}")
    _ask_for_ratio(work, block.values, "deg" if fitting else "")
    return block


def _turning_as_torques_say(
    work: LogWork, block: RecognizedBlock, torques: Sequence[ColumnBlock], rate: float | None
) -> RecognizedBlock:
    """Positions that may be rad or deg, in the unit that explains some torque clearly better; or an open choice."""
    units = ("rad", "deg")
    for torque in torques:
        fits = [fit_of(work, replace(block, unit=unit), torque, rate) for unit in units]
        sizes = {unit: fit.residual for unit, fit in zip(units, fits, strict=True) if fit is not None}
        if len(sizes) == len(units) and min(sizes.values()) * CLEAR_FACTOR < max(sizes.values()):
            unit, other = sorted(sizes, key=lambda unit: sizes[unit])
            told = f"{100 * sizes[unit]:.2g} % of {torque.label} unexplained, {100 * sizes[other]:.2g} % in {other}"
            return replace(block, unit=unit, why=f"{block.why}; {unit}: {told}")
    question = "no name tells the unit, and both rad and deg are within the limits of the robot"
    options, lines = ("--unit q=rad", "--unit q=deg"), ('unit = "rad"', 'unit = "deg"')
    work.open.append(OpenChoice("q", question, options, lines))
    return block


def _unit_of_position(work: LogWork, block: ColumnBlock, values: Array) -> tuple[str, str, str]:
    """Unit, side and reason. Opens a choice where both are possible."""
    how = how_told(block)
    given = work.untold.units.get("q", "") or ("rad" if block.unit == "SI" else block.unit)
    fitting = units_within(work, values)
    if work.untold.ratio and block.side != "joint" and not (given and given in fitting):
        return given or "rad", "motor", f"{how}; beyond the limits of the joints, so in front of the gears"
    if given:
        if given in fitting:
            return given, "joint", f"{how}; {given}, within the limits of the robot"
        if beyond(work, values * TURNING_UNITS["q"].get(given, 1.0)) > 1 and "q" not in work.untold.units:
            _ask_for_ratio(work, values, given)
            return given, "", how
        work.assumed.append(f"positions in {given} leave the limits of the robot: their zeros may differ")
        return given, "joint", f"{how}; {given}"
    if fitting == ["rad"]:
        return "rad", "joint", f"{how}; rad: within the limits of the robot, whose joints would hardly move in deg"
    if fitting == ["rad", "deg"]:
        return "", "joint", how
    return "", "", how


def _ask_for_ratio(work: LogWork, values: Array, other: str) -> None:
    """Positions beyond the limits: in front of the gears, or in another unit."""
    least = [f"{1 + int(size):d}" for size in reaches(work, values)]
    question = "positions in rad are beyond the limits of the joints: in front of the gears"
    question += f", or in {other}" if other == "deg" else ""
    ratio = f"--ratio {','.join('R' * len(least))}"
    lines: tuple[str, ...] = (
        'unit = "rad"',
        'side = "motor"',
        f"[transmission] ratio = [{', '.join(least)}]  # at least",
    )
    options: tuple[str, ...] = (ratio,)
    if other == "deg":
        lines, options = (*lines, 'or unit = "deg"'), (ratio, "--unit q=deg")
    work.open.append(OpenChoice("q", question, options, lines))


def velocities(
    work: LogWork, found: Sequence[ColumnBlock], q: RecognizedBlock | None, rate: float | None
) -> tuple[list[RecognizedBlock], float | None]:
    """Velocities that are the rates of the positions, and the rate of the rows, if they tell it."""
    if not found or q is None:
        return [work.block(block, "v", block.unit, "", "", False) for block in found], rate
    blocks: list[RecognizedBlock] = []
    for block in found:
        factor = rate_factor(q.values, work.values(block))
        taken = not block.computed and factor is not None and not any(one.taken for one in blocks)
        unit = "rad/s" if block.unit == "SI" else work.untold.units.get("v", "") or block.unit
        why = "its sum is not the change of the positions"
        if block.computed:
            why = f"{block.computed!r} in its name: computed, not measured"
        elif factor is not None:
            why = "its sum is the change of the positions"
            if rate is None and unit in TURNING_UNITS["v"] and q.unit in TURNING_UNITS["q"]:
                rate = factor * TURNING_UNITS["v"][unit] / TURNING_UNITS["q"][q.unit]
                rate = float(f"{rate:.4g}")
                work.assumed.append(f"the rate of {rate:g} Hz is that of the velocities; no column is a clock")
            told = unit_of_rate(factor / rate, q.unit) if rate else ""
            unit = unit or told
            if not unit:
                taken, why = False, f"{why}; the rate is needed for its unit"
            elif rate and (not told or told != unit):
                taken, why = False, f"{factor / rate:.4g} times the rate of the positions"
                why += f", which is no unit of {unit}" if unit else ""
        if taken:
            blocks.append(work.block(block, "v", unit, q.side, f"{how_told(block)}; {why}"))
        else:
            blocks.append(work.block(block, "v", block.unit, "", why, False))
    return blocks, rate
