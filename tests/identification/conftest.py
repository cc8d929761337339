"""Fixtures of the identification tests."""

import pytest
from threadpoolctl import threadpool_limits


@pytest.fixture(autouse=True, scope="session")
def _one_blas_thread():
    """Threads only get in each other's way on matrices this small."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
