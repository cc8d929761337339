"""Long robots: a step of one body is recorded once for every kind of body, and done for one body after the other.

Straight-line code grows with the robot, and compiling it takes longer than in proportion. Here constants come from a
table, and what later steps need of a body is kept in memory of its own.
"""

from __future__ import annotations

from dataclasses import replace
from math import prod
from typing import Any

import numpy as np

from graphdyn.compiler.programs import (
    GROUND_COLUMNS,
    Request,
    fixed_root,
    for_joints_only,
    moving_root,
    pivot_scales,
    reduced_links,
)
from graphdyn.compiler.rolled.body_steps import RECURSION_PASSES, STEP_MEMORY, SUMMED_NAMES, Pass
from graphdyn.compiler.rolled.rolled_code import CONSTANTS, INSIDE, OWN, BodyProgram, Kind, LongProgram
from graphdyn.layout import BODY_DOF, Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.recursions.inverse import Wrench, in_joint_axes
from graphdyn.recursions.mechanism.mechanism import Link, links
from graphdyn.recursions.motion import Root, resting_root
from graphdyn.scalars.expressions import Guard, Recorder
from graphdyn.scalars.vectors import Scalars, by_shapes, scalars, zeros

MAX_UNROLLED_BODIES = 24
"""Bodies up to which straight-line code is compiled. It leaves out what is zero for single bodies, and is up to twice
as fast; but the multipliers of so many bodies take a second to compile, and rolled a tenth of that."""

_NUMBERS = {
    "rotation": (3, 3),
    "translation": (3,),
    "link_axes": (3, 3),
    "center_of_mass": (3,),
    "first_moment": (3,),
    "tensor": (3, 3),
    "mass": (),
    "slide": (),
    "offset": (),
}
"""Shapes of the fields of a link that are numbers, in the order of the table; the pivot's scale follows."""

_ENDS = np.cumsum([prod(shape) for shape in STEP_MEMORY.values()]).tolist()
_PLACES = {name: slice(first, last) for name, first, last in zip(STEP_MEMORY, [0, *_ENDS], _ENDS, strict=False)}

VECTORS_PER_BODY = _ENDS[-1]
"""Vectors of memory that a body has."""


def is_long(model: RobotModel, request: Request) -> bool:
    """Whether a request is traced as rolled code: trees without couplings and chords, and recursions of PASSES."""
    tree = not model.couplings and not model.chords
    return tree and model.n_bodies > MAX_UNROLLED_BODIES and request.recursion in RECURSION_PASSES


def record_long(model: RobotModel, request: Request) -> LongProgram:
    bodies = reduced_links(model) if for_joints_only(model, request) else links(model)
    kinds = tuple(Kind(link.prismatic, link.quarters, link.inside < 0) for link in bodies)
    scales = pivot_scales(model)
    table = np.array([[*_numbers(link), 1.0 / scale] for link, scale in zip(bodies, scales, strict=True)])
    known: dict[Kind, dict[int, float]] = {kind: {} for kind in kinds}
    recorded = []
    for each in RECURSION_PASSES[request.recursion]:
        steps = {}
        for kind, columns in known.items():
            numbers = [number for number, other in enumerate(kinds) if other == kind]
            steps[kind] = StepInputs(model, request, bodies[numbers[0]], table[numbers], columns).trace(each)
        recorded.append((each.outwards, steps))
    n = model.n_bodies
    inputs = dict.fromkeys(RECURSIONS[request.recursion].inputs, n)
    inputs |= {"external_wrenches": n * BODY_DOF} if request.external else {}
    inputs |= {"ground": GROUND_COLUMNS} if request.moving_base else {}
    pivots: tuple[Guard, ...] = ("minimum",) if request.recursion == "forward_dynamics" else ()
    return LongProgram(
        kinds=kinds,
        inside=tuple(link.inside for link in bodies),
        table=table,
        passes=tuple(recorded),
        memory=VECTORS_PER_BODY,
        inputs=inputs,
        outputs={
            name: range(n if name == "pivots" else prod(ARRAY_SPECS[name].shape_for(model))) for name in request.outputs
        },
        guards=("finite", "squares", *pivots),
    )


def _numbers(link: Link) -> list[float]:
    return [float(x) for name in _NUMBERS for x in np.ravel(getattr(link, name))]


class StepInputs:
    """What a step is given (graphdyn.compiler.rolled.body_steps), for the bodies of a kind.

    known: columns of memory in which earlier steps left the same number for all of them; record adds its own
    """

    def __init__(
        self, model: RobotModel, request: Request, example: Link, rows: Array, known: dict[int, float]
    ) -> None:
        self._model, self._request, self._known = model, request, known
        self._recorder = Recorder()
        self._inwards = False
        self._given: dict[str, list[Any]] = {}
        self._kept: dict[int, Any] = {}
        self._added: dict[int, Any] = {}
        self._own, self._inside = (self._recorder.inputs(name, VECTORS_PER_BODY) for name in (OWN, INSIDE))
        inputs, same = self._recorder.inputs(CONSTANTS, rows.shape[1]), np.all(rows == rows[0], axis=0)
        constants = [float(rows[0, k]) if same[k] else column for k, column in enumerate(inputs)]
        self.pivot_scale = constants[-1]
        self._at_ground = example.inside < 0
        self.link = replace(example, **by_shapes(constants, _NUMBERS), inside=-1)
        self.reactions = not for_joints_only(model, request)

    @property
    def ground(self) -> Root:
        """The inside body."""
        if not self._at_ground:
            names = ("rotation", "omega", "alpha", "compensated")
            motion = {name: _shaped(name, self._inside) for name in names}
            return replace(resting_root(), gravity=scalars(self._model.gravity), **motion)
        if self._request.moving_base:
            return moving_root(self._model, self._input("ground", GROUND_COLUMNS))
        return fixed_root(self._model)

    @property
    def gained(self) -> Scalars:
        """What the last step kept of the inside body."""
        return zeros(2, 3) if self._at_ground else _shaped("gained", self._inside)

    @property
    def external(self) -> list[Wrench] | None:
        if not self._request.external:
            return None
        columns = self._input("external_wrenches", BODY_DOF)
        return in_joint_axes([self.link], np.array([columns], dtype=object))

    def joint(self, name: str) -> Any:
        """q, v, a or tau."""
        return self._input(name, 1)[0]

    def kept(self, name: str) -> Scalars:
        """What an earlier step of this body kept, and bodies outside have added."""
        known = {} if self._inwards and name in SUMMED_NAMES else self._known
        return _shaped(name, [known.get(k, column) for k, column in enumerate(self._own)])

    def keep(self, name: str, values: Any) -> None:
        places = range(VECTORS_PER_BODY)[_PLACES[name]]
        self._kept.update(zip(places, np.ravel(np.array(values, dtype=object)), strict=True))

    def add(self, name: str, values: Any) -> None:
        """Add to a sum of the inside body."""
        if not self._at_ground:
            places = range(VECTORS_PER_BODY)[_PLACES[name]]
            self._added.update(zip(places, np.ravel(np.array(values, dtype=object)), strict=True))

    def trace(self, one: Pass) -> BodyProgram:
        self._inwards = not one.outwards
        with np.errstate(invalid="ignore"):  # 1 / 0 of a joint without inertia
            answer = one.step(self)
        wanted = {name: answer[name] for name in self._request.outputs if name in answer}
        guards: dict[Guard, list[Any]] = {"finite": [x for columns in self._given.values() for x in columns]}
        if not self.link.prismatic and "q" in self._given:
            guards["squares"] = self._given["q"]
        if "pivots" in answer:
            guards["minimum"] = answer["pivots"]
        added = {k: x for k, x in self._added.items() if not (isinstance(x, float) and x == 0.0)}
        memory = {OWN: list(self._kept.values()), INSIDE: list(added.values())}
        program = self._recorder.program({**memory, **wanted}, guards)
        sums = [k for name in SUMMED_NAMES for k in range(VECTORS_PER_BODY)[_PLACES[name]]] if self._inwards else []
        for column in (*sums, *self._kept):  # sums of inside bodies, too, which this step has changed
            self._known.pop(column, None)
        self._known.update({column: value for column, value in self._kept.items() if isinstance(value, float)})
        return BodyProgram(program, tuple(self._kept), tuple(added))

    def _input(self, name: str, width: int) -> list[Any]:
        if name not in self._given:
            self._given[name] = list(self._recorder.inputs(name, width))
        return self._given[name]


def _shaped(name: str, columns: list[Any]) -> Scalars:
    return np.array(columns[_PLACES[name]], dtype=object).reshape(STEP_MEMORY[name])
