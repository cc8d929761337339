"""Fixtures for the test suites of others, available wherever graphdyn is installed.

def test_my_code(judge_dynamics):
    judge_dynamics("arm.urdf", inverse_dynamics=my_rnea)

def test_my_robot(agrees_with_pinocchio):
    agrees_with_pinocchio("arm.urdf", samples=100)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from crosscheck.comparing.comparison import Comparison
    from crosscheck.judging.judgment import Judgment


@pytest.fixture(scope="session")
def judge_dynamics() -> Callable[..., Judgment]:
    """crosscheck.assert_correct: fails with a table and the diagnoses where a function is wrong."""
    from crosscheck.assertions import assert_correct  # Pinocchio takes half a second to import

    return assert_correct


@pytest.fixture(scope="session")
def agrees_with_pinocchio() -> Callable[..., Comparison]:
    """crosscheck.assert_agrees: fails with the quantities that disagree on a robot, and both sides of the worst."""
    from crosscheck.assertions import assert_agrees

    return assert_agrees
