"""Other libraries in the benchmark, where they are installed and can represent the robot: CasADi and MuJoCo.

On request Pinocchio in C++ too.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.bench.contender import AMORTIZED_SAMPLES, Contender
from crosscheck.bench.forms.native_pinocchio import NativePinocchio
from crosscheck.bench.states import States
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from graphdyn import GraphDynError
from graphdyn.errors import not_installed
from graphdyn.export.casadi import function as casadi_function
from graphdyn.layout import Array

MUJOCO_LOOP, MUJOCO_ROLLOUT = "mujoco loop", "mujoco rollout"
CASADI_NAME = "casadi code generation"
COMPILER_FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")
CASADI_NOTE = (
    f"C code of one state, cc {' '.join(COMPILER_FLAGS[:2])}, mapped over the samples by CasADi in given memory"
)


class CasadiRefuses(GraphDynError):
    """CasADi or a C compiler is missing, or the compiler fails."""


def casadi_dynamics(forward: bool, states: States, folder: Path) -> list[Contender]:
    """Joint accelerations, or joint torques. folder: of the compiled code. Raises CasadiRefuses."""
    _, errors = states.dynamics(forward)
    run = _compiled("joint_accelerations" if forward else "joint_torques", states, folder)
    return [Contender(CASADI_NAME, 1, run, errors, CASADI_NOTE, least=AMORTIZED_SAMPLES)]


def _compiled(name: str, states: States, folder: Path) -> Callable[[int], Array]:
    """run(count) of this verb on the first states. Raises CasadiRefuses."""
    try:
        import casadi
    except ImportError:
        raise CasadiRefuses(not_installed("casadi", "peers")) from None
    compiler = shutil.which("cc")
    if compiler is None:
        raise CasadiRefuses("CasADi generates C code, and there is no C compiler (cc)")
    function = casadi_function(states.model, name)
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
    inputs = [getattr(states, array) for array in function.name_in()]
    out = np.empty((len(inputs[0]), function.nnz_out(0)))
    prepared: dict[int, Callable[[], object]] = {}

    def run(count: int) -> Array:
        if count not in prepared:
            prepared[count] = _on_buffers(native.map(count), [x[:count] for x in inputs], out[:count])
        prepared[count]()
        return out[:count]

    return run


def _on_buffers(function: Any, arguments: list[Array], result: Array) -> Callable[[], object]:
    """A call that reads and writes the arrays in place; CasADi stores by columns what we store by rows."""
    buffer, call = function.buffer()
    for k, array in enumerate(arguments):
        buffer.set_arg(k, array.data)
    buffer.set_res(0, result.data)

    def run(owned: object = (buffer, arguments, result)) -> object:
        return call()

    return run


def mujoco_inverse(states: States, native: MujocoModel) -> list[Contender]:
    out = np.empty(states.q.shape)
    return [
        Contender(
            MUJOCO_LOOP,
            1,
            lambda count: native.inverse_loop(states.q[:count], states.v[:count], states.a[:count], out[:count]),
            states.torque_errors,
            "a Python loop of mj_inverse, arguments copied to MjData and results from there",
        )
    ]


def mujoco_forward(states: States, native: MujocoModel, threads: Sequence[int]) -> list[Contender]:
    return [
        Contender(
            MUJOCO_ROLLOUT,
            used,
            native.rollout(states.q, states.v, states.tau, used),
            states.acceleration_errors,
            "one step of mujoco.rollout per state: forward dynamics and the integration of the state",
            least=AMORTIZED_SAMPLES,
        )
        for used in threads
    ]


class Peers:
    """Other libraries, and why some are left out.

    folder: for code that is compiled; native: whether Pinocchio is compiled from its headers. Raises NativeRefuses.
    """

    def __init__(self, states: States, folder: Path, native: bool = False) -> None:
        self.native = NativePinocchio(states, folder) if native else None
        self._states, self._folder = states, folder
        self.left_out: dict[str, str] = {}
        try:
            self.mujoco: MujocoModel | None = MujocoModel(states.model)
        except MujocoRefuses as refusal:
            self.mujoco, self.left_out["mujoco"] = None, str(refusal)

    def contenders(self, work: str, threads: Sequence[int]) -> list[Contender]:
        found: list[Contender] = []
        if self.native is not None and work in ("inverse_dynamics", "forward_dynamics"):
            found.append(self.native.contender(work == "forward_dynamics"))
        if self.mujoco is not None and work == "inverse_dynamics":
            found += mujoco_inverse(self._states, self.mujoco)
        if self.mujoco is not None and work == "forward_dynamics":
            found += mujoco_forward(self._states, self.mujoco, threads)
        if work in ("inverse_dynamics", "forward_dynamics") and "casadi" not in self.left_out:
            try:
                found += casadi_dynamics(work == "forward_dynamics", self._states, self._folder)
            except CasadiRefuses as refusal:
                self.left_out["casadi"] = str(refusal)
        return found
