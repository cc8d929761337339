"""Right equations with other inertial parameters: one linear least squares tells them from wrong equations.

Torques are linear in the parameters. If some parameters give all answers, the equations are right, and the search is
for the mistake that leads to these parameters: at every link, at some of them, or at one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import CodeFault, named
from crosscheck.judging.faults.link_mistakes import LINK_REMEDY, mistakes, shifted
from crosscheck.judging.faults.link_parameters import LINK_PARAMETERS, PlacedInertial
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.observing.observation import Observation
from graphdyn.layout import Array
from graphdyn.model import parallel_axis

SHOWN_SHARE = 1e-10
"""Part of the largest singular value below which torques do not depend on a combination of parameters."""

MIN_ANSWERS_PER_PARAMETER = 1.5
"""Numbers of answers for each combination of parameters that shows, below which a fit proves nothing."""

WHOLE_NUMBER_TOLERANCE = 1e-5
"""Distance of a coefficient from 0 or 1 within which a link has a mistake or not."""

EQUAL_SHARE = 1e-12
"""Relative difference of two mistakes that are one for this robot, such as those in axes that are not turned."""

MAX_OTHER_BODIES = 3
"""Largest number of bodies whose parameters are told one by one."""


class OtherParameters:
    """What the answers say of the inertial parameters.

    fits: whether some parameters give all answers
    """

    def __init__(self, code: DynamicsCode, rows: Observation, bound: float) -> None:
        self._code, self._bound = code, bound
        self.ours = np.concatenate([_of_numbers(code, k) for k in range(len(code.inside))])
        columns = _columns(code, rows)
        target = -rows.residuals([code])[0].ravel()
        size = np.linalg.norm(columns, axis=0)
        self._size = np.where(size > 0, size, 1.0)
        u, s, vt = np.linalg.svd(columns / self._size, full_matrices=False)
        known = s > SHOWN_SHARE * s.max(initial=0.0)
        self.rank = int(known.sum())
        self._map = (s[known, None] * vt[known]) * self._size  # coordinates of a difference of parameters (rank, 13 n)
        self._target = u[:, known].T @ target
        self._largest = bound * np.sqrt(len(target))
        enough = len(target) >= MIN_ANSWERS_PER_PARAMETER * self.rank
        self.fits = enough and bool(np.abs(target - u[:, known] @ self._target).max(initial=0.0) <= bound)

    def explained_by(self, difference: Array) -> bool:
        """Whether a difference of all parameters (13 n,) gives the answers, nearly: to be verified."""
        return bool(np.linalg.norm(self._target - self._map @ difference) <= self._largest)

    def at_links(self, links: Sequence[PlacedInertial], differences: Array) -> list[int] | None:
        """The links at which a mistake was made; None if it explains nothing. differences: what it changes (L, 13)"""
        whole = np.zeros((len(self.ours), len(links)))
        for k, (link, difference) in enumerate(zip(links, differences, strict=True)):
            whole[link.body * LINK_PARAMETERS : (link.body + 1) * LINK_PARAMETERS, k] = difference
        columns = self._map @ whole
        shown = np.flatnonzero(np.linalg.norm(columns, axis=0) > self._largest)
        for chosen in (shown, *(shown[[k]] for k in range(len(shown)))):
            if len(chosen) and np.linalg.norm(self._target - columns[:, chosen].sum(axis=1)) <= self._largest:
                return [int(k) for k in chosen]
        if len(shown) < 2:
            return None
        share = np.linalg.lstsq(columns[:, shown], self._target, rcond=None)[0]
        some = shown[np.abs(share - 1) < WHOLE_NUMBER_TOLERANCE]
        left = np.linalg.norm(self._target - columns[:, some].sum(axis=1))
        return [int(k) for k in some] if len(some) and left <= self._largest else None

    def of_bodies(self) -> list[tuple[int, ...]]:
        """The smallest sets of bodies whose parameters alone give the answers; none if more than a few are needed."""
        n = len(self.ours) // LINK_PARAMETERS
        for size in range(1, MAX_OTHER_BODIES + 1):
            found = [bodies for bodies in itertools.combinations(range(n), size) if self._among(bodies)]
            if found:
                return found
        return []

    def _among(self, bodies: Sequence[int]) -> bool:
        columns = self._map[:, _places(bodies)] / self._size[_places(bodies)]
        solution = np.linalg.lstsq(columns, self._target, rcond=SHOWN_SHARE)[0]
        return bool(np.linalg.norm(self._target - columns @ solution) <= self._largest)

    def faults(self, links: Sequence[PlacedInertial]) -> Iterator[CodeFault]:
        """Mistakes that lead to the parameters that the answers show."""
        seen: list[Array] = []
        for mistake in mistakes():
            differences = mistake.differences(links)
            if any(np.allclose(differences, other, rtol=0, atol=EQUAL_SHARE * np.abs(other).max()) for other in seen):
                continue
            if not np.isfinite(differences).all() or (at := self.at_links(links, differences)) is None:
                continue
            seen.append(differences)
            changing = [k for k, difference in enumerate(differences) if difference.any()]
            every = len(at) > 1 and set(self._shown(links, differences, changing)) == set(at)
            who = "every link" if every else named("link", [links[k].name for k in at])
            changed = self.ours.copy()
            for k in changing if every else at:
                changed[_places([links[k].body])] += differences[k]
            if (change := _with(changed)) is not None:
                size = 1 if len(at) == 1 else 2 if every else 1 + len(at)
                yield CodeFault.of(mistake.kind, mistake.message.format(who=who), mistake.remedy, change, size)
        for message, of_bodies in shifted(links, self._code):
            difference = np.zeros(len(self.ours))
            for body, own in of_bodies:
                difference[_places([body])] += own
            if self.explained_by(difference) and (change := _with(self.ours + difference)) is not None:
                yield CodeFault.of("inertial_parameters", message, "assign them by name", change, 1)

    def _shown(self, links: Sequence[PlacedInertial], differences: Array, among: Sequence[int]) -> Iterator[int]:
        for k in among:
            if np.linalg.norm(self._map[:, _places([links[k].body])] @ differences[k]) > self._largest:
                yield k

    def smallest(self) -> CodeFault | None:
        """The smallest change of all parameters that gives the answers, each measured by what it does to torques."""
        difference = np.linalg.lstsq(self._map / self._size, self._target, rcond=SHOWN_SHARE)[0] / self._size
        change = _with(self.ours + difference)
        if change is None:
            return None
        message = "the equations are right, with other inertial parameters of more than three bodies"
        return CodeFault.of("inertial_parameters", message, LINK_REMEDY, change, len(self.ours))


def _columns(code: DynamicsCode, rows: Observation) -> Array:
    """What each parameter of each body adds to all torques (T n, 13 n)."""
    n = len(code.inside)
    codes = []
    for k in range(n):
        codes.append(_alone(code, k, 1.0, np.zeros(3), np.zeros((3, 3))))
        codes += [_alone(code, k, 1.0, axis, -parallel_axis(1.0, axis)) for axis in np.eye(3)]
        codes += [_alone(code, k, 0.0, np.zeros(3), entry.reshape(3, 3)) for entry in np.eye(9)]
    torques = (rows.residuals(codes) + rows.answers).reshape(n, LINK_PARAMETERS, -1)
    torques[:, FIRST_MOMENT] -= torques[:, :1]  # they were found with a mass
    columns: Array = torques.reshape(n * LINK_PARAMETERS, -1).T
    return columns


FIRST_MOMENT = slice(1, 4)


def _alone(code: DynamicsCode, k: int, mass: float, center: Array, tensor: Array) -> DynamicsCode:
    """The code with one body that has mass or inertia."""
    n = len(code.inside)
    masses, centers, tensors = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    masses[k], centers[k], tensors[k] = mass, center, tensor
    return code.but(masses=masses, centers=centers, tensors=tensors)


def _of_numbers(code: DynamicsCode, k: int) -> Array:
    """The parameters of a body (13,)."""
    x = code.numbers
    mass, center, tensor = x.masses[k], x.centers[k], x.tensors[k]
    return np.concatenate([[mass], mass * center, (tensor + parallel_axis(mass, center)).ravel()])


def _with(parameters: Array) -> Callable[[DynamicsCode], DynamicsCode] | None:
    """The change of a code to these parameters (13 n,); None for a first moment without mass."""
    rows = parameters.reshape(-1, LINK_PARAMETERS)
    masses, moments = rows[:, 0], rows[:, FIRST_MOMENT]
    weightless = np.abs(masses) <= MASS_ROUNDING * np.abs(masses).max(initial=0.0)
    if np.abs(moments[weightless]).max(initial=0.0) > MASS_ROUNDING * np.abs(moments).max(initial=0.0):
        return None
    masses = np.where(weightless, 0.0, masses)
    centers = np.where(weightless[:, None], 0.0, moments) / np.where(weightless, 1.0, masses)[:, None]
    offsets = np.array([parallel_axis(m, c) for m, c in zip(masses, centers, strict=True)])
    return partial(DynamicsCode.but, masses=masses, centers=centers, tensors=rows[:, 4:].reshape(-1, 3, 3) - offsets)


MASS_ROUNDING = 1e-12
"""Part of the largest mass below which a mass is the rounding of a difference."""


def _places(bodies: Sequence[int]) -> NDArray[np.intp]:
    return np.concatenate([np.arange(k * LINK_PARAMETERS, (k + 1) * LINK_PARAMETERS) for k in bodies])


def with_parameters(
    code: DynamicsCode, differences: Sequence[tuple[int, Array]]
) -> Callable[[DynamicsCode], DynamicsCode] | None:
    """The change of a code by differences of the parameters of bodies; None for a first moment without mass."""
    whole = np.concatenate([_of_numbers(code, k) for k in range(len(code.inside))])
    for body, difference in differences:
        whole[_places([body])] += difference
    return _with(whole)
