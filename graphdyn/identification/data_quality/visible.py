"""The smallest faults that a recording would show, of each kind and joint, from its own fit.

Each fault is planted in the recording as it is after corrections. It shows if Σ log ‖e_j‖ rises by as much as a change
must gain to be a fault (searching.py). Between the sizes that are planted the rise is interpolated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.identification.data_quality.causes.gravity import GravityFit
from graphdyn.identification.data_quality.causes.sizes import SizedChange
from graphdyn.identification.data_quality.fits.free_fit import gram_misfit, grams
from graphdyn.identification.data_quality.fits.thinning import ThinnedRecording
from graphdyn.identification.data_quality.trials.refining import Curve
from graphdyn.identification.data_quality.trials.trials import EVERY_SCREENED_ROW, Part
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import BODY_PARAMETERS, Array

PLANTED_SHARES = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0)
"""Shares by which torques are planted too large, too small, or growing."""

PLANTED_DELAYS = (0.005, 0.01, 0.02, 0.04, 0.08, 0.15)
"""Delays that are planted [s]."""

PLANTED_TILTS = (2.0, 5.0, 10.0, 20.0, 45.0, 90.0, 135.0)
"""Angles by which the mounting is planted wrong [°]."""

PLANTED_LOADS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
"""Masses, in the origin of the last link, that are planted from the middle on [kg]."""


@dataclass(frozen=True, eq=False)
class VisibleSizes:
    """Smallest sizes of faults that a recording shows; ∞ where it shows none of the sizes that were planted.

    zeros: of joints, NaN for those that slide                       (n,) [°]
    gear_ratios, torque_gains, torque_drifts: relative error; of a drift, from begin to end (n,)
    delays: of single torques                                       (n,) [s]
    tilt: of the mounting about the horizontal axis that shows it least [°]
    clock: relative error of the rate
    load: attached in the middle, at the origin of the last link    [kg]
    """

    zeros: Array
    gear_ratios: Array
    torque_gains: Array
    torque_drifts: Array
    delays: Array
    tilt: float
    clock: float
    load: float


def visible_sizes(part: Part, thinned: ThinnedRecording, curves: Sequence[Curve], needed: float) -> VisibleSizes:
    """Visible sizes of a corrected recording.

    part, thinned: its rows; curves: over the sizes of changes; needed: rise of Σ log ‖e_j‖ that shows a fault
    """
    few, n = part.screened, part.samples.q.shape[1]
    tau, unit = few.samples.tau, np.eye(n)
    progress = np.linspace(-0.5, 0.5, len(tau))[:, None]

    def planted(sizes: Sequence[float], spoilt: Callable[[float], Array]) -> float:
        rises = []
        for size in sizes:
            torque = spoilt(size)
            misfit = gram_misfit(grams(few.fit.matrix, torque - few.fit.known, torque, few.fit.kept))
            rises.append(misfit - few.misfit)
        return first_crossing(sizes, rises, needed)

    def of_each(sizes: Sequence[float], spoilt: Callable[[float, Array], Array]) -> Array:
        """The sizes of every torque, larger of both signs. spoilt: torques, of a size and the joint's unit vector"""
        each = [[planted(sizes, lambda x, e=e: spoilt(x, e)) for e in (axis, -axis)] for axis in unit]  # type: ignore[misc]
        return np.asarray(np.max(each, axis=1), dtype=float)

    rows = slice(None, None, EVERY_SCREENED_ROW)
    return VisibleSizes(
        zeros=np.array([_of_curve(curves, "zero", j, needed) for j in range(n)]),
        gear_ratios=np.array([_of_curve(curves, "gear ratio", j, needed) for j in range(n)]),
        torque_gains=of_each(PLANTED_SHARES, lambda x, axis: tau * np.exp(np.log1p(x) * axis)),
        torque_drifts=of_each(PLANTED_SHARES, lambda x, axis: tau * (1 + x * progress * axis)),
        delays=of_each(PLANTED_DELAYS, lambda x, axis: thinned.torque(x * axis)[rows]),
        tilt=_tilt(few, needed),
        clock=_of_curve(curves, "time scale", 0, needed),
        load=_load(few, planted),
    )


def first_crossing(sizes: Sequence[float], rises: Sequence[float], needed: float) -> float:
    """The size from which the rise is large enough, between two that were planted; ∞ if it never is.

    sizes: increasing, without zero (k,); rises: of Σ log ‖e_j‖ (k,)
    """
    before, low = 0.0, 0.0
    for size, rise in zip(sizes, rises, strict=True):
        if rise >= needed:
            return float(low + (size - low) * (needed - before) / (rise - before)) if rise > before else float(size)
        before, low = min(rise, needed), size
    return float("inf")


def _of_curve(curves: Sequence[Curve], kind: str, joint: int, needed: float) -> float:
    """The smallest size of a change of unknown size that shows on both sides; NaN without such a change."""
    own = [curve for curve in curves if curve.change.kind == kind and curve.change.joints[0] == joint]
    if not own:
        return float("nan")
    change, curve = own[0].change, own[0]
    distance = np.array([_distance(change, size) for size in curve.sizes])
    above, below = np.array(curve.sizes) > change.unchanged, np.array(curve.sizes) < change.unchanged
    return max(
        first_crossing(distance[above].tolist(), curve.rises[above].tolist(), needed),
        first_crossing(distance[below][::-1].tolist(), curve.rises[below][::-1].tolist(), needed),
    )


def _distance(change: SizedChange, size: float) -> float:
    """Distance of a size from no change: an angle [°], or the larger factor of two - 1."""
    if change.kind == "zero":
        return abs(size)
    return max(size, 1 / size) - 1


def _tilt(few: Part, needed: float) -> float:
    """The smallest tilt that shows about every horizontal axis."""
    search = GravityFit(few.torque_model, few.samples, few.fit.kept)
    size = float(np.linalg.norm(search.given))
    if size == 0:
        return float("nan")
    across = np.linalg.svd(search.given[None])[2][1:]
    found = []
    for axis in (across[0], -across[0], across[1], -across[1]):
        rises = []
        for degrees in PLANTED_TILTS:
            angle = np.deg2rad(degrees)
            rises.append(search.misfit(np.cos(angle) * search.given + np.sin(angle) * size * axis) - few.misfit)
        found.append(first_crossing(PLANTED_TILTS, rises, needed))
    return max(found)


def _load(few: Part, planted: Callable[[Sequence[float], Callable[[float], Array]], float]) -> float:
    bodies = few.torque_model.slice_of(RigidBodies)
    if bodies is None:
        return float("nan")
    of_mass = few.fit.matrix[..., bodies.stop - BODY_PARAMETERS]
    after = (np.arange(len(of_mass)) >= len(of_mass) // 2)[:, None]
    return planted(PLANTED_LOADS, lambda mass: few.samples.tau + mass * of_mass * after)
