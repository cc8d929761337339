"""Recording a step of one body, and the memory that steps of all bodies share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property
from itertools import product
from math import prod
from typing import Any

import numpy as np

from graphdyn.compiler.programs import GROUND_COLUMNS, Request, fixed_root, moving_root
from graphdyn.compiler.rolled.program import (
    CARRIED,
    CONSTANTS,
    MEMORY,
    BodyProgram,
    Index,
    Order,
    Pass,
    Place,
    RecordedPass,
    Write,
)
from graphdyn.layout import BODY_DOF, BODY_PARAMETERS, Array
from graphdyn.model.robot_model import RobotModel, total_mass
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.recursions.frames import FixedFrame, fixed_frame
from graphdyn.recursions.inverse import Wrench, in_joint_axes
from graphdyn.recursions.mechanism.mechanism import Link, Links
from graphdyn.recursions.motion import Root, rooted
from graphdyn.scalars.expressions import Recorder, program_of
from graphdyn.scalars.vectors import Scalars, by_shapes

NUMBERS = {
    "rotation": (3, 3),
    "translation": (3,),
    "link_axes": (3, 3),
    "center_of_mass": (3,),
    "first_moment": (3,),
    "tensor": (3, 3),
    "mass": (),
    "slide": (),
}
"""Shapes of the fields of a link that are numbers, in the order of the table; the pivot's scale follows."""

SHAPES: dict[str, tuple[int | str, ...]] = {
    "external_wrenches": ("bodies", BODY_DOF),
    "ground": (GROUND_COLUMNS,),
    "pivots": ("n",),
    "pushes": ("n", "n"),
    "released": ("n", "n"),
}
"""Shapes of arrays that are not among ARRAY_SPECS."""

MOST_KINDS = 3
"""Most kinds of bodies that turn, and of those that slide. Each has code of its own, which takes time to compile."""

PER_BODY = {"n": 1, "bodies": 1, "10 bodies": BODY_PARAMETERS, "couplings": 0, "chord rows": 0}
"""Dimensions of arrays that grow with the robot, and how many entries belong to a body. There are no couplings and
chords."""


class Shared:
    """What the steps of all bodies share: the arrays, and what is known of memory.

    robot: bodies and pivots' scales; at_joint_1: whether the ground frame has its origin there (motion.rooted)
    """

    def __init__(self, model: RobotModel, request: Request, links: Links, scales: Array, at_joint_1: bool) -> None:
        self.model, self.request = model, request
        self.recursion = RECURSIONS[request.recursion]
        self.arm = links[0].translation if at_joint_1 else None
        if at_joint_1:
            links, _ = rooted(links, fixed_root(model))
        self.links = [_turned_to_zero(link) for link in links]
        self.table = np.array([[*_numbers(link), 1.0 / scale] for link, scale in zip(self.links, scales, strict=True)])
        self.kinds = _kinds([link.prismatic for link in self.links], self.table)
        self.frame: FixedFrame | None = None
        if request.frame is not None:
            self.frame = fixed_frame(model, self.links, request.frame)
        self.joints_only = not {"body_accelerations", "multipliers", "joint_wrenches"} & set(request.outputs)
        self.fields: dict[str, dict[str, tuple[int, tuple[int, ...]]]] = {MEMORY: {}, CARRIED: {}}
        self.sums: set[str] = set()
        self.arrays: set[str] = set()  # those that steps have answered
        # columns of memory that are the same number for every body, and for the ground too
        self.known: dict[int, float] = {}
        self.known_inside: dict[int, float] = {}
        self._of_ground: dict[int, Any] = {}

    def shape(self, array: str) -> tuple[int | str, ...]:
        return SHAPES[array] if array in SHAPES else ARRAY_SPECS[array].shape

    def size(self, array: str) -> tuple[int, ...]:
        n = self.model.n_bodies
        return tuple(size if isinstance(size, int) else n * PER_BODY[size] for size in self.shape(array))

    def part(self, array: str) -> tuple[int, ...]:
        """Columns of an array that belong to the first body, or pair of bodies."""
        sizes = self.size(array)
        own = [size if isinstance(size, int) else PER_BODY[size] for size in self.shape(array)]
        strides = [prod(sizes[k + 1 :]) for k in range(len(sizes))]
        return tuple(sum(map(int.__mul__, at, strides)) for at in product(*map(range, own)))

    def field(self, space: str, name: str, shape: tuple[int, ...] | None = None) -> tuple[int, tuple[int, ...]]:
        """The column where a field begins, and its shape, which the first step that keeps it decides."""
        fields = self.fields[space]
        if name not in fields and shape is not None:
            fields[name] = self.width(space), shape
        return fields[name]

    def width(self, space: str) -> int:
        return sum(prod(shape) for _, shape in self.fields[space].values())

    def record(self, each: Pass, in_columns: bool = False) -> RecordedPass:
        kinds = [0] if each.order in ("ground", "frame") else sorted(set(self.kinds))
        supposed = dict(self._of_ground) if each.order == "outwards" and not in_columns else {}
        supposed = {column: value for column, value in supposed.items() if not np.isnan(value)}
        certain = self.known_inside
        while True:
            # the ground's numbers hold for all bodies if each body keeps what its inside body is supposed to keep
            self.known_inside = {**supposed, **certain}
            steps = {kind: BodyStep(self, each.order, kind) for kind in kinds}
            with np.errstate(invalid="ignore"):  # 1 / 0 of a joint without inertia
                recorded = {kind: step.trace(each.step) for kind, step in steps.items()}
            kept = [step.numbers_kept() for step in steps.values()]
            holding = {column: x for column, x in supposed.items() if all(known.get(column) == x for known in kept)}
            if len(holding) == len(supposed):
                break
            supposed = holding
        self.known_inside = certain
        if not in_columns:
            self._learn(each.order, kept)
        return RecordedPass(each.order, recorded)

    def _learn(self, order: Order, kept: Sequence[Mapping[int, float]]) -> None:
        """What a pass leaves in memory that is the same number everywhere. kept: by each kind of bodies"""
        if order == "ground":
            self._of_ground |= kept[0]
            for column in kept[0]:
                self.known_inside.pop(column, None)
        elif order in ("outwards", "inwards"):
            for column in set().union(*kept):
                values = {known.get(column) for known in kept}
                (value,) = values if len(values) == 1 else (None,)
                for known, others in ((self.known, value), (self.known_inside, self._of_ground.get(column))):
                    known.pop(column, None)
                    if value is not None and others == value:
                        known[column] = value


class BodyStep:
    """What a step is given, for all bodies of a kind: names are those of fields of memory."""

    def __init__(self, shared: Shared, order: Order, kind: int) -> None:
        self._shared, self.order = shared, order
        self._bodies = [k for k, each in enumerate(shared.kinds) if each == kind]
        if order == "frame":
            assert shared.frame is not None
            self._bodies = [shared.frame.body]
        self.prismatic = shared.links[self._bodies[0]].prismatic
        self._recorder = Recorder()
        self._writes: list[tuple[Write, list[Any]]] = []
        self._own: dict[str, Scalars] = {}
        self.request, self.model = shared.request, shared.model

    # The body

    @cached_property
    def link(self) -> Link:
        """Its constants are numbers where all bodies have the same ones."""
        link = self._shared.links[self._bodies[0]]
        return replace(link, **by_shapes(self._constants, NUMBERS), inside=-1)

    @property
    def pivot_scale(self) -> Any:
        return self._constants[-1]

    @cached_property
    def _constants(self) -> list[Any]:
        rows = self._shared.table[self._bodies]
        same = np.all(rows == rows[0], axis=0)
        place = Place(CONSTANTS, ("body",))
        return [float(rows[0, k]) if same[k] else self._input(place, k) for k in range(rows.shape[1])]

    @property
    def mass(self) -> float:
        """That of all bodies."""
        return total_mass(self.model)

    @property
    def reactions(self) -> bool:
        """Whether more is asked for than what the joints need."""
        return not self._shared.joints_only

    @property
    def frame(self) -> FixedFrame:
        assert self._shared.frame is not None
        return self._shared.frame

    @property
    def root(self) -> Root:
        """The ground, in steps for it."""
        request = self.request
        root = moving_root(self.model, self._array("ground", ())) if request.moving_base else fixed_root(self.model)
        arm = self._shared.arm
        if arm is None:
            return root
        return rooted([replace(self._shared.links[0], translation=arm)], root)[1]

    @property
    def external(self) -> list[Wrench] | None:
        """The external wrench on the body, in joint axes."""
        if not self.request.external:
            return None
        return in_joint_axes([self.link], np.array([self._array("external_wrenches", ("body",))], dtype=object))

    def joint(self, name: str) -> Any:
        """q, v, a or tau; zero where the recursion does not take it, nor a step before has answered it."""
        known = name in self._shared.recursion.inputs or name in self._shared.arrays
        return self._array(name, ("body",))[0] if known else 0.0

    # Memory

    def kept(self, name: str) -> Scalars:
        """What this body keeps, from this step or those before."""
        if name in self._own:
            return self._own[name]
        return self._field(MEMORY, name, "body", {} if name in self._shared.sums else self._shared.known)

    def inside(self, name: str) -> Scalars:
        """What the inside body keeps."""
        return self._field(MEMORY, name, "inside", {} if name in self._shared.sums else self._shared.known_inside)

    def column(self, name: str) -> Scalars:
        """What the body of the column keeps."""
        return self._field(MEMORY, name, "column", {} if name in self._shared.sums else self._shared.known)

    def at_ground(self, name: str) -> Scalars:
        return self._field(MEMORY, name, "ground", {})

    def carried(self, name: str) -> Scalars:
        return self._field(CARRIED, name, None, {})

    def keep(self, name: str, value: Any) -> None:
        self._own[name] = np.array(value, dtype=object)[()]
        self._write(MEMORY, name, "body", value, added=False)

    def sum(self, name: str, value: Any) -> None:
        """Keep what is the body's own of a sum, to which bodies outside add."""
        self._shared.sums.add(name)
        self.keep(name, value)

    def add(self, name: str, value: Any) -> None:
        """Add to a sum of the inside body."""
        self._shared.sums.add(name)
        self._write(MEMORY, name, "inside", value, added=True)

    def add_at_ground(self, name: str, value: Any) -> None:
        self._shared.sums.add(name)
        self._write(MEMORY, name, "ground", value, added=True)

    def carry(self, name: str, value: Any) -> None:
        """Hand on to the next step of the column."""
        self._write(CARRIED, name, None, value, added=False)

    # Arrays

    def answer(self, array: str, values: Any, *of: Index) -> None:
        """The part of an array, of the outputs or in between, that belongs to this body, or to these."""
        self._shared.arrays.add(array)
        flat = list(np.ravel(np.array(values, dtype=object)))
        columns = self._shared.part(array)
        assert len(flat) == len(columns), (array, len(flat), len(columns))
        self._writes.append((Write(Place(array, of or self._index(array)), columns), flat))

    def answered(self, array: str, *of: Index) -> Scalars:
        """A part that steps before have answered."""
        return np.array(self._array(array, of or self._index(array)), dtype=object)

    def _index(self, array: str) -> tuple[Index, ...]:
        return ("body",) if any(isinstance(size, str) for size in self._shared.shape(array)) else ()

    def _array(self, array: str, of: tuple[Index, ...]) -> list[Any]:
        place = Place(array, of)
        return [self._input(place, column) for column in self._shared.part(array)]

    def _field(self, space: str, name: str, index: Index | None, known: Mapping[int, float]) -> Scalars:
        first, shape = self._shared.field(space, name)
        place = Place(space, () if index is None else (index,))
        columns = range(first, first + prod(shape))
        found = [known[k] if k in known else self._input(place, k) for k in columns]
        array: Scalars = np.array(found, dtype=object).reshape(shape)[()]
        return array

    def _write(self, space: str, name: str, index: Index | None, value: Any, added: bool) -> None:
        values = np.array(value, dtype=object)
        first, shape = self._shared.field(space, name, values.shape)
        assert shape == values.shape, (name, shape, values.shape)
        pairs = [
            (first + k, x) for k, x in enumerate(values.ravel()) if not (added and isinstance(x, float) and x == 0.0)
        ]
        place = Place(space, () if index is None else (index,))
        self._writes.append((Write(place, tuple(k for k, _ in pairs), added), [x for _, x in pairs]))

    def _input(self, place: Place, column: int) -> Any:
        return self._recorder.operation("input", place, column)

    def trace(self, step: Callable[[Any], None]) -> BodyProgram:
        step(self)
        outputs = {str(k): values for k, (_, values) in enumerate(self._writes)}
        pivots = [x for write, values in self._writes for x in values if write.place.array == "pivots"]
        program = self._recorder.program(outputs, {"minimum": pivots} if pivots else {})
        return BodyProgram(program, tuple(write for write, _ in self._writes))

    def numbers_kept(self) -> dict[int, float]:
        """Columns of memory that this body keeps, with the number where it is one."""
        return {
            column: value if isinstance(value, float) else np.nan
            for write, values in self._writes
            if write.place == Place(MEMORY, ("body",))
            for column, value in zip(write.columns, values, strict=True)
        }


def with_needed(step: BodyProgram, needed: Set[tuple[str, int]], outputs: Set[str]) -> BodyProgram:
    """The step without what nobody needs. needed: arrays and their columns, beside the outputs"""
    writes: list[Write] = []
    numbers: dict[str, list[int]] = {}
    for k, write in enumerate(step.writes):
        array = write.place.array
        kept = [place for place, column in enumerate(write.columns) if array in outputs or (array, column) in needed]
        if kept:
            numbers[str(len(writes))] = [step.program.outputs[str(k)][place] for place in kept]
            writes.append(replace(write, columns=tuple(write.columns[place] for place in kept)))
    program = program_of(step.program.operations, {}, numbers, step.program.guards)
    return BodyProgram(program, tuple(writes))


def _numbers(link: Link) -> list[float]:
    return [float(x) for name in NUMBERS for x in np.ravel(getattr(link, name))]


def _turned_to_zero(link: Link) -> Link:
    """The angle at q = 0 becomes part of its rotation."""
    c, s = link.at_zero
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], dtype=object)
    return replace(link, rotation=link.rotation @ turn, at_zero=(1.0, 0.0))


def _kinds(prismatic: Sequence[bool], table: Array) -> tuple[int, ...]:
    """The kind of every body: turn or slide, and apart from the others those bodies with the same zeros among their
    constants that have more of them than all have in common."""
    kinds, count = np.zeros(len(table), dtype=int), 0
    for slides in sorted(set(prismatic)):
        left = np.flatnonzero(np.array(prismatic) == slides)
        for _ in range(MOST_KINDS - 1):
            zeros, place, sizes = np.unique(table[left] == 0, axis=0, return_inverse=True, return_counts=True)
            most = sizes.argmax()
            if sizes[most] == 1 or zeros[most].sum() == zeros.all(axis=0).sum():
                break
            alike = place.ravel() == most
            kinds[left[alike]], left, count = count, left[~alike], count + 1
        kinds[left], count = count, count + 1
    return tuple(kinds.tolist())
