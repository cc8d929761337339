"""The methods by which a verb can be computed, and the keywords that all verbs share.

Which frame a verb speaks of, and in which axes: the arguments of the frame verbs that are not arrays.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypedDict, TypeVar, get_args

import numpy as np
from numpy.typing import DTypeLike

from graphdyn.arguments.arrays import FLOAT
from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.errors import InvalidInput
from graphdyn.model.robot_model import RobotModel, check_model

Method = Literal["auto", "recursive", "projected", "dense", "reproducible"]
METHODS: tuple[Method, ...] = ("auto", "recursive", "projected", "dense", "reproducible")

MANY_SAMPLES = 1000
"""Samples from which "reproducible" is "recursive"."""

_auto: ContextVar[Method] = ContextVar("_auto", default="auto")

Answer = TypeVar("Answer")


class VerbKeywords(TypedDict, Generic[Answer], total=False):
    """The keywords of every verb, which answers an Answer; KEYWORDS says what they mean."""

    base: BaseMotion | None
    method: Method
    threads: int | None
    check: bool
    out: Answer | None
    dtype: DTypeLike


DEFAULTS = {"base": None, "method": "auto", "threads": None, "check": True, "out": None, "dtype": np.float64}

KEYWORDS = {
    "base": "prescribed motion of the base; its leading dimensions broadcast with those of the arrays",
    "method": """"dense" solves Eq. (111) as it stands, the specification; "projected" eliminates the multipliers with
    the null space of φ_q (NᵀAN a = …) and reads them off the path matrix, where there are any; "recursive" eliminates
    body after body, in code compiled for this robot. Same answer up to rounding, each faster than the one before.
    "auto" is "projected" until the calls for this robot, in this process, have taken about as long as compiling; it is
    "recursive" from then on, where the code is compiled already, and with out. The last digits of an answer may depend
    on the calls before it. "reproducible" is "recursive" for 1000 samples and more and "projected" for fewer: the same
    digits in every process""",
    "threads": """at most this many for the recursive method, None for one per core. The answer of a sample does not
    depend on it, nor on the other samples, bit for bit (except where a pivot is so small that the projected method
    decides)""",
    "check": """refuse NaN and infinity, naming argument and row; with False the recursive method does not look for
    them, and what depends on them comes out as NaN, in their samples only""",
    "out": """memory for the answer, recursive method only: C-contiguous arrays of the shapes and the dtype of the
    answer""",
    "dtype": """numpy.float32 rounds the arguments to single precision, computes in it by the recursive method, twice as
    many samples at a time, and answers float32 arrays, good to about 1e-6 of the largest terms. Left out it is
    numpy.float64, whatever the type of the arguments""",
}
"""What they mean, wherever a verb has them."""

Function = TypeVar("Function", bound=Callable[..., Any])


def with_keywords(verb: Function) -> Function:
    """Completes signature and docstring of a verb by the keywords that it has, and what they mean."""
    signature = inspect.signature(verb)
    own = {each.name: each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD}
    if len(own) < len(signature.parameters):  # **keywords: Unpack[VerbKeywords[…]]
        for name, kind in VerbKeywords.__annotations__.items():
            annotation = f"{signature.return_annotation} | None" if name == "out" else kind.__forward_arg__
            own[name] = inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=DEFAULTS[name], annotation=annotation
            )
        verb.__signature__ = signature.replace(parameters=list(own.values()))  # type: ignore[attr-defined]
    if verb.__doc__:  # python -OO strips docstrings
        meanings = [f"{name}: {meaning}" for name, meaning in KEYWORDS.items() if name in own]
        verb.__doc__ = "\n".join([inspect.cleandoc(verb.__doc__), "", *meanings])
    return verb


@contextmanager
def reproducible() -> Iterator[None]:
    """Inside, in this thread, method="auto" is "reproducible"."""
    token = _auto.set("reproducible")
    try:
        yield
    finally:
        _auto.reset(token)


def is_recursive(
    method: str, samples: int, has_paid: Callable[[], bool], out: object = None, dtype: np.dtype[Any] = FLOAT
) -> bool:
    """Whether this method, for so many samples, is the recursive one.

    has_paid: whether compiling takes no longer than the calls so far; asked where that decides

    Raises InvalidInput for an unknown method, and for out and dtype with a method that has no such answers.
    """
    if method not in METHODS:
        raise InvalidInput(f"method is '{method}'; use one of {', '.join(METHODS)}")
    if out is not None and method in ("projected", "dense"):
        raise InvalidInput(f"the {method} method makes arrays of its own; omit out=, or use method='recursive'")
    if dtype != FLOAT and method in ("projected", "dense"):
        raise InvalidInput(f"the {method} method computes in float64; omit dtype=, or use method='recursive'")
    if method == "recursive" or out is not None or dtype != FLOAT:
        return True
    method = _auto.get() if method == "auto" else method
    return samples >= MANY_SAMPLES if method == "reproducible" else method == "auto" and has_paid()


Reference = Literal["world", "local", "local_world_aligned"]


@dataclass(frozen=True)
class FrameChoice:
    """name: of a frame of the robot; reference, classical: as in the frame verbs."""

    name: str
    reference: Reference
    classical: bool = True


def frame_choice(model: RobotModel, name: str, reference: str, classical: bool = True) -> FrameChoice:
    """The frame that a verb speaks of, and its axes.

    Raises UnknownFrame for an unknown name, InvalidInput for an unknown reference.
    """
    check_model(model)
    for known in get_args(Reference):
        if reference == known:
            return FrameChoice(model.frame(name).name, known, bool(classical))
    raise InvalidInput(f"reference is {reference!r}; use one of {', '.join(get_args(Reference))}")
