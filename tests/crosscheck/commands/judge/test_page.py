"""The page of a judgment: verdicts, errors, diagnoses, and code that gives what was expected."""

import dataclasses
import math

import numpy as np
import pytest
from faults.judged_functions import DIAGNOSIS, STATES, judged, judgment, judgment_page
from shown.pages import balanced, executed, parsed, rows, snippets

import graphdyn
from crosscheck.commands.judge.report import judge_report
from crosscheck.report.report import Plot

SYMBOLS = {"agrees": "✓", "DISAGREES": "✗", "UNDECIDED": "?"}

PHYSICAL = 1e-9
"""A planted difference, as a part of the value."""


class TestJudgment:
    @pytest.mark.parametrize(
        ("factor", "between", "title", "sentence"),
        [
            (1.0, 0.0, "agrees", "same numbers as every reference implementation (graphdyn, pinocchio)"),
            (1.5, 0.0, "DISAGREES", "inverse_dynamics disagrees with "),
            (1.5, 1e-3, "UNDECIDED", "The reference implementations (graphdyn, pinocchio) disagree on inverse_"),
        ],
    )
    def test_three_verdicts(self, tree, factor, between, title, sentence):
        judged_functions = judgment(tree, judged(tree, "inverse_dynamics", factor, between))
        text = judgment_page(judged_functions)
        assert f"Your functions on some robot: {title}</title>" in text
        assert sentence in " ".join(text.split())
        table = rows(text, "Largest error over all states against each reference implementation")
        error = f"{factor - 1:.1e}"
        assert table["inverse_dynamics"] == [f"{SYMBOLS[title]} {title}", error, error, "1.0e-09", "the largest entry"]
        assert balanced(text)

    def test_every_reference(self, tree):
        text = judgment_page(judgment(tree, judged(tree, "mass_matrix", 1.5, 1e-3)))
        assert rows(text, "Errors over all states, relative to the largest entry") == {
            "against graphdyn": ["✗ DISAGREES", "5.0e-01", "5.0e-01", "1.0e-09"],
            "against pinocchio": ["✗ DISAGREES", "5.0e-01", "5.0e-01", "1.0e-09"],
            "pinocchio against graphdyn": ["✗ DISAGREES", "1.0e-03", "1.0e-03", "1.0e-09"],
        }
        assert "<li>no MuJoCo" in text

    def test_errors_over_the_states(self, tree):
        """A curve per comparison; none where no error can stand on a logarithmic axis."""
        report = judge_report(judgment(tree, judged(tree, "mass_matrix", 1.5, 1e-3)))
        (plot,) = [block for block in report.sections[-1].blocks if isinstance(block, Plot)]
        (panel,) = plot.panels
        assert [one.name for one in panel.series] == [
            "against graphdyn", "against pinocchio", "pinocchio against graphdyn",
        ]  # fmt: skip
        assert [set(one.y.tolist()) for one in panel.series] == [{0.5}, {0.5}, {1e-3}]
        assert (len(plot.x), panel.level) == (STATES, 1e-9)
        nothing = judge_report(judgment(tree, judged(tree, "mass_matrix")))
        assert not any(isinstance(block, Plot) for block in nothing.sections[-1].blocks)

    def test_functions_that_disagree_beside_an_undecided_one(self, tree):
        both = judgment(tree, judged(tree, "mass_matrix", 1.5, 1e-3), judged(tree, "inverse_dynamics", 1.5))
        text = " ".join(judgment_page(both).split())
        assert "disagree on mass_matrix: no verdict there. inverse_dynamics disagrees with all of them" in text
        assert text.index('<section id="inverse_dynamics"') < text.index('<section id="mass_matrix"')

    def test_diagnoses_come_before_the_numbers(self, tree):
        function = judged(tree, "inverse_dynamics", 1.5)
        text = judgment_page(judgment(tree, function, diagnoses=(DIAGNOSIS,)))
        for part in ("joints &lt;1&gt; and 2 are swapped", "[joint_order]", "at 40 states", "swap them", "3.0e-16",
                     "x; or y &amp; z"):  # fmt: skip
            assert part in text
        places = [text.index(f'<section id="{key}"') for key in ("diagnoses", "errors", "judged", "inverse_dynamics")]
        assert places == sorted(places)

    def test_entries_of_a_vector_in_order_and_of_a_matrix_worst_first(self, tree):
        function = judged(tree, "inverse_dynamics", 1.5)
        table = rows(judgment_page(judgment(tree, function)), "Both answers where they differ most")
        assert list(table) == list(tree.joint_names)
        text = judgment_page(judgment(tree, judged(tree, "mass_matrix", 1.5)))
        matrix = graphdyn.mass_matrix(tree, judged(tree, "mass_matrix").worst.arguments["q"])
        i, j = np.unravel_index(np.abs(matrix).argmax(), matrix.shape)
        (table,) = [t for t in parsed(text).iter("table") if "Largest differences" in t.findtext("caption", "")]
        first = ["".join(cell.itertext()) for cell in table.find("tbody")[0]]
        assert first[:3] == [tree.joint_names[i], str(j + 1), f"{matrix[i, j]:.9g}"]

    @pytest.mark.parametrize(
        ("name", "reverse"),
        [
            ("inverse_dynamics", False), ("inverse_dynamics", True), ("forward_dynamics", True),
            ("mass_matrix", True), ("joint_torque_regressor", True),
        ],
    )  # fmt: skip
    def test_snippet_gives_what_was_expected(self, small_comparison, name, reverse, capsys):
        """Arguments are in the foreign order, answers in that of the model."""
        order = small_comparison.model.joint_names[::-1] if reverse else small_comparison.model.joint_names
        function = judged(small_comparison.model, name, 1.5, order=order)
        text = judgment_page(
            judgment(
                small_comparison.model, function, robot=small_comparison.robot, file=small_comparison.file, order=order
            )
        )
        names, difference = executed(snippets(text)[0], capsys)
        np.testing.assert_allclose(names["expected"], function.worst.expected, rtol=1e-12, atol=1e-12)
        assert difference == pytest.approx(max(abs(x) for x in function.worst.expected) / 2)

    def test_snippet_of_a_given_model(self, tree, capsys):
        text = judgment_page(judgment(tree, judged(tree, "mass_matrix")))
        assert executed(snippets(text)[0], capsys, model=tree)[1] < PHYSICAL

    def test_errors_that_are_no_numbers(self, tree):
        function = judged(tree, "inverse_dynamics")
        broken = dataclasses.replace(function, errors={"graphdyn": np.array([0.0, math.nan])})
        text = judgment_page(judgment(tree, broken))
        assert rows(text, "Errors over all states, relative to the largest entry")["against graphdyn"][:3] == [
            "✗ DISAGREES",
            "0.0e+00",
            "∞",
        ]
