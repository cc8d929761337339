"""Programs that answer what no test asks every time: python tests/tools [NAME [ARGUMENTS]].

Without a name, the programs of each folder with what they answer.
"""

import ast
import importlib
import sys
from itertools import groupby
from pathlib import Path

HERE = Path(__file__).parent


def programs() -> dict[str, Path]:
    """Their files by name, folder by folder."""
    return {path.stem: path for path in sorted(HERE.glob("*/[!_]*.py"))}


def answer(program: Path) -> str:
    """The first line of its docstring."""
    documented = ast.get_docstring(ast.parse(program.read_text("utf-8")))
    assert documented, program
    return documented.splitlines()[0]


def main() -> int:
    known, (name, *arguments) = programs(), sys.argv[1:] or [""]
    if name not in known:
        for folder, files in groupby(known.values(), lambda path: path.parent.name):
            print(folder, *(f"  {program.stem:22} {answer(program)}" for program in files), sep="\n")
        return 0 if not name else 2
    places = (known[name].parent, HERE.parent / "helpers", HERE.parents[1] / "docs" / "recordings")
    sys.path[:0] = map(str, places)
    sys.argv = [f"python tests/tools {name}", *arguments]
    return importlib.import_module(name).main() or 0


if __name__ == "__main__":
    sys.exit(main())
