"""Keywords that a function hands on: those that nobody takes are refused by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from inspect import Parameter, signature


def refuse_unknown(function: Callable[..., object], given: Iterable[str], further: Iterable[str]) -> None:
    """Raise TypeError, naming the closest option, for a keyword that is none of the function's.

    further: names that it takes besides the parameters of its signature
    """
    parameters = signature(function).parameters.values()
    known = [each.name for each in parameters if each.kind is not Parameter.VAR_KEYWORD] + [*further]
    for name in given:
        if name not in known:
            near = closest(name, known)
            hint = f"did you mean {near!r}?" if near else f"known are {', '.join(known)}"
            raise TypeError(f"{function.__name__}() has no option {name!r}; {hint}")


def closest(name: str, known: Iterable[str]) -> str | None:
    """The known name that is most like this one, if any resembles it."""
    from difflib import get_close_matches  # imported where first used: import graphdyn stays light

    return next(iter(get_close_matches(name, list(known), n=1)), None)
