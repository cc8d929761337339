"""Pinocchio without Python and without its wheel's library: its headers, compiled for this processor.

Only headers: code for this processor's vectors aligns Eigen's matrices otherwise than the library of the wheel, built
for SSE2. Linking both would not fail but crash.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from crosscheck.bench.contender import Contender
from crosscheck.bench.states import States
from graphdyn import GraphDynError
from graphdyn.compiler import aligned
from graphdyn.layout import Array

NATIVE_NAME = "pinocchio C++"
SOURCE = Path(__file__).with_name("native_pinocchio.cpp")

SHOWN_FLAGS = ("-O3", "-march=native", "-DNDEBUG")
NATIVE_FLAGS = (
    *SHOWN_FLAGS, "-std=c++17", "-w", "-fPIC", "-shared", "-fvisibility=hidden",
    # those of Pinocchio's own build, without which its list of joints is too long for Boost
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)  # fmt: skip
NATIVE_NOTE = f"a loop in C++ on its headers, {' '.join(SHOWN_FLAGS)}, results written to given memory"

NEEDED_HEADERS = (
    ("Pinocchio", "pinocchio/algorithm/rnea.hpp", "pip install pin"),
    ("Boost", "boost/variant.hpp", "pip install cmeel-boost"),
    ("Eigen", "Eigen/Core", "pip install cmeel-eigen"),
)
"""Library, one of its headers, and how to get them."""

FOLDERS_OF_THE_COMPILER = (Path("/usr/local/include"), Path("/usr/include"))
"""Folders in which compilers look by themselves, and must look last."""

N_CHECKED = 100
"""Number of states whose answers must agree with Pinocchio's bindings before anything is timed."""

LARGEST_DIFFERENCE = 1e-10
"""Largest error of these answers on the scales of the works: other instructions round otherwise."""


class NativeRefuses(GraphDynError):
    """Pinocchio cannot be compiled here, or answers otherwise than its bindings."""


class NativePinocchio:
    """The compiled loops of one robot. folder: for the library. Raises NativeRefuses."""

    def __init__(self, states: States, folder: Path) -> None:
        compiler = shutil.which(os.environ.get("CXX", "c++"))
        if compiler is None:
            raise NativeRefuses("--native compiles Pinocchio, and there is no C++ compiler (c++, or the one in CXX)")
        library = _library(compiler, header_folders(tuple(_searched())), folder / "native_pinocchio.so")
        self._loops = {False: library.rnea_loop, True: library.aba_loop}
        for loop in self._loops.values():
            loop.argtypes, loop.restype = [ctypes.c_void_p, ctypes.c_int64, *[ctypes.c_void_p] * 4], None
        library.libraries.restype = ctypes.c_char_p
        library.make_robot.restype = ctypes.c_void_p
        rows, gravity = robot_rows(states), np.array(states.model.gravity, dtype=float)
        library.make_robot.argtypes = [ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p]
        self._robot = library.make_robot(len(rows), rows.ctypes.data, gravity.ctypes.data)
        self._states = states
        self.description = f"{library.libraries().decode()}, {' '.join(SHOWN_FLAGS)}"

    def contender(self, forward: bool) -> Contender:
        """The loop of aba, or of rnea. Raises NativeRefuses."""
        inputs, errors = self._states.dynamics(forward)
        out, loop = aligned(self._states.q.shape), self._loops[forward]
        addresses = [array.ctypes.data for array in (*inputs, out)]

        def run(count: int) -> Array:
            loop(self._robot, count, *addresses)
            return out[:count]

        largest = float(np.max(errors(run(min(N_CHECKED, len(out))))))
        if not largest <= LARGEST_DIFFERENCE:
            name = "aba" if forward else "rnea"
            raise NativeRefuses(f"{name} of Pinocchio compiled here differs from its bindings by {largest:.1e}")
        return Contender(NATIVE_NAME, 1, run, errors, NATIVE_NOTE)


def robot_rows(states: States) -> Array:
    """The robot of Pinocchio's bindings in numbers, as native_pinocchio.cpp reads them (n, 30)."""
    native, rows = states.bare.model, []
    for k, joint in enumerate(states.model.joints, 1):
        place, inertia = native.jointPlacements[k], native.inertias[k]
        along = next((i for i, unit in enumerate(np.eye(3)) if np.array_equal(joint.axis, unit)), 3)
        numbers = (
            native.parents[k], along + 4 * joint.is_prismatic, joint.axis, place.rotation, place.translation,
            inertia.mass, inertia.lever, inertia.inertia,
        )  # fmt: skip
        rows.append(np.concatenate([np.ravel(number) for number in numbers]))
    return np.array(rows, dtype=float)


def header_folders(searched: Sequence[Path]) -> list[Path]:
    """The first folder with the headers of each library. Raises NativeRefuses."""
    found = []
    for library, header, remedy in NEEDED_HEADERS:
        folder = next((folder for folder in searched if (folder / header).is_file()), None)
        if folder is None:
            raise NativeRefuses(f"--native compiles Pinocchio, and there is no {header} of {library}: {remedy}")
        found.append(folder)
    return [folder for folder in dict.fromkeys(found) if folder not in FOLDERS_OF_THE_COMPILER]


def _searched() -> Iterator[Path]:
    """Folders that may hold headers: of wheels, of this environment (conda), of the system."""
    packages = [Path(entry) for entry in sys.path if entry]
    includes = [*(package / "cmeel.prefix/include" for package in packages), Path(sys.prefix) / "include"]
    for include in (*includes, *FOLDERS_OF_THE_COMPILER):
        yield from (include, include / "eigen3")
    yield from (package / "casadi/include/eigen3" for package in packages)


def _library(compiler: str, folders: Sequence[Path], path: Path) -> ctypes.CDLL:
    """The compiled code. Raises NativeRefuses with the first error."""
    headers = [part for folder in folders for part in ("-isystem", str(folder))]
    command = [compiler, *NATIVE_FLAGS, *headers, str(SOURCE), "-o", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or done.stderr.splitlines() or ["killed"]
        raise NativeRefuses(f"the C++ compiler fails on Pinocchio's headers: {lines[0].strip()}")
    return ctypes.CDLL(str(path))
