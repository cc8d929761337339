"""A benchmark of one arm, measured once, and what it consists of. Its times are too short to say anything."""

import functools
from dataclasses import replace

import pytest

from crosscheck.bench import benchmark, cold
from crosscheck.bench.benchmark import N_PROGRESS_STEPS, Effort
from crosscheck.bench.calls import CALL_WORKS
from crosscheck.bench.forms.single_precision import SINGLE_PRECISION_WORKS
from crosscheck.bench.machine.disturbance import Load
from crosscheck.bench.machine.timing import Times
from graphdyn import kr500

SMALL = Effort(duration=1e-3, repeats=3, processes=1, most_loop=300, lengths=(2, 3, 4))
SAMPLES = 60

PEERS = 1e-10
"""Other libraries against Pinocchio on the scales of the works: principal axes and other recursions round more."""

DERIVED = {
    "inverse_dynamics_derivatives": ("dtau_dq", "dtau_dv", "dtau_da"),
    "forward_dynamics_derivatives": ("da_dq", "da_dv", "da_dtau"),
    "mass_matrix_inverse": ("mass_matrix_inverse",),
    "coriolis_matrix": ("coriolis_matrix",),
    "frame_jacobian": ("frame_jacobian",),
    "kinetic_energy": ("kinetic_energy",),
}

WORKS = (
    "inverse_dynamics",
    "forward_dynamics",
    "solve_kkt",
    "joint_torque_regressor",
    *DERIVED,
    *SINGLE_PRECISION_WORKS,
    "simulation",
    *CALL_WORKS,
    "single_inverse",
    "single_forward",
)


@functools.cache
def measured():
    """A benchmark of the first three links of an arm, whose steps of progress are as many as it promises."""
    steps, begun = [], set()

    def identified(task, folder, threads):
        """The first task of each kind in a process of its own, others here."""
        if task in begun:
            return cold.TASKS[task](folder)
        begun.add(task)
        return cold.in_fresh_process(task, folder, threads)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, "QUICK_EFFORT", SMALL)
        patch.setattr("crosscheck.bench.contender.MIN_STEADY_TIME", SMALL.duration)
        patch.setattr("crosscheck.bench.machine.disturbance.N_COPIES", 1)
        patch.setattr("crosscheck.bench.identification.in_fresh_process", identified)
        whole = kr500()
        arm = replace(whole, bodies=whole.bodies[:3], joints=whole.joints[:3])
        result = benchmark.benchmark("kr500", arm, SAMPLES, 0, 2, True, False, lambda _, count: steps.append(count))
    assert sum(steps) == N_PROGRESS_STEPS
    return result


def quiet(found):
    """The same, as if nothing had disturbed it: all repeats alike."""

    def calm(entry):
        return replace(entry, times=Times((entry.times.median,) * len(entry.times.seconds)))

    works = tuple(
        replace(x, core_share=1.0, copy=Times((1e-4,)), entries=tuple(map(calm, x.entries))) for x in found.works
    )
    once = replace(found.identification, entries=tuple(map(calm, found.identification.entries)))
    return replace(found, works=works, identification=once, load=(Load(0.1, 2), Load(1.0, 2)))
