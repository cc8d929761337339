"""Blocks of a report, and the texts of its tables."""

from crosscheck.report.report import Group, Table


def blocks(report, key):
    """Those of a section, in their order; of a group its own, where it has no key."""
    (section,) = [one for one in report.sections if one.key == key]
    found = []
    for block in section.blocks:
        found += block.blocks if isinstance(block, Group) and not block.key else [block]
    return found


def tables(report, key):
    return [block for block in blocks(report, key) if isinstance(block, Table)]


def texts(table):
    """Cells, row by row."""
    return [[column.text(value) for column, value in zip(table.columns, row.cells, strict=True)] for row in table.rows]


def cells(table):
    """The same by the first cell."""
    return {first: others for first, *others in texts(table)}
