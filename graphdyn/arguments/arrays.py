"""The door for array arguments: convert once, broadcast, refuse the rest by name, shape and row."""

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.errors import InvalidInput
from graphdyn.layout import BODY_DOF, Array
from graphdyn.model.robot_model import RobotModel, check_model

FLOAT = np.dtype(float)


class Batched(Protocol):
    """Something else with leading dimensions (BaseMotion)."""

    @property
    def batch(self) -> tuple[int, ...]: ...


def joint_arrays(
    model: RobotModel,
    base: Batched | None = None,
    *,
    check: bool = True,
    dtype: np.dtype[Any] = FLOAT,
    **arguments: ArrayLike | None,
) -> dict[str, Array]:
    """The arguments as arrays of this type of floats with one common leading shape.

    Each must have shape (…, n); external_wrenches (…, n, 6), where None stands for zeros. A base motion broadcasts too.
    check: whether to look for NaN and infinity

    Raises InvalidInput, naming the argument, its shape and the first offending row, where an argument is not numeric,
    has the wrong trailing shape, does not broadcast with the others, or contains NaN or infinity.
    """
    check_model(model)
    n = model.nv
    if base is None and not check and _are_plain(arguments.values(), n, dtype):
        return arguments  # type: ignore[return-value]
    arrays, leading = {}, {}
    for name, value in arguments.items():
        trailing = (model.n_bodies, BODY_DOF) if name == "external_wrenches" else (n,)
        absent = name == "external_wrenches" and value is None
        array = np.zeros(trailing, dtype) if absent else as_floats(name, value, dtype)
        if array.shape[-len(trailing) :] != trailing:
            expected = ", ".join(["…", *map(str, trailing)])
            joints = f"the {n} joints" + (" that no others drive" if model.couplings else "")
            raise InvalidInput(
                f"{name} has shape {array.shape}, expected ({expected}) for {joints} of robot '{model.name}'"
            )
        arrays[name] = array
        leading[name] = array.shape[: array.ndim - len(trailing)]
    if check:
        refuse_non_finite(model, arrays)
    try:
        common = np.broadcast_shapes(*leading.values(), *([] if base is None else [base.batch]))
    except ValueError as error:
        shapes = ", ".join(f"{name} {arrays[name].shape}" for name in arrays)
        shapes += "" if base is None else f", base {(*base.batch, '…')}"
        raise InvalidInput(f"leading dimensions do not broadcast: {shapes}") from error
    return {
        name: array if leading[name] == common else np.broadcast_to(array, common + array.shape[len(leading[name]) :])
        for name, array in arrays.items()
    }


def with_wrenches(model: RobotModel, x: Mapping[str, Array]) -> dict[str, Array]:
    """The arguments of joint_arrays, with external wrenches (…, n, 6), which are zero where none were given."""
    return {"external_wrenches": np.zeros((*x["q"].shape[:-1], model.n_bodies, BODY_DOF)), **x}


def _are_plain(arguments: Iterable[ArrayLike | None], n: int, dtype: np.dtype[Any]) -> bool:
    """Whether these are such arrays (…, n) of one shape, as they mostly are: nothing to convert, nothing to refuse."""
    shape = None
    for array in arguments:
        if type(array) is not np.ndarray or array.dtype is not dtype:
            return False
        if shape is None:
            shape = array.shape
        elif array.shape != shape:
            return False
    return shape is not None and shape[-1:] == (n,)


def one_state(model: RobotModel, base: Batched | None = None, **arguments: ArrayLike | None) -> dict[str, Array]:
    """Check like joint_arrays, for verbs that take ONE state.

    Raises InvalidInput where there are leading dimensions."""
    arrays = joint_arrays(model, base, check=True, dtype=FLOAT, **arguments)
    batch = next(iter(arrays.values())).shape[:-1]
    if batch:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise InvalidInput(f"one state expected, got leading dimensions {batch} ({shapes}); pass one row at a time")
    return arrays


def as_floats(name: str, value: ArrayLike | None, dtype: np.dtype[Any] = FLOAT) -> Array:
    """Floats of integers, booleans or reals. Raises InvalidInput, naming the argument, for anything else."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise InvalidInput(f"{name} is not an array of real numbers: {error}") from error
    if array.dtype.kind not in "buif":
        raise InvalidInput(f"{name} is not an array of real numbers but of {array.dtype}")
    if np.ma.is_masked(value):
        raise InvalidInput(f"{name} has masked entries; fill or drop them")
    with np.errstate(over="ignore"):  # infinity is refused where it must not be
        return np.asarray(array, dtype=dtype)


def refuse_non_finite(model: RobotModel, arrays: Mapping[str, Array]) -> None:
    """Raises InvalidInput, naming the argument and the first row, where one contains NaN or infinity."""
    for name, array in arrays.items():
        n_trailing = 2 if name == "external_wrenches" else 1
        while array.ndim > n_trailing and len(array) and array.strides[0] == 0:  # what broadcasting added
            array = array[0]
        _refuse_non_finite(name, array, n_trailing, model)


def _refuse_non_finite(name: str, array: Array, n_trailing: int, model: RobotModel) -> None:
    bad = np.argwhere(~np.isfinite(array))
    if bad.size == 0:
        return
    index = tuple(int(k) for k in bad[0])
    row, joint = index[: array.ndim - n_trailing], index[array.ndim - n_trailing]
    where = f"row {row[0] if len(row) == 1 else row}, " if row else ""
    names = model.joint_names if n_trailing == 2 else model.independent_joints
    rows = len({tuple(k[: array.ndim - n_trailing]) for k in bad.tolist()})
    raise InvalidInput(
        f"{name} contains {array[index]} at {where}joint '{names[joint]}' "
        f"({rows} of {int(np.prod(array.shape[: array.ndim - n_trailing]))} rows are not finite); remove or repair them"
    )
