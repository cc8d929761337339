"""Files of Python code that a user names: FILE.py:NAME.

What is typed on the command line runs. A file that names code is data: its code runs only where the user allows it.
"""

import ast
import importlib.util
import sys
from collections.abc import Iterator, Sequence
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


OUR_PACKAGES = ("graphdyn", "urdf", "crosscheck")


def imported_files(path: Path) -> tuple[Path, ...]:
    """A file and all files of its folder that it imports, directly or through others, without running any."""
    folder = path.parent
    found = dict.fromkeys([path])
    waiting = [path]
    while waiting:
        file = waiting.pop()
        for name in _imports(file, folder):
            place = folder
            for part in [] if name.split(".")[0] in OUR_PACKAGES else name.split("."):
                place /= part
                for module in (place.with_name(f"{place.name}.py"), place / "__init__.py"):
                    if module not in found and module.is_file():
                        found[module] = None
                        waiting.append(module)
    return tuple(found)


def _imports(file: Path, folder: Path) -> Iterator[str]:
    """Names of modules, seen from the folder. A file that is no Python is refused when it is imported."""
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    package = file.parent.relative_to(folder).parts
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = [*above, *([node.module] if node.module else [])]
            yield from (".".join([*base, one.name]) for one in node.names)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if called in ("import_module", "__import__") and isinstance(node.args[0].value, str):
                yield node.args[0].value.lstrip(".")


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
