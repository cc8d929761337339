"""The back ends of the recursive method, chosen for a stretch of a test."""

import os
from contextlib import ExitStack, contextmanager
from unittest import mock

import pytest
from long_check import LONG

from graphdyn.compiler import native, running
from graphdyn.compiler.gram import gram
from graphdyn.compiler.rolled import rolling

COMPILED = ("host", *(pytest.param(lanes, marks=LONG) for lanes in ("2 lanes", "4 lanes")))
BACK_ENDS = ("numpy", *COMPILED)
LONG_ROBOTS = "body by body"


@contextmanager
def no_programs():
    """Inside, no robot has programs yet: those recorded before are forgotten meanwhile."""
    with ExitStack() as stack:
        for name in ("_of_models", "_of_contents"):
            stack.enter_context(mock.patch.object(running, name, type(getattr(running, name))()))
        yield


@contextmanager
def on(back_end):
    """Inside, the recursive method runs on this back end: NumPy, code for the host's vectors, or for shorter ones, or
    for all robots the code of long ones.

    Programs recorded before are forgotten meanwhile: they belong to another back end.
    """
    with ExitStack() as stack:
        stack.enter_context(
            mock.patch.dict(os.environ, {running.BACKEND_VARIABLE: "numpy" if back_end == "numpy" else "llvm"})
        )
        stack.enter_context(no_programs())
        if back_end in ("2 lanes", "4 lanes"):
            for module in (native, gram):
                stack.enter_context(mock.patch.object(module, "host_lanes", return_value=int(back_end[0])))
        if back_end == LONG_ROBOTS:
            stack.enter_context(mock.patch.object(rolling, "most_unrolled", return_value=0))
        yield
