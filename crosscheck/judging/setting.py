"""What is judged, and how: the options of crosscheck.judge as one object, and the functions by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from crosscheck.quantities.table import FunctionsUnderTest
from crosscheck.quantities.tolerances import FUNCTION_UNDER_TEST, FUNCTION_UNDER_TEST_SINGLE, Tolerance
from crosscheck.reference.subject import Robot
from urdf import Reading, ReadingKeywords
from urdf.reading import AS_IT_STANDS

Precision = Literal["double", "single"]
TOLERANCES: Mapping[Precision, Tolerance] = {"double": FUNCTION_UNDER_TEST, "single": FUNCTION_UNDER_TEST_SINGLE}


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A judgment without its functions; the fields are explained at crosscheck.judge."""

    robot: Robot
    reading: Reading = AS_IT_STANDS
    joint_names: Sequence[str] | None = None
    samples: int = 100
    seed: int = 0
    precision: Precision = "double"
    tolerance: float | None = None
    beyond_limits: bool = False
    frame: str | None = None
    conventions: Mapping[str, str] = field(default_factory=dict)
    external_wrenches: bool = False
    batched: bool = False
    exact: bool = False

    @property
    def bound(self) -> float:
        """Largest relative error that counts as agreement."""
        return TOLERANCES[self.precision].bound if self.tolerance is None else self.tolerance


class JudgedKeywords(FunctionsUnderTest, ReadingKeywords, total=False):
    """What crosscheck.judge takes besides the parameters of its signature: functions, and how the robot is read."""
