"""What the guards have to check to know that all inputs are finite: few outputs instead of many inputs.

What is not finite stays so in sums, products and numerators, and becomes NaN in sine and cosine; in a denominator only
NaN survives, since 1 / ∞ is zero. An output that is finite therefore vouches for every input that reaches it so.

The recursions recorded for one robot: a program for each recursion and choice of its outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.choices import FrameChoice
from graphdyn.compiler.llvm.precision import DOUBLE
from graphdyn.display import short_repr
from graphdyn.layout import BODY_DOF, Array
from graphdyn.model.coupling import DegreesOfFreedom
from graphdyn.model.robot_model import RobotModel, total_mass
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.recursions.declarations import ArraySpec
from graphdyn.recursions.frames import FixedFrame, fixed_frame
from graphdyn.recursions.inverse import Wrench, in_joint_axes
from graphdyn.recursions.loops.couplings import projected
from graphdyn.recursions.mechanism.mechanism import Link, links
from graphdyn.recursions.mechanism.reductions import regrouped, slid, turned
from graphdyn.recursions.motion import Root
from graphdyn.recursions.regressors import joint_torque_regressor
from graphdyn.scalars.differentiation import gradient, substituted
from graphdyn.scalars.expressions import MULTIPLIED_COLUMNS, Expression, Guard, Program, Recorder
from graphdyn.scalars.vectors import Scalars, by_shapes, scalars, zeros


def sufficient(recorder: Recorder, inputs: Sequence[Expression], outputs: Sequence[Any]) -> list[Expression]:
    """Outputs that vouch for several inputs each, and the inputs for which none does."""
    vouched = _vouched(recorder, [x.number for x in inputs])
    candidates = [output for output in outputs if isinstance(output, Expression)]
    chosen, missing = [], (1 << len(inputs)) - 1
    while candidates:
        best = max(candidates, key=lambda output: (vouched[output.number] & missing).bit_count())
        if (vouched[best.number] & missing).bit_count() < 2:
            break
        chosen.append(best)
        missing &= ~vouched[best.number]
    return [*chosen, *(x for place, x in enumerate(inputs) if missing >> place & 1)]


def _vouched(recorder: Recorder, inputs: Sequence[int]) -> list[int]:
    """Per operation, the inputs that are finite if it is: a bit for each."""
    finite: list[int] = []
    not_nan: list[int] = []  # those that are finite if it is not NaN
    bits = {number: 1 << place for place, number in enumerate(inputs)}
    for number, (kind, *arguments) in enumerate(recorder.operations):
        if kind in ("constant", "input"):
            finite.append(bits.get(number, 0))
            not_nan.append(0)
            continue
        first, *others = arguments
        if kind in ("sine", "cosine"):
            survives = reaches = finite[first]
        else:
            survives, reaches = not_nan[first], finite[first]
            for k in others:
                survives |= not_nan[k]
                reaches |= not_nan[k] if kind == "/" else finite[k]
        not_nan.append(survives)
        finite.append(reaches)
    return finite


GROUND_SHAPES = {
    "rotation": (3, 3),
    "position": (3,),
    "velocity": (3,),
    "omega": (3,),
    "alpha": (3,),
    "compensated": (3,),
}
"""The input ground of a base that moves, column after column: the fields of motion.Root that are not constant."""

GROUND_COLUMNS = sum(int(np.prod(shape)) for shape in GROUND_SHAPES.values())


REDUCTIONS = (slid, turned, regrouped)
"""What makes a robot with the same answers for its joints from fewer constants. Its bodies have none of their own."""

JOINT_ARRAYS = {"pivots", *(name for name, array in ARRAY_SPECS.items() if set(array.shape) == {"n"})}
"""Answers for the joints. A request for nothing else is recorded on the reduced robot."""


@dataclass(frozen=True)
@short_repr
class Request:
    """Which program: the recursion, its outputs in order, whether wrenches act on the bodies and the base moves.

    frame: which one, of recursions that speak of a frame
    dtype: of all numbers
    """

    recursion: str
    outputs: tuple[str, ...]
    external: bool = False
    moving_base: bool = False
    frame: FrameChoice | None = None
    dtype: np.dtype[Any] = DOUBLE.dtype


@lru_cache
def request_for(
    recursion: str,
    outputs: tuple[str, ...],
    external: bool,
    moving_base: bool,
    frame: FrameChoice | None,
    dtype: np.dtype[Any],
) -> Request:
    """The same object for the same answers: it is found faster than another one that is equal."""
    return Request(recursion, outputs, external, moving_base, frame, dtype)


@dataclass(frozen=True, eq=False)
@short_repr
class Parts:
    """The constants of a robot as scalars: links, the ground where it rests, couplings, and the frame asked for."""

    links: tuple[Link, ...]
    root: Root
    degrees_of_freedom: DegreesOfFreedom
    frame: FixedFrame | None = None


def trace(model: RobotModel, request: Request, parts: Callable[[Recorder], Parts] | None = None) -> Program:
    """The program of a request. Its inputs are among the arrays q, v, a, tau, external_wrenches and ground.

    parts: the constants of the robot, where they are not those of the model; they may be recorded as inputs
    """
    sample, recursion = Sample(model, request, parts), RECURSIONS[request.recursion]
    compute = recursion.coupled if model.couplings and recursion.coupled else recursion.compute
    compute = recursion.closed if model.chords and recursion.closed else compute
    with np.errstate(invalid="ignore"):  # 1 / 0 of a joint without inertia, while recording
        answer = compute(sample, sample.q, *map(sample.of_joints, recursion.inputs[1:]))
    named = answer if isinstance(answer, dict) else {recursion.outputs[0]: answer}
    outputs = {name: list(np.array(found, dtype=object).ravel()) for name, found in named.items()}
    if "coupling_multipliers" in recursion.outputs:
        needed = outputs["tau"] if model.couplings else sample.zeros
        reactions = scalars(sample.degrees_of_freedom.reactions)
        outputs["coupling_multipliers"] = list(reactions @ np.array(needed, dtype=object))
        outputs.setdefault("chord_multipliers", [])
    if model.couplings:
        outputs = sample.of_degrees_of_freedom(outputs, shapes={} if compute is recursion.coupled else ARRAY_SPECS)
    guards: dict[Guard, list[Any]] = {"squares": sample.turning}
    if "pivots" in outputs:
        scales = [1.0] * len(outputs["pivots"]) if compute is recursion.closed else pivot_scales(model)
        outputs["pivots"] = [d * (1.0 / size) for d, size in zip(outputs["pivots"], scales, strict=True)]
        guards["minimum"] = outputs["pivots"]
    wanted = {name: outputs[name] for name in request.outputs}
    guards["finite"] = sufficient(sample.recorder, sample.given, [x for columns in wanted.values() for x in columns])
    return sample.recorder.program(wanted, guards)


def record_equations(
    model: RobotModel, columns: Sequence[int], n_extra: int, weighted: bool = False
) -> tuple[Program, tuple[NDArray[np.intp], ...]]:
    """The torque equations of all joints, one after the other: [W_j | C_j | τ_j], and the columns of W_j by position.

    Inputs are q, v, a, tau, extra (n n_extra) and, if weighted, weights (n), one for each equation; the output is
    COLUMNS.
    """
    sample, matrix = _chosen_columns(model, columns)
    extra = np.array(sample.input("extra", sample.n * n_extra) if n_extra else [], dtype=object)
    tau = sample.input("tau")
    used = tuple(np.flatnonzero([isinstance(x, Expression) for x in row]) for row in matrix)
    weights = sample.input("weights") if weighted else [1.0] * sample.n
    equations: list[Any] = []
    for j, further in enumerate(extra.reshape(sample.n, n_extra)):
        equations += [x * weights[j] for x in (*matrix[j, used[j]], *further, tau[j])]
    guards: dict[Guard, list[Any]] = {"finite": sample.given, "squares": sample.turning}
    return sample.recorder.program({MULTIPLIED_COLUMNS: equations}, guards), used


def record_regressor_gradient(model: RobotModel, columns: Sequence[int]) -> Program:
    """∂/∂(q, v, a) of Σ_jk weights_jk W_jk, over chosen columns of the joint-torque regressor, by reverse mode.

    Inputs are q, v, a and weights (n len(columns)), row after row; the output is "gradient" (3 n): by q, v and a.
    """
    sample, matrix = _chosen_columns(model, columns)
    weights = np.array(sample.input("weights", matrix.size), dtype=object)
    variables = [x for name in "qva" for x in sample.recorder.inputs(name, sample.n)]
    total = weights @ matrix.ravel()
    return sample.recorder.program({"gradient": list(gradient(total, variables))}, {})


def _chosen_columns(model: RobotModel, columns: Sequence[int]) -> tuple[Sample, Scalars]:
    """The joint-torque regressor (n, len(columns)) of the joints that no others drive."""
    sample = Sample(model, Request("joint_torque_regressor", ("joint_torque_regressor",)))
    matrix = joint_torque_regressor(sample.links, sample.root, sample.q, sample.of_joints("v"), sample.of_joints("a"))
    if model.couplings:
        flat = sample.of_degrees_of_freedom({"joint_torque_regressor": list(matrix.ravel())}, ARRAY_SPECS)[
            "joint_torque_regressor"
        ]
        matrix = np.array(flat, dtype=object).reshape(ARRAY_SPECS["joint_torque_regressor"].shape_for(model))
    return sample, matrix[:, list(columns)]


class Sample:
    """The robot, and the arguments of its recursions for one sample."""

    def __init__(self, model: RobotModel, request: Request, parts: Callable[[Recorder], Parts] | None = None) -> None:
        self.model = model
        self.joints_only = parts is None and for_joints_only(model, request)
        self.recorder = Recorder()
        known = parts_of(model, request) if parts is None else parts(self.recorder)
        self.links = known.links
        self.given: list[Any] = []
        self.n, self.degrees_of_freedom = model.nv, known.degrees_of_freedom
        self.zeros = [0.0] * model.n_bodies
        self._held = dict[Expression, Any]()
        self.q = self.of_joints("q")
        self.root = moving_root(model, self.input("ground", GROUND_COLUMNS)) if request.moving_base else known.root
        if known.frame is not None:
            self.frame = known.frame
        self.external: list[Wrench] | None = None
        if request.external:
            columns = np.array(self.input("external_wrenches", model.n_bodies * BODY_DOF), dtype=object)
            self.external = in_joint_axes(self.links, columns.reshape(-1, BODY_DOF))

    @property
    def mass(self) -> Any:
        """Mass of all bodies. Raises InvalidInput for a robot without mass."""
        _ = total_mass(self.model)
        return sum((link.mass for link in self.links[1:]), self.links[0].mass)

    @property
    def turning(self) -> list[Any]:
        """The angles among q."""
        positions = (self._held.get(x, x) for x in self.q)
        return [x for x, link in zip(positions, self.links, strict=True) if not link.prismatic]

    def of_joints(self, name: str) -> list[Any]:
        """q, v or a of all joints, placeholders where there are couplings; tau of those that no others drive."""
        columns = self.input(name)
        if not self.model.couplings or name == "tau":
            return columns
        offset = self.degrees_of_freedom.offset if name == "q" else np.zeros(len(self.links))
        values = scalars(self.degrees_of_freedom.matrix) @ np.array(columns, dtype=object) + scalars(offset)
        places = self.recorder.placeholders(name, len(self.links))
        self._held.update(zip(places, values, strict=True))
        return list(places)

    def of_degrees_of_freedom(
        self, outputs: Mapping[str, list[Any]], shapes: Mapping[str, ArraySpec]
    ) -> dict[str, list[Any]]:
        """The outputs with the joints where their couplings hold them, projected where their shapes are given."""
        free = dict(outputs)
        for name in (name for name in outputs if name in shapes and "n" in shapes[name].shape):
            whole = np.array(outputs[name], dtype=object).reshape(shapes[name].shape_for(self.model.uncoupled))
            free[name] = list(projected(whole, shapes[name].shape, self.degrees_of_freedom).ravel())
        return {name: substituted(results, self._held) for name, results in free.items()}

    def input(self, name: str, width: int | None = None) -> list[Any]:
        columns = self.recorder.inputs(name, self.n if width is None else width)
        self.given += columns
        return columns


def parts_of(model: RobotModel, request: Request) -> Parts:
    """The constants of a model, of a simpler robot where that answers the request."""
    known = reduced_links(model) if for_joints_only(model, request) else links(model)
    frame = None if request.frame is None else fixed_frame(model, known, request.frame)
    return Parts(known, fixed_root(model), model.degrees_of_freedom, frame)


def for_joints_only(model: RobotModel, request: Request) -> bool:
    """Whether nothing but answers for the joints is asked for, of a robot whose bodies no chords hold."""
    return JOINT_ARRAYS.issuperset(request.outputs) and not model.chords


def reduced_links(model: RobotModel) -> tuple[Link, ...]:
    reduced = links(model)
    for reduction in REDUCTIONS:
        reduced = reduction(reduced)
    return reduced


def moving_root(model: RobotModel, ground: Sequence[Any]) -> Root:
    """The ground of a base that moves. ground: the columns of GROUND"""
    fields = by_shapes(ground, GROUND_SHAPES)
    gravity = scalars(model.gravity)
    acceleration = fields["compensated"] + fields["rotation"].T @ gravity
    return Root(gravity=gravity, acceleration=acceleration, **fields)


def fixed_root(model: RobotModel) -> Root:
    return Root(
        rotation=scalars(model.base.rotation),
        position=scalars(model.base.translation),
        gravity=scalars(model.gravity),
        velocity=zeros(3),
        omega=zeros(3),
        alpha=zeros(3),
        acceleration=zeros(3),
        compensated=scalars(-model.base.rotation.T @ model.gravity),
    )


def pivot_scales(model: RobotModel) -> Array:
    """Per free joint, more than the inertia about it can be in any pose (nv,): the stretched arm [kg m² or kg].

    A pivot of the elimination far below says that the mass matrix may be singular. Slides count as one meter.
    """
    steps = [np.linalg.norm(joint.placement.translation) + joint.is_prismatic for joint in model.joints]
    masses = np.array([body.mass for body in model.bodies])
    centers = np.array([np.linalg.norm(body.center_of_mass) for body in model.bodies])
    tensors = np.array([np.linalg.norm(body.inertia) for body in model.bodies])
    scales = np.zeros(model.n_bodies)
    for j, joint in enumerate(model.joints):
        reach = {j: 0.0}  # from O_j to the origins of body j and those outside, parents first
        for i in range(j + 1, model.n_bodies):
            inside = model.joints[i].inside - 1
            if inside in reach:
                reach[i] = reach[inside] + float(steps[i])
        outside, far = list(reach), np.array(list(reach.values()))
        turning = masses[outside] * (far + centers[outside]) ** 2 + tensors[outside]
        scales[j] = (masses[outside] if joint.is_prismatic else turning).sum()
    if model.couplings:  # (Σ K s)² ≤ (Σ |K|) Σ |K| s², of joints that move together
        share = np.abs(model.degrees_of_freedom.matrix)
        scales = (share.sum(axis=0) * share).T @ scales
    return np.where(scales > 0, scales, 1.0)
