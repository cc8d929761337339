"""Exact values of the verbs: arrays of balls, with as many proven digits as asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from inspect import signature
from itertools import product
from typing import Any, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.exact.balls import (
    Balls,
    as_balls,
    bits,
    decimal,
    is_finite,
    magnitude,
    nearest_double,
    radius,
    rounded,
)
from crosscheck.exact.equations import placed, system
from crosscheck.exact.ground import BASE_SHAPES, ExactGround, ground
from crosscheck.exact.recorded import CONSTANTS, GROUND, evaluate, recorded
from crosscheck.exact.robot import ExactRobot, Truth
from crosscheck.exact.source import ExactSource
from crosscheck.reference.subject import Robot
from graphdyn import BaseMotion, InvalidInput, RobotModel, SingularMassMatrix
from graphdyn.arguments import Reference, closest, frame_choice
from graphdyn.compiler import Request
from graphdyn.layout import BODY_DOF, Array
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.verbs import VERBS, Verb
from urdf import Reading, ReadingKeywords

MAX_BITS = 2000
"""Precision beyond which a value counts as not provable."""

MAX_DIGITS = 250
"""Radii are told as doubles, the smallest of which is 1e-308."""

SMALLEST_RADIUS = 1e-300
"""Radius [SI units] below which values that vanish are not computed further."""

SPARE_BITS = 64
"""Bits beyond the digits asked for with which the work begins: recursions lose 10 to 30, elimination 40."""


@dataclass(frozen=True, eq=False)
class ExactArray:
    """Numbers that are known to so many digits, or further.

    balls: intervals that hold the true values (…)
    digits: the radii are below 10^-digits of the largest value at each state, or below 10^(-2 digits)
    bits: precision at which that was reached; truth: of the file, or of the model in memory
    """

    balls: Balls
    digits: int
    bits: int
    truth: Truth

    @property
    def radius(self) -> float:
        """The largest radius."""
        return radius(self.balls)

    def decimals(self, digits: int | None = None) -> np.ndarray:
        """Texts with so many significant digits, or as many as are proven."""
        with bits(self.bits):
            texts = [decimal(x, digits or self.digits) for x in self.balls.ravel()]
        return np.array(texts, dtype=object).reshape(self.balls.shape)

    def doubles(self) -> Array:
        """The double nearest to each value; where two are equally near within the radius, one of them."""
        return np.array([nearest_double(x) for x in self.balls.ravel()]).reshape(self.balls.shape)

    def is_correctly_rounded(self, values: ArrayLike) -> np.ndarray:
        """Whether doubles (…) are provably the nearest ones."""
        given = np.broadcast_to(np.asarray(values, dtype=float), self.balls.shape)
        with bits(self.bits):
            right = [rounded(x) == y for x, y in zip(self.balls.ravel(), given.ravel(), strict=True)]
        return np.array(right).reshape(self.balls.shape)

    def errors(self, values: ArrayLike) -> tuple[Array, Array]:
        """What doubles (…), or decimals as texts, are wrong by: at least, and at most.

        Raises InvalidInput for another shape, and NaN.
        """
        given = np.asarray(values)
        given = given.astype(object if given.dtype.kind in "OU" else float)
        if given.shape != self.balls.shape:
            raise InvalidInput(f"the values have shape {given.shape}, the exact ones {self.balls.shape}")
        with bits(self.bits):
            apart = self.balls.ravel() - as_balls(given).ravel()
            least = np.array([math.nextafter(float(x.abs_lower().mid()), 0.0) for x in apart])
            most = np.array([math.nextafter(float(x.abs_upper().mid()), math.inf) for x in apart])
        return np.where(least > 0, least, 0.0).reshape(given.shape), most.reshape(given.shape)


def exact_values(
    robot: Robot | ExactSource,
    verb: str,
    *arguments: Any,
    digits: int = 30,
    truth: Truth | None = None,
    method: Literal["recursive", "dense"] = "recursive",
    external_wrenches: Any = None,
    base: BaseMotion | None = None,
    frame: str | None = None,
    reference: Reference | None = None,
    classical: bool = True,
    **reading: Unpack[ReadingKeywords],
) -> dict[str, ExactArray]:
    """What a function of graphdyn would answer if it computed without rounding: its arrays, by name.

    robot: name, path of a URDF, or RobotModel; or an ExactSource, which has a truth of its own
    verb: name of the function, such as "joint_torques", or "frame_placement"
    arguments: as it takes them, (…, n). Doubles count as they are; fractions and texts ('0.3', '2/3', '-3pi/4') as what
        they say
    digits: so many are proven, relative to the largest entry of an array at a state
    truth: "file" for the decimals of the URDF, of which no model in memory holds all; "model" for the doubles of the
        model that was read. The default is that of the file, where there is one
    method: "dense" solves Eq. (111) in balls instead (solve_kkt)
    external_wrenches, base, frame, reference, classical: as the functions take them
    reading: as in urdf.load, for names and paths

    Raises InvalidInput without python-flint, for unknown verbs, robots with loops, files with a <coupling> (their
    models have exact values), wrong shapes, and what is no number; SingularMassMatrix where the mass matrix is
    singular, or not proven regular with MAX_BITS; urdf's errors for a file that cannot be read.
    """
    if verb not in VERBS and verb != PLACEMENT:
        near = closest(verb, (*VERBS, PLACEMENT)) or ", ".join(VERBS)
        raise InvalidInput(f"there is no function '{verb}' of graphdyn that has exact values; did you mean {near}?")
    if not isinstance(digits, int) or not 1 <= digits <= MAX_DIGITS:
        raise InvalidInput(f"digits is {digits!r}; give an integer from 1 to {MAX_DIGITS}")
    source = robot if isinstance(robot, ExactSource) else ExactSource(robot, truth, Reading.of(exact_values, reading))
    if verb == PLACEMENT:
        return _placements(source, arguments, digits, frame, base)
    known = VERBS[verb]
    _refuse_options(known, method, external_wrenches, base, frame)
    chosen = None
    if known.of_frame:
        if frame is None or reference is None:
            raise InvalidInput(f"{verb} speaks of a frame; give frame= and reference=")
        chosen = frame_choice(source.model, frame, reference, classical)
    inputs = _named(known.name, known.inputs, arguments)
    moving = base is not None and RECURSIONS[known.recursion].on_moving_base
    request = Request(known.recursion, known.outputs, external_wrenches is not None, moving, chosen)
    if method == "dense" and (source.model.couplings or not set(known.outputs) <= set(_DENSE_OUTPUTS)):
        raise InvalidInput(f"{verb} of robot '{source.model.name}' is not computed by the dense method; omit method")
    if external_wrenches is not None:
        inputs["external_wrenches"] = external_wrenches
    if moving:
        inputs |= _of_base(base, at_rest="v" not in inputs)
    shapes = {name: ARRAY_SPECS[name].shape_for(source.model) for name in known.outputs}
    compute = _by_equations if method == "dense" else _by_recursion(source, request, digits)
    return _Exact(source, digits, shapes, compute).answer(inputs)


PLACEMENT = "frame_placement"
"""The function of graphdyn that is none of its verbs, and has exact values."""


def _placements(
    source: ExactSource, arguments: tuple[Any, ...], digits: int, frame: str | None, base: BaseMotion | None
) -> dict[str, ExactArray]:
    """rotation (…, 3, 3) and position (…, 3) of a frame in the world."""
    _refuse_other_bases(base)
    inputs = _named(PLACEMENT, ("q",), arguments) | _of_base(base, at_rest=True)
    shapes = {"rotation": (3, 3), "position": (3,)}
    return _Exact(source, digits, shapes, _frame_placement(source, frame)).answer(inputs)


def _named(verb: str, names: tuple[str, ...], arguments: tuple[Any, ...]) -> dict[str, Any]:
    if len(arguments) != len(names):
        raise InvalidInput(f"{verb} takes {', '.join(names)}; {len(arguments)} arguments were given")
    return dict(zip(names, arguments, strict=True))


def _of_base(base: BaseMotion | None, at_rest: bool) -> dict[str, Any]:
    """The arrays of a base. at_rest: without its motion, as functions of q alone take it"""
    if base is None:
        return {}
    placed_base = BaseMotion(base.rotation, base.translation) if at_rest else base
    return {name: getattr(placed_base, name) for name in BASE_SHAPES}


def _refuse_other_bases(base: object) -> None:
    if base is not None and not isinstance(base, BaseMotion):
        raise InvalidInput(f"base is of type {type(base).__name__}; give a graphdyn.BaseMotion")


def _refuse_options(
    known: Verb, method: str, external_wrenches: Any, base: BaseMotion | None, frame: str | None
) -> None:
    """Raises InvalidInput for what the function does not take."""
    if method not in _METHODS:
        raise InvalidInput(f"method is {method!r}; use 'recursive' or 'dense'")
    if external_wrenches is not None and "external_wrenches" not in signature(known.function).parameters:
        raise InvalidInput(f"{known.name} takes no external wrenches; omit external_wrenches")
    if frame is not None and not known.of_frame:
        raise InvalidInput(f"{known.name} speaks of no frame; omit frame")
    _refuse_other_bases(base)
    if base is not None and base.moves and known.name in _OF_BASES_AT_REST:
        raise InvalidInput(f"{known.name} takes a base at rest, here as in graphdyn")


_METHODS = ("recursive", "dense")

_OF_BASES_AT_REST = ("coriolis_matrix", "frame_jacobian_derivative")

_DENSE_OUTPUTS = ("body_accelerations", "multipliers")


Given = Mapping[str, Balls]
"""The arguments of one state in balls, by name; those of a base by the names of BASE_SHAPES."""

Compute = Callable[[ExactRobot, ExactGround, Given], dict[str, Balls]]
"""Arrays of balls at the precision of the robot, flat, unbounded where they are not decided."""


@dataclass(frozen=True, eq=False)
class _Exact:
    """What is asked for, of a robot. shapes: of the arrays for one state, by name"""

    source: ExactSource
    digits: int
    shapes: Mapping[str, tuple[int, ...]]
    compute: Compute

    def answer(self, inputs: Mapping[str, Any]) -> dict[str, ExactArray]:
        """The arrays of all states, each at the precision that it needs."""
        batch, states = _rows(self.source.model, inputs)
        found = [self._of_state(state) for state in states]
        answer = {}
        for name, shape in self.shapes.items():
            entries = np.empty((len(found), math.prod(shape)), dtype=object)
            for row, (arrays, _) in zip(entries, found, strict=True):
                row[:] = list(arrays[name])
            whole = entries.reshape((*batch, *shape))
            precision = max((precision for _, precision in found), default=next(_precisions(self.digits)))
            answer[name] = ExactArray(whole, self.digits, precision, self.source.truth)
        return answer

    def _of_state(self, state: Mapping[str, Any]) -> tuple[dict[str, Balls], int]:
        for precision in _precisions(self.digits):
            with bits(precision):
                given = {name: as_balls(values) for name, values in state.items()}
                robot = self.source.at(precision)
                arrays = self.compute(robot, ground(robot, given if "rotation" in given else None), given)
                if all(_is_proven(array, self.digits) for array in arrays.values()):
                    return arrays, precision
        raise _singular(self.source.model, self.digits)


def _singular(model: RobotModel, digits: int) -> SingularMassMatrix:
    massless = [body.name for body in model.bodies if body.mass == 0 or not body.inertia.any()]
    cause = f" (bodies without mass or inertia: {', '.join(massless)})" if massless else ""
    return SingularMassMatrix(
        f"robot '{model.name}': {digits} digits are not proven with {MAX_BITS} bits; its mass matrix is singular at "
        f"this state, or is not proven regular{cause}"
    )


def _by_recursion(source: ExactSource, request: Request, digits: int) -> Compute:
    precision = next(_precisions(digits))
    with bits(precision):
        program = recorded(source.at(precision), request)
    if program.divides_by_zero:
        raise _singular(source.model, digits)
    constants: dict[ExactRobot, list[Any]] = {}

    def compute(robot: ExactRobot, on: ExactGround, given: Given) -> dict[str, Balls]:
        if robot not in constants:
            constants[robot] = program.constants(robot)
        columns = {name: list(values.ravel()) for name, values in given.items()}
        found = evaluate(program.program, {**columns, CONSTANTS: constants[robot], GROUND: on.columns(robot)})
        return {name: np.array(values, dtype=object) for name, values in found.items()}

    return compute


def _by_equations(robot: ExactRobot, on: ExactGround, given: Given) -> dict[str, Balls]:
    q, v, tau = (list(given[name]) for name in ("q", "v", "tau"))
    solved = system(robot, q, v, tau, given.get("external_wrenches"), on).solve()
    if solved is None:  # perhaps at a higher precision
        return dict.fromkeys(_DENSE_OUTPUTS, np.full(1, as_balls(0.0)[()] / 0, dtype=object))
    return {"body_accelerations": solved[0].ravel(), "multipliers": solved[1].ravel()}


def _frame_placement(source: ExactSource, frame: str | None) -> Compute:
    if frame is None:
        raise InvalidInput("frame_placement speaks of a frame; give frame=")
    name = source.model.frame(frame).name

    def compute(robot: ExactRobot, on: ExactGround, given: Given) -> dict[str, Balls]:
        rotation, position = placed(robot, on, list(given["q"]), name)
        return {"rotation": rotation.ravel(), "position": position}

    return compute


def _precisions(digits: int) -> Iterator[int]:
    """The numbers of bits to be tried, each twice the one before."""
    precision = math.ceil(digits * math.log2(10)) + SPARE_BITS
    while precision < MAX_BITS:
        yield precision
        precision *= 2
    yield MAX_BITS


def _is_proven(values: Balls, digits: int) -> bool:
    """Whether the radii are small enough beside the largest value, or all values vanish as far as can be told."""
    if not is_finite(values):
        return False
    return radius(values) <= max(10.0**-digits * magnitude(values), max(10.0 ** (-2 * digits), SMALLEST_RADIUS))


def _rows(model: RobotModel, inputs: Mapping[str, Any]) -> tuple[tuple[int, ...], list[dict[str, Any]]]:
    """The leading shape of the arguments, and those of each state. Raises InvalidInput for other shapes."""
    arrays = {}
    for name, given in inputs.items():
        array = np.asarray(given, dtype=object)
        trailing = {**BASE_SHAPES, "external_wrenches": (model.n_bodies, BODY_DOF)}.get(name, (model.nv,))
        if array.shape[array.ndim - len(trailing) :] != trailing:
            raise InvalidInput(f"{name} has shape {array.shape}, expected (…, {', '.join(map(str, trailing))})")
        arrays[name] = (array, len(trailing))
    shapes = {name: array.shape[: array.ndim - depth] for name, (array, depth) in arrays.items()}
    try:
        batch = np.broadcast_shapes(*shapes.values())
    except ValueError as error:
        raise InvalidInput(f"leading dimensions do not broadcast: {shapes}") from error
    full = {name: np.broadcast_to(x, (*batch, *x.shape[x.ndim - depth :])) for name, (x, depth) in arrays.items()}
    indices: Sequence[tuple[int, ...]] = list(product(*map(range, batch)))
    return batch, [{name: array[index] for name, array in full.items()} for index in indices]
