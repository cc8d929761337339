"""Masses of CAD that a recording contradicts: a limit by CAD must not hide that CAD is wrong.

A mass at its limit may be one that the recording does not determine, or one that it determines elsewhere. To tell, the
limit of this mass is given up, then those of all, and the fits predict the time blocks that they have not seen. CAD is
contradicted if the free fit predicts them better by MIN_GAIN, by more than MIN_DEVIATIONS deviations of the mean over
the folds, and if the mass that it takes lies outside of the limit by MIN_DEVIATIONS of its own (jackknife over the
folds). A free fit takes the mass that fits and is nearest to CAD, the end of the profile of this mass.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import joint_noise, merged
from graphdyn.identification.bodies.limits import PhysicalLimits
from graphdyn.identification.consistent.program import ConsistentProgram
from graphdyn.identification.estimators.consistent import PRIOR_STRENGTHS
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

MIN_DEVIATIONS = 3.0
"""Smallest difference in its own standard deviations: of nine degrees of freedom, one in seventy passes by chance."""

MIN_GAIN = 0.02
"""Smallest part of the squared prediction error that vanishes: less may be a term that the torque model lacks."""

MAX_LEFT = 0.8
"""Largest part of the error that one mass alone leaves, if all together count: several masses of CAD are then wrong."""


@dataclass(frozen=True)
class ContradictedMass:
    """A mass that CAD states, and that the recording contradicts.

    body: empty for all masses together, whose sum the numbers are
    cad, limit: mass by CAD, and the one within the limits  [kg]
    mass, deviation: of the fit without limits of this mass, of those that fit the one nearest to CAD    [kg]
    gain: part of the squared error of blocks that were not fitted, which vanishes without the limit
    """

    body: str
    cad: float
    limit: float
    mass: float
    deviation: float
    gain: float

    @property
    def factor(self) -> float:
        """Ratio of the mass and that of CAD, in the direction in which it is above 1."""
        return max(self.mass / self.cad, self.cad / self.mass)


def contradicted_masses(problem: Problem, limits: PhysicalLimits) -> tuple[ContradictedMass, ...]:
    """Masses of CAD that the recording contradicts, the one with the largest gain first; none without unknown bodies.

    limits: those of the methods; a mass that they state outright counts like that of CAD
    """
    try:
        return _contradicted(problem, limits)
    except EstimationFailed:  # no unknown body, too few time blocks, no fit within the limits: nothing can be told
        return ()


def _contradicted(problem: Problem, limits: PhysicalLimits) -> tuple[ContradictedMass, ...]:
    bounded = _Fits.of(problem, limits)
    reached = bounded.at_limit
    together = _tested(problem, bounded, limits, "") if reached else None
    if together is None:
        return ()
    names = [name for name in reached if name]
    found = [each for name in names if (each := _tested(problem, bounded, limits, name))]
    left = 1 - max((each.gain for each in found), default=0.0)
    if 1 - together.gain < MAX_LEFT * left:
        return (together,)
    return tuple(sorted(found, key=lambda each: -each.gain))


def _tested(problem: Problem, bounded: _Fits, limits: PhysicalLimits, name: str) -> ContradictedMass | None:
    """What the recording has against this mass of CAD, or against all together; None if nothing."""
    try:
        free = _Fits.of(problem, _without(limits, name))
    except EstimationFailed:  # the other limits cost so much that their fit is at the precision of the solver
        return None
    gain, deviation = bounded.gain_of(free)
    (mass, spread), (limit, _) = free.mass_of(name), bounded.mass_of(name)
    if not (gain > max(MIN_GAIN, MIN_DEVIATIONS * deviation) and abs(mass - limit) > MIN_DEVIATIONS * spread):
        return None
    return ContradictedMass(name, bounded.cad_of(name), limit, mass, spread, gain)


def _without(limits: PhysicalLimits, name: str) -> PhysicalLimits:
    """The limits without those of this mass; without those of any mass for an empty name."""
    if not name:
        return replace(limits, mass={}, total_mass=None, cad_factor=np.inf, cad_factors={})
    others = {body: bounds for body, bounds in limits.mass.items() if body != name}
    return replace(limits, mass=others, cad_factors={**limits.cad_factors, name: np.inf})


@dataclass(frozen=True, eq=False)
class _Fits:
    """Fits to all folds and to all but one.

    whole: parameters (p,); parts: without each fold (folds, p); errors: of the predicted folds (folds,)
    """

    program: ConsistentProgram
    whole: Array
    parts: Array
    errors: Array

    @classmethod
    def of(cls, problem: Problem, limits: PhysicalLimits) -> _Fits:
        """Fit with the weakest prior of the methods, which leaves most to the recording."""
        program = ConsistentProgram(problem, None, "entropic", limits=limits)
        noise, folds, strength = joint_noise(problem.equations), problem.folds, PRIOR_STRENGTHS[0]
        if len(folds) < 2:
            raise EstimationFailed("one time block alone cannot be predicted")
        whole = program.convex(problem.equations, noise).solve(strength).parameters
        parts, errors = [], []
        for k, fold in enumerate(folds):
            fit = program.convex(merged([*folds[:k], *folds[k + 1 :]]), noise).solve(strength)
            parts.append(fit.parameters)
            errors.append(float(np.sum(fold.residual_squares(problem.base.values(fit.parameters)) / noise**2)))
        return cls(program, whole, np.array(parts), np.array(errors))

    @property
    def at_limit(self) -> list[str]:
        """Bodies with a mass at a limit by CAD; an empty name for the total mass."""
        limits = self.program.body_limits
        reached = [each for each in limits.reached(self.whole) if each.quantity in ("mass", "total mass")]
        known = dict(zip(limits.names, np.isfinite(limits.cad_mass), strict=True))
        return [each.body for each in reached if known.get(each.body, True)]

    def gain_of(self, free: _Fits) -> tuple[float, float]:
        """Part of the squared error that vanishes with the other fits, and its standard deviation over the folds."""
        apart, size = self.errors - free.errors, self.errors.sum()
        return float(apart.sum() / size), float(np.std(apart, ddof=1) * np.sqrt(len(apart)) / size)

    def mass_of(self, name: str) -> tuple[float, float]:
        """Mass of a body, or of all for an empty name, and its standard deviation by the jackknife [kg]."""
        columns, n = self._masses(name), len(self.parts)
        parts = self.parts[:, columns].sum(axis=1)
        deviation = np.sqrt((n - 1) / n * np.sum((parts - parts.mean()) ** 2))
        return float(self.whole[columns].sum()), float(deviation)

    def cad_of(self, name: str) -> float:
        """Mass by CAD, of what mass_of has [kg]."""
        limits = self.program.body_limits
        chosen = limits.counted if not name else np.array([body == name for body in limits.names])
        return float(np.nansum(limits.cad_mass[chosen]))

    def _masses(self, name: str) -> list[int]:
        limits = self.program.body_limits
        rows = zip(limits.names, limits.columns, limits.counted, strict=True)
        return [part.start for body, part, counts in rows if (body == name if name else counts)]
