"""`graphdyn robots`: the catalog."""

from __future__ import annotations

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.options import EXAMPLES, JsonOptions

EPILOG = f"""{EXAMPLES}  graphdyn robots
  graphdyn robots --json robots.json
"""


def run(options: JsonOptions) -> None:
    """List the robots known by name, with origin and licence."""
    import urdf
    from crosscheck.commands.robots.record import robots_report

    deliver(robots_report(urdf.robots()), options)
