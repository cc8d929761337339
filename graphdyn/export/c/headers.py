"""The headers for users: in C with shapes, units, order and limits of the joints, in C++ with arrays of known sizes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence

from graphdyn.compiler.llvm.precision import DOUBLE
from graphdyn.export.c.dialect import Dialect
from graphdyn.export.c.identifiers import comment, comment_text
from graphdyn.export.functions import ExportedFunction
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.declarations import ArraySpec

LINE = 110

ARRAY_MEANINGS = {
    "external_wrenches": "force and moment on each body at the origin of its link, in link axes",
    "base_rotation": "to world axes; the ground frame stands on the moving base",
    "base_translation": "in world axes",
    "base_velocity": "of its origin, then angular, in world axes",
    "base_acceleration": "of its origin, then angular, in world axes",
    "body_accelerations": "of the center of mass in world axes, then angular in link axes",
    "multipliers": "constraint reaction of the inside body on each body",
    "joint_wrenches": "force and moment on each body at its joint, actuator included, in link axes",
}
"""What arrays mean, where name and shape do not say it."""

_HEADER = """#ifndef @NAME@_H
#define @NAME@_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    @NAME@_N = @n@, /* joints: entries of q, v, a and tau */
    @NAME@_BODIES = @bodies@
};

/* What functions return, joined by |. */
enum {
@statuses@
};

@functions@
#ifdef __cplusplus
}
#endif

#endif
"""

STATUSES = {
    "OK": "",
    "WRONG_N": "the robot has another number of joints: nothing is computed",
    "FAR_ANGLE": f"an angle is beyond {DOUBLE.max_angle:g} rad or no number: results have fewer digits or none",
    "SINGULAR": "the mass matrix is singular or nearly so: results have fewer digits or none",
}
"""What functions return: a bit each, the first one none."""


def declaration(function: ExportedFunction, dialect: Dialect, *, batch: bool) -> str:
    """The declaration of a function without its semicolon."""
    arguments = ["int n", *(["size_t rows"] if batch else [])]
    arguments += [f"const {dialect.real} *{array}" for array in function.inputs]
    arguments += [f"{dialect.real} *{array}" for array in function.outputs]
    return _call(f"int {dialect.name}_{function.name}{'_batch' if batch else ''}", arguments)


def _call(start: str, arguments: Iterable[str], end: str = "") -> str:
    """start(arguments)end, in lines of a readable length."""
    lines = [f"{start}("]
    for argument in arguments:
        if len(lines[-1]) + len(argument) + len(end) > LINE - 4:
            lines.append("        ")
        lines[-1] += f"{argument}, "
    return "\n".join(line.rstrip() for line in [*lines[:-1], f"{lines[-1].removesuffix(', ')}){end}"])


def c_header(model: RobotModel, functions: Sequence[ExportedFunction], dialect: Dialect) -> str:
    """NAME.h."""
    statuses = [
        f"    {dialect.upper}_{name} = {1 << number >> 1}{',' * (name != 'SINGULAR')}"
        + (f" /* {text} */" if text else "")
        for number, (name, text) in enumerate(STATUSES.items())
    ]
    described = [
        "\n".join(
            [
                comment(_description(function)),
                *(f"{declaration(function, dialect, batch=batch)};" for batch in (False, True)),
                "",
            ]
        )
        for function in functions
    ]
    text = dialect.filled(
        _HEADER,
        n=model.nv,
        bodies=model.n_bodies,
        statuses="\n".join(statuses),
        functions="\n".join(described),
    )
    return f"{comment(_head(model, dialect))}\n{text}"


def _head(model: RobotModel, dialect: Dialect) -> Iterator[str]:
    def wrapped(text: str, indent: str = "") -> list[str]:
        return textwrap.wrap(text, LINE, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False)

    yield f"Rigid-body dynamics of {comment_text(model.name)}, written by graphdyn."
    yield ""
    yield from wrapped(
        "A function takes the number of joints n, its arguments, and room for its results, which overlap with no other "
        f"array. It returns {dialect.upper}_OK or what is wrong. That with _batch takes rows of each array, one for "
        "each state, without gaps, and returns what is wrong in any of them. Matrices are stored row by row. Functions "
        "keep nothing between calls, allocate nothing, and run in any number of threads at once. They do not look for "
        "NaN and infinity, nor for open loops."
    )
    yield ""
    yield f"Numbers are {dialect.real}s in SI units. Gravity is ({', '.join(f'{x:g}' for x in model.gravity)}) m/s^2."
    yield ""
    yield "Joints in the order of q, v, a and tau, and their limits, which nothing here keeps:"
    yield from _table(_joint_rows(model))
    driven = [joint for joint in model.joint_names if joint not in model.independent_joints]
    if driven:
        yield from wrapped(f"Joints that these drive: {', '.join(map(comment_text, driven))}")
    yield "Bodies in the order of arrays with a row for each:"
    yield from wrapped(", ".join(map(comment_text, model.body_names)), "  ")


def _joint_rows(model: RobotModel) -> Iterator[tuple[str, ...]]:
    yield "", "joint", "kind", "lower", "upper", "velocity", "effort"
    for number, k in enumerate(model.degrees_of_freedom.independent):
        joint, limits = model.joints[k], model.joints[k].limits
        position, effort = ("m", "N") if joint.is_prismatic else ("rad", "N m")
        of_limits = (limits.lower, position), (limits.upper, position), (limits.velocity, f"{position}/s")
        told = ("-" if x is None else f"{x:g} {unit}" for x, unit in (*of_limits, (limits.effort, effort)))
        yield str(number), comment_text(joint.name), joint.kind, *told


def _description(function: ExportedFunction) -> Iterator[str]:
    yield f"{', '.join(function.outputs)} = {function.name}({', '.join(function.inputs)})"
    if function.frame is not None:
        frame = function.frame
        kind = f", {'classical' if frame.classical else 'spatial'}" if function.name == "frame_acceleration" else ""
        yield f"  frame {comment_text(frame.name)}, reference {frame.reference}{kind}"
    arrays = {**function.inputs, **function.outputs}
    yield from _table(
        (name, _shape(function.shape(name)), _unit(spec), ARRAY_MEANINGS.get(name, "")) for name, spec in arrays.items()
    )


def _shape(sizes: Sequence[int]) -> str:
    return f"({', '.join(map(str, sizes))})" if sizes else "one number"


def _unit(spec: ArraySpec) -> str:
    return f"[{spec.unit.replace('²', '^2')}]"


def _table(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    table = list(rows)
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


_CPP = """#ifndef @NAME@_HPP
#define @NAME@_HPP

#include <array>
#include <cstddef>

#include "@name@.h"

namespace @name@ {

constexpr std::size_t n = @n@;
constexpr std::size_t bodies = @bodies@;

using Joints = std::array<@real@, n>;

@functions@
} // namespace @name@

#endif
"""


def cpp_header(model: RobotModel, functions: Sequence[ExportedFunction], dialect: Dialect) -> str:
    """NAME.hpp: the same functions in a namespace, of arrays whose sizes are part of their types."""
    what = f"The functions of {dialect.name}.h for one state, with arrays of known sizes, for C++11 and later."
    text = "\n".join("\n".join(_cpp_function(function, dialect)) for function in functions)
    return f"{comment([what])}\n" + dialect.filled(_CPP, n=model.nv, bodies=model.n_bodies, functions=text)


def _cpp_function(function: ExportedFunction, dialect: Dialect) -> Iterator[str]:
    arrays = {**function.inputs, **function.outputs}
    types = {name: _cpp_type(function, name, dialect) for name in arrays}
    arguments = [f"{'const ' * (name in function.inputs)}{kind} &{name}" for name, kind in types.items()]
    passed = [f"{name}.data()" if function.shape(name) else f"&{name}" for name in arrays]
    yield _call(f"inline int {function.name}", arguments, " noexcept")
    yield "{"
    yield _call(f"    return ::{dialect.name}_{function.name}", [f"{dialect.upper}_N", *passed], ";")
    yield "}\n"


def _cpp_type(function: ExportedFunction, array: str, dialect: Dialect) -> str:
    shape = function.shape(array)
    if {**function.inputs, **function.outputs}[array].shape == ("n",):
        return "Joints"
    return f"std::array<{dialect.real}, {function.size(array)}>" if shape else dialect.real
