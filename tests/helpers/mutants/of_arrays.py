"""Faults of named arrays, as they stand in files of numbers. Each function changes the arrays in place."""

from __future__ import annotations

import random
import warnings
from contextlib import suppress
from typing import Any

import numpy as np
from mutants.material import NAMES
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]

ODD_VALUES = (np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0, -0.0, 2.0**53 + 2, -1.0, 1e-9, 1e12)
KINDS = ("f4", "f8", ">f8", "f2", "i1", "i4", "i8", "u8", "u1", "?", "c16", "U8", "S8", "M8[ns]", "m8[s]")


def _some(rng: random.Random, arrays: Arrays) -> str:
    return rng.choice(list(arrays))


def odd_value(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    if arrays[name].size and arrays[name].dtype.kind == "f":
        arrays[name] = arrays[name].copy()
        arrays[name].flat[rng.randrange(arrays[name].size)] = rng.choice(ODD_VALUES)


def other_kind(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", np.exceptions.ComplexWarning)
        with suppress(TypeError, ValueError, RuntimeError):
            arrays[name] = arrays[name].astype(rng.choice(KINDS))


def other_shape(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    x = np.atleast_1d(arrays[name])
    shapes = [x.T, x[None], x[..., None], x.ravel(), x[:0], x[:1], x[..., :1], x[1:], x[..., 1:], x.reshape(-1, 1)]
    arrays[name] = rng.choice(shapes)


def scalar(rng: random.Random, arrays: Arrays) -> None:
    arrays[_some(rng, arrays)] = np.array(rng.choice([1.0, 7, "a text", True, np.nan]))


def fewer_rows(rng: random.Random, arrays: Arrays) -> None:
    for name in arrays:
        if arrays[name].ndim and rng.random() < 0.5:
            arrays[name] = arrays[name][: rng.randint(0, 3)]


def exchange_rows(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    x = arrays[name]
    if x.ndim and len(x) > 1:
        order = list(range(len(x)))
        i, k = rng.randrange(len(x)), rng.randrange(len(x))
        order[i], order[k] = order[k], rng.choice([order[i], order[k]])
        arrays[name] = x[order]


def scaled(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    if arrays[name].dtype.kind == "f":
        with np.errstate(all="ignore"):
            arrays[name] = arrays[name] * rng.choice([1e3, 1e-3, 1e9, -1.0, 1e300, 57.29577951308232])


def shifted(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    if arrays[name].dtype.kind == "f":
        with np.errstate(all="ignore"):
            arrays[name] = arrays[name] + rng.choice([1.7e9, 1e-3, -1e3, 1e18])


def delete_array(rng: random.Random, arrays: Arrays) -> None:
    if len(arrays) > 1:
        del arrays[_some(rng, arrays)]


def duplicate_array(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    arrays[rng.choice([name + "2", name + "_1", name.upper(), "copy", *NAMES])] = arrays[name]


def rename_array(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    values = arrays.pop(name)
    arrays[rng.choice([name.upper(), name + "s", name + " [deg]", name + "_cmd", *NAMES])] = values


def exchange_arrays(rng: random.Random, arrays: Arrays) -> None:
    one, other = _some(rng, arrays), _some(rng, arrays)
    arrays[one], arrays[other] = arrays[other], arrays[one]


def larger(rng: random.Random, arrays: Arrays) -> None:
    name = _some(rng, arrays)
    if arrays[name].ndim:
        arrays[name] = np.repeat(arrays[name], rng.choice([2, 1000]), axis=0)


ON_ARRAYS = {
    function.__name__.replace("_", " "): function
    for function in (
        odd_value, other_kind, other_shape, scalar, fewer_rows, exchange_rows, scaled, shifted, delete_array,
        duplicate_array, rename_array, exchange_arrays, larger,
    )
}  # fmt: skip
