"""Pages for readers without eyes, mouse or color: by rules that are read in the page, and by axe-core in Chromium."""

import numpy as np
import pytest
from markupsafe import Markup
from random_trees import random_tree
from shown.axe import AXE, violations
from shown.browser import CHROMIUM
from shown.driven_browser import DrivenBrowser
from shown.pages import opened, parsed

from crosscheck.report.html import PACKED_FROM, page
from crosscheck.report.report import (
    Code,
    Column,
    Facts,
    Group,
    Lines,
    Note,
    Notes,
    Panel,
    Picture,
    Plot,
    Prose,
    Report,
    Row,
    Section,
    Series,
    Table,
    Verdict,
)
from crosscheck.viewing.figures import Figure, ShownRobot
from crosscheck.viewing.page import page as view_page
from crosscheck.viewing.robots import stand_ins

WIDTHS = (390, 1280, 1920)

OPENED = """(async () => {
  for (const one of document.querySelectorAll("details")) one.open = true;
  await new Promise((done) => setTimeout(done, 100));
  return document.querySelectorAll("[data-packed]").length;
})()"""


@pytest.fixture(scope="module")
def pages():
    """Every block with and without a title above it, and the view."""
    tree = random_tree(3, (0, 1, 1), ("revolute", "prismatic", "revolute"))
    return {
        "blocks": page(every_block(), ["graphdyn"], {"graphdyn": "1"}),
        "view": view_page("tree", [Figure("tree", ShownRobot(tree, stand_ins(tree)))]),
    }


def every_block():
    columns = tuple(Column(f"column {k}" if k else "", "number" if k else "name") for k in range(30))
    row = Row(("a name that is much longer than its column", *map(float, range(29))))
    t = np.linspace(0, 1, 20)
    box = '<svg role="img" aria-label="a box" width="900"></svg>'
    blocks = (
        Table(columns, (row, Row(("", *row.cells[1:]))), title="A table"),
        Plot(t, "t [s]", (Panel("x", (Series("sine", np.sin(t)),), "m"),), "A curve", title="A plot"),
        Picture(lambda key: Markup(box), title="A picture"),
        Facts((("name", "said"),), title="Facts"),
        Prose("Words."),
        Lines((300 * "x",), title="Lines"),
        Notes(tuple(Note("said", code="c", where="there", state="undecided") for _ in range(5)), title="Notes"),
        Code("print(1)  # " + 300 * "x", title="Code"),
        Code(PACKED_FROM * "x", title="Much", folded=True),
    )
    inner = Group(blocks, title="A group")
    sections = (Section("first", "", (*blocks, inner)), Section("second", "Titled", (*blocks, inner)))
    return Report("Every block", Verdict("agrees", "agrees", "Why."), sections, warnings=("a warning",))


def test_headings_descend_by_single_steps(pages):
    for name, text in pages.items():
        levels = [int(found.tag[1]) for found in parsed(opened(text)).iter("h1", "h2", "h3", "h4", "h5", "h6")]
        assert levels[0] == 1, name
        assert max(np.diff(levels, append=1)) <= 1, name


def test_no_header_is_empty(pages):
    for text in pages.values():
        assert all("".join(found.itertext()).strip() for found in parsed(opened(text)).iter("th", "h1", "h2", "h3"))


def test_what_may_scroll_can_be_reached_by_keys(pages):
    for text in pages.values():
        scrolling = parsed(opened(text)).xpath("//pre | //*[contains(@class, 'scroll')]")
        assert all(box.get("tabindex") == "0" for box in scrolling)


@pytest.mark.skipif(CHROMIUM is None or AXE is None, reason="no chromium or no axe-core on this machine")
@pytest.mark.parametrize("width", WIDTHS)
def test_axe(pages, width, tmp_path):
    """No violation, no complaint, nothing wider than the window, light and dark, all that is folded open."""
    with DrivenBrowser(tmp_path / "profile") as browser:
        for name, text in pages.items():
            (tmp_path / f"{name}.html").write_text(text, encoding="utf-8")
            browser.appear(width, dark=width == WIDTHS[1])
            browser.load((tmp_path / f"{name}.html").as_uri(), "0")
            assert browser.value(OPENED) == 0
            assert (violations(browser), browser.complaints) == ([], []), name
            assert browser.value("document.documentElement.scrollWidth") <= width
