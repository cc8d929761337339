"""`graphdyn errata`: what the paper's printed errors do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from crosscheck.cli.console import out, progress
from crosscheck.cli.options import EXAMPLES, JsonOption, SeedOption, check_writable

if TYPE_CHECKING:
    from rich.table import Table

    from crosscheck.studies.errata import Effect

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
    check_writable(json=json_file)
    from crosscheck.studies.errata import EFFECTS, ERRATA, measure

    with progress("errata", EFFECTS) as advance:
        effects = measure(samples, seed, lambda effect: advance(f"{effect.erratum} on {effect.robot}", 1))
    out.print(effects_table(effects))
    for name, sentence in ERRATA.items():
        out.print(f"{name}: {sentence}", soft_wrap=True)
    if json_file is not None:
        from crosscheck.report.json import write_json
        from crosscheck.report.records.errata import record

        write_json(json_file, record(effects))


def effects_table(effects: Sequence[Effect]) -> Table:
    """One row per erratum, robot and, for A3, distance from gimbal lock."""
    from rich.table import Table

    table = Table("erratum", "robot", "measured", "median", "90 %", "largest", "corrected form, largest")
    for effect in effects:
        numbers = (f"{value:.2g}" for value in (effect.median, effect.upper, effect.largest, effect.corrected))
        table.add_row(effect.erratum, effect.robot, effect.measure, *numbers)
    return table
