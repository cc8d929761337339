"""The sources of the functions, and what CMake builds of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from graphdyn.export.c.dialect import Dialect
from graphdyn.export.c.headers import declaration
from graphdyn.export.functions import ExportedFunction

MAX_VECTORIZED_OPERATIONS = 8_000
"""Operations up to which a batch computes several rows at once. Beyond, compilers take more than ten seconds for it,
and its numbers do not fit into the first-level cache."""


def source(function: ExportedFunction, dialect: Dialect) -> str:
    """The file of a function: it includes its rows for one lane and for many, and deals rows out to them."""
    vectorized = function.program.arithmetic <= MAX_VECTORIZED_OPERATIONS
    batch = _batch if vectorized else _row_after_row
    return "\n".join([*_rows(function, dialect, vectorized), *_one(function, dialect), *batch(function, dialect)])


def _rows(function: ExportedFunction, dialect: Dialect, vectorized: bool) -> Iterator[str]:
    whole = f"{dialect.name}_{function.name}"
    yield f'#include "{dialect.name}_internal.h"\n'
    for what, lanes in (("one", "1"), *([("many", f"{dialect.upper}_LANES")] if vectorized else [])):
        yield f"#define ROWS {whole}_{what}\n#define LANES {lanes}"
        yield f'#include "{whole}_rows.h"\n#undef ROWS\n#undef LANES\n'


def _one(function: ExportedFunction, dialect: Dialect) -> Iterator[str]:
    yield declaration(function, dialect, batch=False)
    yield "{"
    yield _refusal(dialect)
    yield f"    return {dialect.name}_{function.name}_one({', '.join([*function.inputs, *function.outputs])});"
    yield "}\n"


def _batch(function: ExportedFunction, dialect: Dialect) -> Iterator[str]:
    arrays, lanes = [*function.inputs, *function.outputs], f"{dialect.upper}_LANES"
    yield declaration(function, dialect, batch=True)
    yield "{"
    for array in arrays:
        yield f"    {dialect.real} lanes_{array}[{function.size(array)} * {lanes}];"
    yield f"    int status = {dialect.upper}_OK;"
    yield _refusal(dialect)
    yield f"    for (size_t row = 0; row < rows; row += {lanes}) {{"
    yield f"        const size_t left = rows - row, lanes = {lanes}, count = left < lanes ? left : lanes;"
    for array in function.inputs:
        size = function.size(array)
        yield f"        {dialect.name}_gather({array} + {size} * row, count, {size}, lanes_{array});"
    yield f"        status |= {dialect.name}_{function.name}_many({', '.join(f'lanes_{array}' for array in arrays)});"
    for array in function.outputs:
        size = function.size(array)
        yield f"        {dialect.name}_scatter(lanes_{array}, count, {size}, {array} + {size} * row);"
    yield "    }"
    yield "    return status;"
    yield "}\n"


def _row_after_row(function: ExportedFunction, dialect: Dialect) -> Iterator[str]:
    """A batch without lanes."""
    each = (f"{array} + {function.size(array)} * row" for array in (*function.inputs, *function.outputs))
    yield declaration(function, dialect, batch=True)
    yield "{"
    yield f"    int status = {dialect.upper}_OK;"
    yield _refusal(dialect)
    yield "    for (size_t row = 0; row < rows; ++row)"
    yield f"        status |= {dialect.name}_{function.name}_one({', '.join(each)});"
    yield "    return status;"
    yield "}\n"


def _refusal(dialect: Dialect) -> str:
    return f"    if (n != {dialect.upper}_N)\n        return {dialect.upper}_WRONG_N;"


_CMAKE = """cmake_minimum_required(VERSION 3.10)
project(@name@ C)

option(@NAME@_NATIVE "Compile for the processor of this machine" OFF)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library(@name@
@sources@)
target_include_directories(@name@ PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
set_target_properties(@name@ PROPERTIES
  C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON WINDOWS_EXPORT_ALL_SYMBOLS ON)
if(UNIX)
  target_link_libraries(@name@ PUBLIC m)
endif()
if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
  # products and sums may round once together, where the processor can; loops over lanes become vector instructions
  target_compile_options(@name@ PRIVATE $<$<NOT:$<CONFIG:Debug>>:-O3> -ffp-contract=fast)
  if(@NAME@_NATIVE)
    target_compile_options(@name@ PRIVATE -march=native)
  endif()
endif()

if(CMAKE_CURRENT_SOURCE_DIR STREQUAL CMAKE_SOURCE_DIR)
  enable_testing()
  add_executable(@name@_test @name@_test.c)
  set_target_properties(@name@_test PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
  target_link_libraries(@name@_test @name@)
  add_test(NAME @name@ COMMAND @name@_test)
endif()
"""


def cmake_lists(functions: Sequence[ExportedFunction], dialect: Dialect) -> str:
    """CMakeLists.txt: a library, and where it is not part of another project the test."""
    files = (f"  {dialect.name}_{function.name}.c" for function in functions)
    return dialect.filled(_CMAKE, sources="\n".join(files))
