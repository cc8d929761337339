"""Faults that any function of the table may have: put into graphdyn's function, and its answers compared.

For functions that are not taken apart by experiments into the terms of the equations of motion.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, combinations

import numpy as np

from crosscheck.judging.faults.fault import FaultDescription, factor_said, round_factor
from crosscheck.judging.functions.table import formulation_of
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.searching.found_fault import FIRST_TRIAL_STATES, AnswerFault, Answering, FoundFault
from crosscheck.judging.searching.frame_faults import other_frames
from crosscheck.judging.searching.load_faults import other_loads
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS, Quantity
from crosscheck.quantities.measures import Chosen
from graphdyn import Placement, RobotModel
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS, Array

SIGN_FACTOR_TOLERANCE = 1e-4
"""Distance of a fitted factor from 1 or -1 within which it is that number."""


def faults(known: Quantity, states: JudgedStates) -> Iterator[AnswerFault]:
    """All faults without free numbers."""
    ours = known.of_graphdyn
    yield AnswerFault("sign", "all answers have the opposite sign", "negate them", lambda s, c: -ours(s, c))
    absolute = "the absolute values of the numbers are given"
    yield AnswerFault("sign", absolute, "keep their signs", lambda s, c: np.abs(ours(s, c)))
    positive = "negative numbers are replaced by zero"
    yield AnswerFault("clipped", positive, "keep them", lambda s, c: np.maximum(ours(s, c), 0.0))
    yield from _other_arguments(known)
    if states.loads is not None:
        yield from other_loads(known, states)
    if known.of_frame:
        yield from other_frames(known, states)
    if formulation_of(known.name, states.model, states.frame, next(known.readings({}))) is None:
        yield from _other_models(known, states.model)


def layouts(known: Quantity) -> Iterator[AnswerFault]:
    """Right numbers at other places, with another sign of a half, or not all of them; those of another function."""
    yield from _other_functions(known)
    yield from _matrices(known)
    yield from _of_other_joints(known)
    yield from _of_halves(known)


def _matrices(known: Quantity) -> Iterator[AnswerFault]:
    """Transposed, symmetric, or filled in or inverted in part."""
    if len(known.shape) == 2 and known.shape[0] == known.shape[1]:
        yield AnswerFault(
            "transposed", "the matrix is transposed", "transpose it",
            lambda s, c: np.swapaxes(known.of_graphdyn(s, c), -1, -2),
        )  # fmt: skip
        yield AnswerFault(
            "triangle", "only the diagonal of the matrix is filled in", "its other entries couple the joints",
            lambda s, c: (x := known.of_graphdyn(s, c)) * np.eye(x.shape[-1]),
        )  # fmt: skip
        yield AnswerFault(
            "transposed", "the matrix is made symmetric, ½ (X + Xᵀ)", "it is not symmetric",
            lambda s, c: ((x := known.of_graphdyn(s, c)) + np.swapaxes(x, -1, -2)) / 2,
        )  # fmt: skip
        for name, part in (("lower", np.tril), ("upper", np.triu)):
            yield AnswerFault(
                "triangle", f"only the {name} triangle of the matrix is filled in", "copy it to the other side",
                lambda s, c, part=part: part(known.of_graphdyn(s, c)),  # type: ignore[misc]
            )  # fmt: skip
    elif len(known.shape) >= 2:
        yield AnswerFault(
            "transposed", "the numbers of the matrix are stored column by column", "store them row by row",
            lambda s, c: np.swapaxes(x := known.of_graphdyn(s, c), -1, -2).reshape(x.shape),
        )  # fmt: skip
    if known.name == "mass_matrix_inverse":
        for name, part in (("lower", np.tril), ("upper", np.triu)):
            yield AnswerFault(
                "triangle", f"the {name} triangle of the mass matrix alone is inverted", "invert the whole matrix",
                lambda s, c, part=part: np.linalg.inv(part(s.mass)).astype(float),  # type: ignore[misc]
            )  # fmt: skip
        yield AnswerFault(
            "transposed", "the inverse of the factor of Cholesky is multiplied in the other order: L⁻¹ L⁻ᵀ",
            "M = L Lᵀ has the inverse L⁻ᵀ L⁻¹", lambda s, c: _other_order(s.mass),
        )  # fmt: skip
        yield AnswerFault(
            "gravity", "gravity acts in every column: the accelerations at rest are in it", "take gravity away",
            lambda s, c: np.asarray(known.of_graphdyn(s, c) - np.linalg.solve(s.mass, _weights(s)[..., None]), float),
        )  # fmt: skip
    if known.name in ("da_dq", "da_dv"):
        yield AnswerFault(
            "argument", "M⁻¹ is that at q = 0", "take it at the same q",
            lambda s, c: np.asarray(np.linalg.solve(s.but(q=0 * s.q).mass, s.mass @ known.of_graphdyn(s, c)), float),
        )  # fmt: skip


def _other_order(mass: Array) -> Array:
    """L⁻¹ L⁻ᵀ of M = L Lᵀ."""
    factor: Array = np.linalg.inv(np.linalg.cholesky(mass))
    product: Array = factor @ factor.swapaxes(-1, -2)
    return product


def _weights(states: JudgedStates) -> Array:
    """Torques of gravity (N, n)."""
    return FUNCTIONS["gravity_torque"].of_graphdyn(states, {})


def _of_other_joints(known: Quantity) -> Iterator[AnswerFault]:
    """Columns of other joints, sums over the joints, or blocks of joints inside left out."""
    if known.shape[-1:] == ("n",) and len(known.shape) > 1:
        for shift, where in ((1, "before"), (-1, "after")):
            yield AnswerFault(
                "joint_order", f"each column is that of the joint {where} it", "fill in the columns by joint",
                lambda s, c, shift=shift: np.roll(known.of_graphdyn(s, c), shift, axis=-1),  # type: ignore[misc]
            )  # fmt: skip
    if known.shape[:1] == ("n",):
        yield AnswerFault(
            "transposed", "each entry is the sum of those of all joints before it, and its own", "take no sums",
            lambda s, c: np.cumsum(known.of_graphdyn(s, c), axis=1),
        )  # fmt: skip
    if len(known.shape) == 3 and known.shape[0] == known.shape[-1] == "n":
        yield AnswerFault(
            "triangle", "what joints change at joints inside of them is left out", "fill in all blocks",
            lambda s, c: known.of_graphdyn(s, c) * _moved_by(s.model)[:, None],
        )  # fmt: skip


def _of_halves(known: Quantity) -> Iterator[AnswerFault]:
    """Linear and angular part in the other order, or one of them with the other sign."""
    if JOINT_CONSTRAINTS in known.shape:
        axis = known.shape.index(JOINT_CONSTRAINTS) - len(known.shape)
        yield AnswerFault(
            "transposed", "λ_4, λ_5 come first, then λ_1, λ_2, λ_3", "forces come first",
            lambda s, c: np.roll(known.of_graphdyn(s, c), 2, axis=axis),
        )  # fmt: skip
    if BODY_DOF not in known.shape:
        return
    axis = known.shape.index(BODY_DOF) - len(known.shape)
    if "order" not in known.conventions:
        yield AnswerFault(
            "transposed", "the angular part comes first, then the linear part", "exchange the halves",
            lambda s, c: np.roll(known.of_graphdyn(s, c), 3, axis=axis),
        )  # fmt: skip
    for name, signs in (("linear", (-1.0, 1.0)), ("angular", (1.0, -1.0))):
        yield AnswerFault(
            "sign", f"the {name} part has the opposite sign", "negate it",
            _with_signs(known, *signs, axis),
        )  # fmt: skip


def _moved_by(model: RobotModel) -> Array:
    """Whether joint i is moved by joint k, itself or inside of it (n, n)."""
    found = np.eye(model.n_bodies)
    for k, joint in enumerate(model.joints):
        if joint.inside:
            found[k] = np.maximum(found[k], found[joint.inside - 1])
    return found


def _with_signs(known: Quantity, linear: float, angular: float, axis: int) -> Answering:
    return lambda states, chosen: known.of_graphdyn(states, chosen) * _halves(linear, angular, chosen, axis)


def _halves(linear: float, angular: float, chosen: Chosen, axis: int) -> Array:
    """Factors on the two halves of an axis of six, which is the axis-th from the end."""
    parts = (angular, linear) if chosen.get("order") == "angular first" else (linear, angular)
    return np.repeat(parts, 3).reshape(-1, *[1] * (-axis - 1))


def _other_arguments(known: Quantity) -> Iterator[AnswerFault]:
    moving = [name for name in known.arguments if name in "qva"]
    subsets = [x for size in range(len(moving), 0, -1) for x in combinations(moving, size)]
    for names in subsets:
        are = f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'}"
        for kind, what, remedy, change in (
            ("unit", "taken as degrees", "the arguments are in rad", np.deg2rad),
            ("unit", "converted to degrees", "the arguments are in rad", np.rad2deg),
            ("sign", "taken with the opposite sign", "compare the senses of the joints", np.negative),
            ("argument", "ignored", "use the arguments", np.zeros_like),
        ):
            yield AnswerFault(
                kind, f"{are} {what}", remedy,
                lambda s, c, names=names, change=change: known.of_graphdyn(  # type: ignore[misc]
                    s.but(**{name: change(getattr(s, name)) for name in names}), c
                ),
            )  # fmt: skip
    for x, y in combinations(moving, 2):
        yield AnswerFault(
            "argument", f"{x} and {y} are exchanged", f"the arguments are {', '.join(known.arguments)}",
            lambda s, c, x=x, y=y: known.of_graphdyn(s.but(**{x: getattr(s, y), y: getattr(s, x)}), c),  # type: ignore[misc]
        )  # fmt: skip


def _other_functions(known: Quantity) -> Iterator[AnswerFault]:
    for other in FUNCTIONS.values():
        alike = other.shape == known.shape and set(other.arguments) <= set(known.arguments)
        if other is not known and alike and not (other.of_frame or other.conventions):
            unused = [name for name in known.arguments if name not in other.arguments]
            without = f", which takes no {' and no '.join(unused)}" if unused else ""
            yield AnswerFault(
                "other_function", f"the answers are those of {other.name}{without}", f"{known.name} is asked for",
                lambda s, c, other=other: other.of_graphdyn(s, {}),  # type: ignore[misc]
            )  # fmt: skip


def _other_models(known: Quantity, model: RobotModel) -> Iterator[AnswerFault]:
    def of(message: str, kind: str, remedy: str, other: RobotModel) -> AnswerFault:
        ours = known.of_graphdyn
        return AnswerFault(kind, message, remedy, lambda s, c: ours(dataclasses.replace(s, model=other), c))

    if model.gravity.any():
        remedy = "use the gravity of the model"
        yield of("gravity is left out", "gravity", remedy, model.with_gravity(0 * model.gravity))
        yield of("gravity has the opposite sign", "gravity", remedy, model.with_gravity(-model.gravity))
    yield of("the placement of the base is left out", "frame", "begin with the base", model.with_base(Placement()))
    for k, joint in enumerate(model.joints):
        placement, name = joint.placement, joint.name
        reversed_axis = _but(model, k, axis=-joint.axis)
        back = _but(model, k, placement=Placement(placement.rotation.T, placement.translation))
        yield of(f"the axis of joint '{name}' points the other way", "sign", "reverse the axis", reversed_axis)
        yield of(f"the rotation of joint '{name}' is transposed", "frame", "transpose it", back)


def _but(model: RobotModel, k: int, **fields: Array | Placement) -> RobotModel:
    """The robot with other fields of one joint."""
    joints = list(model.joints)
    joints[k] = dataclasses.replace(joints[k], **fields)  # type: ignore[arg-type]
    return dataclasses.replace(model, joints=tuple(joints))


def _scaled(known: Quantity, answer: Array, ours: Array, chosen: Chosen) -> Iterator[AnswerFault]:
    """One factor on all answers; one each on the linear and angular parts."""
    remedy = "compare units and formula"
    factor = round_factor(_factor(answer, ours))
    message = f"all answers are multiplied by {factor:.6g}" if factor else "all answers are zero"
    yield AnswerFault("unit" if factor else "zero", message, remedy, lambda s, c: factor * known.of_graphdyn(s, c))
    if BODY_DOF in known.shape:
        axis = known.shape.index(BODY_DOF) - len(known.shape)
        halves = (_halves(1.0, 0.0, chosen, axis), _halves(0.0, 1.0, chosen, axis))
        linear, angular = (round_factor(_factor(answer * half, ours * half)) for half in halves)
        yield AnswerFault(
            "unit",
            "; ".join(
                factor_said(f"the {name} part", x) for name, x in (("linear", linear), ("angular", angular)) if x != 1
            ),
            remedy,
            _with_signs(known, linear, angular, axis),
        )


def _per_joint(known: Quantity, answer: Array, ours: Array, model: RobotModel) -> Iterator[AnswerFault]:
    """A factor on what belongs to each joint."""
    for axis, size in enumerate(known.shape, start=1):
        if size != "n":
            continue
        pairs = zip(np.moveaxis(answer, axis, 0), np.moveaxis(ours, axis, 0), strict=True)
        factors = np.array([round_factor(_factor(theirs, here)) for theirs, here in pairs])
        joints = zip(model.joint_names, factors, strict=True)
        wrong = {name: x for name, x in joints if abs(x - 1) > SIGN_FACTOR_TOLERANCE}
        what = {1: "entries", 2: "row" if axis == 1 else "column"}.get(len(known.shape), "part")
        said = ", ".join(f"'{name}' × {x:.6g}" for name, x in wrong.items())
        scale = factors.reshape(-1, *[1] * (len(known.shape) - axis))
        kind = "sign" if all(abs(x + 1) <= SIGN_FACTOR_TOLERANCE for x in wrong.values()) else "unit"
        yield AnswerFault(
            kind, f"the {what} of a joint multiplied: {said}", "compare the sense and the unit of the joint",
            lambda s, c, scale=scale: known.of_graphdyn(s, c) * scale,  # type: ignore[misc]
        )  # fmt: skip


def _factor(answer: Array, ours: Array) -> float:
    """Least squares."""
    size = float((ours**2).sum())
    return float((answer * ours).sum()) / size if size > 0 else 1.0


def layout_fault(
    known: Quantity, answer: Array, states: JudgedStates, declared: Chosen, bound: float
) -> FoundFault | None:
    """The first of the layouts that leaves no more than the bound, by any reading."""
    return _first(lambda _: layouts(known), known, answer, states, declared, bound)


def answer_fault(
    known: Quantity, answer: Array, states: JudgedStates, declared: Chosen, bound: float
) -> FoundFault | None:
    """The first fault without free numbers that leaves no more than the bound, by any reading in keeping with the
    declared conventions."""
    return _first(lambda _: faults(known, states), known, answer, states, declared, bound)


def factor_fault(
    known: Quantity, answer: Array, states: JudgedStates, declared: Chosen, bound: float
) -> FoundFault | None:
    """The first of factors on all numbers, on halves, or on what belongs to each joint, that leaves no more."""

    def factors(chosen: Chosen) -> Iterator[AnswerFault]:
        ours = known.of_graphdyn(states, chosen)
        return chain(_scaled(known, answer, ours, chosen), _per_joint(known, answer, ours, states.model))

    return _first(factors, known, answer, states, declared, bound)


def _first(
    tried: Callable[[Chosen], Iterable[AnswerFault]],
    known: Quantity,
    answer: Array,
    states: JudgedStates,
    declared: Chosen,
    bound: float,
) -> FoundFault | None:
    """The first fault that leaves no more than the bound, of those tried for each reading in turn."""
    few = np.arange(len(states.q)) < FIRST_TRIAL_STATES
    first = states.rows(few)  # once: it keeps what graphdyn answers there

    def left(fault: AnswerFault, chosen: Chosen, some: JudgedStates, given: Array) -> float:
        errors = relative_errors(known, given, fault.answers(some, chosen), some, chosen)
        return float(errors.max() if fault.undefined is None else errors[~fault.undefined(some)].max(initial=0.0))

    for chosen in known.readings(declared):
        for fault in tried(chosen):
            if left(fault, chosen, first, answer[few]) > bound:
                continue
            if (rest := left(fault, chosen, states, answer)) <= bound:
                return FoundFault(FaultDescription(fault.kind, fault.message, fault.remedy), rest, chosen)
    return None
