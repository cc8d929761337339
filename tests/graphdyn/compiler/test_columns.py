"""Rows and columns of compiled programs with many outputs."""

import numpy as np
import pytest
from back_ends import on
from random_trees import NAMED, random_state

import graphdyn
from graphdyn.compiler.llvm import emitter
from graphdyn.compiler.llvm.columns import _runs
from graphdyn.compiler.llvm.emitter import scratch
from graphdyn.compiler.programs import Request, trace

MODEL = NAMED["mixed_chain"]


def test_runs_of_consecutive_numbers():
    assert [*_runs({7, 3, 4, 9, 8})] == [(3, 5), (7, 10)]
    assert [*_runs(set())] == []


@pytest.mark.parametrize("back_end", ["host", "2 lanes"])
def test_columns_in_memory_are_those_that_are_written_one_by_one(back_end, monkeypatch):
    """A regressor with blocks of zeros, whose width is no multiple of the lanes; samples at and beside the lanes."""
    monkeypatch.setattr(emitter, "MIN_SHARE_OF_BLOCKS", 0.1)
    program = trace(MODEL, Request("joint_torque_regressor", ("joint_torque_regressor",)))
    arrays = random_state(MODEL, 3, (19,))
    with on(back_end):
        one_by_one = graphdyn.joint_torque_regressor(MODEL, *arrays, method="recursive")
    assert len(scratch(program, 8)) == 160 * 8
    monkeypatch.setattr(emitter, "MIN_COLUMNS_IN_MEMORY", 16)
    with on(back_end):
        in_memory = graphdyn.joint_torque_regressor(MODEL, *arrays, method="recursive")
    assert len(scratch(program, 8)) == 2 * 160 * 8
    assert np.array_equal(in_memory, one_by_one)
    assert (in_memory == 0).any()
