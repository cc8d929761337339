"""Names of methods in a configuration: those of METHODS, and FILE.py:NAME for one of one's own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from crosscheck.identifying import ESTIMATORS
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.settings.settings import texts
from graphdyn.identification import Estimator


def methods_reader(folder: Path, everything: tuple[str, ...]) -> Callable[[object], tuple[str, ...]]:
    """A reader of lists of methods. folder: in which files of one's own are; everything: what "all" stands for"""

    def read(value: object) -> tuple[str, ...]:
        names = everything if value == "all" else texts('methods, or "all"')(value)
        found = dict.fromkeys(
            one for name in names for one in (everything if name == "all" else (_method(folder, name),))
        )
        if not found:
            raise ValueError('give methods, or "all"')
        for name, times in Counter(map(shown_name, found)).items():
            if times > 1:
                raise ValueError(f"several are called {name} in tables, which name no folders; rename a file")
        return tuple(found)

    return read


def _method(folder: Path, name: str) -> str:
    where, _, function = name.rpartition(":")
    if where.endswith(".py") and function:
        path = (folder / where).resolve()
        if path.is_file():
            return f"{path}:{function}"
        raise ValueError(f"there is no file {path}")
    if name in ESTIMATORS:
        return name
    raise ValueError(f"there is no method '{name}'; use {', '.join(ESTIMATORS)}, all, or FILE.py:NAME")


def measurable_methods(points: Sequence[Scenario]) -> tuple[str, ...]:
    """All methods; those that take wrenches for measured only where a scenario measures them."""
    wrenches = any(scenario.force_noise is not None for scenario in points)
    return tuple(name for name, made in ESTIMATORS.items() if wrenches or not takes_wrenches(made()))


def takes_wrenches(estimator: Estimator) -> bool:
    """It asks for a recording, which has joint wrenches, beside the problem."""
    return hasattr(estimator, "recording")


def shown_name(method: str) -> str:
    """The name in tables: that of METHODS; of an own one FILE:NAME without its folder."""
    where, colon, name = method.rpartition(":")
    return f"{Path(where).stem}:{name}" if colon else method
