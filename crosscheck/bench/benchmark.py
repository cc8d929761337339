"""The whole benchmark of one robot."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from crosscheck.bench import curves
from crosscheck.bench.cold import in_fresh_process
from crosscheck.bench.contender import MeasuredWork, measure
from crosscheck.bench.curves import ScalingCurve
from crosscheck.bench.forms.native_pinocchio import NATIVE_NAME
from crosscheck.bench.forms.peers import CASADI_NAME as CASADI
from crosscheck.bench.forms.peers import Peers
from crosscheck.bench.forms.pinocchio_forms import instruction_set
from crosscheck.bench.identification import Identifications, identifications
from crosscheck.bench.machine.disturbance import Load, load
from crosscheck.bench.machine.floor import Floor, Machine, floor, limit, machine
from crosscheck.bench.machine.timing import Times
from crosscheck.bench.states import random_states
from crosscheck.bench.works import WORK_DESCRIPTIONS, work, works_of
from crosscheck.reference.pinocchio_model import PINOCCHIO_VERSION as PINOCCHIO
from crosscheck.reference.subject import check_counts
from graphdyn import InvalidInput, RobotModel
from graphdyn.compiler import chosen_backend, cores
from graphdyn.display import Displayed

RECORDING_FACTOR = 10
"""Factor on the given number of samples for the recording of the identification and for the largest batch."""


@dataclass(frozen=True)
class Effort:
    """How long the benchmark may take.

    duration: of one run of a slow contender, which gets fewer samples [s]; repeats: of every measurement
    processes: number of fresh processes for imports and for each identification, and of first calls of a chain
    most_loop: largest number of samples for identification with Pinocchio's loop
    lengths: numbers of bodies of the chains
    """

    duration: float
    repeats: int
    processes: int
    most_loop: int
    lengths: tuple[int, ...]


FULL_EFFORT = Effort(0.25, 9, 2, 10**9, (2, 3, 4, 6, 8, 12, 16, 24, 32, 40, 50, 60))
QUICK_EFFORT = Effort(0.02, 5, 2, 5000, (2, 4, 8, 16))


@dataclass(frozen=True, eq=False, repr=False)
class Benchmark(Displayed):
    """All measurements.

    robot: name or file as given
    samples: random states per run; the identification and the largest batch take ten times as many
    seed: of the random states
    quick: whether fewer repeats and points were asked for
    threads: numbers of threads that were compared
    backend: what runs graphdyn's recursive forms: compiled code or NumPy arrays
    cores: processor cores that the program may use
    load: of the machine, before and after
    machine: what it could do at best, by number of threads; empty where nothing can be compiled
    floors: least times on one thread of the works that have a program
    peers: what took part: version, instruction set of the build as far as it is known, and how it was used, by library
    left_out: why a library took no part, by name
    works: what was done, by several contenders
    imports: processor time of an import in a fresh process, by module
    first_calls: processor time of the first call of a verb in a fresh process, which records and compiles, by verb; the
        first one loads the compiler too
    identification: from a recording in memory to the inertial parameters, in fresh processes
    curves: times against the size of a batch, the number of bodies or of threads
    """

    robot: str
    model: RobotModel
    samples: int
    seed: int
    quick: bool
    effort: Effort
    threads: tuple[int, ...]
    backend: str
    cores: int
    load: tuple[Load, Load]
    machine: tuple[Machine, ...]
    floors: Mapping[str, Floor]
    peers: Mapping[str, str]
    left_out: Mapping[str, str]
    works: tuple[MeasuredWork, ...]
    imports: Mapping[str, Times]
    first_calls: Mapping[str, Times]
    identification: Identifications
    curves: tuple[ScalingCurve, ...]

    def summary(self) -> str:
        """What was measured, and whether the answers agree."""
        said = "agree" if self.agrees else "DISAGREE"
        return (
            f"benchmark of {self.robot}, {self.samples} samples: {len(self.works)} works beside "
            f"{', '.join(self.peers)}; the answers {said}"
        )

    @property
    def agrees(self) -> bool:
        """Whether our answers agree with Pinocchio's within the bounds."""
        return all(measured.agrees for measured in self.works)

    @property
    def copy_slowdown(self) -> Mapping[str, float]:
        """How many times as long a copy within the caches took as the fastest in the benchmark, by work (median)."""
        fastest = min((measured.copy.fastest for measured in self.works), default=np.nan)
        return {measured.name: measured.copy.median / fastest for measured in self.works}


N_PROGRESS_STEPS = len(WORK_DESCRIPTIONS) + len(
    ("machine", "first calls", "identification", "batches", "batches", "chains", "threads")
)
"""Number of steps of the progress bar."""


def benchmark(
    robot: str,
    model: RobotModel,
    samples: int,
    seed: int,
    threads: int | None,
    quick: bool,
    native: bool,
    done: Callable[[str, int], None],
) -> Benchmark:
    """Measure. done: called with the current step, and the number of N_PROGRESS_STEPS that it finishes.

    threads: largest number of threads, all cores if None
    native: whether Pinocchio takes part compiled from its headers too
    Raises InvalidInput, PinocchioRefuses, NativeRefuses, SingularMassMatrix.
    """
    check_counts(samples, seed)
    if threads is not None and threads < 1:
        raise InvalidInput(f"threads is {threads!r}; give a number from 1, or None for all cores")
    if model.couplings:
        coupled = ", ".join(coupling.joint for coupling in model.couplings)
        raise InvalidInput(
            f"robot '{robot}': {coupled} is coupled, and the functions of Pinocchio that are measured take independent "
            "joints; read it with --mimic independent or --mimic locked (urdf.Reading(mimic=…))"
        )
    effort = QUICK_EFFORT if quick else FULL_EFFORT
    counts = thread_numbers(cores() if threads is None else threads)
    compared = (1, counts[-1]) if counts[-1] > 1 else (1,)
    states = random_states(model, samples, seed)
    before = load()

    with TemporaryDirectory(prefix="graphdyn-bench-") as folder:
        done("compiling Pinocchio, half a minute" if native else "machine", 0)
        peers, works = Peers(states, Path(folder), native), []
        done("machine", 0)
        machines = tuple(measured for used in compared if (measured := machine(used)) is not None)
        floors = {name: least for name in WORK_DESCRIPTIONS if machines and (least := floor(model, name, machines[0]))}
        done("machine", 1)
        for name in works_of(states):
            title = WORK_DESCRIPTIONS[name][0]
            done(title, 0)
            loop = limit(floors[name], machines[0]) if name in floors else None
            works.append(measure(work(name, states, compared, peers), samples, effort.duration, effort.repeats, loop))
            if works[-1].limit is not None:
                floors[name] = replace(floors[name], seconds=works[-1].limit.median)
            done(title, 1)
        (Path(folder) / "model.pickle").write_bytes(pickle.dumps(model))
        fresh = []
        for k in range(effort.processes):
            done(f"first calls, process {k + 1} of {effort.processes}", 0)
            fresh.append(in_fresh_process("first_calls", Path(folder)))
        done("first calls", 1)

    def working(what: str) -> None:
        done(what, 0)

    recorded = RECORDING_FACTOR * samples
    found = identifications(model, recorded, seed, compared, effort.processes, effort.most_loop, working)
    done("identification", 1)
    how = effort.duration, effort.repeats
    lines = [curves.thread_counts(states, counts, *how)]
    done("threads", 1)
    states = random_states(model, recorded, seed)
    for name in ("inverse_dynamics", "forward_dynamics"):
        lines.append(curves.batch_sizes(states, name, compared, *how, working))
        done("batches", 1)
    lines += curves.chain_lengths(effort.lengths, *how, effort.processes, working)
    done("chains", 1)
    return Benchmark(
        robot=robot,
        model=model,
        samples=samples,
        seed=seed,
        quick=quick,
        effort=effort,
        threads=compared,
        backend=chosen_backend(),
        cores=cores(),
        load=(before, load()),
        machine=machines,
        floors=floors,
        peers=_peers(works, peers),
        left_out=peers.left_out,
        works=tuple(works),
        imports=_times(fresh, "imports"),
        first_calls=_times(fresh, "first_calls"),
        identification=found,
        curves=tuple(lines),
    )


def thread_numbers(most: int) -> tuple[int, ...]:
    """1, 2, 4, … and the largest number itself."""
    doubled = [2**k for k in range(most.bit_length()) if 2**k < most]
    return (*doubled, most)


def _peers(works: list[MeasuredWork], peers: Peers) -> dict[str, str]:
    """A description of each library that was measured: version and build."""
    taking_part = {entry.name.split()[0] for measured in works for entry in measured.entries}
    described = {"pinocchio": f"{PINOCCHIO}, as installed, built for {instruction_set()}"}
    if peers.native is not None:
        described[NATIVE_NAME] = peers.native.description
    if "mujoco" in taking_part:
        described["mujoco"] = f"{version('mujoco')}, as installed; constraints, contacts and limits off"
    if CASADI.split()[0] in taking_part:
        described["casadi"] = (
            f"{version('casadi')}: C code of graphdyn's recorded recursions, one state at a time, "
            "built for this machine; Pinocchio's own pinocchio.casadi is not used"
        )
    return described


def _times(records: list[dict[str, dict[str, float]]], kind: str) -> dict[str, Times]:
    return {name: Times(tuple(record[kind][name] for record in records)) for name in records[0][kind]}
