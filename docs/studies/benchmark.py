"""The tables of docs/benchmark.md from a finished benchmark: python docs/studies/benchmark.py OUT."""

import sys
from pathlib import Path

from crosscheck.study.inputs import read_inputs
from crosscheck.study.settings.design import StudyDesign
from crosscheck.study.statistics.outcomes import read_outcomes
from crosscheck.study.statistics.summary import summarized

SIGNS = {"better": "↓", "worse": "↑", "equivalent": "=", "undecided": ""}
"""Beside a median: whether the method is better or worse than wls in this scenario, or equivalent."""

DEGREES = {1.7453292519943296e-6: "1e-4°", 1.7453292519943296e-5: "1e-3°", 1.7453292519943296e-4: "1e-2°"}


def column(axes):
    error = axes["model_error"]
    return DEGREES[axes["position_noise"]] if error == "none" else error


def percent(value):
    return "–" if not value < float("inf") else f"{100 * value:.2g}"


def table(found, robot):
    """Medians of the torque error [%] of every method, scenario by scenario, with the verdict against wls."""
    chosen = [one for one in found.scenarios if one.outcomes.axes["robot"] == robot]
    order = [*DEGREES.values(), "gains", "delay", "quantized", "lugre", "flexible"]
    chosen.sort(key=lambda one: order.index(column(one.outcomes.axes)))
    yield f"| {robot} | {' | '.join(column(one.outcomes.axes) for one in chosen)} |"
    yield "|---|" + "---|" * len(chosen)
    for k in found.methods("torques"):
        cells = [found.outcomes.methods[k].name]
        for one in chosen:
            comparison = one.comparisons["torques", "torque_error"]
            name = comparison.first(cells[0])
            verdict = next((pair.verdict for pair in comparison.pairs if pair.method == name), "undecided")
            method = one.methods[k]
            failed = f", {method.runs - method.found} failed" if method.found < method.runs else ""
            cells.append(f"{percent(method.errors['torque_error'].value)} {SIGNS[verdict]}{failed}".strip())
        yield f"| {' | '.join(cells)} |"


def overall(found):
    """Ratios over all scenarios."""
    comparison = found.comparisons["torques", "torque_error"]
    yield f"| method, {comparison.runs} runs | error / that of {comparison.reference} | verdict |"
    yield "|---|---|---|"
    for pair in sorted(comparison.pairs, key=lambda one: one.ratio.value):
        ratio = pair.ratio
        failed = f", {pair.failed} failed" if pair.failed else ""
        yield f"| {pair.method} | {ratio.value:.2f} ({ratio.low:.2f}–{ratio.high:.2f}) | {pair.verdict}{failed} |"


if __name__ == "__main__":
    out = Path(sys.argv[1])
    summary = summarized(read_outcomes(out), StudyDesign())
    for part in (overall(summary), *(table(summary, robot) for robot in ("ur5", "tx40"))):
        print("\n".join(part), end="\n\n")
    for name, sha256 in read_inputs(out).files.items():
        if name.endswith(".parquet"):
            print(f"{name}: {sha256}")
