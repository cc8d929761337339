"""From a recording to the equations of identification: filter, derivatives, decimation, slow rows left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Literal

from numpy.typing import ArrayLike

from crosscheck.recordings import Recording, decimated_columns, differentiated
from crosscheck.recordings.decimation import rows_needed
from crosscheck.recordings.derivatives import Cutoff
from graphdyn import InvalidInput
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Preparation:
    """How a recording is prepared for the fit.

    cutoff: of the zero-phase low-pass [Hz], as in crosscheck.differentiated
    velocity: "recorded" takes v where there is one, "derived" differentiates q
    decimate: factors of the stages, 2 … 13; torque and every column of the regressor go through the same filter
    min_speed: rows of joint j with smaller |v_j| are not fitted; one for all joints, or (n,) [rad/s or m/s]
    """

    cutoff: Cutoff = "residual"
    velocity: Literal["recorded", "derived"] = "recorded"
    decimate: tuple[int, ...] = ()
    min_speed: ArrayLike = 0.0

    def differentiated(self, recording: Recording) -> Recording:
        """With v and a. Raises InvalidInput where there is no torque, or the recording is too short for the filter."""
        recording.channel("tau")
        return differentiated(recording, self.cutoff, velocity=self.velocity)

    def problem(self, torque_model: TorqueModel, recording: Recording) -> Problem:
        """The problem of a recording that has v and a. Raises InvalidInput where every block is too short."""
        pieces = [samples_of(recording.take(rows)) for rows in self._blocks(recording)]
        row_filter = (lambda columns: decimated_columns(columns, self.decimate)) if self.decimate else None
        return Problem(torque_model, pieces, min_speed=self.min_speed, row_filter=row_filter)

    def times(self, recording: Recording) -> list[Array]:
        """Time of the rows of the problem, block by block (N_k,) [s]."""
        return [recording.t[rows][:: prod(self.decimate)] for rows in self._blocks(recording)]

    def _blocks(self, recording: Recording) -> Sequence[slice]:
        """The blocks that are long enough to be decimated."""
        needed = rows_needed(self.decimate) if self.decimate else 1
        blocks = [rows for rows in recording.block_slices if rows.stop - rows.start >= needed]
        if not blocks:
            raise InvalidInput(
                f"{', '.join(recording.provenance.files)}: no block has the {needed} rows that decimation by "
                f"{self.decimate} needs; use smaller factors, or hold out less"
            )
        return blocks


def samples_of(recording: Recording) -> Samples:
    """A recording as samples of graphdyn.identification. Raises InvalidInput for a missing channel."""
    q, v, a, tau = (recording.channel(name) for name in ("q", "v", "a", "tau"))
    return Samples(q, v, a, tau)
