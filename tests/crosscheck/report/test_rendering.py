"""A report of every kind of block, on the terminal and on the page."""

import base64
import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest
from markupsafe import Markup
from shown.pages import parsed

from crosscheck.report.html import MAX_NOTE_LENGTH, page
from crosscheck.report.pictures.plot import MAX_STATIC_POINTS, plot_data, plot_picture, thinned
from crosscheck.report.report import (
    Code,
    Column,
    Facts,
    Group,
    Hover,
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
from crosscheck.report.text import as_text

GOOD, BAD, OPEN = Verdict("agrees", "agrees"), Verdict("disagrees", "DISAGREES"), Verdict("undecided", "undecided")
NUMBERS = Column("error", "number", "N m", ".1e")


def report(*blocks, verdict=GOOD, sections=()):
    return Report("A title", verdict, (Section("first", "First", blocks), *sections))


def shown(*blocks, **options):
    """The page, parsed."""
    text = page(report(*blocks, **options), ["graphdyn", "test"], {"graphdyn": "1"})
    return parsed(text)


def words(element):
    return " ".join("".join(element.itertext()).split())


def table(*states, **options):
    rows = tuple(Row((f"row {k}", state, 0.1 * k), state.state) for k, state in enumerate(states))
    return Table((Column("name", "name"), Column("verdict", "verdict"), NUMBERS), rows, **options)


class TestCells:
    @pytest.mark.parametrize(
        ("value", "text"),
        [(None, "–"), (math.nan, "–"), (math.inf, "∞"), (-math.inf, "−∞"), (0.000123, "1.2e-04"), (BAD, "DISAGREES")],
    )
    def test_numbers(self, value, text):
        assert NUMBERS.text(value) == NUMBERS.text(Hover(value, "more")) == text

    def test_a_function_as_form(self):
        assert Column("q", form=lambda q: f"{q[0]} and {q[1]}").text((1, 2)) == "1 and 2"

    def test_units_stand_in_the_heading(self):
        assert NUMBERS.heading == "error [N m]"


class TestText:
    def test_verdict_first_then_sections(self):
        lines = as_text(report(Prose("words"), verdict=Verdict("disagrees", "DISAGREES", "Why."))).splitlines()
        assert [line.strip() for line in lines] == ["A title: DISAGREES", "Why.", "", "First", "words"]

    def test_failures_come_first(self):
        text = as_text(report(table(GOOD, OPEN, BAD)))
        assert text.index("row 2") < text.index("row 1") < text.index("row 0")
        unsorted = as_text(report(table(GOOD, OPEN, BAD, failures_first=False)))
        assert unsorted.index("row 0") < unsorted.index("row 1") < unsorted.index("row 2")

    def test_sections_that_fail_come_first_and_the_others_keep_their_places(self):
        sections = (Section("a", "a", (Prose("."),), GOOD), Section("b", "b", (Prose("."),), BAD))
        ordered = report(Prose("."), sections=(*sections, Section("end", "end", (Prose("."),)))).ordered
        assert [section.key for section in ordered] == ["first", "b", "a", "end"]

    def test_what_is_for_the_page_is_left_out(self):
        text = as_text(report(Prose("here"), Prose("there", on=("page",)), Group((Prose("inner", on=("page",)),))))
        assert "here" in text
        assert "there" not in text
        assert "inner" not in text

    def test_a_section_without_blocks_is_left_out(self):
        assert "First" not in as_text(report(Table((NUMBERS,), ()), Facts(())))

    def test_columns_that_need_room(self):
        wide = Table((Column("name", "name"), Column("explained", from_width=100)), (Row(("a", "why")),))
        assert "explained" in as_text(report(wide), 100)
        assert "explained" not in as_text(report(wide), 99)

    def test_columns_that_do_not_fit_come_in_further_tables(self):
        columns = (Column("name", "name"), *(Column(f"joint {k}", "number") for k in range(12)))
        text = as_text(report(Table(columns, (Row(("a", *map(float, range(12)))),))), 60)
        assert max(map(len, text.splitlines())) <= 60
        assert [text.count(f" {float(k)} ") for k in range(12)] == [1] * 12
        assert text.count("│ a ") == text.count("┏") > 1

    def test_headings_fold_before_a_table_is_divided(self):
        columns = (Column("name", "name"), *(Column(f"a rather long heading {k}", "number") for k in range(3)))
        long = Table(columns, (Row(("one two three", "10 ns", "20 ns", "30 ns")),))
        for width, heading, name in ((120, 1, 1), (60, 5, 1)):
            lines = as_text(report(long), width).splitlines()
            assert max(map(len, lines)) <= width
            start, middle = (next(k for k, line in enumerate(lines) if line[:1] == mark) for mark in "┏┡")
            assert middle - start - 1 == heading
            assert sum(line.startswith("│") for line in lines) == name
            assert all(f" {number} ns " in lines[middle + 1] for number in (10, 20, 30))

    def test_a_column_without_a_heading(self):
        columns = (Column("", "name"), *(Column(f"a rather long heading {k}", "number") for k in range(3)))
        text = as_text(report(Table(columns, (Row(("", "10 ns", "20 ns", "30 ns")), Row(("b", 1, 2, 3))))), 60)
        assert re.search(r"│ b +│ +1 │ +2 │ +3 │", text)

    def test_compact_tables_have_no_frames(self):
        columns = (Column("name", "name"), Column("p", "number"), Column("q", "number"))
        text = as_text(report(Table(columns, (Row(("a", 1, 2)), Row(("b", 3, 4), rule=True)), compact=True)))
        lines = [line.rstrip() for line in text.splitlines()]
        assert lines[-8:-2] == ["", "name p q", "────────", "a    1 2", "", "b    3 4"]

    def test_lines_side_by_side_or_not_at_all(self):
        blocks = (Lines(("1 2", "3 4"), title="S"), Lines(("x" * 80,), title="T"))
        assert "1 2   " in as_text(report(*blocks), 120)
        assert "x" * 80 in as_text(report(*blocks), 120)
        assert "\nT: too wide for 79 characters; --json and --html have it" in as_text(report(*blocks), 79)

    def test_no_template_and_no_plot_is_imported(self):
        code = (
            "import sys, crosscheck.report.text, crosscheck.commands.crosscheck.report;"
            "sys.exit(any(name in sys.modules for name in ('jinja2', 'matplotlib')))"
        )
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


class TestPage:
    def test_verdict_contents_sections(self):
        root = shown(Prose("words"), verdict=BAD, sections=(Section("b", "Second", (Prose("x"),), OPEN),))
        (banner,) = root.xpath("//header/div[@class='banner disagrees']")
        assert words(banner) == "✗ DISAGREES"
        assert [a.get("href") for a in root.xpath("//nav//a")] == ["#first", "#b"]
        assert [section.get("id") for section in root.xpath("//main/section")] == ["first", "b"]
        assert words(root.xpath("//section[@id='b']/h2")[0]) == "Second: ? undecided"

    def test_one_section_needs_no_contents(self):
        assert shown(Prose("words")).xpath("//nav") == []

    def test_failures_come_first(self):
        rows = shown(table(GOOD, BAD, OPEN)).xpath("//tbody/tr")
        assert [row.get("class").split()[0] for row in rows] == ["disagrees", "undecided", "agrees"]

    def test_long_names_are_whole_on_hover(self):
        name = "left_shoulder_roll_to_elbow_" * 2
        cell, *_ = shown(Table((Column("name", "name"),), (Row((name,)),))).xpath("//tbody//span")
        assert cell.get("title") == name
        (short,) = shown(Table((Column("name", "name"),), (Row(("arm",)),))).xpath("//tbody//span")
        assert short.get("title") is None

    def test_hover_and_link(self):
        rows = (Row(("a", Hover(1e-13, "why")), link="first"),)
        root = shown(Table((Column("name", "name"), NUMBERS), rows))
        assert root.xpath("//tbody//a/@href") == ["#first"]
        assert root.xpath("//tbody/tr/td/@title") == ["why"]

    def test_every_table_has_a_caption(self):
        (seen,) = shown(table(GOOD, caption="Errors")).iter("caption")
        (unseen,) = shown(table(GOOD, title="Joints")).iter("caption")
        assert (words(seen), seen.get("class")) == ("Errors", None)
        assert (words(unseen), unseen.get("class")) == ("Joints", "unseen")

    def test_notes_of_a_kind_are_folded_together_and_long_ones_alone(self):
        alike = tuple(Note(f"note {k}", "doubtful", f"link {k}") for k in range(5))
        root = shown(Notes((Note("first"), *alike, Note("x" * (MAX_NOTE_LENGTH + 1)))))
        (folded,) = root.xpath("//details[@class='notes']")
        assert words(folded.find("summary")) == "doubtful (5)"
        assert len(folded.xpath(".//li")) == 5
        assert len(root.xpath("//details[@class='long-note']")) == 1

    def test_folded_blocks(self):
        root = shown(Code("print(1)", title="Python", folded=True), Group((Facts((("a", "b"),)),), title="Inside"))
        assert words(root.xpath("//details/summary")[0]) == "Python"
        assert words(root.xpath("//h3")[0]) == "Inside"
        assert [words(x) for x in root.xpath("//dl[@class='facts']")[0]] == ["a", "b"]

    def test_pictures_get_keys_of_their_own(self):
        drawings = tuple(Picture(lambda key: Markup(f'<svg id="{key}"></svg>')) for _ in range(3))
        assert len(set(shown(*drawings).xpath("//svg/@id"))) == 3

    def test_text_is_escaped(self):
        root = shown(Prose("<b>"), Code("a < b"), Notes((Note("<i>", where="<u>"),)))
        assert not root.xpath("//b | //i | //u")

    def test_the_library_of_plots_comes_with_plots_only(self):
        assert not any("uPlot" in script.text for script in shown(Prose("x")).iter("script"))
        assert any("uPlot" in script.text for script in shown(curves()).iter("script"))


def curves(**options):
    x = np.linspace(0, 1, 50)
    series = (Series("measured", np.sin(x)), Series("predicted", np.cos(x), "dashed", 1), Series("far", x, hidden=True))
    panels = (Panel("torque", series, "N m"), Panel("residual", (Series("e", np.abs(x)),), log=True, level=0.5))
    return Plot(x, "t [s]", panels, "Torque over time", **options)


class TestPlots:
    def test_data_survive(self):
        """In single precision; every byte is decoded as the page does it."""
        plot = curves()
        data = json.loads(plot_data(plot))
        for panel, told in zip(plot.panels, data["panels"], strict=True):
            for one, there in zip(panel.series, told["series"], strict=True):
                y = np.frombuffer(base64.b64decode(there["y"]), dtype="<f4")
                assert np.array_equal(y, one.y.astype("f4"))
        assert [one["hidden"] for one in data["panels"][0]["series"]] == [False, False, True]

    def test_names_cannot_end_the_script(self):
        x = np.zeros(2)
        text = plot_data(Plot(x, "</script><b>", (Panel("p", (Series("<", x),)),), "label"))
        assert "<" not in text
        assert json.loads(text)["x_title"] == "</script><b>"

    def test_the_static_picture_names_the_curves_that_are_on(self):
        svg = plot_picture("k", curves())
        assert 'aria-label="Torque over time"' in svg
        for text in ("measured", "predicted", "torque [N m]", "t [s]"):
            assert f">{text}</text>" in svg
        assert ">far</text>" not in svg

    def test_thinned_curves_keep_their_extremes_and_gaps(self):
        rng = np.random.default_rng(0)
        y = rng.normal(size=20_000)
        y[777], y[12_345], y[5000:5100] = 50.0, -50.0, np.nan
        rows = thinned(y)
        assert len(rows) <= 3 * MAX_STATIC_POINTS
        assert {777, 12_345} <= set(rows.tolist())
        assert np.isnan(y[rows]).any()
        assert np.all(np.diff(rows) > 0)
        assert np.array_equal(thinned(y[:100]), np.arange(100))

    def test_times_in_units(self):
        """As 10 µs, whatever the unit of the axis was."""
        y = np.array([2e-7, 3e-5, 4e-3])
        panel = Panel("time per call", (Series("ours", y, low=y / 2, high=2 * y),), "s", log=True, prefixes=True)
        plot = Plot(np.array([1.0, 10.0, 100.0]), "samples", (panel,), "l", log_x=True, upright=10.0)
        svg = plot_picture("k", plot)
        for text in ("1 µs", "1 ms", "1", "10", "100", "time per call"):
            assert f">{text}</text>" in svg
        data = json.loads(plot_data(plot))
        assert (data["upright"], data["panels"][0]["prefixes"]) == (10.0, True)
        low, high = (np.frombuffer(base64.b64decode(data["panels"][0]["series"][0][e]), "<f4") for e in ("low", "high"))
        assert np.array_equal(low, (y / 2).astype("f4"))
        assert np.array_equal(high, (2 * y).astype("f4"))

    @pytest.mark.parametrize(("log_x", "pieces"), [(True, 1), (False, 2)])
    def test_lines_go_on_over_the_x_of_others(self, log_x, pieces):
        """On a logarithmic x, where several numbers of samples share the axis; in time, a gap is a gap."""
        y = np.array([1.0, 2.0, np.nan, 4.0, 5.0])
        plot = Plot(np.arange(1.0, 6.0), "x", (Panel("p", (Series("e", y),)),), "l", log_x=log_x)
        (line,) = re.findall(
            r'<path d="([^"]*)"[^>]*stroke: var\(--c0[^>]*stroke-width: 1\.3', plot_picture("k", plot)
        )[:1]
        assert line.count("M") == pieces

    def test_no_formula_in_a_label(self):
        """Text is not typeset: matplotlib's powers of ten would come as their source."""
        x = np.geomspace(1, 3, 4)
        assert "$" not in plot_picture("k", Plot(x, "x", (Panel("p", (Series("e", x),), log=True),), "l", log_x=True))

    def test_text_has_the_font_of_the_page(self):
        assert "font-family" not in plot_picture("k", curves())

    def test_zeros_on_a_logarithmic_axis_are_left_out(self):
        x = np.arange(3.0)
        svg = plot_picture("k", Plot(x, "x", (Panel("p", (Series("e", np.array([0.0, 1e-3, 1e-2])),), log=True),), "l"))
        assert "nan" not in svg.lower()

    def test_colors_follow_the_page(self):
        svg = plot_picture("k", curves())
        assert set(re.findall(r"var\((--\w+), #", svg)) >= {"--ink", "--faint", "--c0", "--c1"}
