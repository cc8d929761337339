"""Linearized torques of the simulated loop: the equations of one Gauss-Newton step.

S_g dx ≈ τ_g - τ_g(x)     for every joint g, S_g = dτ_g/dx or its approximation
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.identification.algebra.solution import leverages, residual_deviations, solve
from graphdyn.identification.closed_loop.beside import RowBlock
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class OutputFit:
    """x (r,) after the step, its covariance (r, r), noise of each joint (n,), and the equations of every time block."""

    x: Array
    covariance: Array
    noise: Array
    change: Array
    blocks: tuple[CompressedEquations, ...]

    @property
    def block_covariance(self) -> Array | None:
        """Covariance (r, r) that allows for correlation in time."""
        return jackknife_covariance(self.blocks, self.change, self.noise)


def output_step(problem: Problem, x: Array, parts: Iterable[RowBlock], noise: Array | None) -> OutputFit:
    """One step from base parameters x (r,).

    parts: with S as their regressor, and τ(x) as their output; noise: as given, None if it is to be estimated (n,)
    """
    blocks: dict[int, Accumulator] = defaultdict(lambda: Accumulator(problem.base.rank, problem.n_joints))
    for part in parts:
        left = part.measured.measured - part.output
        blocks[part.measured.block].add(part.regressor, left, kept=part.measured.kept)
    equations = tuple(accumulator.compressed for _, accumulator in sorted(blocks.items()))
    together = replace(merged(equations), noise=noise)
    even = np.full(problem.n_joints, problem.base.rank / problem.n_joints)
    start = np.sqrt(together.measured_squares / np.maximum(together.counts, 1)) + np.finfo(float).tiny
    noise = residual_deviations(together, together.residual_squares(solve(together, start).x), even)
    solution = solve(together, noise)
    noise = residual_deviations(
        together, together.residual_squares(solution.x), leverages(together, noise, solution.inverse)
    )
    return OutputFit(x + solution.x, solution.inverse, noise, solution.x, equations)
