"""What all tests share: how many examples hypothesis draws, and one thread in linear algebra."""

import os

import pytest
from hypothesis import settings
from threadpoolctl import threadpool_limits

settings.register_profile("graphdyn", deadline=None, derandomize=True, max_examples=40)
settings.register_profile("nightly", deadline=None, derandomize=False, max_examples=1000, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "graphdyn"))


@pytest.fixture(autouse=True, scope="session")
def _one_blas_thread():
    """Threads only get in each other's way on matrices this small."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
