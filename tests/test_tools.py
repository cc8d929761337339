"""The programs in tests/tools: what they import exists, though no other test runs them."""

import ast
import importlib
from importlib.util import find_spec
from pathlib import Path

import pytest

PROGRAMS = sorted((Path(__file__).parent / "tools").glob("*/[!_]*.py"))


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_what_a_program_imports_exists(program):
    for node in ast.walk(ast.parse(program.read_text("utf-8"))):
        if not isinstance(node, ast.ImportFrom) or not node.module:
            continue
        if find_spec(node.module.partition(".")[0]) is None:
            continue  # a tool of its own, which its docstring names
        module = importlib.import_module(node.module)
        for name in node.names:
            assert hasattr(module, name.name) or find_spec(f"{node.module}.{name.name}"), (node.module, name.name)
