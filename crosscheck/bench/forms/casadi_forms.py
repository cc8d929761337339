"""CasADi in the benchmark: C code for one state, from graphdyn's recorded recursions, compiled for this machine."""

from __future__ import annotations

import operator
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.bench.contender import AMORTIZED_SAMPLES, Contender
from crosscheck.bench.states import States
from graphdyn import GraphDynError
from graphdyn.compiler import Request, trace
from graphdyn.layout import Array
from graphdyn.scalars import Program

CASADI_NAME = "casadi code generation"
COMPILER_FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")
CASADI_NOTE = (
    f"C code of one state, cc {' '.join(COMPILER_FLAGS[:2])}, mapped over the samples by CasADi in given memory"
)


class CasadiRefuses(GraphDynError):
    """CasADi or a C compiler is missing, or the compiler fails."""


def inverse(states: States, folder: Path) -> list[Contender]:
    program = trace(states.model, Request("inverse_dynamics", ("tau",)))
    run = _compiled(program, "tau", {"q": states.q, "v": states.v, "a": states.a}, folder)
    return [Contender(CASADI_NAME, 1, run, states.torque_errors, CASADI_NOTE, least=AMORTIZED_SAMPLES)]


def forward(states: States, folder: Path) -> list[Contender]:
    program = trace(states.model, Request("forward_dynamics", ("a",)))
    run = _compiled(program, "a", {"q": states.q, "v": states.v, "tau": states.tau}, folder)
    return [Contender(CASADI_NAME, 1, run, states.acceleration_errors, CASADI_NOTE, least=AMORTIZED_SAMPLES)]


def _compiled(program: Program, output: str, arrays: dict[str, Array], folder: Path) -> Callable[[int], Array]:
    """run(count) on the first rows of the arrays. Raises CasadiRefuses."""
    try:
        import casadi
    except ImportError:
        raise CasadiRefuses("the package casadi is not installed: pip install 'graphdyn[peers]'") from None
    compiler = shutil.which("cc")
    if compiler is None:
        raise CasadiRefuses("CasADi generates C code, and there is no C compiler (cc)")
    name = f"{output}_of_one_state"
    function = casadi_function(casadi, program, output, name)
    generator = casadi.CodeGenerator(f"{name}.c")
    generator.add(function)
    source, library = folder / f"{name}.c", folder / f"{name}.so"
    source.write_text(generator.dump(), encoding="utf-8")
    done = subprocess.run(
        [compiler, *COMPILER_FLAGS, str(source), "-o", str(library), "-lm"], capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise CasadiRefuses(f"the C compiler fails on CasADi's code: {' '.join(done.stderr.split())}")
    native = casadi.external(name, str(library))
    out = np.empty((len(arrays["q"]), len(program.outputs[output])))
    prepared: dict[int, Callable[[], object]] = {}

    def run(count: int) -> Array:
        if count not in prepared:
            prepared[count] = _on_buffers(native.map(count), [arrays[k][:count] for k in program.inputs], out[:count])
        prepared[count]()
        return out[:count]

    return run


def casadi_function(casadi: Any, program: Program, output: str, name: str) -> Any:
    """A recorded program as a CasADi function: the same operations on CasADi's scalars."""
    inputs = {array: casadi.SX.sym(array, width) for array, width in program.inputs.items()}
    apply: dict[str, Callable[..., Any]] = {
        "constant": casadi.SX,
        "+": operator.add,
        "-": operator.sub,
        "*": operator.mul,
        "/": operator.truediv,
        "negate": operator.neg,
        "sine": casadi.sin,
        "cosine": casadi.cos,
    }
    values: list[Any] = []
    for kind, *operands in program.operations:
        if kind == "input":
            array, column = operands
            values.append(inputs[array][column])
        elif kind == "constant":
            values.append(apply[kind](*operands))
        else:
            values.append(apply[kind](*(values[k] for k in operands)))
    return casadi.Function(name, list(inputs.values()), [casadi.vertcat(*(values[k] for k in program.outputs[output]))])


def _on_buffers(function: Any, arguments: list[Array], result: Array) -> Callable[[], object]:
    """A call that reads and writes the arrays in place; CasADi stores by columns what we store by rows."""
    buffer, call = function.buffer()
    for k, array in enumerate(arguments):
        buffer.set_arg(k, array.data)
    buffer.set_res(0, result.data)

    def run(owned: object = (buffer, arguments, result)) -> object:
        return call()

    return run
