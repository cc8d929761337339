"""What a paper takes from a study: comparisons and errors as CSV and LaTeX tables (booktabs), pictures as SVG."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, get_args

from crosscheck.commands.study.comparison_report import verdict_text
from crosscheck.commands.study.recordings import RecordedResults
from crosscheck.commands.study.words import ERRORS_IN_WORDS
from crosscheck.report.report import Picture, Report
from crosscheck.study.statistics.intervals import Interval
from crosscheck.study.statistics.outcomes import ERRORS, Measures
from crosscheck.study.statistics.summary import StudySummary
from urdf.document import write_whole

Rows = Sequence[Sequence[Any]]

COMPARISON_COLUMNS = (
    "measures", "error", "scenario", "method", "reference", "ratio", "ratio_low", "ratio_high", "probability",
    "verdict", "runs", "failed", "other_failed", "detectable",
)  # fmt: skip

ALL_SCENARIOS = "all"
"""Stands for the comparison over all scenarios."""


def write_paper_files(found: StudySummary, recorded: RecordedResults, report: Report, folder: Path) -> list[str]:
    """Write them, and answer their names. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    files = dict[str, str]()
    if found.scenarios:
        files = {
            "comparisons.csv": _csv(COMPARISON_COLUMNS, list(_comparisons(found))),
            "errors.csv": _csv(*_errors(found)),
            **{f"comparisons-{measures}.tex": text for measures, text in _latex(found)},
            **dict(_pictures(report)),
        }
    if recorded:
        rows = [[label, *vars(one).values()] for label, of in recorded.items() for one in of]
        files["recordings.csv"] = _csv(("recording", "method", "torque_error", "real", "failure"), rows)
    for name, text in files.items():
        write_whole(folder / name, text.encode())
    return list(files)


def _csv(columns: Sequence[str], rows: Rows) -> str:
    written = io.StringIO()
    csv.writer(written, lineterminator="\n").writerows([columns, *rows])
    return written.getvalue()


def _comparisons(found: StudySummary) -> Iterator[list[Any]]:
    every = [(ALL_SCENARIOS, found.comparisons), *((one.outcomes.name, one.comparisons) for one in found.scenarios)]
    for scenario, comparisons in every:
        for (measures, error), comparison in comparisons.items():
            for pair in comparison.pairs:
                ratio = pair.ratio
                yield [
                    measures, error, scenario, pair.method, pair.other, ratio.value, ratio.low, ratio.high,
                    pair.probability, pair.verdict, pair.runs, pair.failed, pair.other_failed, pair.detectable,
                ]  # fmt: skip


def _errors(found: StudySummary) -> tuple[list[str], list[list[Any]]]:
    """A row for every scenario and method: medians with the ends of their intervals."""
    axes = list(found.outcomes.scenarios[0].axes)
    numbers = [f"{error}{end}" for error in ERRORS for end in ("", "_low", "_high")]
    rows = []
    for scenario in found.scenarios:
        for method in scenario.methods:
            if method.runs:
                ends = [(one.value, one.low, one.high) for one in (method.errors[error] for error in ERRORS)]
                rows.append(
                    [
                        scenario.outcomes.name, *scenario.outcomes.axes.values(), method.method.name, method.runs,
                        method.found, *(end for one in ends for end in one), method.seconds.value,
                    ]
                )  # fmt: skip
    return ["scenario", *axes, "method", "runs", "found", *numbers, "processor_seconds"], rows


def _latex(found: StudySummary) -> Iterator[tuple[str, str]]:
    """One table for each class of methods: ratios over all scenarios by every error, verdict by torque error."""
    for measures in get_args(Measures):
        of = {error: found.comparisons[key] for error in ERRORS if (key := (measures, error)) in found.comparisons}
        if not of:
            continue
        first = next(iter(of.values()))
        head = " & ".join(["method", *(ERRORS_IN_WORDS[error] for error in of), "by torque error"])
        lines = [rf"\begin{{tabular}}{{l{'r' * len(of)}l}}", r"\toprule", rf"{head} \\", r"\midrule"]
        said = of.get("torque_error", first)
        for method in dict.fromkeys(name for comparison in of.values() for name in comparison.with_reference):
            pair = said.with_reference.get(said.first(method))
            verdict = f"one with {said.reference}" if pair is None else verdict_text(pair, said, found.design.region)
            ratios = [_tex_interval(comparison.ratio(method)) for comparison in of.values()]
            lines.append(" & ".join([_tex(method), *ratios, _tex(verdict)]) + r" \\")
        caption = f"% error / that of {first.reference}, geometric means over {first.runs} runs"
        yield measures, "\n".join([caption, *lines, r"\bottomrule", r"\end{tabular}", ""])


def _tex(text: str) -> str:
    return re.sub(r"([%_&#$])", r"\\\1", text)


def _tex_interval(found: Interval) -> str:
    return rf"${found.value:.3g}$ (${found.low:.3g}$--${found.high:.3g}$)".replace("inf", r"\infty").replace("nan", "-")


def _pictures(report: Report) -> Iterator[tuple[str, str]]:
    """Every titled picture of the page, on a white background; the number tells those of one title apart."""
    names = dict[str, int]()
    for section in report.sections:
        for block in section.blocks:
            if isinstance(block, Picture) and block.title:
                name = re.sub(r"[^a-z0-9]+", "-", f"{block.title} {section.key}".lower()).strip("-")
                names[name] = names.get(name, 0) + 1
                number = "" if names[name] == 1 else f"-{names[name]}"
                drawn = str(block.draw("p"))
                white = 'style="background: #ffffff; font-family: sans-serif"'
                yield f"{name}{number}.svg", drawn.replace('class="picture"', white, 1)
