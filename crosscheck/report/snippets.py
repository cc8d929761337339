"""Python that reproduces a worst state: what a reader copies from the page and runs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from os import PathLike, fspath

import numpy as np

import urdf
from crosscheck.comparing.comparison import Comparison, QuantityResult, WorstState
from crosscheck.judging.judgment import UNCOUPLED, JudgedFunction, Judgment
from crosscheck.quantities import COUPLED, FUNCTIONS, LOADS, LOOPED, ComparedQuantity, TabulatedQuantity
from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf import Reading

_URDF = re.compile(r"\b(?=(?:InertialsFromMeshes|Xacro)\()")
"""Before the names of classes that a user calls urdf.InertialsFromMeshes, urdf.Xacro."""

_SYSTEM = "graphdyn.kkt_system(model, q, v, tau)"
_RANKS = {
    "constraint_rank": (f"{_SYSTEM}.constraint_rank()", "5 * model.n_bodies"),
    "kkt_rank": (f"{_SYSTEM}.rank()", "11 * model.n_bodies"),
}
_REFERENCE = "dict(reference=reference)"
_SHOWN = "print(ours, theirs, np.abs(ours - theirs).max(), sep='\\n')"


def _calls(quantity: ComparedQuantity) -> tuple[str, str] | None:
    """What graphdyn computes, and what it must be equal to; None for what belongs to all states together."""
    if not isinstance(quantity, TabulatedQuantity):
        return _RANKS.get(quantity.name)
    row, form = quantity.row, quantity.form
    usual = form.method == "auto" or (form.when != "all" and not form.loaded)  # as one state is computed in any case
    code = row.ours.code if form.loaded else row.ours.code.replace(f", {LOADS}", "")
    code = code if usual and not form.suffix else code.replace(")", f", method={form.method!r})", 1)
    theirs = (
        f"QUANTITIES[{row.name!r}].pinocchio(there, {'{}' if row.from_file or not row.of_frame else _REFERENCE})[0]"
    )
    if not row.of_frame:
        return code, theirs
    filled = {"{reference!r}": "reference", "{classical}": "True", "{frame!r}": "name"}
    for place, name in filled.items():
        code = code.replace(place, name)
    if row.from_file:
        return f"np.array([{code} for name in [frame.name for frame in model.frames]])", theirs
    references = "for reference in FRAME_REFERENCES]"
    return (
        f"np.array([[{code} for name in compared_frames(model)] {references})",
        f"np.array([{theirs} {references})",
    )


def worst_state(comparison: Comparison, result: QuantityResult) -> str | None:
    """Both sides of a quantity at its worst state; None for a quantity that belongs to all states together.

    Where a RobotModel was compared, the reader must put it into `model` first.
    """
    quantity, worst, calls = result.quantity, result.worst, _calls(result.quantity)
    if worst is None or calls is None:
        return None
    text = "\n".join(calls)
    pinocchio, loaded = "there" in text, isinstance(quantity, TabulatedQuantity) and quantity.form.loaded
    coupled = not COUPLED.keys().isdisjoint(comparison.quantities)
    looped = not LOOPED.keys().isdisjoint(comparison.quantities)
    lines = ["import numpy as np", "", "import graphdyn"]
    lines += ["import urdf"] if comparison.file else []
    lines += [f"from {module} import {names}" for module, names, used in _IMPORTS if used in text]
    lines += ["from urdf.document import locate"] if pinocchio and worst.route == "urdf" else []
    lines += ["", *_robot(comparison, ".uncoupled" * coupled + ".opened" * looped)]
    lines += [f"reference = PinocchioModel.{_pinocchio(comparison, worst.route)}"] if pinocchio else []
    lines += _surroundings(worst, comparison.model, pinocchio)
    lines += _numbers(worst, quantity.solves, loaded, text)
    names = ("q", "v", "a", "tau" if quantity.solves else "0 * q", *([LOADS] if loaded else []))
    lines += [f"there = PinocchioAnswers(reference, model, {', '.join(f'{x}[None]' for x in names)})"] * pinocchio
    ours, theirs = calls
    return "\n".join([*lines, "", f"ours = {ours}", f"theirs = {theirs}", _SHOWN]) + "\n"


_IMPORTS = (
    ("crosscheck.quantities", "QUANTITIES", "there"),
    ("crosscheck.reference.pinocchio_model", "PinocchioAnswers, PinocchioModel", "there"),
    ("crosscheck.reference.subject", "FRAME_REFERENCES, compared_frames", "FRAME_REFERENCES"),
    ("graphdyn.equations", "link_origins", "link_origins"),
)
"""Modules, their names, and what in the code shows that these are needed."""


def worst_call(judgment: Judgment, function: JudgedFunction) -> str:
    """graphdyn's answer at the worst call, beside the recorded answer of the function under test.

    Where a RobotModel was judged, the reader must put it into `model` first.
    """
    model = judgment.model
    lines = ["import numpy as np", "", "import graphdyn", *(["import urdf"] if judgment.file else []), ""]
    lines += _robot(judgment, ".uncoupled" * (UNCOUPLED in judgment.notes))
    reordered = judgment.joint_names != model.joint_names
    if reordered:
        lines += [
            f"names = {list(judgment.joint_names)!r}  # the order of the function under test",
            "order = [names.index(name) for name in model.joint_names]",
        ]
    for name, values in function.worst.arguments.items():
        shaped = f".reshape({model.n_bodies}, 6)" if name == LOADS else ""
        lines.append(f"{name} = {_array(values)}{shaped}{'[order]' if reordered else ''}")
    code = function.code or f"{_array(function.worst.expected)}  # of graphdyn, by the conventions of the function"
    if LOADS in code and LOADS not in function.worst.arguments:
        lines.append(f"{LOADS} = None")
    lines += [
        f"answer = {_array(function.worst.answer)}  # of the function under test, in the order of the model",
        "",
        f"expected = np.ravel({code})" if function.code else f"expected = {code}",
        "print(expected, answer, np.abs(expected - answer).max(), sep='\\n')",
    ]
    return "\n".join(lines) + "\n"


def smallest_test(judgment: Judgment, function: JudgedFunction) -> str | None:
    """A test of the smallest example, with the function under test by the name of what it computes; None without one.

    The expected numbers are graphdyn's, in the order of the joints of the function.
    """
    call, bound = function.smallest, function.bound
    if call is None:
        return None
    n, order = judgment.model.n_bodies, [judgment.model.joint_names.index(name) for name in judgment.joint_names]
    axes = FUNCTIONS[function.name].shape
    expected = np.reshape(call.expected, [size or -1 for size in FUNCTIONS[function.name].shape_for(n)])
    for axis, size in enumerate(axes):
        if size in ("n", "10 n"):
            parts = np.split(expected, n, axis=axis)
            expected = np.concatenate([parts[k] for k in order], axis=axis)
    lines = ["import numpy as np", "", "", f"def test_{function.name}_at_the_smallest_example():"]
    for name, values in call.arguments.items():
        lines.append(f"    {name} = {_array(values)}{f'.reshape({n}, 6)' if name == LOADS else ''}")
    largest = float(np.abs([*call.expected, *(x for x in call.answer if np.isfinite(x))]).max())
    lines += [
        f"    expected = {_array(expected)}",
        f"    answer = {function.name}({', '.join(call.arguments)})",
        f"    np.testing.assert_allclose(answer, expected, rtol=0, atol={bound * (largest or 1.0):.2g})",
    ]
    return "\n".join(lines) + "\n"


def _origin(record: Comparison | Judgment) -> str | None:
    """What urdf.load takes: the name in the catalog, or the whole path. None where a RobotModel was given."""
    if record.file is None:
        return None
    named = (entry.path for entry in urdf.robots() if entry.name == record.robot)
    return record.robot if record.file in (str(path.resolve()) for path in named) else record.file


def _robot(result: Comparison | Judgment, only: str) -> list[str]:
    """How a reader gets the robot. only: what is taken of it"""
    origin, model = _origin(result), result.model
    if origin is None:
        return ["# model is the RobotModel that was given"]
    options = ", ".join([repr(origin), *_reading(result.reading), f"gravity={model.gravity.tolist()}"])
    return [f"model = urdf.load({options}){only}"]


def _reading(reading: Reading) -> list[str]:
    """What one types for each option that is stated; gravity apart, which the model has."""
    values = {name: getattr(reading, name) for name in reading.stated if name != "gravity"}
    values |= {"lock": reading.locked} if reading.lock else {}
    values |= {"loops": fspath(reading.loops)} if isinstance(reading.loops, PathLike) else {}
    return [f"{name}={_URDF.sub('urdf.', repr(value))}" for name, value in values.items()]


def _pinocchio(comparison: Comparison, route: str) -> str:
    if route == "model":
        return "from_model(model)"
    options = ", ".join(_reading(comparison.reading))
    reading = f", urdf.Reading({options})" if options else ""
    return f"from_urdf(locate({_origin(comparison)!r})[0], model{reading})"


def _surroundings(worst: WorstState, model: RobotModel, pinocchio: bool) -> list[str]:
    """Base and gravity of the case, where they are not the robot's own."""
    if np.array_equal(worst.turn, np.eye(3)) and np.array_equal(worst.gravity, model.gravity):
        return []
    return [
        f"turn = graphdyn.Placement({_rows(worst.turn)})",
        f"model = model.with_base(turn @ model.base).with_gravity({list(worst.gravity)})",
        *(["reference = reference.turned(turn, model.gravity)"] if pinocchio else []),
    ]


def _numbers(worst: WorstState, solves: bool, loaded: bool, text: str) -> list[str]:
    """q, v, a; torques and external wrenches where the text needs them, zeros where their values do not matter."""
    lines = [f"{name} = {_array(getattr(worst, name))}" for name in ("q", "v", "a")]
    given = _array(worst.tau) if worst.tau is not None else "graphdyn.inverse_dynamics(model, q, v, a).tau"
    if solves or re.search(r"\btau\)", text):
        lines.append(f"tau = {given if solves else '0 * q'}")
    if loaded:
        lines.append(f"{LOADS} = np.array({_rows(worst.external_wrenches)})")
    return lines


def _array(values: Sequence[float] | Array) -> str:
    return f"np.array({np.asarray(values).tolist()})"


def _rows(matrix: Sequence[Sequence[float]]) -> str:
    """A list of lists, one row per line."""
    return "[\n" + "".join(f"    {list(row)},\n" for row in matrix) + "]"
