"""Torques or currents: which block, unit, side and gain, by names and by what the motion needs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings.mapping.units import TURNING_UNITS
from crosscheck.recordings.recognizing.blocks import ColumnBlock
from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock
from crosscheck.recordings.recognizing.together import CLEAR_FACTOR, TorqueFit, torque_fit
from crosscheck.recordings.recognizing.work import LogWork, how_told
from crosscheck.recordings.table import in_words
from graphdyn.layout import Array

MOST_RESIDUAL = 0.7
"""Unexplained part of the variation of a torque from which a block without a name is none."""

LIKELY_GAIN = 3.0
"""Factor up to which measured torques may differ from those of the robot's file, whose masses may be wrong."""

PROPORTIONAL = 1e-3
"""Relative residual up to which one block is another times a factor for each joint."""


def torques(
    work: LogWork, found: Sequence[ColumnBlock], q: RecognizedBlock | None, rate: float | None
) -> list[RecognizedBlock]:
    if not found:
        question = "no columns are recognized as torques or currents"
        work.open.append(OpenChoice("tau", question, work.take("tau"), ('[tau] columns = ["…"]',)))
        return []
    fits = {block.label: fit_of(work, q, block, rate) for block in found}
    found, dropped = _of_motors(work, list(found))
    unnamed = [block for block in found if block.quantity == "unnamed"]
    named = [block for block in found if block.quantity != "unnamed"]
    measured = [block for block in named if block.quantity == "tau" and not block.computed]
    if measured and "tau" not in work.untold.take:
        dropped += [
            work.block(b, "tau", b.unit, b.side, "torques are there too", False)
            for b in named if b.quantity == "current"
        ]  # fmt: skip
        named = [block for block in named if block.quantity == "tau"]
    if not named or work.untold.take.get("tau", "") in [block.label for block in unnamed]:
        named, more = _explained(work, unnamed, fits)
        dropped += more
    else:
        dropped += [work.block(b, "", "", "", "columns without meaning", False) for b in unnamed]
    if not named:
        return dropped
    chosen, others = work.chosen("tau", named)
    if chosen is None:
        return [*others, *dropped]
    return [_measured_torque(work, chosen, fits[chosen.label], q, found), *others, *dropped]


def _explained(
    work: LogWork, unnamed: Sequence[ColumnBlock], fits: dict[str, TorqueFit | None]
) -> tuple[list[ColumnBlock], list[RecognizedBlock]]:
    """The one of the blocks without names that the equations of motion explain; all where none stands out."""
    sizes = {block.label: fit.residual for block in unnamed if (fit := fits[block.label]) is not None}
    ordered = sorted((b for b in unnamed if b.label in sizes), key=lambda b: sizes[b.label])
    best = ordered[0] if ordered else None
    if best is None or sizes[best.label] > MOST_RESIDUAL:
        return list(unnamed), []
    if len(ordered) > 1 and sizes[ordered[1].label] < CLEAR_FACTOR * sizes[best.label]:
        return list(unnamed), []
    others = [
        work.block(b, "", "", "", "the equations of motion explain it less than the torques", False)
        for b in unnamed if b is not best
    ]  # fmt: skip
    return [best], others


def _of_motors(work: LogWork, found: list[ColumnBlock]) -> tuple[list[ColumnBlock], list[RecognizedBlock]]:
    """Without torques of motors that are others of the joints, divided by the ratios of the gears."""
    kept, dropped = [], []
    for block in found:
        twin = next((b for b in found if b.side == "joint" and block.side == "motor" and _times(work, b, block)), None)
        if twin is None or work.untold.take.get("tau") == block.label:
            kept.append(block)
            continue
        ratio = in_words(f"{r:.6g}" for r in _times(work, twin, block))
        dropped.append(work.block(block, "tau", block.unit, "motor", f"{twin.label} is it times {ratio}", False))
    return kept, dropped


def _times(work: LogWork, one: ColumnBlock, other: ColumnBlock) -> tuple[float, ...]:
    """The factor of each joint, if one is the other times a factor."""
    a, b = np.nan_to_num(work.values(one)), np.nan_to_num(work.values(other))
    size = np.sum(b * b, axis=0)
    if not np.all(size > 0):
        return ()
    factor = np.sum(a * b, axis=0) / size
    close = np.linalg.norm(a - factor * b, axis=0) <= PROPORTIONAL * np.linalg.norm(a, axis=0)
    return tuple(factor.tolist()) if close.all() else ()


def fit_of(work: LogWork, q: RecognizedBlock | None, block: ColumnBlock, rate: float | None) -> TorqueFit | None:
    """The fit of a torque to the motion; None if the motion at the joints is not known."""
    if q is None or rate is None or not q.unit or not q.side or (q.side == "motor" and not work.untold.ratio):
        return None
    factor = TURNING_UNITS["q"].get(q.unit, 1.0)
    ratio = np.array(work.untold.ratio) if q.side == "motor" else 1.0
    position, tau = q.values * factor / ratio, work.values(block)
    if _side(work, block, q) == "motor":
        tau = tau * np.array(work.untold.ratio)
    if not (np.isfinite(position).all() and np.isfinite(tau).all()):
        return None
    return torque_fit(work.model, rate, position, tau)


def _measured_torque(
    work: LogWork, block: ColumnBlock, fit: TorqueFit | None, q: RecognizedBlock | None, found: Sequence[ColumnBlock]
) -> RecognizedBlock:
    """The torque with unit and side. Opens a choice for what neither name nor size tells."""
    how, untold, side = how_told(block), work.untold, _side(work, block, q)
    unit = untold.units.get("tau", "") or ("N m" if block.unit == "SI" else block.unit)
    size = fit.gain if fit else None
    told = f"; {size:.3g} times the torques of the robot's file" if size is not None else ""
    if untold.gain:
        return work.block(block, "tau", unit or "A", side, f"{how}; with the gains given")
    if block.quantity == "current" and unit not in ("N m", "kN m", "mN m"):
        _ask_for_gain(work, block, fit, found)
        return work.block(block, "tau", unit or "A", side, f"{how}; currents")
    if block.side == "motor" and not untold.ratio:
        n = len(work.model.independent_joints)
        question = "torques of the motors: the ratios of the gears are not known"
        needed = ('side = "motor"', "[transmission] ratio = [" + ", ".join("…" for _ in range(n)) + "]")
        work.open.append(OpenChoice("tau", question, (f"--ratio {','.join('R' * n)}",), needed))
        return work.block(block, "tau", unit or "N m", "", how)
    likely = size is None or is_likely(size)
    if unit:
        if not likely and "tau" not in untold.units:
            work.assumed.append(f"torques are {size:.3g} times those of the robot's file: check unit, side and file")
        return work.block(block, "tau", unit, side, f"{how}; {unit}{told}")
    if size is not None and likely:
        return work.block(block, "tau", "N m", side, f"{how}; N m: {told.removeprefix('; ')}")
    options = ("--unit 'tau=N m'", "--unit 'tau=mN m'", f"--gain {','.join('G' * len(block.numbers))}")
    lines = ('unit = "N m"', 'unit = "mN m"', 'unit = "A"', "gain = […]  # N m per A")
    question = "no name tells the unit" + (f", and the size does not: {told.removeprefix('; ')}" if told else "")
    work.open.append(OpenChoice("tau", question, options, lines))
    return work.block(block, "tau", "", side, how)


def _side(work: LogWork, block: ColumnBlock, q: RecognizedBlock | None) -> str:
    """The side of the gears of a torque; if its name does not tell, that of the positions."""
    at_motor = block.side == "motor" or (block.side == "" and q is not None and q.side == "motor")
    return "motor" if work.untold.ratio and at_motor else "joint"


def _ask_for_gain(work: LogWork, block: ColumnBlock, fit: TorqueFit | None, found: Sequence[ColumnBlock]) -> None:
    """Gains of currents as candidates: by torques that the controller computed, and by the robot's file."""
    lines = []
    for other in found:
        if other.quantity == "tau" and other.computed:
            lines.append(f"gain = {_as_list(_slopes(work, block, other))}  # by {other.label}, which is computed")
    if fit is not None and np.all(np.isfinite(fit.gains)) and np.all(fit.gains != 0):
        shares = ", ".join(f"{100 * share:.0f}" for share in fit.shares)
        lines.append(f"gain = {_as_list(1 / fit.gains)}  # by the masses of the file, {shares} % of the torque")
    lines.append("gain = 1  # keeps the currents, for graphdyn payload, which finds gains")
    question = "these are currents: their gains [N m/A at the joints] are not known"
    option = f"--gain {','.join('G' * len(block.numbers))}"
    work.open.append(OpenChoice("tau", question, (option, "--unit 'tau=N m'"), tuple(lines)))


def _slopes(work: LogWork, block: ColumnBlock, other: ColumnBlock) -> Array:
    a, b = np.nan_to_num(work.values(other)), np.nan_to_num(work.values(block))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sum(a * b, axis=0) / np.sum(b * b, axis=0))


def is_likely(gain: float | None) -> bool:
    return gain is not None and 1 / LIKELY_GAIN <= gain <= LIKELY_GAIN


def _as_list(values: Array) -> str:
    return "[" + ", ".join(f"{value:.4g}" for value in values) + "]"
