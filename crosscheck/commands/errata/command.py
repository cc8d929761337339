"""`graphdyn errata`: what the paper's printed errors do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.console import progress
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.options import EXAMPLES, JsonOptions, SeedOption

EPILOG = f"""{EXAMPLES}  graphdyn errata --samples 20
  graphdyn errata --json errata.json
"""


@dataclass(frozen=True, kw_only=True)
class ErrataOptions(JsonOptions):
    """What `graphdyn errata` is asked for."""

    samples: Annotated[int, typer.Option(min=10, metavar="N", help="Random states per robot.")] = 1000
    seed: SeedOption = 0


def run(options: ErrataOptions) -> None:
    """Measure what the printed errors of the paper do.

    Each is put back alone into the correct model of two arms, and the result compared with Pinocchio.
    """
    from crosscheck.commands.errata.report import errata_report
    from crosscheck.paper.errata import N_EFFECTS, measure

    with progress("errata", N_EFFECTS) as advance:
        effects = measure(
            options.samples, options.seed, lambda effect: advance(f"{effect.erratum} on {effect.robot}", 1)
        )
    deliver(errata_report(effects, options.samples, options.seed), options)
