"""`graphdyn robots`: the catalogue."""

from __future__ import annotations

from crosscheck.cli.delivery import deliver
from crosscheck.cli.options import EXAMPLES, JsonOption

EPILOG = f"""{EXAMPLES}  graphdyn robots
  graphdyn robots --json robots.json
"""


def run(json_file: JsonOption = None) -> None:
    """List the robots known by name, with origin and licence."""
    import urdf
    from crosscheck.report.commands.robots import robots_report

    deliver(robots_report(urdf.robots()), json_file=json_file)
