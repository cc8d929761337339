"""The measured motion in the rows of a problem's equations, with the covariance of its errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn._errors import EstimationFailed
from graphdyn.identification.problem import Problem
from graphdyn.identification.rows import Rows
from graphdyn.identification.runs import runs
from graphdyn.identification.samples import Samples, joined_samples
from graphdyn.layout import Array

WINDOW = 4096
"""Rows that are computed at once: enough for compiled code to be worth it."""

NO_ERRORS = (
    "needs the errors of q, v and a (motion_covariance of the samples), which crosscheck.identify estimates from "
    "recorded positions"
)


@dataclass(frozen=True, eq=False)
class Measured:
    """Consecutive rows of one run.

    rows: their equations; blocks: the time block of each   (N,)
    motion: q, v, a where they are
    covariance: of the errors of all q, then v, then a      (3 n, 3 n)
    """

    rows: Rows
    blocks: NDArray[np.int64]
    motion: Samples
    covariance: Array


def measured_motion(problem: Problem) -> Iterator[Measured]:
    """All equations, window by window.

    Raises EstimationFailed where the errors are not known, for a base that moves, and for friction with memory.
    """
    if problem.torque_model.has_memory:
        raise EstimationFailed("knows the errors of a row at a time, and friction with memory takes all rows together")
    motion, covariances, run, position = *_motion(problem), 0
    for parts in _windows(problem.rows()):
        names = ("matrix", "right", "measured", "velocity", "kept")
        matrix, right, measured, velocity, kept = (
            np.concatenate([getattr(part, name) for part in parts]) for name in names
        )
        rows = Rows(matrix, right, measured, velocity, kept)
        blocks = np.concatenate([np.full(len(part), part.block) for part in parts])
        end = position + len(rows)
        yield Measured(rows, blocks, motion[position:end], covariances[run[position]])
        position = end


def _windows(chunks: Iterable[Rows]) -> Iterator[list[Rows]]:
    """Neighbouring chunks of one run together, until there are WINDOW rows."""
    parts: list[Rows] = []
    for chunk in chunks:
        if parts and (chunk.first or sum(map(len, parts)) >= WINDOW):
            yield parts
            parts = []
        parts.append(chunk)
    yield parts


def joined(covariance: Array) -> Array:
    """Of q, v, a of each joint (n, 3, 3) → of all q, then v, then a (3 n, 3 n)."""
    n = len(covariance)
    together = np.zeros((3, n, 3, n))
    for j, own in enumerate(covariance):
        together[:, j, :, j] = own
    return together.reshape(3 * n, 3 * n)


def _motion(problem: Problem) -> tuple[Samples, list[Array], NDArray[np.int64]]:
    """The rows that count of all that the filters leave; the covariance of the errors of every run; each row's run."""
    parts, covariances, lengths = list[Samples](), list[Array](), list[int]()
    for run in runs([problem.data] if isinstance(problem.data, Samples) else problem.data):
        pieces = list(run.samples)
        if any(piece.base is not None for piece in pieces):
            raise EstimationFailed("the base of the recording moves; errors of the motion know a base at rest only")
        if pieces[0].motion_covariance is None:
            raise EstimationFailed(NO_ERRORS)
        covariances.append(joined(pieces[0].motion_covariance))
        left = joined_samples(pieces, slice(None, None, 1 if run.row_filter is None else run.row_filter.factor))
        parts.append(left)
        lengths.append(len(left))
    of_run = np.repeat(np.arange(len(lengths)), lengths)
    return joined_samples(parts, problem.chosen(np.arange(len(of_run)))), covariances, problem.chosen(of_run)
