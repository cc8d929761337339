"""Formulas become pictures that need nothing from the network."""

import re

import pytest

KKT = r"\begin{bmatrix} A & \varphi_q^T \\ \varphi_q & 0 \end{bmatrix} \begin{pmatrix} \ddot q \\ \lambda \end{pmatrix}"


@pytest.fixture(scope="module")
def formulas():
    pytest.importorskip("ziamath", reason="the extra graphdyn[docs] is not installed")
    return pytest.importorskip("formulas", reason="the extra graphdyn[docs] is not installed")


def test_a_formula_is_one_drawing_with_its_source_as_text(formulas):
    drawing = formulas.svg(KKT, 17.0)
    assert drawing.startswith("<svg ")
    assert drawing.count("<svg ") == 1
    assert 'role="img"' in drawing
    assert "\\ddot q" in re.search(r'aria-label="([^"]*)"', drawing)[1]
    assert "currentColor" in drawing
    assert not re.search(r"href=\"http|@import|url\(", drawing)


def test_what_is_below_the_line_hangs_below_it(formulas):
    def depth(tex):
        return float(re.search(r"vertical-align:(-?[\d.]+)px", formulas.svg(tex, 17.0))[1])

    assert depth("q_j") < depth("a") < 1.0


@pytest.mark.parametrize("tex", [r"\unknowncommand x", r"a + \nosuchthing"])
def test_an_unknown_command_is_an_error(formulas, tex):
    with pytest.raises(formulas.UnknownCommand, match=r"unknowncommand|nosuchthing"):
        formulas.svg(tex, 17.0)
