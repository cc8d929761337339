"""The names of `import crosscheck`: each from where __init__.pyi says, nothing loaded before it is used."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import crosscheck

STUB = Path(crosscheck.__file__).with_suffix(".pyi")
IMPORTS = [node for node in ast.parse(STUB.read_text(encoding="utf-8")).body if isinstance(node, ast.ImportFrom)]
HOMES = {name.name: f"crosscheck.{node.module}" for node in IMPORTS if node.module for name in node.names}


@pytest.mark.parametrize("name", sorted(HOMES))
def test_every_name_is_what_its_module_has(name):
    assert getattr(crosscheck, name) is getattr(importlib.import_module(HOMES[name]), name)


def test_all_lists_every_name_once():
    assert sorted(crosscheck.__all__) == sorted({*HOMES, "identifying"})
    assert set(crosscheck.__all__) <= set(dir(crosscheck))


def test_the_import_contract_sees_the_same_edges():
    """It reads __init__.py, whose imports for type checkers have to name every room of the stub."""
    source = ast.parse(Path(crosscheck.__file__).read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(source) if isinstance(node, ast.ImportFrom) and node.module == "crosscheck"]
    assert {name.name for node in imports for name in node.names} == {home.split(".")[1] for home in HOMES.values()}


def test_unknown_name():
    with pytest.raises(AttributeError, match="crosscheck"):
        crosscheck.compar  # noqa: B018


def test_import_alone_loads_neither_pinocchio_nor_numpy():
    code = "import sys, crosscheck; sys.exit(any(name in sys.modules for name in ('pinocchio', 'numpy')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_other_door():
    """`python -m crosscheck` is the program."""
    done = subprocess.run([sys.executable, "-m", "crosscheck", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("graphdyn ")
