"""Tables and pictures for a paper: the numbers of the study, whole files, LaTeX that keeps its signs."""

import csv

import numpy as np
import pytest
from identified.study_tables import study_tables
from lxml import etree

from crosscheck.commands.study.paper_files import write_paper_files
from crosscheck.commands.study.report import study_report
from crosscheck.study.statistics.outcomes import outcomes
from crosscheck.study.statistics.summary import summarized


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The summary, and the folder of its files."""
    folder, found = tmp_path_factory.mktemp("paper"), outcomes(*study_tables(14))
    report = study_report(found, [], lambda scenario, run: [])
    names = write_paper_files(summarized(found), {}, report, folder)
    assert sorted(names) == sorted(file.name for file in folder.iterdir())
    return summarized(found), folder


def rows(file):
    with file.open(newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text))


def test_comparisons(written):
    found, folder = written
    table = rows(folder / "comparisons.csv")
    every = [found.comparisons, *(one.comparisons for one in found.scenarios)]
    pairs = [pair for comparisons in every for one in comparisons.values() for pair in one.pairs]
    assert [row["method"] for row in table] == [pair.method for pair in pairs]
    for name, values in {
        "ratio": [p.ratio.value for p in pairs],
        "probability": [p.probability for p in pairs],
    }.items():
        assert np.array([float(row[name]) for row in table]) == pytest.approx(np.array(values), nan_ok=True)
    assert [row["verdict"] for row in table] == [pair.verdict for pair in pairs]
    assert {row["scenario"] for row in table} == {"all", *(one.outcomes.name for one in found.scenarios)}


def test_errors(written):
    found, folder = written
    table = rows(folder / "errors.csv")
    assert len(table) == sum(method.runs > 0 for one in found.scenarios for method in one.methods)
    first = found.scenarios[0]
    for row, method in zip(table, first.methods, strict=False):
        assert (row["scenario"], row["method"]) == (first.outcomes.name, method.method.name)
        assert float(row["torque_error_high"]) == method.errors["torque_error"].high
        assert float(row["position_noise"]) == first.outcomes.axes["position_noise"]


def test_latex(written):
    """A row of booktabs for every pair; a percent sign of a verdict is no comment."""
    found, folder = written
    text = (folder / "comparisons-torques.tex").read_text(encoding="utf-8")
    lines = text.splitlines()
    assert lines[0].startswith("% error / that of ")
    assert lines[1:3] == [r"\begin{tabular}{lrrrl}", r"\toprule"]
    assert lines[-2:] == [r"\bottomrule", r"\end{tabular}"]
    body = lines[lines.index(r"\midrule") + 1 : -2]
    assert len(body) == len(found.comparisons["torques", "torque_error"].pairs)
    assert all(line.endswith(r" \\") and line.count("&") == 4 for line in body)
    assert all(line[k - 1] == "\\" for line in body for k, sign in enumerate(line) if sign in "%_")


def test_latex_of_methods_that_are_one_by_one_error(tmp_path):
    """By torque error alone: the method has its row, with its ratios by the other errors."""
    results, scenarios, times = study_tables(14)
    reference = summarized(outcomes(results, scenarios, times)).comparisons["torques", "torque_error"].reference
    other = next(row["method"] for row in results if row["measures"] == "torques" and row["method"] != reference)
    known = {(row["scenario"], row["run"]): row for row in results if row["method"] == reference}
    same = [
        row | {key: known[row["scenario"], row["run"]][key] for key in ("torque_error", "status")}
        if row["method"] == other
        else row
        for row in results
    ]
    found = summarized(outcomes(same, scenarios, times))
    assert other in next(iter(found.comparisons["torques", "torque_error"].same))
    assert other in found.comparisons["torques", "parameter_error"].with_reference
    write_paper_files(found, {}, study_report(found.outcomes, [], lambda scenario, run: []), tmp_path)
    lines = (tmp_path / "comparisons-torques.tex").read_text(encoding="utf-8").splitlines()
    (row,) = (line for line in lines if line.startswith(f"{other} &"))
    assert row.endswith(rf"& one with {reference} \\")


def test_pictures(written):
    _, folder = written
    pictures = [file for file in folder.iterdir() if file.suffix == ".svg"]
    assert any(file.name.startswith("torque-error-against-") for file in pictures)
    for file in pictures:
        assert etree.fromstring(file.read_bytes()).tag == "{http://www.w3.org/2000/svg}svg"
