"""The error of a result: per joint, over the rows in which it moves, and on the mean over the joints."""

from __future__ import annotations

import numpy as np

from graphdyn.identification import MethodResult, ResidualStatistics
from graphdyn.layout import Array

LEAST_ROWS = 50
"""Smallest number of moving rows of a joint; with fewer, its error is taken over all rows."""


def joint_errors(statistics: ResidualStatistics) -> Array:
    """‖e‖ / ‖τ‖ per joint (n,): over the rows in which it moves, or over all rows if these are too few."""
    enough = statistics.moving.count >= LEAST_ROWS
    return np.where(enough, statistics.moving.relative, statistics.everything.relative)


def mean_error(result: MethodResult) -> float:
    """Mean over the joints of the held-out error, or of the training error where nothing was held out."""
    statistics = result.held_out or result.training
    return float(np.nanmean(joint_errors(statistics))) if statistics is not None else float("nan")
