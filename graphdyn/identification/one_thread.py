"""Linear algebra on matrices as small as those of an identification, where several threads are slower than one."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any


def one_thread() -> AbstractContextManager[Any]:
    """Limit NumPy's and SciPy's linear algebra to one thread. The sums of graphdyn.kernels keep theirs."""
    import scipy.linalg  # noqa: F401  # imported where first used; a library must be loaded to be limited
    from threadpoolctl import threadpool_limits

    limited: AbstractContextManager[Any] = threadpool_limits(limits=1, user_api="blas")
    return limited
