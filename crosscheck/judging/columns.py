"""Columns of a foreign regressor: the order of the ten parameters, and factors on them."""

from __future__ import annotations

import numpy as np

from crosscheck.judging.fits import ROUND, FittedFault
from graphdyn._inertia import PARAMETER_NAMES
from graphdyn.layout import BODY_PARAMETERS, Array

ALIKE = 1e-6
"""Part of a column that may remain after subtracting a multiple of another one to count as that multiple."""


def column_fault(answer: Array, ours: Array) -> FittedFault | None:
    """The fault that columns are ours in another order or scale; None if they are not. answer, ours: (N, n, 10n)."""
    there, here = (_by_parameter(regressor) for regressor in (answer, ours))
    places, factors, left = [], [], 0.0
    for column in there:
        sizes = (here**2).sum(axis=1)
        factor = np.divide(here @ column, sizes, out=np.zeros_like(sizes), where=sizes > 0)
        rest = np.abs(column - factor[:, None] * here).max(axis=1) / (np.abs(column).max() or 1.0)
        best = int(rest.argmin())
        if rest[best] > ALIKE:
            return None
        places.append(best)
        factors.append(float(factor[best]))
        left = max(left, float(rest[best]))
    if sorted(places) != list(range(BODY_PARAMETERS)):
        return None
    wrong = [
        f"{PARAMETER_NAMES[place]} × {factor:.4g}"
        for place, factor in zip(places, factors, strict=True)
        if abs(factor - 1) > ROUND
    ]
    remedy = f"use {', '.join(PARAMETER_NAMES)} about the link origin"
    if places != list(range(BODY_PARAMETERS)):
        named = ", ".join(PARAMETER_NAMES[place] for place in places)
        scaled = f", scaled: {', '.join(wrong)}" if wrong else ""
        message = f"the ten columns of each body are in the order {named}{scaled}"
        return FittedFault("parameter_order", message, remedy, left)
    if wrong:
        return FittedFault("parameter_order", f"columns are scaled: {', '.join(wrong)}", remedy, left)
    return None


def _by_parameter(regressor: Array) -> Array:
    """All entries that belong to each of the ten parameters: (N, n, 10n) → (10, N n n)."""
    return np.moveaxis(regressor.reshape(*regressor.shape[:2], -1, BODY_PARAMETERS), -1, 0).reshape(BODY_PARAMETERS, -1)
