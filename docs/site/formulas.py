r"""Formulas as pictures, drawn while the site is built: the browser needs neither scripts, nor fonts, nor a network.

ziamath draws TeX as SVG with the outlines of STIX Two Math. The TeX source is the picture's text for screen readers.
"""

from __future__ import annotations

import html
import re
from typing import Any

import ziamath
from docutils import nodes
from latex2mathml.converter import convert

INLINE, DISPLAY = 15.0, 17.0
"""Sizes in CSS pixels, beside text of 16."""


class UnknownCommand(ValueError):
    """TeX that the renderer would print as it stands."""


def svg(tex: str, size: float) -> str:
    """The formula as one <svg> element in the color of the text. Raises UnknownCommand, naming the command."""
    unknown = re.search(r"\\[a-zA-Z]+", convert(re.sub(r"\\(begin|end)\{aligned\}", "", tex)))
    if unknown:
        raise UnknownCommand(f"{unknown[0]} in {tex}")
    formula = ziamath.Latex(tex, size=size, color="currentColor")
    drawing = formula.svg()
    descent = formula.getyofst()
    label = html.escape(" ".join(tex.split()), quote=True)
    style = f"vertical-align:{descent:.2f}px;max-width:none"
    return drawing.replace("<svg ", f'<svg role="img" aria-label="{label}" style="{style}" ', 1)


def visit_math(self: Any, node: nodes.math) -> None:
    self.body.append(f'<span class="math">{svg(node.astext(), INLINE)}</span>')
    raise nodes.SkipNode


def visit_math_block(self: Any, node: nodes.math_block) -> None:
    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    self.body.append(f'<div class="math">{number}{svg(node.astext(), DISPLAY)}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    app.add_html_math_renderer("svg", (visit_math, None), (visit_math_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
