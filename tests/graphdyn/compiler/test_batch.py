"""The same bits, whatever the size of the batch, where it is cut, and how many threads work on it."""

import sys
import threading

import numpy as np
import pytest
from back_ends import BACK_ENDS, COMPILED, LONG_ROBOTS, on
from random_trees import NAMED, random_base_motion, random_state, random_wrenches

import graphdyn
from graphdyn.compiler import interpreter, native, running
from graphdyn.compiler.gram import gram as gram_of_portions
from graphdyn.compiler.gram.gram import SAMPLES_PER_PORTION, torque_gram
from graphdyn.compiler.llvm import emitter
from graphdyn.compiler.native import MAX_CACHED_RESULT_BYTES, host_lanes

MODEL = NAMED["mixed_chain"]
"""Four joints, one of them prismatic."""

FUSED = 1e-13
"""Products that are fused with sums, or rounded before: relative to the largest number; measured 2e-17."""

back_ends = pytest.mark.parametrize("back_end", BACK_ENDS)
with_long_robots = pytest.mark.parametrize("back_end", [*BACK_ENDS, LONG_ROBOTS])


def states(count, seed=0):
    return *random_state(MODEL, seed, (count,)), random_wrenches(MODEL, seed + 1, (count,))


def verbs(q, v, x, wrenches, **keywords):
    """Arrays by name, narrow and wide, of the recursive method."""
    keywords |= {"method": "recursive"}
    f = graphdyn.forward_dynamics(MODEL, q, v, x, wrenches, **keywords)
    return {
        **vars(f),
        "tau": graphdyn.joint_torques(MODEL, q, v, x, **keywords),
        "matrix": graphdyn.joint_torque_regressor(MODEL, q, v, x, **keywords),
    }


def assert_same(one, other):
    for name, value in one.items():
        assert np.array_equal(value, other[name], equal_nan=True), name


@with_long_robots
def test_a_sample_does_not_depend_on_the_samples_beside_it(back_end):
    """Below, at and above the numbers of lanes, no multiples of them; every sample in the place of every lane."""
    arrays = states(37)
    with on(back_end):
        together = verbs(*arrays)
        for first, last in [(k, k + 1) for k in range(9)] + [(0, 2), (1, 4), (0, 7), (3, 12), (5, 37), (0, 33)]:
            part = verbs(*(x[first:last] for x in arrays))
            assert_same(part, {name: value[first:last] for name, value in together.items()})


@pytest.mark.parametrize("back_end", ["host", LONG_ROBOTS])
def test_code_that_is_not_optimized_computes_the_same(back_end, monkeypatch):
    """Most other tests run on it: it is compiled in half the time, with the same operations, fewer of them fused."""
    q, v, x, wrenches = states(37)
    found = []
    for level in (native.OPTIMIZATION, 0):
        monkeypatch.setattr(native, "OPTIMIZATION", level)
        with on(back_end):
            second = graphdyn.inverse_dynamics_derivatives(MODEL, q, v, x, method="recursive")
            gram = torque_gram(MODEL, [0, 3, 12], 0)(q, v, x, x, np.empty((*x.shape, 0)))
            found.append({**verbs(q, v, x, wrenches), **vars(second), "gram": np.concatenate(gram[0], axis=None)})
    for name, value in found[0].items():
        assert np.abs(value - found[1][name]).max(initial=0.0) <= FUSED * np.abs(value).max(initial=0.0), name


@with_long_robots
def test_the_number_of_threads_changes_nothing(back_end, monkeypatch):
    """With work handed out a few samples at a time."""
    arrays = states(61)
    with on(back_end):
        alone = verbs(*arrays, threads=1)
        monkeypatch.setattr(running, "WORTH_A_THREAD", 1_000)
        used = set()
        original = running.in_threads
        monkeypatch.setattr(
            running,
            "in_threads",
            lambda work, ranges, threads: used.add(len(ranges)) or original(work, ranges, threads),
        )
        for threads in (2, 3, 7, 30):
            assert_same(alone, verbs(*arrays, threads=threads))
        assert {2, 3, 7} <= used  # otherwise nothing was tested
        assert max(used) > 61 / host_lanes()  # fewer samples than lanes


@pytest.mark.parametrize("back_end", COMPILED)
def test_large_results_that_bypass_the_caches_are_the_same(back_end):
    """Whole cache lines past the caches need aligned memory; memory of the caller may lie anywhere."""
    width = 4 * 40
    count = MAX_CACHED_RESULT_BYTES // (8 * width) + 11
    q, v, a, _ = states(count)
    with on(back_end):
        large = graphdyn.joint_torque_regressor(MODEL, q, v, a, method="recursive")
        parts = [slice(k, k + 100) for k in range(0, count, 100)]
        small = [graphdyn.joint_torque_regressor(MODEL, q[k], v[k], a[k], method="recursive") for k in parts]
        for shift in range(8):
            memory = np.full(count * width + 16, 7.0)
            shifted = memory[shift : shift + count * width].reshape(large.shape)
            graphdyn.joint_torque_regressor(MODEL, q, v, a, out=shifted)
            assert np.array_equal(large, shifted)
            assert np.all(memory[:shift] == 7.0)
            assert np.all(memory[shift + count * width :] == 7.0)
    assert large.nbytes > MAX_CACHED_RESULT_BYTES
    assert np.array_equal(large, np.concatenate(small))


def test_blocks_of_the_interpreter_are_not_seen(monkeypatch):
    arrays = states(50)
    with on("numpy"):
        whole = verbs(*arrays)
    monkeypatch.setattr(interpreter, "BLOCK_SAMPLES", 7)
    with on("numpy"):
        assert_same(whole, verbs(*arrays))


@back_ends
def test_batches_of_more_dimensions_are_rows_in_order(back_end):
    q, v, x, wrenches = states(12)
    base = random_base_motion(3, (3, 1))
    with on(back_end):
        flat = verbs(q, v, x, wrenches)
        cube = verbs(*(y.reshape(2, 3, 2, *y.shape[1:]) for y in (q, v, x, wrenches)))
        assert_same(cube, {name: y.reshape(2, 3, 2, *y.shape[1:]) for name, y in flat.items()})
        moved = verbs(q.reshape(3, 4, 4), v[:4], x[0], wrenches[0], base=base)
        rows = verbs(q[4:8], v[:4], x[0], wrenches[0], base=base.at((3, 4), (np.full(4, 1), np.arange(4))))
        assert_same(rows, {name: y[1] for name, y in moved.items()})


@back_ends
def test_layout_and_type_of_the_arguments_do_not_matter(back_end):
    q, v, x, wrenches = states(19)
    with on(back_end):
        plain = verbs(q, v, x, wrenches)
        assert_same(plain, verbs(*(np.asfortranarray(y) for y in (q, v, x, wrenches))))
        wide = np.full((19, 13), np.nan)
        wide[:, 1:9:2] = q
        assert_same(plain, verbs(wide[:, 1:9:2], v[::-1].copy()[::-1], x, wrenches))
        unaligned = np.empty(q.nbytes + 1, dtype=np.uint8)[1:].view(float).reshape(q.shape)
        unaligned[:] = q
        swapped = v.astype(">f8")
        frozen = x.copy()
        frozen.flags.writeable = False
        assert_same(plain, verbs(unaligned, swapped, frozen, wrenches.tolist()))
        single = [y.astype(np.float32) for y in (q, v, x, wrenches)]
        assert_same(verbs(*(y.astype(float) for y in single)), verbs(*single))
        whole = [np.round(y).astype(np.int8) for y in (q, v, x, wrenches)]
        assert_same(verbs(*(y.astype(float) for y in whole)), verbs(*whole))


@back_ends
def test_many_threads_at_once_get_the_same(back_end, monkeypatch):
    """First calls too: everybody waits for the one that compiles."""
    arrays = states(40)
    monkeypatch.setattr(running, "WORTH_A_THREAD", 10_000)
    results, switch = [], sys.getswitchinterval()
    with on(back_end):
        callers = [threading.Thread(target=lambda: results.append(verbs(*arrays, threads=3))) for _ in range(6)]
        sys.setswitchinterval(1e-5)
        try:
            for caller in callers:
                caller.start()
            for caller in callers:
                caller.join()
        finally:
            sys.setswitchinterval(switch)
        assert len(running.programs_of(MODEL).ready) == 3
        expected = verbs(*arrays, threads=1)
    assert len(results) == 6
    for result in results:
        assert_same(expected, result)


def test_sines_one_turn_ahead_are_those_of_the_rows(monkeypatch):
    """With one turn of the loop, and with a last turn that starts at rows that were done before."""
    several = states(19)
    one = [x[: host_lanes()] for x in several]
    with on("host"):
        ahead = verbs(*one), verbs(*several)
    monkeypatch.setattr(emitter, "sincos_pipelining", lambda program, lanes, precision: ({}, None))
    with on("host"):
        assert_same(ahead[0], verbs(*one))
        assert_same(ahead[1], verbs(*several))


# Gram matrices

SUM = 1e-13
"""Sums over samples in another order, relative to the largest entry: measured 3.5e-15."""


TURNED = 1e-8
"""Six million rad more, rounded to 1e-9 rad, relative to the largest entry: measured 2.4e-10."""


def gram(count, threads, model=MODEL):
    q, v, a, _ = states(count, seed=4)
    extra = np.random.default_rng(5).normal(size=(count, 4, 2))
    summed = torque_gram(model, [1, 5, 6, 12, 23, 30, 31, 32, 33, 38], 2)
    return (q, v, a, extra), summed, summed(q, v, a, tau := q * v, extra, threads), tau


@back_ends
@pytest.mark.parametrize("count", [0, 1, 3, 9, 1001])
def test_gram_matrices_are_those_of_the_regressor(back_end, count):
    with on(back_end):
        (q, v, a, extra), summed, (matrices, guards), tau = gram(count, 1)
    assert guards["finite"] == 0
    whole = graphdyn.joint_torque_regressor(MODEL, q, v, a, method="projected")[
        ..., [1, 5, 6, 12, 23, 30, 31, 32, 33, 38]
    ]
    for j, (columns, matrix) in enumerate(zip(summed.columns, matrices, strict=True)):
        missing = np.delete(whole[:, j], columns, axis=1)
        assert np.all(missing == 0)
        block = np.concatenate([whole[:, j][:, columns], extra[:, j], tau[:, j, None]], axis=1)
        assert np.abs(matrix - block.T @ block).max() <= SUM * np.abs(matrix).max()


@back_ends
def test_gram_matrices_do_not_depend_on_the_number_of_threads(back_end):
    """Bit for bit, with the last portion cut short and not a multiple of the lanes."""
    with on(back_end):
        sums = [gram(2 * SAMPLES_PER_PORTION + 1003, threads)[2][0] for threads in (1, 2, 5)]
    for other in sums[1:]:
        assert all(np.array_equal(x, y) for x, y in zip(sums[0], other, strict=True))


@back_ends
def test_gram_matrices_tell_what_is_not_finite_and_bring_angles_back(back_end):
    """A thousand turns more are the same angle up to rounding of the angle; a million more too."""
    with on(back_end):
        (q, v, a, extra), summed, (matrices, _), tau = gram(50, 1)
        turns = 2 * np.pi * np.array([1e6, 0, 1e6, 0])
        far, guards = summed(q + turns, v, a, tau, extra)
        assert guards["squares"] < 4**2 * q[:, [0, 2, 3]].size
        for x, y in zip(matrices, far, strict=True):
            assert np.abs(x - y).max() < TURNED * np.abs(x).max()
        spoiled = v.copy()
        spoiled[17, 2] = np.inf
        assert np.isnan(summed(q, spoiled, a, tau, extra)[1]["finite"])


@back_ends
def test_gram_matrices_tell_what_is_not_finite_in_any_portion_of_any_argument(back_end, monkeypatch):
    monkeypatch.setattr(gram_of_portions, "SAMPLES_PER_PORTION", 16)
    with on(back_end):
        (q, v, a, extra), summed, (matrices, guards), tau = gram(50, 2)
        assert guards["finite"] == 0
        assert guards["squares"] == pytest.approx((q[:, [0, 2, 3]] ** 2).sum())
        for row in (0, 15, 16, 40, 49):
            for place in range(5):
                arrays = [x.copy() for x in (q, v, a, tau, extra)]
                arrays[place][row].flat[-1] = np.nan
                assert np.isnan(summed(*arrays)[1]["finite"]), (row, place)
            far = q.copy()
            far[row, 3] += 2e6 * np.pi
            found, _ = summed(far, v, a, tau, extra)
            for x, y in zip(matrices, found, strict=True):
                assert np.abs(x - y).max() < TURNED * np.abs(x).max()


def test_lanes_of_the_host_are_a_power_of_two():
    assert host_lanes() in (2, 4, 8)
