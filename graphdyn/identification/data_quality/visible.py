"""The smallest faults that a recording would show, of each kind and joint, from its own fit.

Each fault is planted in the recording as it is after corrections. It shows if Σ log ‖e_j‖ rises by as much as a change
must gain to be a fault (search/deciding.py). Between the sizes that are planted the rise is interpolated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.display import short_repr
from graphdyn.identification.data_quality.causes.sizes import SizedChange
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
@short_repr
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
    tau = few.samples.tau
    progress = np.linspace(-0.5, 0.5, len(tau))

    def of_each(sizes: Sequence[float], planted: Callable[[int, float], Array]) -> Array:
        """The sizes of every torque, larger of both signs. planted: torque (N,) of a joint, of a size with its sign"""

        def visible(j: int, sign: float) -> float:
            torques = ((size, planted(j, sign * size)) for size in sizes)
            misfits = ((size, few.free_fit.misfit_of_torque(j, torque)) for size, torque in torques)
            return first_crossing(((size, misfit - few.misfit) for size, misfit in misfits), needed)

        return np.array([max(visible(j, 1.0), visible(j, -1.0)) for j in range(n)])

    rows = slice(None, None, EVERY_SCREENED_ROW)
    return VisibleSizes(
        zeros=np.array([_of_curve(curves, "zero", j, needed) for j in range(n)]),
        gear_ratios=np.array([_of_curve(curves, "gear ratio", j, needed) for j in range(n)]),
        torque_gains=of_each(PLANTED_SHARES, lambda j, x: tau[:, j] * (1 + abs(x)) ** np.sign(x)),
        torque_drifts=of_each(PLANTED_SHARES, lambda j, x: tau[:, j] * (1 + x * progress)),
        delays=of_each(PLANTED_DELAYS, lambda j, x: thinned.torque_of(j, x)[rows]),
        tilt=_tilt(few, needed),
        clock=_of_curve(curves, "time scale", 0, needed),
        load=_load(few, needed),
    )


def first_crossing(rises: Iterable[tuple[float, float]], needed: float) -> float:
    """The size from which the rise is large enough, between two that were planted; ∞ if it never is.

    rises: sizes, increasing, without zero, and the rise of Σ log ‖e_j‖ for each; asked up to the first that is enough
    """
    before, low = 0.0, 0.0
    for size, rise in rises:
        if rise >= needed:
            return float(low + (size - low) * (needed - before) / (rise - before)) if rise > before else float(size)
        before, low = rise, size
    return float("inf")


def _of_curve(curves: Sequence[Curve], kind: str, joint: int, needed: float) -> float:
    """The smallest size of a change of unknown size that shows on both sides; NaN without such a change."""
    own = [curve for curve in curves if curve.change.kind == kind and curve.change.joints[0] == joint]
    if not own:
        return float("nan")
    change, curve = own[0].change, own[0]
    rises = [
        (_distance(change, size), size > change.unchanged, rise)
        for size, rise in zip(curve.sizes, curve.rises.tolist(), strict=True)
        if size != change.unchanged
    ]
    sides = (sorted((size, rise) for size, above, rise in rises if above is side) for side in (True, False))
    return max(first_crossing(side, needed) for side in sides)


def _distance(change: SizedChange, size: float) -> float:
    """Distance of a size from no change: an angle [°], or the larger factor of two - 1."""
    if change.kind == "zero":
        return abs(size)
    return max(size, 1 / size) - 1


def _tilt(few: Part, needed: float) -> float:
    """The smallest tilt that shows about every horizontal axis."""
    given = few.gravity_fit.given
    size = float(np.linalg.norm(given))
    if size == 0:
        return float("nan")
    across = np.linalg.svd(given[None])[2][1:]

    def rise(degrees: float, axis: Array) -> float:
        angle = np.deg2rad(degrees)
        return few.gravity_fit.misfit(np.cos(angle) * given + np.sin(angle) * size * axis) - few.misfit

    axes = (across[0], -across[0], across[1], -across[1])
    return max(first_crossing(((tilt, rise(tilt, axis)) for tilt in PLANTED_TILTS), needed) for axis in axes)


def _load(few: Part, needed: float) -> float:
    bodies = few.torque_model.slice_of(RigidBodies)
    if bodies is None:
        return float("nan")
    of_mass = few.fit.matrix[..., bodies.stop - BODY_PARAMETERS]
    after = (np.arange(len(of_mass)) >= len(of_mass) // 2)[:, None]
    torques = ((mass, few.samples.tau + mass * of_mass * after) for mass in PLANTED_LOADS)
    misfits = ((mass, few.free_fit.misfit_of_torques(torque)) for mass, torque in torques)
    return first_crossing(((mass, misfit - few.misfit) for mass, misfit in misfits), needed)
