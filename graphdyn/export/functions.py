"""What is exported: the verbs of one robot as programs, of arrays that their users know."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import nan, prod
from typing import Any

import numpy as np

from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.arguments.choices import FrameChoice, Reference, frame_choice
from graphdyn.arguments.keywords import closest
from graphdyn.compiler.programs import GROUND_SHAPES, Request, trace
from graphdyn.display import short_repr
from graphdyn.equations.loops.reactions import in_self_stress_usually
from graphdyn.errors import InvalidInput
from graphdyn.layout import BODY_DOF, Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.recursions.declarations import INPUTS, ArraySpec
from graphdyn.scalars.expressions import Program, Recorder
from graphdyn.scalars.vectors import Scalars, by_shapes, cross, scalars
from graphdyn.verbs.verb import VERBS, Verb

BASE_ARRAYS = {
    "base_rotation": ArraySpec((3, 3), "1"),
    "base_translation": ArraySpec((3,), "m"),
    "base_velocity": ArraySpec((BODY_DOF,), "m/s, rad/s"),
    "base_acceleration": ArraySpec((BODY_DOF,), "m/s², rad/s²"),
}
"""The fields of a BaseMotion as arguments, the last ones."""

WHERE_BASE_IS = ("gravity_torque", "static_torque", "frame_jacobian_derivative")
"""Verbs for which of the motion of a base only the placement counts, although their recursions know all of it."""

WRENCHES = ArraySpec(("bodies", BODY_DOF), "N, N m")


@dataclass(frozen=True)
class ExportChoices:
    """What functions take beside their joint arrays, where they can, and of which frame they speak.

    external_wrenches: force, moment on each body at O_j, in link axes (bodies, 6), after the joint arrays
    moving_base: the fields of a BaseMotion that count, as the last arguments (BASE_ARRAYS)
    frame, reference, classical: as in the frame verbs, whose reference has no default
    """

    external_wrenches: bool = False
    moving_base: bool = False
    frame: str | None = None
    reference: Reference | None = None
    classical: bool = True


AS_THEY_ARE = ExportChoices()


@dataclass(frozen=True, eq=False)
@short_repr
class ExportedFunction:
    """A verb of one robot as a program. Arrays without entries are left out.

    inputs, outputs: shapes and units of its arrays by name, in the order of the arguments
    program: its inputs and outputs are these arrays, a column for each entry, row by row; its guard "minimum" are the
        pivots: with one below DOUBLE.min_pivot_share the mass matrix may be singular
    """

    model: RobotModel
    verb: Verb
    frame: FrameChoice | None
    inputs: Mapping[str, ArraySpec]
    outputs: Mapping[str, ArraySpec]
    program: Program

    @property
    def name(self) -> str:
        return self.verb.name

    def shape(self, array: str) -> tuple[int, ...]:
        """Shape of an input or output."""
        return {**self.inputs, **self.outputs}[array].shape_for(self.model)

    def size(self, array: str) -> int:
        """Number of entries of an input or output."""
        return prod(self.shape(array))

    def expected(self, x: Mapping[str, Array]) -> dict[str, Array]:
        """The outputs as the equations give them, Eq. (111) as it stands: inputs and outputs are arrays (N, …)."""
        arguments = [x[name] for name in self.verb.inputs]
        keywords: dict[str, Any] = {"method": "projected" if self.model.chords else "dense"}
        if "external_wrenches" in x:
            keywords["external_wrenches"] = x["external_wrenches"]
        if "base_rotation" in x or "base_translation" in x:
            keywords["base"] = BaseMotion(**{name.removeprefix("base_"): x[name] for name in BASE_ARRAYS if name in x})
        if self.frame is not None:
            keywords |= {"frame": self.frame.name, "reference": self.frame.reference}
            if "classical" in inspect.signature(self.verb.function).parameters:
                keywords["classical"] = self.frame.classical
        arrays = self.verb.memory(self.verb.function(self.model, *arguments, **keywords))
        assert arrays is not None
        return {name: arrays[name] for name in self.outputs}


def exported_functions(model: RobotModel, names: Iterable[str], choices: ExportChoices) -> list[ExportedFunction]:
    """The functions of these names, each of which is that of a verb.

    Raises InvalidInput for a name that is none, or is given twice; for a verb without a compiled form for this robot;
    for one that speaks of a frame, where none is chosen; UnknownFrame.
    """
    check_model(model)
    wanted = list(names)
    if not wanted:
        raise InvalidInput("no function to export; name at least one")
    for name in wanted:
        if wanted.count(name) > 1:
            raise InvalidInput(f"function '{name}' is given twice; name it once")
    return [_exported(model, _known(name), choices) for name in wanted]


def exportable(model: RobotModel, choices: ExportChoices = AS_THEY_ARE) -> list[str]:
    """Names of the verbs that can be exported for this robot: with a compiled form, and a frame where they need one."""
    return [
        name
        for name, verb in VERBS.items()
        if verb.is_compiled(model)
        and not (model.chords and verb.remedy is not None)
        and (choices.frame is not None or not verb.of_frame)
    ]


def _known(name: str) -> Verb:
    if name not in VERBS:
        near = closest(name, VERBS)
        raise InvalidInput(
            f"there is no function '{name}' to export; use {repr(near) if near else 'some of ' + ', '.join(VERBS)}"
        )
    return VERBS[name]


def _exported(model: RobotModel, verb: Verb, choices: ExportChoices) -> ExportedFunction:
    verb.refuse_loops(model)
    verb.refuse_uncompiled(model, "leave it out")
    frame = None
    if verb.of_frame:
        if choices.frame is None or choices.reference is None:
            raise InvalidInput(f"{verb.name} speaks of a frame; say which, with its reference, or leave it out")
        frame = frame_choice(model, choices.frame, choices.reference, choices.classical)
    moving = choices.moving_base and RECURSIONS[verb.recursion].on_moving_base
    loaded = choices.external_wrenches and "external_wrenches" in inspect.signature(verb.function).parameters
    inputs = {name: INPUTS[name] for name in verb.inputs}
    inputs |= {"external_wrenches": WRENCHES} if loaded else {}
    outputs = {name: ARRAY_SPECS[name] for name in verb.outputs if 0 not in ARRAY_SPECS[name].shape_for(model)}
    traced = trace(model, Request(verb.recursion, tuple(outputs), loaded, moving, frame))
    program = _of_arrays(model, traced, inputs, at_rest=verb.name in WHERE_BASE_IS)
    used = {operands[0] for kind, *operands in program.operations if kind == "input"}
    inputs |= {name: spec for name, spec in BASE_ARRAYS.items() if name in used}
    sizes = {name: prod(spec.shape_for(model)) for name, spec in inputs.items()}
    return ExportedFunction(model, verb, frame, inputs, outputs, replace(program, inputs=sizes))


def _of_arrays(model: RobotModel, program: Program, inputs: Mapping[str, ArraySpec], at_rest: bool) -> Program:
    """The program of these inputs, and of BASE_ARRAYS instead of the ground, with no guards but the pivots.

    It answers NaN where loops leave a reaction undetermined. at_rest: whether the base only stands somewhere
    """
    recorder = Recorder()

    def arrays(specs: Mapping[str, ArraySpec]) -> dict[str, list[Any]]:
        return {name: list(recorder.inputs(name, prod(spec.shape_for(model)))) for name, spec in specs.items()}

    columns = arrays(inputs)
    if "ground" in program.inputs:
        base = arrays(BASE_ARRAYS)
        if at_rest:
            base |= {name: [0.0] * BODY_DOF for name in ("base_velocity", "base_acceleration")}
        columns["ground"] = _ground(model, base)
    values: list[Any] = []
    for kind, *operands in program.operations:
        values.append(columns[operands[0]][operands[1]] if kind == "input" else _computed(kind, values, operands))
    undetermined = in_self_stress_usually(model) if model.chords else {}
    outputs = {}
    for name, numbers in program.outputs.items():
        unknown = np.ravel(undetermined.get(name, np.zeros(len(numbers), dtype=bool)))
        outputs[name] = [nan if lost else values[k] for k, lost in zip(numbers, unknown, strict=True)]
    return recorder.program(outputs, {"minimum": [values[k] for k in program.guards.get("minimum", ())]})


def _computed(kind: str, values: list[Any], operands: list[Any]) -> Any:
    if kind == "constant":
        return operands[0]
    x, *others = (values[k] for k in operands)
    if kind == "negate":
        return -x
    if kind in ("sine", "cosine"):
        return np.sin(x) if kind == "sine" else np.cos(x)
    (y,) = others
    return x + y if kind == "+" else x - y if kind == "-" else x * y if kind == "*" else x / y


def _ground(model: RobotModel, base: Mapping[str, list[Any]]) -> list[Any]:
    """The columns of graphdyn.compiler.programs.GROUND_SHAPES, of those of BASE_ARRAYS."""
    shapes = {name: spec.shape_for(model) for name, spec in BASE_ARRAYS.items()}
    flat = [x for columns in base.values() for x in columns]
    rotation, translation, velocity, acceleration = by_shapes(flat, shapes).values()
    omega, alpha = velocity[3:], acceleration[3:]
    arm = rotation @ scalars(model.base.translation)
    turned = rotation @ scalars(model.base.rotation)
    moved: Scalars = acceleration[:3] + cross(alpha, arm) + cross(omega, cross(omega, arm))
    columns = {
        "rotation": turned.ravel(),
        "position": translation + arm,
        "velocity": turned.T @ (velocity[:3] + cross(omega, arm)),
        "omega": turned.T @ omega,
        "alpha": turned.T @ alpha,
        "compensated": turned.T @ (moved - scalars(model.gravity)),
    }
    return [x for name in GROUND_SHAPES for x in columns[name]]
