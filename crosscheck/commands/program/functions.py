"""Functions named on the command line: FILE.py:NAME or MODULE:NAME. They run in a process of their own."""

from __future__ import annotations

import importlib
import inspect
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import typer

from crosscheck.commands.program import own_process
from crosscheck.user_code import module_of_file

_files: set[str] = set()
"""Files of the user code that this process has imported, as tracebacks name them."""


def user_function(option: str, text: str) -> Callable[..., object]:
    """The function that an option names.

    The first time, the whole command is run again in a process of its own, and the program ends with its exit code:
    whatever user code does to its process, there is a verdict or an error. So ask before the work begins.

    Raises typer.BadParameter, saying what is wrong; UserCodeEnded; typer.Exit.
    """
    where, _, name = text.rpartition(":")
    if not where or not name:
        raise typer.BadParameter(f"{option} {text}: give FILE.py:FUNCTION or MODULE:FUNCTION")
    own_process.enter(f"{option} {text}")
    try:
        module = _file(Path(where)) if where.endswith(".py") else _module(where)
    except FileNotFoundError:
        raise typer.BadParameter(f"{option} {text}: there is no file {where}") from None
    except (Exception, SystemExit) as error:  # whatever user code raises when it is imported
        place = place_in_user_code(error)
        raise typer.BadParameter(
            f"{option} {text}: importing {where} raised {type(error).__name__}: {error}{f' ({place})' if place else ''}"
        ) from error
    function = getattr(module, name, None)
    if not callable(function):
        reason = "is not a function" if hasattr(module, name) else "does not exist"
        raise typer.BadParameter(f"{option} {text}: {name} {reason} in {where}")
    with suppress(TypeError, OSError):  # what is written in C has no file
        _files.add(inspect.getfile(inspect.unwrap(function)))
    found: Callable[..., object] = function
    return found


def place_of(function: Callable[..., object]) -> tuple[str, int] | None:
    """File and line where a function is defined; None where there is no Python code of it."""
    with suppress(TypeError, OSError):
        plain = inspect.unwrap(function)
        file = inspect.getsourcefile(plain)
        return None if file is None else (file, inspect.getsourcelines(plain)[1] or 1)
    return None


def place_in_user_code(error: BaseException) -> str:
    """The place in user code where an error was raised, or what it called: "my_code.py, line 12, in rnea"; "" if
    elsewhere."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in _files]
    return f"{frames[-1].filename}, line {frames[-1].lineno}, in {frames[-1].name}" if frames else ""


def _file(path: Path) -> ModuleType:
    if not path.is_file():
        raise FileNotFoundError(path)
    _files.add(str(path.absolute()))
    return module_of_file(path)


def _module(name: str) -> ModuleType:
    """An installed module, or one below the working folder."""
    sys.path.insert(0, "")
    module = importlib.import_module(name)
    if module.__file__ is not None:
        _files.add(module.__file__)
    return module
