"""`graphdyn errata`: what the paper's printed errors do."""

from __future__ import annotations

from typing import Annotated

import typer

from crosscheck.commands.program.console import progress
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.options import EXAMPLES, JsonOption, SeedOption

EPILOG = f"""{EXAMPLES}  graphdyn errata --samples 20
  graphdyn errata --json errata.json
"""


def run(
    samples: Annotated[int, typer.Option(min=10, metavar="N", help="Random states per robot.")] = 1000,
    seed: SeedOption = 0,
    json_file: JsonOption = None,
) -> None:
    """Measure what the printed errors of the paper do.

    Each is put back alone into the correct model of two arms, and the result compared with Pinocchio.
    """
    from crosscheck.commands.errata.report import errata_report
    from crosscheck.paper.errata import N_EFFECTS, measure

    with progress("errata", N_EFFECTS) as advance:
        effects = measure(samples, seed, lambda effect: advance(f"{effect.erratum} on {effect.robot}", 1))
    deliver(errata_report(effects, samples, seed), json_file=json_file)
