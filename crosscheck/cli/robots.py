"""`graphdyn robots`: the catalogue."""

from __future__ import annotations

from crosscheck.cli.console import out
from crosscheck.cli.options import EXAMPLES, JsonOption, check_writable

FORMAT = "graphdyn robots 1"

EPILOG = f"""{EXAMPLES}  graphdyn robots
  graphdyn robots --json robots.json
"""


def run(json_file: JsonOption = None) -> None:
    """List the robots known by name, with origin and licence."""
    check_writable(json=json_file)
    from rich.table import Table

    import urdf
    from crosscheck.report.comparisons import write_json

    table = Table("name", "origin", "licence")
    entries = urdf.robots()
    for entry in entries:
        table.add_row(entry.name, entry.origin, entry.licence)
    out.print(table)
    if json_file is not None:
        rows = [{"name": e.name, "path": str(e.path), "origin": e.origin, "licence": e.licence} for e in entries]
        write_json(json_file, {"format": FORMAT, "robots": rows})
