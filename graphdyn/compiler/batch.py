"""Batches through a program: from the arguments of a verb to its arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isnan, prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import refuse_non_finite
from graphdyn.arguments.base_motion import BaseMotion, ground
from graphdyn.arguments.choices import FrameChoice
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.llvm.precision import DOUBLE, precision_of
from graphdyn.compiler.programs import GROUND_SHAPES, Request, request_for
from graphdyn.compiler.running import prepared, run
from graphdyn.errors import InvalidInput
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import ARRAY_SPECS

NO_ROWS = np.empty(0, dtype=np.intp)


class Evaluation(NamedTuple):
    """arrays: the outputs by name (…, *trailing); suspects: numbers of samples whose mass matrix may be singular."""

    arrays: dict[str, Array]
    suspects: NDArray[np.intp]


def request_of(
    recursion: str,
    outputs: tuple[str, ...],
    x: Mapping[str, Array],
    base: BaseMotion | None,
    frame: FrameChoice | None = None,
    dtype: np.dtype[Any] = DOUBLE.dtype,
) -> Request:
    """These outputs of a recursion, of such arguments."""
    return request_for(recursion, outputs, "external_wrenches" in x, base is not None, frame, dtype)


def evaluate(
    model: RobotModel,
    request: Request,
    x: Mapping[str, Array],
    base: BaseMotion | None,
    out: Mapping[str, Array] | None = None,
    *,
    threads: int | None = None,
    check: bool = True,
) -> Evaluation:
    """What is requested, for arrays of one leading shape (request_of the same arrays), written into out if given.

    x: arrays of the dtype of the request
    threads: at most this many; None for one per core
    check: refuse NaN and infinity in the arguments; otherwise their samples come out as NaN

    Raises InvalidInput for NaN and infinity; for outputs of the wrong shape, type or layout, read-only ones, and ones
    that overlap with an argument or each other. After an error the contents of out are undefined.
    """
    check_threads(threads)
    batch = x["q"].shape[:-1]
    count = prod(batch)
    inputs = {name: _as_rows(_plain(array), batch) for name, array in x.items()}
    if base is not None:
        inputs["ground"] = _as_rows(ground_columns(model, base, batch).astype(request.dtype), batch)
    shapes = {name: (*batch, *ARRAY_SPECS[name].shape_for(model)) for name in request.outputs}
    if out is None:
        arrays = {name: aligned(shape, request.dtype) for name, shape in shapes.items()}
    else:
        arrays = _writable(out, shapes, request.dtype, x)
    if count == 0:
        return Evaluation(arrays, NO_ROWS)
    rows = {name: _as_rows(array, batch) for name, array in arrays.items()}
    guarded = run(model, request, inputs, rows, threads)
    if check and isnan(guarded["finite"]):
        refuse_non_finite(model, x)
    suspicious = guarded.get("minimum", np.inf) < precision_of(request.dtype).min_pivot_share
    return Evaluation(arrays, _suspects(model, request, inputs, threads) if suspicious else NO_ROWS)


def check_threads(threads: int | None) -> None:
    """Raises InvalidInput for anything but a number from 1, or None."""
    if threads is not None and (not isinstance(threads, int | np.integer) or threads < 1):
        raise InvalidInput(f"threads is {threads!r}; give a number from 1, or None for all cores")


def _plain(array: Array) -> Array:
    """The array itself, or a copy where compiled code could not read it."""
    flags = array.flags
    return array if flags.c_contiguous and flags.aligned else array.copy()


def _as_rows(array: Array, batch: tuple[int, ...]) -> Array:
    """(…, *trailing) seen as (N, width)."""
    if array.ndim == 2 and len(batch) == 1:
        return array
    return array.reshape(prod(batch), prod(array.shape[len(batch) :]))


def _suspects(
    model: RobotModel, request: Request, inputs: Mapping[str, Array], threads: int | None
) -> NDArray[np.intp]:
    of_pivots = replace(request, outputs=("pivots",))
    ready = prepared(model, of_pivots)
    pivots = np.empty((len(inputs["q"]), len(ready.program.outputs["pivots"])), request.dtype)
    run(model, of_pivots, inputs, {"pivots": pivots}, threads)
    return np.flatnonzero((pivots < ready.precision.min_pivot_share).any(axis=-1))


def ground_columns(model: RobotModel, base: BaseMotion, batch: tuple[int, ...]) -> Array:
    """The columns of programs.GROUND_SHAPES, in their order."""
    moving = ground(model, base, batch)

    def own_axes(vector: Array) -> Array:
        turned: Array = np.einsum("...ba,...b->...a", moving.rotation, vector)
        return turned

    columns = {
        "rotation": moving.rotation.reshape(*batch, 9),
        "position": moving.position,
        "velocity": own_axes(moving.velocity[..., LINEAR]),
        "omega": own_axes(moving.velocity[..., ANGULAR]),
        "alpha": own_axes(moving.acceleration[..., ANGULAR]),
        "compensated": own_axes(moving.acceleration[..., LINEAR] - model.gravity),
    }
    return np.concatenate([columns[name] for name in GROUND_SHAPES], axis=-1)


def _writable(
    out: Mapping[str, Array], shapes: Mapping[str, tuple[int, ...]], dtype: np.dtype[Any], x: Mapping[str, Array]
) -> dict[str, Array]:
    """The arrays of the caller, if the answer can be written to them."""
    taken, arrays = list(x.items()), {}
    for name, shape in shapes.items():
        array = out[name]
        if shape[-1:] == (0,) and isinstance(array, np.ndarray) and array.size == 0:  # of a robot without couplings
            array = array.reshape(shape)
        arrays[name] = array
        if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
            found = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else type(array).__name__
            raise InvalidInput(f"out for {name} is {found}; give a {dtype} array of shape {shape}")
        if not array.flags.carray:
            flags = array.flags
            fault = "not C-contiguous" if not flags.c_contiguous else "not aligned" if flags.writeable else "read-only"
            raise InvalidInput(f"out for {name} is {fault}; give a writable, aligned, C-contiguous array")
        for other, memory in taken:
            if np.shares_memory(array, memory):
                raise InvalidInput(f"out for {name} overlaps with {other}; give memory of its own")
        taken.append((f"out for {name}", array))
    return arrays
