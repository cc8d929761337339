"""Memory of answers: aligned, reused where it is large, and never shared by two arrays."""

import threading

import numpy as np
import pytest

from graphdyn.compiler.llvm import memory as module
from graphdyn.compiler.llvm.memory import CACHE_LINE_BYTES, MIN_REUSED_BYTES, aligned

SIZE = MIN_REUSED_BYTES // 8


@pytest.fixture(autouse=True)
def _nothing_kept(monkeypatch):
    monkeypatch.setattr(module, "_kept", {})


@pytest.mark.parametrize("shape", [(3,), (7, 5), (SIZE, 2), (2, SIZE, 1)])
def test_arrays_begin_with_a_line(shape):
    array = aligned(shape)
    assert array.shape == shape
    assert array.ctypes.data % CACHE_LINE_BYTES == 0
    assert array.flags.carray
    array[...] = 1.0


def test_large_memory_is_reused_once_nothing_refers_to_it():
    array = aligned((SIZE,))
    place, view = array.ctypes.data, array[5:9]
    view[:] = 3.0
    del array
    other = aligned((SIZE,))
    assert other.ctypes.data != place
    other.fill(7.0)
    assert np.all(view == 3.0)
    del view
    assert aligned((SIZE,)).ctypes.data == place


def test_other_sizes_have_other_memory():
    place = aligned((SIZE,)).ctypes.data
    assert aligned((SIZE + 1,)).ctypes.data != place
    assert aligned((SIZE,)).ctypes.data == place


def test_the_oldest_memory_is_let_go(monkeypatch):
    monkeypatch.setattr(module, "MAX_KEPT_BYTES", 8 * 5 * SIZE)
    arrays = [aligned((SIZE + k,)) for k in range(6)]
    sizes = [array.size + CACHE_LINE_BYTES // 8 for array in arrays]
    while arrays:
        del arrays[0]
    assert [memory.size for memory in module._kept.values()] == sizes[2:]


def test_threads_never_share():
    mixed = []

    def work(number):
        for _ in range(200):
            array = aligned((SIZE,))
            array[::4096] = number
            mixed.append(not np.all(array[::4096] == number))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not any(mixed)
