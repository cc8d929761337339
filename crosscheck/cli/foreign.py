"""Functions named on the command line: FILE.py:NAME or MODULE:NAME."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import typer


def foreign_function(option: str, text: str) -> Callable[..., object]:
    """The function that an option names. Raises typer.BadParameter, saying what is wrong."""
    where, _, name = text.rpartition(":")
    if not where or not name:
        raise typer.BadParameter(f"{option} {text}: give FILE.py:FUNCTION or MODULE:FUNCTION")
    try:
        module = _file(Path(where)) if where.endswith(".py") else _module(where)
    except FileNotFoundError:
        raise typer.BadParameter(f"{option} {text}: there is no file {where}") from None
    except Exception as error:  # whatever foreign code raises when it is imported
        raise typer.BadParameter(
            f"{option} {text}: importing {where} raised {type(error).__name__}: {error}"
        ) from error
    function = getattr(module, name, None)
    if not callable(function):
        reason = "is not a function" if hasattr(module, name) else "does not exist"
        raise typer.BadParameter(f"{option} {text}: {name} {reason} in {where}")
    found: Callable[..., object] = function
    return found


def _file(path: Path) -> ModuleType:
    """A file as a module, which can import other files of its folder."""
    if not path.is_file():
        raise FileNotFoundError(path)
    sys.path.insert(0, str(path.resolve().parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def _module(name: str) -> ModuleType:
    """An installed module, or one below the working folder."""
    sys.path.insert(0, "")
    return importlib.import_module(name)
