"""Programs that answer what no test asks every time: python tests/tools [NAME [ARGUMENTS]].

Without a name, the programs with what each answers.
"""

import ast
import importlib
import sys
from pathlib import Path

HERE = Path(__file__).parent


def answers() -> dict[str, str]:
    """The first line of the docstring of each program, by its name."""
    documented = {path.stem: ast.get_docstring(ast.parse(path.read_text("utf-8"))) for path in HERE.glob("[!_]*.py")}
    return {name: documented[name].splitlines()[0] for name in sorted(documented)}


def main() -> int:
    known, (name, *arguments) = answers(), sys.argv[1:] or [""]
    if name not in known:
        print(*(f"{program:22} {line}" for program, line in known.items()), sep="\n")
        return 0 if not name else 2
    sys.path[:0] = [str(HERE.parent / "helpers"), str(HERE.parents[1] / "docs" / "recordings")]
    sys.argv = [f"python tests/tools {name}", *arguments]
    return importlib.import_module(name).main() or 0


if __name__ == "__main__":
    sys.exit(main())
