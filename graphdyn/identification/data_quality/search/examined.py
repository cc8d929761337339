"""A recording under examination: its thinned rows, its fit, and its delays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns
from graphdyn.identification.data_quality.delays.torque_delays import Lag, lag
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.thinning import Piece, ThinnedRecording
from graphdyn.identification.data_quality.trials.trials import Part
from graphdyn.identification.problem.torque_model import TorqueModel

MIN_KEPT_SHARE = 0.05
"""Part of the rows of a joint that must be faster than the smallest speed; otherwise all of them count: it may be the
unit of the angles that makes it slow."""


@dataclass(frozen=True, eq=False)
class Examined:
    """A recording, as it is or after changes.

    min_speed: of the rows that count for a joint, (n,) or one for all
    without: joints whose torque does not count
    fit, delays: of the thinned rows
    """

    torque_model: TorqueModel
    pieces: Sequence[Piece]
    min_speed: ArrayLike
    without: tuple[int, ...]
    thinned: ThinnedRecording
    fit: BoundedFit
    delays: Lag

    @classmethod
    def of(
        cls,
        torque_model: TorqueModel,
        pieces: Sequence[Piece],
        min_speed: ArrayLike,
        without: tuple[int, ...] = (),
    ) -> Examined:
        """The recording of these pieces. min_speed: as in Problem"""
        thinned = ThinnedRecording(pieces)
        kept = np.abs(thinned.samples.v) >= min_speed
        resting = kept.mean(axis=0) < MIN_KEPT_SHARE
        counted = (kept | resting) & ~np.isin(np.arange(kept.shape[1]), without)
        fit = BoundedFit.of(torque_model, thinned.samples, counted)
        return cls(torque_model, pieces, min_speed, without, thinned, fit, lag(torque_model, thinned, fit))

    @property
    def samples(self) -> Samples:
        return self.thinned.samples

    @cached_property
    def part(self) -> Part:
        rate = self.thinned.torque_rate(np.zeros(self.samples.tau.shape[1]))
        return Part(self.torque_model, self.samples, self.fit, rate)

    def with_derived_velocities(self) -> Examined:
        """The recording with velocities and accelerations from its positions."""
        pieces = [piece.derived() for piece in self.pieces]
        return Examined.of(self.torque_model, pieces, self.min_speed, self.without)

    def after(self, changes: Sequence[Change], columns: RecordedColumns) -> Examined:
        """The recording after some changes, one after the other."""
        if not changes:
            return self
        model, pieces = self.torque_model, self.pieces
        for change in changes:
            model, pieces = change.under_gravity(model), [undone(piece, change, columns) for piece in pieces]
        return Examined.of(model, pieces, self.min_speed, self.without)


def undone(piece: Piece, change: Change, columns: RecordedColumns) -> Piece:
    """The piece after a change."""
    if change.kind == "late torque":
        n = len(columns.zero)
        seconds = np.zeros(n)
        seconds[list(change.joints)] = change.factor
        return piece.later(seconds)
    period = piece.period * change.factor if change.kind == "time scale" else piece.period
    return replace(piece, samples=change.applied(piece.samples, columns), period=period)
