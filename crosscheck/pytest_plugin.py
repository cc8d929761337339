"""A fixture for the test suites of other codes, `judge_dynamics`, available wherever graphdyn is installed.

def test_dynamics(judge_dynamics):
    judge_dynamics("arm.urdf", inverse_dynamics=my_rnea)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from crosscheck.judging.judgment import Judgment


@pytest.fixture(scope="session")
def judge_dynamics() -> Callable[..., Judgment]:
    """crosscheck.assert_correct: fails with a table and the diagnoses where a function is wrong."""
    from crosscheck.assertions import assert_correct  # Pinocchio takes half a second to import

    return assert_correct
