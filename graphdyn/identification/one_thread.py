"""Linear algebra on matrices as small as those of an identification: threads only get in each other's way."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any


def one_thread() -> AbstractContextManager[Any]:
    """Hold NumPy's and SciPy's linear algebra to one thread. The sums of graphdyn.kernels keep theirs."""
    import scipy.linalg  # noqa: F401  # imported where first used; a library must be loaded to be held
    from threadpoolctl import threadpool_limits

    limited: AbstractContextManager[Any] = threadpool_limits(limits=1, user_api="blas")
    return limited
