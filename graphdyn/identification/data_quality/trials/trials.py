"""Trials of changes: how much better the equations of motion fit after each of them.

Few rows and no bounds decide which changes are worth a fit within bounds (free_fit.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns
from graphdyn.identification.data_quality.causes.gravity import GravityFit
from graphdyn.identification.data_quality.channels.measured_torque import gains, misfits_in_units
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.fits.free_fit import FreeFit, Motion, free_misfits
from graphdyn.identification.data_quality.fits.held_out import HELD_OUT_BLOCKS, held_out_squares
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MIN_MISFIT_RISE = 0.25
"""Rise of Σ log ‖e_j‖ below which a recording cannot reveal that a change would be wrong."""

MIN_HINT_GAIN = 0.3
"""Fall of Σ log ‖e_j‖ from which a change is worth a hint; on clean recordings none has more than 0.25."""

MIN_COMPARED_GAIN = 0.1
"""Fall of Σ log ‖e_j‖ from which a change may be compared with others; the fits of others are not kept."""

KINDS_THAT_CAD_SHOWS = ("gravity subtracted",)
"""Kinds of changes that the fit of CAD shows, and no other: what subtracted gravity leaves looks like light links."""

CLEAR_GAIN, COMPARED_SHARE = 2.0, 0.3
"""Fall of Σ log ‖e_j‖ from which a recording has a clear fault, and the share of it that the right change gains at
least, when a wrong one gains most in a fit without bounds."""

EVERY_SCREENED_ROW = 3
"""Distance of the examined rows that decide whether a change is worth a fit within bounds."""


@dataclass(frozen=True, eq=False)
class Part:
    """Rows of a recording, and their fit within bounds.

    torque_rate: rate of the measured torque (N, n); None after a change
    """

    torque_model: TorqueModel
    samples: Samples
    fit: BoundedFit
    torque_rate: Array | None = None

    def after(self, change: Change, columns: RecordedColumns) -> Motion:
        """Torque model, samples, and the rows that count, after a change."""
        model, kept = change.under_gravity(self.torque_model), change.followed(self.fit.kept)
        return model, change.applied(self.samples, columns), kept

    @cached_property
    def screened(self) -> Part:
        """Some of the rows."""
        rows = slice(None, None, EVERY_SCREENED_ROW)
        rate = None if self.torque_rate is None else self.torque_rate[rows]
        return Part(self.torque_model, self.samples[rows], self.fit.part(rows), rate)

    @cached_property
    def free_fit(self) -> FreeFit:
        """The fit without bounds."""
        return FreeFit(self.torque_model, self.fit, self.samples.tau)

    @cached_property
    def gravity_fit(self) -> GravityFit:
        """The fit without bounds under any gravity."""
        return GravityFit(self.torque_model, self.samples, self.fit.kept)

    @cached_property
    def misfit(self) -> float:
        """Σ_j log(‖e_j‖ / ‖τ_j‖) of the fit within bounds."""
        return misfit_of(self.fit, self.samples.tau)

    @cached_property
    def cad_misfit(self) -> float:
        """The same of CAD with fitted drives."""
        return cad_misfit(self.torque_model, self.samples, self.fit)

    @cached_property
    def scaled_cad_misfit(self) -> float:
        """The same of CAD in the unit, one for all joints, in which it fits best."""
        return float(min(misfits_in_units(self.torque_model, self.samples, self.fit)))


@dataclass(frozen=True, eq=False)
class ChangeTrial:
    """A change that was tried.

    gained: fall of Σ log ‖e_j‖; errors: ‖e_j‖ / ‖τ_j‖ afterwards (n,)
    unexplained: the same relative to the variation of the torque, geometric mean over the joints
    after: rows and fit after the change; None if it gains too little to be compared with others
    deviation_of_size: computes the standard deviation of a size that was found; None for another change
    """

    change: Change
    gained: float
    errors: Array
    unexplained: float
    after: Part | None
    deviation_of_size: Callable[[], float] | None = None

    @cached_property
    def deviation(self) -> float:
        """Standard deviation of a size that was found, in its unit; NaN for another change."""
        return float("nan") if self.deviation_of_size is None else self.deviation_of_size()

    def cad_misfit(self) -> float:
        """Σ log of the errors of CAD with fitted drives afterwards."""
        return float("nan") if self.after is None else self.after.cad_misfit

    def held_out(self) -> Array:
        """Errors of blocks that were not fitted, afterwards, as of held_out_squares (blocks, n)."""
        if self.after is None:
            return np.full((HELD_OUT_BLOCKS, len(self.errors)), np.nan)
        return held_out_squares(self.after.fit, self.after.samples.tau)


def variation(tau: Array) -> Array:
    """Variation ‖τ_j - mean‖ / ‖τ_j‖ (n,)."""
    size = np.linalg.norm(tau, axis=0)
    return np.asarray(np.linalg.norm(tau - tau.mean(axis=0), axis=0) / np.where(size > 0, size, 1.0))


def tried_changes(part: Part, columns: RecordedColumns, considered: Sequence[Change]) -> Iterator[ChangeTrial]:
    """Trials of those changes after which the recording may fit better, or about as well."""
    few = part.screened
    lower = free_misfits([few.after(change, columns) for change in considered])
    gains = few.misfit - np.array(lower)
    least, before = worth_from(gains.max(initial=0.0)), part.fit.errors(part.samples.tau)
    for k in np.flatnonzero(gains > least).tolist():
        change = considered[k]
        if (found := trial(part, change, columns, before)) is not None:
            yield found


def worth_from(best: float) -> float:
    """Gain of the fit without bounds from which a change is worth a fit within bounds. best: the largest such gain

    Beside a clear fault only those count that gain about as much; else also those that gain nothing, because the
    recording cannot reveal them.
    """
    return COMPARED_SHARE * best if best > CLEAR_GAIN else -MIN_MISFIT_RISE


def misfit_of(fit: BoundedFit, tau: Array) -> float:
    """Σ_j log(‖e_j‖ / ‖τ_j‖) of a fit within bounds. tau: measured (N, n)"""
    return float(np.sum(np.log(fit.errors(tau))))


def fit_of(motion: Motion) -> BoundedFit | None:
    """The fit of a changed motion; None for an impossible one, which a user's term or torque refuses."""
    try:
        return BoundedFit.of(*motion)
    except Exception:
        return None


def trial(part: Part, change: Change, columns: RecordedColumns, before: Array) -> ChangeTrial | None:
    """The trial of a change of this part; None for an impossible motion. before: errors without it (n,)"""
    model, samples, kept = part.after(change, columns)
    fit = fit_of((model, samples, kept)) if change.moves else part.fit
    if fit is None:
        return None
    return trial_of(model, change, before, samples, fit)


def trial_of(model: TorqueModel, change: Change, before: Array, samples: Samples, fit: BoundedFit) -> ChangeTrial:
    """The trial of a change. before: errors without it (n,); samples, fit: after it"""
    errors = fit.errors(samples.tau)

    varies = variation(samples.tau)
    unexplained = float(np.exp(np.mean(np.log(errors / np.where(varies > 0, varies, 1.0)))))
    gained = float(np.sum(np.log(before / errors)))
    compared = gained > MIN_COMPARED_GAIN or change.kind in KINDS_THAT_CAD_SHOWS
    after = Part(model, samples, fit) if compared else None
    return ChangeTrial(change, gained, errors, unexplained, after)


def cad_misfit(model: TorqueModel, samples: Samples, fit: BoundedFit, further: Array | None = None) -> float:
    """Σ_j log(‖e_j‖ / ‖τ_j‖) of CAD with fitted drives. further: columns that belong to no body (N, n, c)"""
    return float(np.nansum(np.log(np.maximum(gains(model, samples, fit, further).without_gain, MIN_RESIDUAL))))
