"""`graphdyn vectors`: test vectors of one robot, for test suites without Python."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from crosscheck.commands.program.console import out, progress, warnings_shown
from crosscheck.commands.program.judged_functions import (
    BeyondLimitsOption,
    ConventionOption,
    ExternalWrenchesOption,
    FrameOption,
    GravityOption,
    PrecisionOption,
    names,
    pairs,
)
from crosscheck.commands.program.options import (
    EXAMPLES,
    ChainOption,
    LockOption,
    RobotArgument,
    SamplesOption,
    SeedOption,
    command_line,
    locked_joints,
)
from crosscheck.commands.program.output_files import refuse_folder, write_folder

EPILOG = f"""{EXAMPLES}  graphdyn vectors ur5 --out vectors/
  graphdyn vectors arm.urdf --for inverse_dynamics,mass_matrix --out tests/arm_vectors
  graphdyn vectors arm.urdf --frame tool0 --convention reference=local --out vectors/
"""

TABLE, MODEL = "vectors.json", "model.json"
"""Names of the file that lists the others, and of the exported model."""

OutOption = Annotated[
    Path, typer.Option("--out", metavar="FOLDER", help="The folder; it may exist from an earlier run.")
]
ForOption = Annotated[
    str | None,
    typer.Option(
        "--for",
        metavar="NAME,NAME,…",
        help="The functions, of those `graphdyn judge --help` lists; all that Pinocchio confirms, if left out.",
    ),
]


def run(
    robot: RobotArgument,
    folder: OutOption,
    functions: ForOption = None,
    frame: FrameOption = None,
    convention: ConventionOption = None,
    external_wrenches: ExternalWrenchesOption = False,
    samples: SamplesOption = 20,
    seed: SeedOption = 0,
    precision: PrecisionOption = "double",
    beyond_limits: BeyondLimitsOption = False,
    lock: LockOption = None,
    chain: ChainOption = None,
    gravity: GravityOption = None,
) -> None:
    """Write test vectors for a test suite in any language.

    A folder to keep: for each function a CSV file whose rows hold arguments, answer and the tolerance of each number,
    confirmed by all reference implementations; the model; and vectors.json, which lists the files with units, scales,
    versions and hashes. docs/languages.md has readers of twenty lines.
    """
    refuse_folder("--out", folder, TABLE)
    from crosscheck.commands.export import record as export
    from crosscheck.commands.vectors import record as vectors
    from crosscheck.judging.exchange.vectors import confirmed_functions, vector_tables
    from crosscheck.judging.setting import TOLERANCES, Setting
    from crosscheck.reference.subject import subject
    from crosscheck.report.json import as_bytes, plain
    from urdf import Reading

    setting = Setting(
        robot=robot,
        samples=samples,
        seed=seed,
        beyond_limits=beyond_limits,
        reading=Reading(lock=locked_joints(lock) or None, chain=chain, gravity=gravity),
        frame=frame,
        external_wrenches=external_wrenches,
    )
    chosen, bound = names(functions) or confirmed_functions(frame), TOLERANCES[precision].bound
    tables = {}
    with progress(robot, len(chosen)) as advance, warnings_shown():
        model = subject(robot, setting.reading).model.uncoupled
        for table in vector_tables(setting, chosen, dict(pairs("--convention", convention, "NAME=WAY")), bound):
            tables[f"{table.known.name}.csv"] = table, table.csv()
            advance(table.known.name, 1)
    exported = as_bytes(plain(export.record(model, robot, setting.reading.locked)))
    listed = vectors.record(robot, model, frame, seed, bound, (MODEL, exported), tables, command_line())
    files = {name: content for name, (_, content) in tables.items()}
    write_folder(folder, {**files, MODEL: exported, TABLE: as_bytes(plain(listed))})
    out.print(f"{len(tables)} functions at {listed.states} states in {folder}, sha256 {listed.sha256}")
