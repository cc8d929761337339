"""Serial chains of any number of bodies.

Time per sample against the size of a batch, the number of bodies and the number of threads.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

import graphdyn
from crosscheck.bench.contender import Contender, Work, measure
from crosscheck.bench.forms import graphdyn_forms, pinocchio_forms
from crosscheck.bench.machine.clocks import clock_of, elapsed
from crosscheck.bench.machine.floor import REQUESTS
from crosscheck.bench.machine.timing import TimedRun, Times, in_turns
from crosscheck.bench.states import States, random_states
from crosscheck.bench.works import GRAPHDYN_FORMS, PINOCCHIO_FORMS
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.compiler import chosen_backend, cores, is_long, most_unrolled
from graphdyn.errors import counted
from graphdyn.layout import Array
from graphdyn.model import rotation_about

LINK_LENGTH, LINK_RADIUS, LINK_MASS = 0.2, 0.04, 1.0
"""Length, radius and mass of each body, a cylinder along z [m, m, kg]."""

JOINT_TWIST = 1.0
"""Angle about z between consecutive joint frames [rad]: it leaves no zeros that a compiler could exploit."""


def chain(n_bodies: int) -> RobotModel:
    """A serial chain of revolute joints with axes normal to the chain."""
    across = LINK_MASS * (3 * LINK_RADIUS**2 + LINK_LENGTH**2) / 12
    tensor = np.diag([across, across, LINK_MASS * LINK_RADIUS**2 / 2])
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), JOINT_TWIST)
    bodies, joints = [], []
    for k in range(n_bodies):
        place = Placement(turn, np.array([0.0, 0.0, LINK_LENGTH if k else 0.0]))
        bodies.append(Body(f"body_{k + 1}", LINK_MASS, np.array([0.0, 0.0, LINK_LENGTH / 2]), tensor))
        joints.append(Joint(f"joint_{k + 1}", "revolute", k, place, np.array([1.0, 0.0, 0.0])))
    return RobotModel(f"chain of {n_bodies}", tuple(bodies), tuple(joints))


CHAIN_SAMPLES = 2000
"""Largest number of samples per run of a chain."""

FIRST_CALL_CURVE = "graphdyn first call"


@dataclass(frozen=True)
class Line:
    """Times of one contender over x.

    name, threads: of the contender; threads are 0 where they are varied
    """

    name: str
    threads: int
    x: tuple[int, ...]
    times: tuple[Times, ...]

    @property
    def exponent(self) -> float | None:
        """k of a time that grows as x^k, from the fastest repeats of the upper half of the points; None for fewer than
        three."""
        if len(self.x) < 3:
            return None
        half = len(self.x) // 2
        x, y = self.x[half:], [times.fastest for times in self.times[half:]]
        return float(np.polyfit(np.log(x), np.log(y), 1)[0])


@dataclass(frozen=True)
class ScalingCurve:
    """Lines over a common x.

    name: which diagram; title: its name in words; x: what is varied
    seconds_of: what one time is for: a sample, or a first call
    lines: one per contender; notes: what a reader must know
    """

    name: str
    title: str
    x: str
    seconds_of: str
    lines: tuple[Line, ...]
    notes: tuple[str, ...] = ()


def batch_sizes(
    states: States, work: str, threads: Sequence[int], duration: float, repeats: int, done: Callable[[str], None]
) -> ScalingCurve:
    """1, 10, 100 … samples per call; a line ends where a call takes half of the duration or longer [s]."""
    sizes = [10**k for k in range(len(str(len(states))))]
    contenders = [c for c in _forms(states, work, threads) if c.name != graphdyn_forms.DENSE_NAME]
    if work == "inverse_dynamics":
        contenders.append(_by_default(states))
    rows: list[list[tuple[int, Times]]] = [[] for _ in contenders]
    for size in sizes:
        done(f"{size} samples")
        chosen = [k for k, row in enumerate(rows) if not row or _call(row[-1]) <= duration / 2]
        going = [contenders[k] for k in chosen]
        runs = [TimedRun(partial(c.run, size), c.threads, clock_of(c.threads)) for c in going]
        for k, seconds in zip(chosen, in_turns(runs, repeats), strict=True):
            rows[k].append((size, Times(tuple(second / size for second in seconds))))
    lines = tuple(_line(c.name, c.threads, row) for c, row in zip(contenders, rows, strict=True))
    title = f"{work.replace('_', ' ')}: size of the batch"
    return ScalingCurve(f"batch_{work}", title, "samples per call", "sample", lines)


def _line(name: str, threads: int, row: Sequence[tuple[int, Times]]) -> Line:
    """row: x and times of every point"""
    x, times = zip(*row, strict=True)
    return Line(name, threads, x, times)


def _call(point: tuple[int, Times]) -> float:
    size, times = point
    return size * times.median


def chain_lengths(
    lengths: Sequence[int], duration: float, repeats: int, first_calls: int, done: Callable[[str], None]
) -> list[ScalingCurve]:
    """Times of all accelerations and multipliers of chains, and of the first call for each."""
    rows: dict[tuple[str, int], list[tuple[int, Times]]] = {}
    first: list[tuple[int, Times]] = []
    for n in lengths:
        done(counted(n, "body", "bodies"))
        states = random_states(chain(n), CHAIN_SAMPLES, 0)
        first.append((n, Times(tuple(_first_call(n) for _ in range(first_calls)))))
        contenders = tuple(replace(c, errors=None) for c in _forms(states, "solve_kkt", (1,)))
        for entry in measure(Work("", "", "", 0.0, contenders), len(states), duration, repeats).entries:
            rows.setdefault((entry.name, entry.threads), []).append((n, entry.times))
    lines, notes = tuple(_line(*key, row) for key, row in rows.items()), long_notes(lengths)
    call, of_chain = _line(FIRST_CALL_CURVE, 1, first), "length of a chain"
    return [
        ScalingCurve("bodies", f"all accelerations and multipliers: {of_chain}", "bodies", "sample", lines, notes),
        ScalingCurve("first_call", f"recording and compiling: {of_chain}", "bodies", "first call", (call,), notes),
    ]


def long_notes(lengths: Sequence[int]) -> tuple[str, ...]:
    """Number of bodies from where chains have other code."""
    long = chosen_backend() == "llvm" and is_long(chain(max(lengths)), REQUESTS["solve_kkt"])
    most = most_unrolled(REQUESTS["solve_kkt"])
    return (f"beyond {most} bodies, code for one body after the other",) if long else ()


def thread_counts(states: States, threads: Sequence[int], duration: float, repeats: int) -> ScalingCurve:
    """Forward dynamics with 1, 2, … threads, in wall time."""
    contenders = tuple(
        replace(c, errors=None)
        for c in _forms(states, "forward_dynamics", threads)
        if c.name in (graphdyn_forms.our_name(), pinocchio_forms.PINOCCHIO_PARALLEL)
    )
    work = Work("", "", "", 0.0, contenders)
    entries = measure(work, len(states), duration, repeats, clock=lambda _: "wall").entries
    lines = tuple(
        _line(name, 0, [(entry.threads, entry.times) for entry in entries if entry.name == name])
        for name in dict.fromkeys(entry.name for entry in entries)
    )
    notes = ("all in wall time",)
    return ScalingCurve("threads", "forward dynamics: number of threads", "threads", "sample", lines, notes)


def _forms(states: States, work: str, threads: Sequence[int]) -> list[Contender]:
    return [*GRAPHDYN_FORMS[work](states, threads), *PINOCCHIO_FORMS[work](states, threads)]


def _by_default(states: States) -> Contender:
    def run(count: int) -> Array:
        return graphdyn.joint_torques(states.model, states.q[:count], states.v[:count], states.a[:count])

    return Contender(graphdyn_forms.DEFAULT_NAME, cores(), run, None, graphdyn_forms.NEW_ARRAYS_NOTE)


def _first_call(n_bodies: int) -> float:
    """Processor time of the first call for a new chain [s]."""
    model, x = chain(n_bodies), np.zeros((1, n_bodies))
    return elapsed(lambda: graphdyn.forward_dynamics(model, x, x, x, method="recursive")).processor
