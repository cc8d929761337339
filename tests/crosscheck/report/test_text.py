"""Tables of a report on terminals of any width."""

import pytest

from crosscheck.report.report import Column, Prose, Report, Row, Section, Table, Verdict
from crosscheck.report.text import as_text

JOINTS = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint")


def text(table, width):
    return as_text(Report("", None, (Section("one", "", (table,)),), dict), width)


def errors():
    """A number per joint, under names that are longer."""
    columns = (Column("method", "name"), *(Column(name, "number", form=".3f") for name in JOINTS))
    return Table(columns, (Row(("consistent, entropic prior", *(k + 1.234 for k in range(6)))),))


def headings(text):
    """Of every table, its lines above the first row."""
    return [[line for line in part.splitlines() if "┃" in line] for part in text.split("┡")[:-1]]


def test_headings_stay_whole_where_there_is_room():
    (lines,) = headings(text(errors(), 160))
    assert len(lines) == 1
    assert all(name in lines[0] for name in JOINTS)


def test_headings_are_folded_before_a_table_is_divided():
    said = text(errors(), 100)
    (lines,) = headings(said)
    assert [line.split("┃")[2].strip() for line in lines] == ["", "shoulder_", "pan_joint"]
    assert "consistent, entropic" in said


def test_a_divided_table_has_about_as_many_columns_in_each_part():
    said = text(errors(), 72)
    assert [lines[0].count("┃") - 2 for lines in headings(said)] == [3, 3]
    assert said.count("│ consistent, entropic") == 2


@pytest.mark.parametrize("width", range(40, 140, 7))
def test_no_number_is_cut(width):
    said = text(errors(), width)
    assert max(map(len, said.splitlines())) <= width
    for k in range(6):
        assert f" {k + 1.234:.3f} " in said


def test_text_is_wrapped_at_words():
    table = Table(
        (Column("link", "name"), Column("position", "vector"), Column("mass", "number", "kg")),
        (Row(("forearm", "0.1234 0.5678 0.9012", "12.5")),),
    )
    said = text(table, 34)
    assert max(map(len, said.splitlines())) <= 34
    assert all(word in said for word in ("forearm", "0.1234", "0.5678", "0.9012", "12.5"))


def test_a_table_without_rows_but_columns():
    assert text(Table((Column("link", "name"),), ()), 80) == ""


@pytest.mark.parametrize(
    ("width", "last"),
    [(80, "Robots: agrees. All do. Some\nare shown."), (30, "Robots: agrees. All do."), (20, "Robots: agrees")],
)
def test_the_last_line_is_the_verdict(width, last):
    """With the reason, its first sentence, or without, as the line has room: the end is what people read."""
    verdict = Verdict("agrees", "agrees", "All do. Some\nare shown.")
    table = Table((Column("link", "name"),), (Row(("base",)),))
    lines = [
        line.strip()
        for line in as_text(Report("Robots", verdict, (Section("one", "one", (table,)),)), width).rstrip().splitlines()
    ]
    assert lines[0] == "Robots: agrees"
    assert lines[-2:] == ["", last.replace("\n", " ")]


def test_nothing_to_end():
    """What has no verdict, and what is short."""
    section = Section("one", "one", (Prose("words"),))
    for verdict in (None, Verdict("agrees", "agrees")):
        assert as_text(Report("Robots", verdict, (section,))).rstrip().endswith("words")
    assert as_text(Report("Robots", Verdict("agrees", "agrees"), ())) == "Robots: agrees\n"
