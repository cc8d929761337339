"""What compiled steps keep in memory: columns of vectors, one robot per lane."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from graphdyn.compiler.llvm.vector_code import VectorCode
from graphdyn.layout import Array
from graphdyn.scalars.expressions import Program

HOLDING_SHARE = 1 + 1e-9
"""Dry friction holds a joint up to so much of F_c: at F_c itself it rests, whatever the rounding of its torque."""

JOINT_CONSTANTS = ("viscous", "coulomb", "offset", "least_torque", "largest_torque")
STOP_CONSTANTS = ("lower", "upper", "stiffness", "damping")
BRISTLE_CONSTANTS = ("bristle_coulomb", "bristle_breakaway", "bristle_velocity", "bristle_stiffness", "bristle_damping")


@dataclass(frozen=True, eq=False)
class ClosingCode:
    """What closes the loops of a robot after a step. Each program has what must be above zero in its output certain.

    position: q (n) after a Newton step from q, and closed: above zero where q was closed but for rounding
    velocity: v (n), the nearest to a v that keeps the loops closed at q
    passes: most Newton steps
    """

    position: Program
    velocity: Program
    passes: int


@dataclass(frozen=True, eq=False)
class StepCode:
    """What the code is made of.

    accelerations: program with a and required, inputs q, v, tau and some of those of simulated.Inputs
    law: program with tau of q, v, reference and gains; None where the torque itself is given
    a, b: coefficients of the method                        (s, s), (s,)
    friction, stops, clamped: whether there is friction, are springs at the limits, and limits of torque
    bristles: whether there is friction of bristles
    noisy: whether noise is added to the q and v that the law sees; rounded: whether that q is rounded
    late: whether a torque of the law acts one tick later
    closing: of a robot with loops, whose accelerations have certain too
    """

    n: int
    accelerations: Program
    law: Program | None
    a: Array
    b: Array
    friction: bool
    stops: bool
    clamped: bool
    noisy: bool
    bristles: bool = False
    rounded: bool = False
    late: bool = False
    closing: ClosingCode | None = None

    @property
    def stages(self) -> int:
        return len(self.b)

    @property
    def sticking(self) -> bool:
        return "free" in self.accelerations.inputs

    @cached_property
    def constants(self) -> dict[str, int]:
        """Widths of what stays the same during a run, in the order of their columns."""
        own = {"external_wrenches", "parameters", "rotor"}
        widths = {name: width for name, width in self.accelerations.inputs.items() if name in own}
        names = (JOINT_CONSTANTS[:3] if self.friction else ()) + (JOINT_CONSTANTS[3:] if self.clamped else ())
        names += (STOP_CONSTANTS if self.stops else ()) + (BRISTLE_CONSTANTS if self.bristles else ())
        widths.update(dict.fromkeys((*names, *(("resolution",) if self.rounded else ())), self.n))
        if self.law is not None:
            widths["gains"] = self.law.inputs["gains"]
        return widths

    @property
    def state(self) -> dict[str, int]:
        """q, v, work of the actuators, and work of friction and stops."""
        return {"q": self.n, "v": self.n, "work": 1, "loss": 1}

    @property
    def control(self) -> dict[str, int]:
        """What is new at every tick."""
        return {"tau": self.n} if self.law is None else {"reference": self.law.inputs["reference"]}

    @property
    def record(self) -> dict[str, int]:
        """What is written at the recorded steps; passive: torque of friction and stops on the joints."""
        return {**self.state, "tau": self.n, "a": self.n, "passive": self.n}

    @cached_property
    def memory(self) -> dict[str, int]:
        """What is kept between steps, and scratch: sign of the sliding, the stage, and the rates of each stage.

        deflection and dry: of the bristles, and their torque; ordered: the torque that acts from the next tick on
        With loops, 1 or 0: lost, where the last step was not taken, and open, where Newton steps go on.
        """
        names: tuple[str, ...] = ("tau", "passive", "held", "sign", "free")
        names += (("deflection", "dry") if self.bristles else ()) + (("ordered",) if self.late else ())
        joints = dict.fromkeys(names, self.n)
        loops = {} if self.closing is None else {"lost": 1, "open": 1}
        return {**joints, **loops, "stage": 2 * self.n + 2, "rates": self.stages * (2 * self.n + 2)}


def places(widths: dict[str, int]) -> dict[str, int]:
    """First column of each part."""
    firsts, first = {}, 0
    for name, width in widths.items():
        firsts[name], first = first, first + width
    return firsts


class Columns:
    """Columns of one pointer."""

    def __init__(self, code: VectorCode, pointer: str, widths: dict[str, int]) -> None:
        self._code, self._pointer, self._places = code, pointer, places(widths)

    def load(self, name: str, column: int) -> str:
        code = self._code
        return code.load(code.vector, self._pointer, code.lanes * (self._places[name] + column))

    def columns(self, name: str, count: int, first: int = 0) -> list[str]:
        return [self.load(name, first + column) for column in range(count)]

    def store(self, name: str, column: int, value: str) -> None:
        code = self._code
        code.store(f"{code.vector} {value}", self._pointer, code.lanes * (self._places[name] + column))

    def address(self, name: str, column: int = 0) -> str:
        return self._code.element(self._pointer, self._code.lanes * (self._places[name] + column))
