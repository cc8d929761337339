"""The rows of loops at single states, of which steps in Python need thousands: compiled where that is possible."""

from __future__ import annotations

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from graphdyn.compiler.native import CompiledProgram, compiling
from graphdyn.compiler.running import Prepared, chosen_backend
from graphdyn.compiler.simulated import record_rows
from graphdyn.layout import Array
from graphdyn.model.loops import Loops
from graphdyn.model.robot_model import RobotModel


class RowsAt(NamedTuple):
    """J (…, k, n), γ (…, k) and gaps (…, k) at states, rows in their units."""

    jacobian: Array
    bias: Array
    gaps: Array


class LoopRows:
    """The rows as graphdyn.model.loops defines them: the specification of CompiledRows."""

    def __init__(self, loops: Loops) -> None:
        self._loops = loops

    def at(self, q: Array, v: Array) -> RowsAt:
        """The rows at states (…, n)."""
        loops, units = self._loops, self._loops.row_units
        links = loops.links(q, v)
        return RowsAt(loops.jacobian(links) / units[:, None], loops.bias(links) / units, loops.gaps(q) / units)


class CompiledRows(LoopRows):
    """The same by compiled code, without rows that no joint moves. For one thread at a time.

    Gaps agree where they are small. An end that is flipped by 180° has infinite ones.
    """

    def __init__(self, loops: Loops, prepared: Prepared) -> None:
        super().__init__(loops)
        self._n, lanes = len(loops.free_joints), prepared.backend.lanes
        self._states = {name: np.zeros((lanes, self._n)) for name in prepared.program.inputs}
        outputs = prepared.program.outputs
        self._found = {name: np.zeros((lanes, len(columns))) for name, columns in outputs.items()}
        self._run = prepared.backend.bind_row(self._states, self._found)

    def at(self, q: Array, v: Array) -> RowsAt:
        if q.ndim > 1:
            return super().at(q, v)
        for name, place in self._states.items():
            place[0] = q if name == "q" else v
        self._run()
        jacobian, bias, gaps, agreeing = (self._found[name][0] for name in ("jacobian", "bias", "gaps", "agreeing"))
        gaps = gaps.copy() if (agreeing > 0).all() else np.full_like(gaps, np.inf)
        return RowsAt(jacobian.reshape(-1, self._n).copy(), bias.copy(), gaps)


_prepared: WeakKeyDictionary[RobotModel, Prepared] = WeakKeyDictionary()


def loop_rows(model: RobotModel) -> LoopRows:
    """The rows of a robot with memory of their own; compiled once per robot."""
    if chosen_backend() != "llvm":
        return LoopRows(model.loops)
    with compiling:
        if model not in _prepared:
            _prepared[model] = Prepared(record_rows(model), "llvm", one_row=True)
        prepared = _prepared[model]
    is_short = isinstance(prepared.backend, CompiledProgram)
    return CompiledRows(model.loops, prepared) if is_short else LoopRows(model.loops)
