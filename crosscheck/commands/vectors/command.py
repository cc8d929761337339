"""`graphdyn vectors`: test vectors of one robot, for test suites without Python."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

import typer

from crosscheck.commands.program.console import out, progress, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.judged_functions import ConventionOptions, SettingOptions, names
from crosscheck.commands.program.options import EXAMPLES, SamplesOption, command_line
from crosscheck.commands.program.output_files import refuse_folder, write_folder
from graphdyn.errors import counted

EPILOG = f"""{EXAMPLES}  graphdyn vectors ur5 --out vectors/
  graphdyn vectors arm.urdf --for inverse_dynamics,mass_matrix --out tests/arm_vectors
  graphdyn vectors arm.urdf --digits 30 --out tests/arm_vectors
  graphdyn vectors arm.urdf --frame tool0 --convention reference=local --out vectors/
"""

TABLE, MODEL = "vectors.json", "model.json"
"""Names of the file that lists the others, and of the exported model."""


@dataclass(frozen=True, kw_only=True)
class VectorsOptions(ConventionOptions, SettingOptions):
    """What `graphdyn vectors` is asked for."""

    folder: Annotated[
        Path, typer.Option("--out", metavar="FOLDER", help="Folder of the vectors; it may exist from an earlier run.")
    ]
    functions: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="NAME,NAME,…",
            show_default="all that Pinocchio confirms",
            help="The functions, of those that `graphdyn judge --help` lists.",
        ),
    ] = None
    samples: SamplesOption = 20
    digits: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=250,
            metavar="N",
            show_default="doubles alone",
            help="Exact answers, too, with so many proven digits; needs the extra exact.",
        ),
    ] = None
    truth: Annotated[
        Literal["file", "model"],
        typer.Option(help="What is exact (with --digits): the decimals of the file, or the doubles of the model."),
    ] = "file"


def run(options: VectorsOptions) -> None:
    """Write test vectors for a test suite in any language.

    A folder to keep: for each function a CSV file whose rows hold arguments, answer and the tolerance of each number,
    confirmed by all reference implementations; the model; and vectors.json, which lists the files with units, scales,
    versions and hashes. docs/languages.md has readers of twenty lines. With --digits a second file for each function
    holds the answers as decimals that are proven.
    """
    robot, frame, folder = options.robot, options.frame, options.folder
    refuse_folder("--out", folder, TABLE)
    from crosscheck.commands.export import record as export
    from crosscheck.commands.vectors import record as vectors
    from crosscheck.judging.exchange.proven_digits import ProvenDigits
    from crosscheck.judging.exchange.vectors import confirmed_functions, vector_tables
    from crosscheck.reference.subject import subject

    setting = replace(options.setting, conventions=options.conventions, precision=options.precision)
    chosen = names(options.functions) or confirmed_functions(frame)
    digits = None if options.digits is None else ProvenDigits(options.digits, options.truth)
    tables, files = {}, {}
    with progress(robot, len(chosen)) as advance, warnings_shown():
        model = subject(robot, setting.reading).model.uncoupled
        for table in vector_tables(setting, chosen, digits):
            name = table.known.name
            tables[f"{name}.csv"], files[f"{name}.csv"] = table, table.csv()
            if table.exact is not None:
                files[f"{name}_exact.csv"] = table.exact_csv()
            advance(name, 1)
    exported = json_content(export.record(export.ExportedModel(model, robot, setting.reading)))
    listed = vectors.record(
        robot, model, frame, options.seed, setting.bound, digits, (MODEL, exported), tables, files, command_line()
    )
    write_folder(folder, {**files, MODEL: exported, TABLE: json_content(listed)})
    out.print(f"{counted(len(tables), 'function')} at {listed['states']} states in {folder}, sha256 {listed['sha256']}")
