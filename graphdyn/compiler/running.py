"""Programs of a robot, recorded and compiled when first needed, and run on batches with several threads."""

from __future__ import annotations

import logging
import os
import sys
import warnings
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from functools import cache
from itertools import pairwise
from math import inf
from typing import Any, TypeVar
from weakref import WeakKeyDictionary, WeakValueDictionary

import numpy as np

from graphdyn.arguments.choices import MANY_SAMPLES, Method
from graphdyn.compiler.interpreter import Interpreter, together
from graphdyn.compiler.llvm.precision import DOUBLE, Precision, precision_of
from graphdyn.compiler.native import CompiledProgram, compiling, try_out
from graphdyn.compiler.programs import Request, trace
from graphdyn.compiler.rolled.program import LongProgram
from graphdyn.compiler.rolled.rolling import is_long, most_unrolled, record_long
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import RECURSIONS
from graphdyn.scalars.expressions import Guard, Program

T = TypeVar("T")

log = logging.getLogger(__name__)

BACKENDS = ("llvm", "numpy")

BACKEND_VARIABLE = "GRAPHDYN_BACKEND"
"""Environment variable that chooses one of BACKENDS."""

MAX_COMPILED_LENGTH = 30_000
"""Length (graphdyn.scalars.expressions.Program.length) beyond which a program is interpreted: compiling would take more
than two seconds. Measured, with 8 lanes: 55 to 70 µs for each unit up to there, more beyond."""

WORTH_COMPILING = 4000
"""Number of samples for which the projected method takes as long as compiling, for most verbs: 2000 to 9000, for robots
of 2 to 20 bodies (python tests/tools compiling_times)."""

DERIVATIVES_WORTH_COMPILING, REGRESSORS_WORTH_COMPILING = 300, 20_000
"""The same for derivatives, of which a sample takes long, 50 to 700, and for regressors, which take long to compile,
19,000 and more."""

SAMPLES_PER_CALL = 50
"""Number of samples for which the projected method takes as long as for what it does once a call: 25 to 110, and 1 to
50 where a sample takes long, as derivatives do; there it is CALLS_WORTH_COMPILING that counts."""

CALLS_WORTH_COMPILING = 80
"""Number of calls for one sample that take as long as compiling."""

REMEMBERED_ROBOTS = 16
"""Robots whose programs are kept after the last model of them is gone. The programs of one take some megabytes."""

WORTH_A_THREAD = 2_000_000
"""Operations that take more than 100 µs, several times the cost of handing them to a thread."""


Backend = Interpreter | CompiledProgram


class Prepared:
    """A recorded program and what runs it, on batches or on one row after the other.

    Copies and pickles are compiled again, for the processor and by the back end of where they are.
    """

    def __init__(
        self,
        program: Program | LongProgram,
        backend: str,
        one_row: bool = False,
        dtype: np.dtype[Any] = DOUBLE.dtype,
    ) -> None:
        self.program, self.precision = program, precision_of(dtype)
        self.backend = _backend(program, backend, one_row, self.precision)
        self._one_row = one_row

    def __reduce__(self) -> tuple[Callable[..., Prepared], tuple[Program | LongProgram, bool, np.dtype[Any]]]:
        return _prepared_here, (self.program, self._one_row, self.precision.dtype)


def _prepared_here(program: Program | LongProgram, one_row: bool, dtype: np.dtype[Any]) -> Prepared:
    return Prepared(program, chosen_backend(), one_row, dtype)


class RobotPrograms:
    """What there is for a robot, however often it is loaded: models that are equal share it.

    ready: programs by request, back end, and whether they are for one row after the other
    samples: those that were asked for, by request; infinitely many once there is compiled code for them
    """

    def __init__(self) -> None:
        self.ready: dict[tuple[Request, str, bool], Prepared] = {}
        self.samples: defaultdict[Request, float] = defaultdict(float)


_of_models: WeakKeyDictionary[RobotModel, RobotPrograms] = WeakKeyDictionary()
_of_contents: WeakValueDictionary[bytes, RobotPrograms] = WeakValueDictionary()
_recent: deque[RobotPrograms] = deque(maxlen=REMEMBERED_ROBOTS)
_forced: ContextVar[str | None] = ContextVar("_forced", default=None)


def programs_of(model: RobotModel) -> RobotPrograms:
    """The same object for models of the same content, while there is one of them, and for a while longer."""
    programs = _of_models.get(model)
    if programs is None:
        with compiling:
            programs = _of_models[model] = _of_contents.setdefault(model.digest, RobotPrograms())
            _recent.append(programs)
    return programs


def prepared(model: RobotModel, request: Request, one_row: bool = False) -> Prepared:
    """The program, recorded and compiled once per robot for batches, and once for one row after the other."""
    key, programs = (request, chosen_backend(), one_row), programs_of(model)
    with compiling:
        if key not in programs.ready:
            log.info("%s %s", "compiling" if key[1] == "llvm" else "recording", request.recursion)
            long = key[1] == "llvm" and is_long(model, request)
            programs.ready[key] = Prepared((record_long if long else trace)(model, request), *key[1:], request.dtype)
        ready = programs.ready[key]
        if isinstance(ready.backend, CompiledProgram) and not one_row:
            programs.samples[request] = inf
        return ready


def has_paid(model: RobotModel, request: Request, samples: int, worth: int = WORTH_COMPILING) -> bool:
    """Whether compiling takes no longer than these samples and those asked for before, which are counted.

    worth: number of samples for which the projected method takes as long
    """
    programs = programs_of(model)
    asked = programs.samples[request] + samples + min(SAMPLES_PER_CALL, worth / CALLS_WORTH_COMPILING)
    programs.samples[request] = asked
    if asked < worth:
        return False
    # what is interpreted, because it takes too long to compile, is for many samples
    return asked == inf or samples >= MANY_SAMPLES or isinstance(prepared(model, request).backend, CompiledProgram)


def run(
    model: RobotModel,
    request: Request,
    inputs: Mapping[str, Array],
    outputs: Mapping[str, Array],
    threads: int | None = None,
) -> dict[Guard, float]:
    """Fill the outputs (N, width) from the inputs (N, width), C-contiguous arrays; return what the guards found.

    The result does not depend on N, nor on the number of threads. Angles beyond the precision's max_angle are first
    reduced by whole turns, so that no sample loses digits.
    """
    ready = prepared(model, request)
    count = len(inputs["q"])
    guards = _in_parallel(ready, inputs, outputs, count, threads)
    if beyond_reduction(model, inputs["q"], guards, ready.precision):
        near = turned_back(model, inputs["q"], ready.precision)
        return _in_parallel(ready, {**inputs, "q": near}, outputs, count, threads)
    return guards


def beyond_reduction(model: RobotModel, q: Array, seen: Mapping[Guard, float], precision: Precision = DOUBLE) -> bool:
    """Whether an angle is beyond max_angle. What was seen of all, the sum of squares, mostly denies it."""
    if seen.get("squares", 0.0) <= precision.max_angle**2:
        return False
    turning = [not joint.is_prismatic for joint in model.joints]
    positions = model.joint_positions(q) if model.couplings else q  # one that is NaN does not spoil those beside it
    return bool(np.any(np.abs(positions[:, turning]) > precision.max_angle))


def turned_back(model: RobotModel, q: Array, precision: Precision = DOUBLE) -> Array:
    """Joint positions (N, n) with angles beyond max_angle reduced by whole turns.

    Raises InvalidInput for a robot with couplings: a whole turn of one joint need not be one of those that it drives.
    """
    if model.couplings:
        raise InvalidInput(
            f"a joint of robot '{model.name}' is beyond {precision.max_angle:g} rad, and some joints drive "
            "others; give smaller angles, or method='projected'"
        )
    turning = np.array([not joint.is_prismatic for joint in model.joints])
    far = (np.abs(q) > precision.max_angle) & turning
    q = q.copy()
    with np.errstate(invalid="ignore"):  # infinity becomes NaN, in its sample
        angles = q[far].astype(float)
        q[far] = np.arctan2(np.sin(angles), np.cos(angles))
    return q


def chosen_backend() -> str:
    """What the environment asks for, or "llvm" where llvmlite is there; "numpy" inside interpreted.

    Raises InvalidInput for an unknown choice.
    """
    choice = _forced.get() or os.environ.get(BACKEND_VARIABLE) or "llvm"
    if choice not in BACKENDS:
        raise InvalidInput(
            f"the environment variable {BACKEND_VARIABLE} is '{choice}'; use one of {', '.join(BACKENDS)}"
        )
    if choice == "llvm":
        with compiling:
            return "llvm" if _can_compile() else "numpy"
    return choice


@contextmanager
def interpreted() -> Iterator[None]:
    """Inside, in this thread, the recursive method runs on NumPy: for too few samples to be worth compiling."""
    token = _forced.set("numpy")
    try:
        yield
    finally:
        _forced.reset(token)


@contextmanager
def quick_for_few(model: RobotModel, recursion: str, samples: int) -> Iterator[Method]:
    """Inside, the method that is quickest for what is computed again and again, whatever was computed before.

    That is the recursive one: compiled for many samples, on NumPy for few. Of robots that take long to record, few
    samples are computed by the projected method.
    """
    with nullcontext() if samples >= MANY_SAMPLES else interpreted():
        short = model.n_bodies <= most_unrolled(Request(recursion, RECURSIONS[recursion].outputs))
        yield "recursive" if samples >= MANY_SAMPLES or short else "projected"


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _can_compile() -> bool:
    try:
        try_out()
    except Exception as error:
        warnings.warn(
            f"no compiled dynamics ({str(error).splitlines()[0]}); the NumPy back end gives the same results, some "
            f"fifty times slower. Install llvmlite 0.45 or newer, or set {BACKEND_VARIABLE}=numpy to silence this",
            RuntimeWarning,
            stacklevel=_level_of_the_caller(),
        )
        return False
    return True


def _level_of_the_caller() -> int:
    """What warnings.warn has to be told where it is called, so that it names the first line outside this package."""
    package = os.path.join(os.path.dirname(os.path.dirname(__file__)), "")
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(package):
        frame, level = frame.f_back, level + 1
    return level


def _backend(
    program: Program | LongProgram, choice: str, one_row: bool = False, precision: Precision = DOUBLE
) -> Backend:
    if isinstance(program, Program) and (choice == "numpy" or program.length > MAX_COMPILED_LENGTH):
        return Interpreter(program)
    return CompiledProgram(program, one_row, precision)


def _in_parallel(
    ready: Prepared, inputs: Mapping[str, Array], outputs: Mapping[str, Array], count: int, threads: int | None
) -> dict[Guard, float]:
    bound = ready.backend.bind(inputs, outputs)
    work = count * ready.program.arithmetic // WORTH_A_THREAD
    if work < 2 or threads == 1:
        return bound(0, count)
    threads = cores() if threads is None else threads
    parts = min(threads, work)
    ends = [count * part // parts for part in range(parts + 1)]
    return together(ready.program.guards, in_threads(bound, list(pairwise(ends)), threads))


def in_threads(work: Callable[[int, int], T], ranges: Sequence[tuple[int, int]], threads: int | None) -> list[T]:
    """work(first, last) on every range, answers in their order. A free thread, this one included, takes the next."""
    answers: dict[int, T] = {}
    pending = iter(range(len(ranges)))

    def take() -> None:
        for k in pending:
            answers[k] = work(*ranges[k])

    helpers = min(len(ranges), cores() if threads is None else threads) - 1
    helping = [_pool(helpers).submit(take) for _ in range(helpers)]
    take()
    for helper in helping:
        helper.result()
    return [answers[k] for k in range(len(ranges))]


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="graphdyn")


if hasattr(os, "register_at_fork"):  # threads do not survive a fork
    os.register_at_fork(after_in_child=_pool.cache_clear)
