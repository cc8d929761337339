"""Fixtures of the graphdyn tests."""

import json
from contextvars import ContextVar

import numpy as np
import pytest
from long_check import LONG, few
from random_trees import NAMED
from shared_data import DATA, existing

from graphdyn.arguments import choices


@pytest.fixture(params=few(NAMED, *(NAMED.keys() - {"revolute_chain", "prismatic_inside_and_out"})))
def robot(request):
    return NAMED[request.param]


BACK_ENDS = {"recursive, NumPy": "numpy", "recursive, compiled": "llvm"}


@pytest.fixture(params=["projected", "dense", *BACK_ENDS])
def method(request, monkeypatch):
    """Every method on every back end; the recursive one is then also what the verbs use where none is named."""
    return _recursive(BACK_ENDS[request.param], monkeypatch) if request.param in BACK_ENDS else request.param


@pytest.fixture(params=["projected", *BACK_ENDS])
def default_method(request, monkeypatch):
    """The same for tests that name no method."""
    return _recursive(BACK_ENDS[request.param], monkeypatch) if request.param in BACK_ENDS else request.param


COMPILED_ROBOT = "mixed_chain"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Compiled programs of one robot stand for all: tests/kernels compares them with interpreted ones."""
    for item in items:
        chosen = item.callspec.params if hasattr(item, "callspec") else {}
        back_ends = chosen.get("method"), chosen.get("default_method")
        if "robot" in chosen and "recursive, compiled" in back_ends and chosen["robot"] != COMPILED_ROBOT:
            item.add_marker(LONG)


def _recursive(back_end, monkeypatch):
    monkeypatch.setenv("GRAPHDYN_BACKEND", back_end)
    monkeypatch.setattr(choices, "_auto", ContextVar("_auto", default="reproducible"))
    monkeypatch.setattr(choices, "MANY_SAMPLES", 1)
    return "recursive"


@pytest.fixture
def interpreted(monkeypatch):
    """Programs of the recursive method run without being compiled, for tests of what they compute.

    tests/kernels shows that compiled ones give the same, test_verbs that every verb has one.
    """
    monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture(scope="session")
def reference():
    """Reader of the reference files: reference("puma560_full_precision.json")."""

    def read(name):
        return json.loads(existing(DATA / "reference" / name).read_text(encoding="utf-8"))

    return read
