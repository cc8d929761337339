"""What the axes looked at so far leave open of the translations of a robot."""

from __future__ import annotations

import numpy as np

from graphdyn.layout import Array

SLANT = 0.02
"""Sine of the angle between an axis and a free translation above which the axis tells how large it is: that of axes
that count as parallel."""


class FreeTranslations:
    """Translations that no axis has determined yet: those of the base, and of the joints that slide."""

    def __init__(self, held: bool) -> None:
        """held: the base is where it must be"""
        self._vectors, self._owners = np.eye(3), [-1, -1, -1]
        self._basis = np.zeros((3, 0)) if held else np.eye(3)

    def add(self, direction: Array, joint: int) -> None:
        """A joint that slides along a direction."""
        self._vectors = np.column_stack([self._vectors, direction])
        self._owners.append(joint)
        grown = np.zeros((self._basis.shape[0] + 1, self._basis.shape[1] + 1))
        grown[:-1, :-1], grown[-1, -1] = self._basis, 1.0
        self._basis = grown

    def reaches(self, direction: Array) -> bool:
        """Whether a translation across this direction is still free."""
        free = self._vectors @ self._basis
        return bool(free.size and np.linalg.norm(free - np.outer(direction, direction @ free)) > SLANT)

    def hold(self, direction: Array) -> None:
        """The translation of all along this direction is known."""
        along = direction[None] @ self._vectors @ self._basis
        _, values, rows = np.linalg.svd(along)
        self._basis = self._basis @ rows[int((values > SLANT).sum()) :].T

    def absorbed(self, axis: Array, gap: Array) -> list[tuple[int, Array]]:
        """Owner (-1: the base) and translation, which together close a gap across an axis as far as they can."""
        if not self._basis.shape[1]:
            return []
        across_axis = (np.eye(3) - np.outer(axis, axis)) @ self._vectors @ self._basis
        left, values, rows = np.linalg.svd(across_axis)
        rank = int((values > SLANT).sum())
        shares = rows[:rank].T @ ((left[:, :rank].T @ gap) / values[:rank])
        amounts, self._basis = self._basis @ shares, self._basis @ rows[rank:].T
        return [(owner, amounts[k] * self._vectors[:, k]) for k, owner in enumerate(self._owners) if amounts[k]]
