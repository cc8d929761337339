"""`graphdyn errata`: what the paper's printed errors do."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from crosscheck.program.console import out, progress
from crosscheck.program.options import EXAMPLES, JsonOption, SeedOption, check_writable

FORMAT = "graphdyn errata 1"

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
    from rich.table import Table

    from crosscheck.errata import EFFECTS, ERRATA, measure
    from crosscheck.report import finite, versions, write_json

    with progress("errata", EFFECTS) as advance:
        effects = measure(samples, seed, lambda effect: advance(f"{effect.erratum} on {effect.robot}", 1))
    table = Table("erratum", "robot", "measured", "median", "90 %", "largest", "corrected form, largest")
    for effect in effects:
        numbers = (f"{value:.2g}" for value in (effect.median, effect.upper, effect.largest, effect.corrected))
        table.add_row(effect.erratum, effect.robot, effect.measure, *numbers)
    out.print(table)
    for name, sentence in ERRATA.items():
        out.print(f"{name}: {sentence}", soft_wrap=True)
    if json_file is not None:
        rows = [finite(asdict(effect)) for effect in effects]
        write_json(json_file, {"format": FORMAT, "versions": versions(), "effects": rows})
