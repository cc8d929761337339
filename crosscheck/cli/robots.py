"""`graphdyn robots`: the catalogue."""

from __future__ import annotations

from crosscheck.cli.delivery import deliver
from crosscheck.cli.options import EXAMPLES, JsonOption, check_writable

EPILOG = f"""{EXAMPLES}  graphdyn robots
  graphdyn robots --json robots.json
"""


def run(json_file: JsonOption = None) -> None:
    """List the robots known by name, with origin and licence."""
    check_writable(json=json_file)
    import urdf
    from crosscheck.report.commands.robots import robots_report

    deliver(robots_report(urdf.robots()), json_file=json_file)
