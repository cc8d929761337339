"""Cross products, whatever way a number of vectors is multiplied."""

import numpy as np
import pytest

from graphdyn.model.spatial import MANY_ROWS, cross


@pytest.mark.parametrize("batch", [(), (1,), (6,), (MANY_ROWS,), (3, MANY_ROWS)])
@pytest.mark.parametrize("dtype", [float, np.float32, complex])
def test_has_the_bits_of_numpy(batch, dtype):
    """Of vectors beside each other, and of one beside a batch of views."""
    rng = np.random.default_rng(0)
    a, b = (rng.normal(size=(2, *batch, 3)) + (1j if dtype is complex else 0)).astype(dtype)
    for other in (b, b[..., ::-1], b.reshape(-1, 3)[0]):
        for first, second in ((a, other), (other, a)):
            found, expected = cross(first, second), np.cross(first, second)
            assert (found.dtype, found.shape) == (expected.dtype, expected.shape)
            assert found.tobytes() == expected.tobytes()
