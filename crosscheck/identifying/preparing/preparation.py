"""Preparation of a recording for identification: filter, derivatives, decimation, removal of slow rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crosscheck.recordings import Recording, differentiated, samples_of, sampling_rate
from crosscheck.recordings.preparation.derivatives import Cutoff, Differentiation, motion_covariance
from crosscheck.recordings.preparation.filtering import filtered_blocks
from crosscheck.recordings.preparation.resampling import is_even, resampled
from graphdyn.display import short_repr
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.closed_loop import held_torque
from graphdyn.identification.data_quality import Piece
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class Preparation:
    """Settings of the preparation of a recording for the fit.

    cutoff: of the zero-phase low-pass [Hz], as in crosscheck.differentiated; of the torque and of every column of the
        regressor alike
    velocity: "recorded" takes v if there is one, "derived" differentiates q
    decimate: factors of the stages, 2 … 13, of the torque and of every column of the regressor, after the low-pass
    torque_hold: hold time of each recorded torque from its row on; taken at the middle of the hold [s]
    min_speed: rows of joint j with smaller |v_j| are not fitted; one for all joints, or (n,) [rad/s or m/s]
    """

    cutoff: Cutoff = "residual"
    velocity: Literal["recorded", "derived"] = "recorded"
    decimate: tuple[int, ...] = ()
    torque_hold: float = 0.0
    min_speed: ArrayLike = 0.0

    def differentiated(self, recording: Recording) -> Recording:
        """The recording with v and a. Raises InvalidInput without torque, or for too few rows for the filter."""
        return differentiated(self._at_middle_of_hold(recording), self.cutoff, velocity=self.velocity)

    def differentiation(self, recording: Recording) -> Differentiation:
        """The operation of `differentiated` on the motion of a recording."""
        return Differentiation.of(recording, self.cutoff, self.velocity)

    def problem(self, torque_model: TorqueModel, recording: Recording) -> Problem:
        """The problem of a recording that has v and a. Raises InvalidInput if every block is too short."""
        return Problem(torque_model, self.samples(recording), min_speed=self.min_speed)

    def samples(self, recording: Recording) -> list[Samples]:
        """Samples as from crosscheck.samples_of, with the errors of the motion. Raises InvalidInput likewise."""
        blocks = filtered_blocks(recording, self.decimate)
        pieces = zip(samples_of(recording, self.decimate), map(recording.take, blocks), strict=True)
        return [replace(samples, motion_covariance=self._errors(block, samples)) for samples, block in pieces]

    def _errors(self, block: Recording, samples: Samples) -> Array | None:
        """Covariance of the errors of q, v and a of one block, if the noise of its positions is known."""
        if block.q_noise is None or len(block.t) < 2:
            return None
        cutoff = float(block.torque_cutoff[0]) if self.cutoff == "residual" else self.cutoff
        v_noise = None if block.v_noise is None else block.v_noise[0]
        low = Differentiation.of(block, cutoff, "derived" if v_noise is None else "recorded")
        return motion_covariance(low, samples.row_filter, sampling_rate(block), block.q_noise[0], v_noise)

    def part(self, problem: Problem, recording: Recording, rows: NDArray[np.bool_]) -> tuple[Problem, list[Array]]:
        """The problem of some rows (N,) of a recording from that of all, filtered as a whole, and their times."""
        blocks = filtered_blocks(recording, self.decimate)
        used = [rows[block][:: prod(self.decimate)] for block in blocks]
        times = [t[here] for t, here in zip(self.times(recording), used, strict=True) if here.any()]
        return problem.part(np.concatenate(used)), times

    def pieces(self, recording: Recording) -> tuple[list[Piece], list[Array]]:
        """Uninterrupted pieces of a recording as it was read, q, v, a and tau low-passed alike, not decimated.

        The second item is their torques without a filter. Channels that were to stay as they are get the lowest cutoff
        of the others. Raises InvalidInput as differentiated.
        """
        cutoff = min(self.cutoff.values()) if isinstance(self.cutoff, Mapping) else self.cutoff
        prepared = differentiated(self._at_middle_of_hold(recording), cutoff, velocity=self.velocity)
        period = 1 / sampling_rate(prepared)
        pieces, torques = [], []
        for samples in samples_of(prepared):
            torques.append(samples.tau)
            tau = samples.tau if samples.row_filter is None else samples.row_filter(samples.tau)
            pieces.append(Piece(replace(samples, tau=tau, row_filter=None), period))
        return pieces, torques

    def _at_middle_of_hold(self, recording: Recording) -> Recording:
        tau = recording.channel("tau")
        if not self.torque_hold:
            return recording
        if not is_even(recording):
            recording = resampled(recording)
            tau = recording.channel("tau")
        period = 1 / sampling_rate(recording)
        parts = [held_torque(tau[rows], period, self.torque_hold) for rows in recording.block_slices]
        return recording.take(
            slice(None), f"tau in the middle of a hold of {self.torque_hold:g} s", tau=np.concatenate(parts)
        )

    def times(self, recording: Recording) -> list[Array]:
        """Time of the rows of the problem, block by block (N_k,) [s]."""
        return [recording.t[rows][:: prod(self.decimate)] for rows in filtered_blocks(recording, self.decimate)]
