"""Trials of what may have changed during a recording."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from graphdyn.identification.data_quality.causes.additions import (
    DISSIPATING_TERMS,
    Addition,
    additions,
    columns_of,
)
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.held_out import held_out_squares
from graphdyn.identification.data_quality.fits.size_deviation import covariance
from graphdyn.identification.data_quality.trials.trials import MIN_HINT_GAIN, Part, cad_misfit, worth_from
from graphdyn.layout import Array

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class AdditionTrial:
    """An addition that was tried.

    gained, errors, cad_misfit, held_out: as in ChangeTrial
    parameters: of its columns (c,); deviation_of_size: computes the standard deviation of the first of them
    """

    addition: Addition
    gained: float
    errors: Array
    cad_misfit: Callable[[], float]
    held_out: Callable[[], Array]
    parameters: Array
    deviation_of_size: Callable[[], float]


def tried_additions(part: Part, changed: float = 0.0) -> Iterator[AdditionTrial]:
    """Trials of what may have changed; of each kind and joint the best one, if it promises a gain.

    changed: gain of the best change of the whole recording
    """
    few = part.screened
    best: dict[tuple[str, tuple[int, ...]], tuple[float, int]] = {}
    for k, addition in enumerate(additions(few.torque_model, few.fit, few.samples.tau, few.torque_rate)):
        log.info("torque that may be added, %d", k + 1)
        gained = few.misfit - few.free_fit.misfit_with(addition.columns)
        best[addition.kind, addition.joints] = max(best.get((addition.kind, addition.joints), (0.0, k)), (gained, k))
    least = max(MIN_HINT_GAIN, worth_from(max((changed, *(gained for gained, _ in best.values())))))
    chosen = {k for gained, k in best.values() if gained > least}
    if not chosen:
        return
    before = part.fit.errors(part.samples.tau)
    for k, addition in enumerate(additions(part.torque_model, part.fit, part.samples.tau, part.torque_rate)):
        if k in chosen:
            found = _trial(part, addition, before)
            if found is not None:
                yield found


def _drives(part: Part, addition: Addition, x: Array) -> bool:
    """Whether the friction of each of its joints drives: that of some joints alone has another cause.

    x: parameters of the torque model, then those of the addition
    """
    dissipating = columns_of(part.torque_model, DISSIPATING_TERMS)
    friction = part.fit.matrix[..., dissipating] @ x[dissipating] + addition.columns @ x[-addition.columns.shape[-1] :]
    power = np.sum(np.where(part.fit.kept, friction * part.samples.v, 0.0), axis=0)
    return bool(np.all(power[list(addition.joints)] < 0))


def _trial(part: Part, addition: Addition, before: Array) -> AdditionTrial | None:
    """The trial of an addition; None for a low-pass that leads, and for subtracted friction that does not drive."""
    tau = part.samples.tau
    fit = part.fit.extended(addition.columns, body=addition.body)
    errors, x = fit.errors(tau), fit.parameters(tau)
    own = x[-addition.columns.shape[-1] :]
    if addition.kind == "filtered torque" and own[0] <= 0:
        return None
    if addition.kind == "friction subtracted" and not _drives(part, addition, x):
        return None
    spread = addition.spread(own)
    gained = float(np.sum(np.log(before / errors))) + spread

    def deviation() -> float:
        return float(np.sqrt(covariance(part.fit, fit.residual(tau, x), addition.columns[None, ..., 0])[0, 0]))

    cad = partial(cad_misfit, part.torque_model, part.samples, part.fit, addition.columns)
    return AdditionTrial(addition, gained, errors, cad, partial(_held_out, fit, tau, addition, spread), own, deviation)


def _held_out(fit: BoundedFit, tau: Array, addition: Addition, spread: float) -> Array:
    """Errors of blocks that were not fitted, those of torques that drift in units of the recorded ones."""
    squares = held_out_squares(fit, tau)
    squares[:, list(addition.joints)] *= np.exp(-2 * spread / len(addition.joints))
    return squares
