"""Functions of a robot as files in C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import get_args

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.export.c.dialect import Dialect, Precision, Sines
from graphdyn.export.c.headers import c_header, cpp_header
from graphdyn.export.c.identifiers import checked_prefix, prefix_of
from graphdyn.export.c.internals import internal_header
from graphdyn.export.c.rows import rows_text
from graphdyn.export.c.sources import cmake_lists, source
from graphdyn.export.c.testing import test_program
from graphdyn.export.functions import AS_THEY_ARE, ExportChoices, ExportedFunction, exported_functions
from graphdyn.model.robot_model import RobotModel

USUAL_FUNCTIONS = ("joint_torques", "joint_accelerations", "mass_matrix", "solve_kkt")
"""The functions that are exported where none are named."""


MAX_OPERATIONS = 40_000
"""Operations of a function for which a compiler takes a minute; it takes longer than in proportion."""


@dataclass(frozen=True, eq=False)
@short_repr
class CCode:
    """Functions of one robot in C99, which need nothing but a compiler.

    name: with which all names in C begin, and those of the files
    files: contents by file name: NAME.h for C, NAME.hpp for C++, a source for each function, CMakeLists.txt, and
        NAME_test.c, which compares them with numbers of the equations
    functions: what the files compute
    """

    name: str
    precision: Precision
    sines: Sines
    files: Mapping[str, str]
    functions: tuple[ExportedFunction, ...]


def c_code(
    model: RobotModel,
    functions: Iterable[str] = USUAL_FUNCTIONS,
    choices: ExportChoices = AS_THEY_ARE,
    *,
    name: str | None = None,
    precision: Precision = "double",
    sines: Sines = "own",
) -> CCode:
    """Functions of a robot in C99, each for one state and for rows of states: no allocation, no state, no dependencies.

    functions: names of verbs, such as "joint_torques"; graphdyn.export.exportable lists those of a robot
    choices: external wrenches, a base that moves, and the frame that functions speak of
    name: with which all names in C begin; the robot's, as far as an identifier can have it, if left out
    precision: "single" computes with floats
    sines: "own" sine and cosine make vector instructions of several angles or states, for angles up to 1e6 rad; "libm"
        takes those of the C library

    As in graphdyn.compile, NaN, infinity and open loops are not looked for.

    Raises InvalidInput for a function that is none, has no compiled form for this robot, speaks of a frame where none
    is chosen, or is too long for compilers, and for a name that is no identifier; UnknownFrame; SingularMassMatrix and
    InconsistentState for robots whose accelerations are not determined, or whose loops cannot be closed.
    """
    for what, given, known in (("precision", precision, get_args(Precision)), ("sines", sines, get_args(Sines))):
        if given not in known:
            raise InvalidInput(f"{what} is {given!r}; use one of {', '.join(known)}")
    chosen = exported_functions(model, functions, choices)
    for function in chosen:
        _refuse_long(function)
    dialect = Dialect(prefix_of(model.name) if name is None else checked_prefix(name), precision, sines)
    prefix = dialect.name
    files = {
        f"{prefix}.h": c_header(model, chosen, dialect),
        f"{prefix}.hpp": cpp_header(model, chosen, dialect),
        f"{prefix}_internal.h": internal_header(dialect),
    }
    for function in chosen:
        files[f"{prefix}_{function.name}.c"] = source(function, dialect)
        files[f"{prefix}_{function.name}_rows.h"] = rows_text(function.program, dialect)
    files[f"{prefix}_test.c"] = test_program(chosen, dialect)
    files["CMakeLists.txt"] = cmake_lists(chosen, dialect)
    return CCode(prefix, precision, sines, files, tuple(chosen))


def _refuse_long(function: ExportedFunction) -> None:
    count = function.program.arithmetic
    if count > MAX_OPERATIONS:
        raise InvalidInput(
            f"{function.name} of robot '{function.model.name}' is {count} operations in a row, for which C compilers "
            f"take minutes; {MAX_OPERATIONS} are written at most: leave it out, or lock joints"
        )
