"""From data to HTML: the templates of this package, and how numbers and verdicts are written on a page."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from urdf._files import write_whole

VERDICTS = {
    "agrees": ("✓", "agrees"),
    "disagrees": ("✗", "DISAGREES"),
    "undecided": ("?", "undecided"),
}
"""Symbol and word of each verdict: no reader depends on colour."""


def render(template: str, **content: object) -> str:
    """The page of a template. Text is escaped; pictures (svg.picture) are not."""
    return _environment().get_template(template).render(**content)


def write_page(path: Path, html: str) -> None:
    """Write the page as a whole file or not at all. Raises OSError."""
    write_whole(path, html.encode())


def error_text(x: float) -> str:
    """An error with two digits."""
    return f"{x:.1e}" if math.isfinite(x) else "∞"


def span_text(pair: tuple[float, float]) -> str:
    """Smallest and largest, once where they are equal."""
    low, high = (f"{x:.3g}" if math.isfinite(x) else "∞" for x in pair)
    return low if low == high else f"{low} … {high}"


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("crosscheck.report.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(error=error_text, span=span_text, zip=zip)
    environment.globals.update(VERDICTS=VERDICTS)
    return environment
