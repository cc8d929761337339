"""Measurements in fresh processes: time to import, time of first calls, whole identifications, peak memory.

`python -m crosscheck.bench.cold TASK FOLDER THREADS` prints one JSON record. The folder holds the robot
(model.pickle) and, for identification, a recording (q.npy, v.npy, a.npy, tau.npy).
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from graphdyn import RobotModel
    from graphdyn.layout import Array

FIRST_CALLS = (
    "joint_torques",
    "joint_accelerations",
    "forward_dynamics",
    "joint_torque_regressor",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
)
"""Functions in the order of their first calls; the first call also loads the compiler."""


def in_fresh_process(task: str, folder: Path, threads: int = 1) -> dict[str, Any]:
    """The record of a task, which compiles all it needs. Raises RuntimeError with the error output of the process."""
    from graphdyn.compiler import CACHE_VARIABLE  # not above: the task takes the time of importing graphdyn

    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    done = subprocess.run(
        [sys.executable, "-P", "-m", __name__, task, str(folder), str(threads)],
        env={**os.environ, "PYTHONPATH": paths, CACHE_VARIABLE: "off"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"the task {task} in a process of its own failed: {' '.join(done.stderr.split())}")
    record: dict[str, Any] = json.loads(done.stdout)
    return record


def first_calls(folder: Path) -> dict[str, Any]:
    """Processor time of imports, and of the first call of each function on one sample [s]."""
    imports = {name: _seconds(lambda name=name: __import__(name)) for name in ("numpy", "graphdyn")}  # type: ignore[misc]
    import numpy as np

    import graphdyn

    model = _model(folder)
    x = np.zeros((1, model.n_bodies))
    calls = {}
    for name in FIRST_CALLS:
        verb = getattr(graphdyn, name)
        calls[name] = _seconds(lambda verb=verb: verb(model, x, x, x, method="recursive"))  # type: ignore[misc]
    imports["pinocchio"] = _seconds(lambda: __import__("crosscheck.reference.pinocchio_model"))
    return {"imports": imports, "first_calls": calls}


def identify_graphdyn(folder: Path) -> dict[str, Any]:
    """The inertial parameters by ordinary least squares on sums of products: the regressor is never written out."""
    import scipy.linalg  # noqa: F401  # imported before the clock starts, as Pinocchio is below

    from graphdyn.compiler import chosen_backend
    from graphdyn.identification import OrdinaryLeastSquares, Problem, Samples, TorqueModel
    from graphdyn.identification.terms import RigidBodies

    chosen_backend()  # loads the compiler

    def work(model: RobotModel, q: Array, v: Array, a: Array, tau: Array) -> Array:
        problem = Problem(TorqueModel(model, (RigidBodies(),)), Samples(q, v, a, tau), compression="gram")
        return OrdinaryLeastSquares().estimate(problem).parameters

    return _identified(folder, work)


def identify_pinocchio(folder: Path) -> dict[str, Any]:
    """The inertial parameters by numpy.linalg.lstsq on the stacked regressors of Pinocchio, one per sample."""
    import numpy as np

    from crosscheck.reference.pinocchio_model import PinocchioModel

    def work(model: RobotModel, q: Array, v: Array, a: Array, tau: Array) -> Array:
        bare = PinocchioModel.from_model(model).bare_calls()
        regressor, native, data = bare.torque_regressor, bare.model, bare.data
        rows = np.empty((*q.shape, 10 * model.n_bodies))
        for k in range(len(q)):
            rows[k] = regressor(native, data, q[k], v[k], a[k])
        return np.asarray(np.linalg.lstsq(rows.reshape(-1, rows.shape[-1]), tau.ravel())[0], dtype=float)

    return _identified(folder, work)


TASKS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "first_calls": first_calls,
    "identify_graphdyn": identify_graphdyn,
    "identify_pinocchio": identify_pinocchio,
}


def _identified(folder: Path, work: Callable[..., Array]) -> dict[str, Any]:
    """Times by both clocks, memory and parameters of work; libraries, robot and recording are loaded before."""
    import numpy as np

    model = _model(folder)
    arrays = [np.load(folder / f"{name}.npy") for name in ("q", "v", "a", "tau")]
    before = _memory("VmRSS")
    wall, processor = time.perf_counter(), time.process_time()
    x = work(model, *arrays)
    taken = {"processor": time.process_time() - processor, "wall": time.perf_counter() - wall}
    peak = _memory("VmHWM")
    extra = None if before is None or peak is None else max(0, peak - before)
    return {"seconds": taken, "extra_bytes": extra, "parameters": x.tolist()}


def hold_to_cores(count: int) -> None:
    """Restrict the process, and so every library, to this number of cores, where the system supports it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:count])


def _memory(field: str) -> int | None:
    """Resident memory of this process: now (VmRSS) or its peak (VmHWM) [bytes]; None where the system has no figure."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    kilobytes = next((line.split()[1] for line in lines if line.startswith(f"{field}:")), None)
    return None if kilobytes is None else 1024 * int(kilobytes)


def _model(folder: Path) -> RobotModel:
    model: RobotModel = pickle.loads((folder / "model.pickle").read_bytes())
    return model


def _seconds(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


if __name__ == "__main__":
    hold_to_cores(int(sys.argv[3]))
    print(json.dumps(TASKS[sys.argv[1]](Path(sys.argv[2]))))
