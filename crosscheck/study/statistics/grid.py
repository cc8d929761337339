"""How the scenarios of a study differ: the axes along which errors are shown, and words for each scenario."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from crosscheck.study.statistics.outcomes import ScenarioOutcomes

AXIS_UNITS = {
    "position_noise": "rad",
    "torque_noise": "N m",
    "force_noise": "N",
    "sampling_rate": "Hz",
    "control_rate": "Hz",
    "duration": "s",
    "cutoff": "Hz",
    "min_speed": "rad/s",
}
"""Units of the axes of the grid that have one; of sliding joints m, N and m/s."""

MIN_PLAIN_NUMBER = 1e-3
"""Numbers below are written as powers of ten."""


@dataclass(frozen=True)
class View:
    """Scenarios along one axis, in lines.

    along: the axis, then those that change with it
    places: values on the axis in words, in order
    lines: what tells each line from the others, and its scenarios' numbers in the order of the places, None where
        the study has none there
    numeric: whether the places are numbers, between which lines make sense
    """

    along: tuple[str, ...]
    places: tuple[str, ...]
    lines: tuple[tuple[str, tuple[int | None, ...]], ...]
    numeric: bool

    @property
    def title(self) -> str:
        """Such as "position noise [rad], and torque noise with it"."""
        first = self.along[0]
        unit = f" [{AXIS_UNITS[first]}]" if first in AXIS_UNITS else ""
        more = " and ".join(map(_spaced, self.along[1:]))
        return f"{_spaced(first)}{unit}{f', and {more} with it' if more else ''}"


@dataclass(frozen=True, eq=False)
class Grid:
    """varying: axes on which scenarios differ, the first noise in front; standard: the usual value on each of them"""

    scenarios: Sequence[ScenarioOutcomes]
    varying: tuple[str, ...]
    standard: Mapping[str, Any]

    def words(self, scenario: ScenarioOutcomes) -> str:
        """Its place on the first axis, and what else is not as usual."""
        if not self.varying:
            return "the only scenario"
        first, *others = self.varying
        said = [f"{_spaced(first)} {with_unit(first, scenario.axes[first])}"]
        return ", ".join([*said, *self._unusual(scenario, [axis for axis in others if not self._follows(axis, first)])])

    @property
    def usual(self) -> str:
        """The usual values of the axes but the first, in words."""
        others = [axis for axis in self.varying[1:] if not self._follows(axis, self.varying[0])]
        return ", ".join(f"{_spaced(axis)} {with_unit(axis, self.standard[axis])}" for axis in others)

    def _unusual(self, scenario: ScenarioOutcomes, axes: Sequence[str]) -> list[str]:
        return [
            f"{_spaced(axis)} {with_unit(axis, scenario.axes[axis])}"
            for axis in axes
            if scenario.axes[axis] != self.standard[axis]
        ]

    def order(self) -> list[int]:
        """Numbers of the scenarios: the usual ones first, each line along the first axis."""

        def key(number: int) -> tuple[bool, list[Any], list[Any]]:
            axes = self.scenarios[number].axes
            others = [
                axis
                for axis in self.varying[1:]
                if axes[axis] != self.standard[axis] and not self._follows(axis, self.varying[0])
            ]
            return (
                bool(others),
                [(self.varying.index(axis), _order(axes[axis])) for axis in others],
                [_order(axes[axis]) for axis in self.varying[:1]],
            )

        return sorted(range(len(self.scenarios)), key=key)

    def views(self) -> list[View]:
        """One for the first axis, and for each other one that shows scenarios which no view before it has."""
        found: list[View] = []
        shown: set[int] = set()
        for axis in self.varying:
            view = self._view(axis, shown)
            if view is not None:
                found.append(view)
                shown |= {number for _, line in view.lines for number in line if number is not None}
        return found

    def _view(self, axis: str, shown: set[int]) -> View | None:
        along = (axis, *(other for other in self.varying if other != axis and self._follows(other, axis)))
        others = [other for other in self.varying if other not in along]
        values = sorted({one.axes[axis] for one in self.scenarios}, key=_order)
        numeric = all(isinstance(value, int | float) for value in values)
        if not numeric:
            values.sort(key=lambda value: value != self.standard[axis])
        lines: dict[tuple[Any, ...], list[int | None]] = {}
        for number in self.order():
            axes = self.scenarios[number].axes
            line = lines.setdefault(tuple(axes[other] for other in others), [None] * len(values))
            line[values.index(axes[axis])] = number
        kept = []
        for line in lines.values():
            there = [number for number in line if number is not None]
            if len(there) > 1 and not shown.issuperset(there):
                name = ", ".join(self._unusual(self.scenarios[there[0]], others)) or "usual"
                kept.append((name, tuple(line)))
        if not kept:
            return None
        used = [k for k in range(len(values)) if any(line[k] is not None for _, line in kept)]
        return View(
            along,
            tuple(_number(values[k]) for k in used),
            tuple((name, tuple(line[k] for k in used)) for name, line in kept),
            numeric,
        )

    def _follows(self, axis: str, first: str) -> bool:
        """Whether it is known where the first is known."""
        values = {one.axes[first] for one in self.scenarios}
        return len({(one.axes[first], one.axes[axis]) for one in self.scenarios}) == len(values)


def grid_of(scenarios: Sequence[ScenarioOutcomes]) -> Grid:
    """The grid of a study's scenarios, which have the same axes."""
    varying = [axis for axis in scenarios[0].axes if len({one.axes[axis] for one in scenarios}) > 1]
    varying.sort(key=lambda axis: "noise" not in axis)
    standard = {}
    for axis in varying:
        counts = Counter(one.axes[axis] for one in scenarios)
        standard[axis] = max(counts, key=lambda value: (counts[value], [-ord(c) for c in str(value)]))
    return Grid(scenarios, tuple(varying), standard)


def with_unit(axis: str, value: Any) -> str:
    """A value of an axis in words."""
    if value is None:
        return "none"
    return f"{_number(value)} {AXIS_UNITS[axis]}" if axis in AXIS_UNITS else _number(value)


def _number(value: Any) -> str:
    """1.75e-4 for 0.000175."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "none" if value is None else str(value)
    if 0 < abs(value) < MIN_PLAIN_NUMBER:
        digits, _, power = f"{value:.2e}".partition("e")
        return f"{float(digits):g}e{int(power)}"
    return f"{value:.6g}"


def _spaced(axis: str) -> str:
    return axis.replace("_", " ")


def _order(value: Any) -> tuple[bool, bool, float, str]:
    """Numbers rising, then words, then none."""
    number = isinstance(value, int | float)
    return value is None, not number, float(value) if number else 0.0, "" if number else str(value)
