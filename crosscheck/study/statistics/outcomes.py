"""The tables of a study as arrays: what every method made of every record.

A record is one run of one scenario; all methods have identified from the same one. Where a method has failed its
errors are infinite, and its parameters NaN.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.arrow import check_arrow
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.layout import Array

Measures = Literal["torques", "wrenches"]

ERRORS = ("parameter_error", "torque_error", "trajectory_error")
"""Columns of results.parquet by which methods are compared, the smaller the better."""


DISTANCES = ("d_beta", "d_tau", "d_q", "diverged")
"""Columns of results.parquet with the distances of Leboutet et al. (2021)."""


@dataclass(frozen=True)
class Method:
    """A method that takes part.

    name: as in the configuration
    measures: what it needs of every joint: its torque, or all six components of its wrench; the two are never compared
    """

    name: str
    measures: Measures


@dataclass(frozen=True, eq=False)
class ScenarioOutcomes:
    """R runs of one scenario by M methods, with b base parameters; NaN for methods that take no part.

    name: as in the tables
    axes: the values of the study's grid, by the name of the axis
    base_names, base_units: of the base parameters, such as "XX_2 - YY_2 + 0.18 M_3"
    truth: the true base parameters                                             (b,)
    runs: their numbers                                                         (R,)
    taken: whether the method takes part: where no wrenches are measured, those that need them do not      (M,)
    found: whether the method has an answer                                     (R, M)
    errors: by the names of ERRORS; infinite where there is none                (R, M)
    base, sigma: what was found, and its standard deviation as stated; NaN      (R, M, b)
    redrawn: what was found when one source was drawn once more, K times, by the name of the source   (R, K, M, b)
    consistent: 1 for real bodies in all links, 0 for others; NaN where unknown (R, M)
    distances: by the names of DISTANCES, diverged as 1 or 0; NaN where unknown (R, M)
    iterations, simulations, seconds: NaN where there is none                   (R, M)  [1, 1, s]
    reasons: why a method failed, by (row, column)
    """

    name: str
    axes: Mapping[str, Any]
    base_names: tuple[str, ...]
    base_units: tuple[str, ...]
    truth: Array
    runs: NDArray[np.int64]
    taken: NDArray[np.bool_]
    found: NDArray[np.bool_]
    errors: Mapping[str, Array]
    base: Array
    sigma: Array
    redrawn: Mapping[str, Array]
    consistent: Array
    distances: Mapping[str, Array]
    iterations: Array
    simulations: Array
    seconds: Array
    reasons: Mapping[tuple[int, int], str]


@dataclass(frozen=True, eq=False)
class StudyOutcomes:
    """methods: in the order of the columns of all scenarios, of which a study of real recordings alone has none"""

    methods: tuple[Method, ...]
    scenarios: tuple[ScenarioOutcomes, ...]

    def columns(self, measures: Measures) -> list[int]:
        """Numbers of the methods that measure this."""
        return [k for k, method in enumerate(self.methods) if method.measures == measures]


def read_outcomes(folder: Path) -> StudyOutcomes:
    """Read results.parquet, scenarios.parquet and times.parquet of a study.

    Raises InvalidInput where a record has no row of a method that others have, OSError where a file is missing.
    """
    check_arrow(folder)
    from pyarrow.parquet import read_table

    results, scenarios, times = (
        read_table(folder / f"{name}.parquet").to_pylist() for name in ("results", "scenarios", "times")
    )
    return outcomes(results, scenarios, times)


def outcomes(
    results: Sequence[Mapping[str, Any]], scenarios: Sequence[Mapping[str, Any]], times: Sequence[Mapping[str, Any]]
) -> StudyOutcomes:
    """The same from the rows of the three tables."""
    methods = tuple(Method(*both) for both in dict.fromkeys((row["method"], row["measures"]) for row in results))
    seconds = {
        (row["scenario"], row["run"], row["method"]): row["processor_seconds"] for row in times if not row["repeat"]
    }
    of: dict[str, dict[tuple[int, str], Mapping[str, Any]]] = {row["scenario"]: {} for row in scenarios}
    again: dict[str, list[Mapping[str, Any]]] = {row["scenario"]: [] for row in scenarios}
    for row in results:
        if row["scenario"] not in of:
            raise InvalidInput(f"results.parquet has scenario '{row['scenario']}', scenarios.parquet has not")
        if row["repeat"]:
            again[row["scenario"]].append(row)
        else:
            of[row["scenario"]][row["run"], row["method"]] = row
    found = tuple(
        _scenario(row, of[row["scenario"]], again[row["scenario"]], methods, seconds)
        for row in scenarios
        if of[row["scenario"]]
    )
    if scenarios and not found:
        raise InvalidInput("results.parquet has no rows: the study has no run to report")
    return StudyOutcomes(methods, found)


_OWN = ("scenario", "base_names", "base_units", "truth")
"""Columns of scenarios.parquet that are no axes of the grid."""


_NO_PART: Mapping[str, Any] = defaultdict(lambda: None)
"""The row of a method that takes no part."""


def _scenario(
    scenario: Mapping[str, Any],
    rows: Mapping[tuple[int, str], Mapping[str, Any]],
    again: Sequence[Mapping[str, Any]],
    methods: Sequence[Method],
    seconds: Mapping[tuple[str, int, str], float],
) -> ScenarioOutcomes:
    name, size = scenario["scenario"], len(scenario["base_names"])
    runs, taken = sorted({run for run, _ in rows}), {method for _, method in rows}
    for run in runs:
        for method in methods:
            if method.name in taken and (run, method.name) not in rows:
                raise InvalidInput(f"results.parquet has no row of '{method.name}' for run {run} of scenario '{name}'")
    table = [[rows.get((run, method.name), _NO_PART) for method in methods] for run in runs]

    def numbers(column: str, missing: float) -> Array:
        return np.array([[missing if row[column] is None else row[column] for row in line] for line in table], float)

    def vectors(column: str) -> Array:
        return np.array([[_whole(row, column, size) for row in line] for line in table])

    part = np.array([method.name in taken for method in methods])
    errors = {column: numbers(column, np.inf) for column in ERRORS}
    timed = [[seconds.get((name, run, method.name), np.nan) for method in methods] for run in runs]
    return ScenarioOutcomes(
        name,
        {axis: value for axis, value in scenario.items() if axis not in _OWN},
        tuple(scenario["base_names"]),
        tuple(scenario["base_units"]),
        np.array(scenario["truth"], float),
        np.array(runs),
        part,
        np.array([[row["status"] == "found" for row in line] for line in table]),
        {column: np.where(part, np.where(np.isnan(found), np.inf, found), np.nan) for column, found in errors.items()},
        vectors("base"),
        vectors("sigma"),
        _redrawn(again, runs, methods, size),
        numbers("consistent", np.nan),
        {column: numbers(column, np.nan) for column in DISTANCES},
        numbers("iterations", np.nan),
        numbers("simulations", np.nan),
        np.array(timed, float),
        {(i, j): row["reason"] for i, line in enumerate(table) for j, row in enumerate(line) if row["reason"]},
    )


def _redrawn(
    rows: Sequence[Mapping[str, Any]], runs: Sequence[int], methods: Sequence[Method], size: int
) -> dict[str, Array]:
    places = {run: k for k, run in enumerate(runs)}
    columns = {method.name: k for k, method in enumerate(methods)}
    found = dict[str, Array]()
    for source in dict.fromkeys(row["redrawn"] for row in rows):
        own = [row for row in rows if row["redrawn"] == source and row["run"] in places]
        values = np.full((len(runs), max(row["repeat"] for row in own), len(methods), size), np.nan)
        for row in own:
            values[places[row["run"]], row["repeat"] - 1, columns[row["method"]]] = _whole(row, "base", size)
        found[source] = values
    return found


def _whole(row: Mapping[str, Any], column: str, size: int) -> Array:
    if row[column] is None:
        return np.full(size, np.nan)
    values = np.array([np.nan if value is None else value for value in row[column]], float)
    if len(values) != size:
        raise InvalidInput(
            f"results.parquet: '{column}' of '{row['method']}', run {row['run']} of scenario '{row['scenario']}' has "
            f"{counted(len(values), 'value')}, scenarios.parquet names {counted(size, 'base parameter')}"
        )
    return values
