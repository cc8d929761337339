"""`graphdyn robots`: the catalogue."""

from __future__ import annotations

from crosscheck.cli.console import out
from crosscheck.cli.options import EXAMPLES, JsonOption, check_writable

EPILOG = f"""{EXAMPLES}  graphdyn robots
  graphdyn robots --json robots.json
"""


def run(json_file: JsonOption = None) -> None:
    """List the robots known by name, with origin and licence."""
    check_writable(json=json_file)
    from rich.table import Table

    import urdf

    table = Table("name", "origin", "licence")
    entries = urdf.robots()
    for entry in entries:
        table.add_row(entry.name, entry.origin, entry.licence)
    out.print(table)
    if json_file is not None:
        from crosscheck.report.json import write_json
        from crosscheck.report.records.robots import record

        write_json(json_file, record(entries))
