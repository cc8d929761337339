"""What functions for CasADi and JAX cost: python tests/tools solver_functions [ROBOT]

Of ROBOT (ur5 by default): operations of the recorded function, microseconds of processor time for one state by CasADi
and for each of 10,000 states by JAX under vmap, with seconds to compile that; the same of derivatives: the Jacobian by
CasADi, and by JAX the gradient of the sum of the results. A dash where a library is not installed. A minute or two.
"""

import sys
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

import graphdyn.export.casadi
import graphdyn.export.jax
import urdf
from graphdyn import InvalidInput, RobotModel
from graphdyn.export import ExportChoices
from graphdyn.export.functions import ExportedFunction, exported_functions
from graphdyn.layout import Array

NAMES = ("joint_torques", "joint_accelerations", "mass_matrix", "solve_kkt")
STATES = 10_000
REPEATS = 7
CALLS = 2_000
"""Of CasADi, which are timed together."""


def fastest(work: Callable[[], object]) -> float:
    """Seconds of processor time, all threads together."""
    taken = []
    for _ in range(REPEATS):
        start = process_time()
        work()
        taken.append(process_time() - start)
    return min(taken)


def by_casadi(model: RobotModel, name: str, x: list[Array]) -> list[float]:
    """Microseconds for one state: of the function, and of its Jacobian."""
    function = graphdyn.export.casadi.function(model, name)
    row = [array[0] for array in x]
    return [_on_buffers(function, row), _on_buffers(function.jacobian(), [*row, *_results(function, row)])]


def _results(function: Any, row: list[Array]) -> list[Array]:
    found = function(*row)
    return [np.array(y) for y in (found if isinstance(found, tuple) else (found,))]


def _on_buffers(function: Any, arguments: list[Array]) -> float:
    """In memory that stays, without the time that Python takes to convert arrays."""
    buffer, call = function.buffer()
    columns = [np.asfortranarray(array) for array in arguments]
    results = [np.zeros(function.nnz_out(k)) for k in range(function.n_out())]
    for k, array in enumerate(columns):
        buffer.set_arg(k, memoryview(array.ravel(order="F")))
    for k, array in enumerate(results):
        buffer.set_res(k, memoryview(array))
    return fastest(lambda: [call() for _ in range(CALLS)]) / CALLS * 1e6


def by_jax(model: RobotModel, name: str, x: list[Array]) -> list[float]:
    """Seconds to compile, and microseconds for each state: of the function, and of its gradient."""
    import jax

    jax.config.update("jax_enable_x64", True)
    function = graphdyn.export.jax.function(model, name)

    def total(*row: Any) -> Any:
        return sum(array.sum() for array in jax.tree.leaves(function(*row)))

    found = []
    for each in (function, jax.grad(total, argnums=tuple(range(len(x))))):
        start = process_time()
        compiled = jax.jit(jax.vmap(each)).lower(*x).compile()
        found.append(process_time() - start)
        found.append(fastest(lambda run=compiled: jax.block_until_ready(run(*x))) / STATES * 1e6)
    return found


def row(model: RobotModel, function: ExportedFunction) -> list[str]:
    rng = np.random.default_rng(0)
    known = dict(zip("qv", model.random_state(rng, STATES), strict=True))
    x = [known.get(name, rng.normal(size=(STATES, *function.shape(name)))) for name in function.inputs]
    cells = [function.name, f"{function.program.arithmetic}"]
    for measured, columns in ((by_casadi, 2), (by_jax, 4)):
        try:
            cells += [f"{number:.2f}" for number in measured(model, function.name, x)]
        except (InvalidInput, ImportError):
            cells += ["–"] * columns
    return cells


def main() -> None:
    model = urdf.load(sys.argv[1] if len(sys.argv) > 1 else "ur5")
    heads = ["function", "operations", "CasADi, µs", "Jacobian, µs"]
    heads += ["JAX compiled, s", "JAX, µs a state", "gradient compiled, s", "gradient, µs a state"]
    print(" | ".join(heads))
    for function in exported_functions(model, NAMES, ExportChoices()):
        print(" | ".join(row(model, function)), flush=True)
