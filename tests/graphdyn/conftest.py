"""Fixtures of the graphdyn tests."""

import json

import numpy as np
import pytest
from hypothesis import settings
from random_trees import NAMED
from shared_data import DATA, existing

settings.register_profile("graphdyn", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("graphdyn")


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
        return json.loads(existing(DATA / "reference" / name).read_text(encoding="utf-8"))

    return read
