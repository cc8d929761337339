"""Fixtures of the graphdyn tests."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from random_trees import NAMED

settings.register_profile("graphdyn", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("graphdyn")

REPOSITORY = Path(__file__).parents[2]
DATA = (REPOSITORY / os.environ.get("GRAPHDYN_TEST_DATA", "../shared")).resolve()


@pytest.fixture(params=NAMED)
def robot(request):
    return NAMED[request.param]


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture(scope="session")
def reference():
    """Reader of the reference files: reference("puma560_full_precision.json")."""

    def read(name):
        path = DATA / "reference" / name
        if not path.is_file():
            pytest.skip(f"reference numbers not found: {path}; set GRAPHDYN_TEST_DATA to the folder that holds them")
        return json.loads(path.read_text(encoding="utf-8"))

    return read
