"""`graphdyn paper`: the tables and results of the paper beside the corrected model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.console import progress
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, SeedOption

EPILOG = f"""{EXAMPLES}  graphdyn paper --samples 20
  graphdyn paper --html paper.html
  graphdyn paper --json paper.json
"""


@dataclass(frozen=True, kw_only=True)
class PaperOptions(ReportOptions):
    """What `graphdyn paper` is asked for."""

    samples: Annotated[int, typer.Option(min=10, metavar="N", help="Random states per robot for the errata.")] = 300
    seed: SeedOption = 0


def run(options: PaperOptions) -> None:
    """Show the paper beside the corrected model.

    Tables 2 to 4 and the multipliers of section 3.2, each beside what the corrected model gives and with the reason
    where they differ; then what the printed errors do. Pinocchio is the judge.
    """
    from crosscheck.commands.paper.report import paper_report
    from crosscheck.paper.errata import N_EFFECTS
    from crosscheck.paper.reproduction import PROGRESS_STEPS, reproduce

    with progress("paper", len(PROGRESS_STEPS) + N_EFFECTS) as advance:
        found = reproduce(options.samples, options.seed, lambda what: advance(what, 1))
    deliver(paper_report(found), options)
    raise typer.Exit(AGREED if found.agrees else DISAGREED)
