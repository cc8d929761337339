"""The distances of Leboutet et al. (2021), where a study has them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.commands.study.words import METHOD_CLASSES
from crosscheck.report.report import Column, Row, Section, Table
from crosscheck.study.statistics.outcomes import DISTANCES, Measures
from crosscheck.study.statistics.summary import StudySummary, mean_distances


def distances_section(found: StudySummary, measures: Measures) -> Iterator[Section]:
    """Means over all records whose answer has not diverged."""
    if not found.design.distances:
        return
    rows = []
    for k in found.methods(measures):
        every = {
            name: np.concatenate([scenario.distances[name][:, k] for scenario in found.outcomes.scenarios])
            for name in DISTANCES
        }
        rows.append(Row((found.outcomes.methods[k].name, *mean_distances(every).values())))
    means = [
        ("d β", "2 / b Σ |x - x*| / (|x| + |x*|)"),
        ("d τ", "mean of ‖τ - W x‖ / ‖τ‖ over the fitted rows"),
        ("d q", "mean of ‖q - q(x)‖ / ‖q‖, of the simulated loop"),
    ]
    table = Table(
        (
            Column("method", "name"),
            *(Column(title, "number", form=".3%", meaning=meaning) for title, meaning in means),
            Column("diverged", "number", form=".0f", meaning="answers 50 times as far from the truth as the start"),
        ),
        tuple(rows),
        caption="Means over all records whose answer has not diverged; study.json has those of every scenario.",
    )
    title = f"Distances of Leboutet et al. 2021 ({METHOD_CLASSES[measures][1]} measured)"
    yield Section(f"distances-{measures}", title, (table,))
