"""Files of Python code that a user names: FILE.py:NAME.

What is typed on the command line runs. A file that names code is data: its code runs only where the user allows it.
"""

import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from graphdyn import InvalidInput


def module_of_file(path: Path) -> ModuleType:
    """A file as a module, which can import other files of its folder. Raises whatever the file raises."""
    sys.path.insert(0, str(path.resolve().parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def refuse_code(where: str, names: Sequence[str], allowed: bool) -> None:
    """Raise InvalidInput for code that a file names and that is not to run: a module always, FILE.py:NAME if not
    allowed.

    where: the file, for the message
    """
    for name in names:
        if not name.rpartition(":")[0].endswith(".py"):
            raise InvalidInput(f"{where}: {name} is a module, which no file may run; name code beside it, FILE.py:NAME")
    if not allowed:
        raise InvalidInput(
            f"{where}: names Python code, {', '.join(names)}, which can do whatever you can; read it, and if you trust "
            "it, add --allow-code"
        )
