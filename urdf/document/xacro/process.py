"""The process that expands one .xacro file: a self-contained script, run with an empty environment.

Standard input: a JSON object with path, content (a character per byte), arguments, packages, cpu_seconds, megabytes.
Standard output: a JSON object with text and the places of its elements (files, and per element the number of its file
and its line), or with problem and remedy.

xacro evaluates ${…} with Python's eval and most names removed, which alone is no protection (a generator's frame gives
access to all of Python). Hence three barriers: expressions that could reach a frame are refused; an audit hook refuses
every file outside the given folders, all writing, and everything but computation; the kernel limits time and memory.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import io
import json
import os
import re
import resource
import signal
import sys
import types
from collections.abc import Callable, Iterator, Mapping
from typing import Any

HARMLESS_EVENTS = {"compile", "exec", "glob.glob", "glob.glob/2", "builtins.id", "import"}
"""Audit events that are allowed; the files that an import opens are audited separately."""

FORBIDDEN_NODES = (ast.Lambda, ast.GeneratorExp, ast.Await, ast.NamedExpr)
FORBIDDEN_ATTRIBUTES = ("format", "format_map")
FORBIDDEN_FUNCTIONS = ("type", "vars")
"""Functions that lead from a value to its class or its frame."""


MAX_MESSAGE_CHARACTERS = 300
"""Largest number of characters of a message, which may quote the file."""


class Refused(Exception):
    """The document asks for something that no description of a robot needs."""

    def __init__(self, problem: str, remedy: str):
        super().__init__(problem)
        self.remedy = remedy


def main() -> None:
    task = json.load(sys.stdin)
    out, sys.stdout = sys.stdout, sys.stderr
    try:
        answer: dict[str, Any] = expanded(task)
    except Exception as error:
        answer = explained(error, task["megabytes"])
    json.dump(answer, out)


def explained(error: Exception, megabytes: int) -> dict[str, str]:
    """Problem and remedy. xacro wraps the errors of its functions, so that the cause is further down the chain."""
    causes = list(chain_of(error))
    if any(isinstance(cause, MemoryError) for cause in causes):
        remedy = "expand the file yourself, if you trust it, and give the URDF"
        return {"problem": f"expanding takes more than {megabytes} MB", "remedy": remedy}
    if any(isinstance(cause, RecursionError) for cause in causes):
        return {"problem": "endless recursion of macros or includes", "remedy": "correct the file"}
    for cause in causes:
        if isinstance(cause, Refused):
            return {"problem": str(cause), "remedy": cause.remedy}
    text = re.sub(r"<class '[\w.]+'>: ", "", str(error))  # as xacro names the kind of an error that it passes on
    said = " ".join(text.split())[:MAX_MESSAGE_CHARACTERS] or type(error).__name__
    return {"problem": f"xacro cannot expand it: {said}", "remedy": "correct the file, or give what it needs"}


def chain_of(error: BaseException | None) -> Iterator[BaseException]:
    """The error and its causes."""
    while error is not None:
        yield error
        error = getattr(error, "exc", None) or error.__cause__ or error.__context__


def expanded(task: Mapping[str, Any]) -> dict[str, Any]:
    """The expansion with the places of its elements. Raises Refused, and what xacro raises."""
    xacro = importlib.import_module("xacro")
    for name in ("yaml", "xml.dom.expatbuilder", "encodings.latin_1", "encodings.idna"):
        importlib.import_module(name)
    limits = beside("yaml_limits")
    places = beside("places").Places(xacro, sys.modules["xml.dom.expatbuilder"].ExpatBuilderNS)
    offer_packages(task["packages"])
    guard_expressions(xacro)
    limit(task["cpu_seconds"], task["megabytes"])
    sys.addaudithook(fence([os.path.dirname(task["path"]), *task["packages"].values()]))
    xacro.init_stacks(task["path"])
    offer_folder(xacro)
    guard_yaml(limits)
    document = xacro.parse(io.BytesIO(task["content"].encode("latin-1")))
    xacro.process_doc(document, mappings=task["arguments"])
    return {"text": str(document.toxml()), **numbered(places.of(document))}


def numbered(places: list[tuple[str, int] | None]) -> dict[str, Any]:
    """The files once, and per element the number of its file and its line; null where it has no place."""
    files = {place[0]: None for place in places if place}
    numbers = {file: number for number, file in enumerate(files)}
    return {"files": list(files), "places": [place and (numbers[place[0]], place[1]) for place in places]}


def limit(cpu_seconds: float, megabytes: int) -> None:
    """The kernel ends the process after this processor time; more memory is a MemoryError."""
    signal.setitimer(signal.ITIMER_PROF, cpu_seconds)
    resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))


def offer_packages(packages: Mapping[str, str]) -> None:
    """Answer $(find NAME) in place of the ROS package index, which xacro imports when it needs it."""

    def get_package_share_directory(name: str) -> str:
        if name not in packages:
            raise Refused(f"$(find {name}): no folder is given for this package", f"give packages={{'{name}': FOLDER}}")
        return packages[name]

    index = types.ModuleType("ament_index_python.packages")
    index.get_package_share_directory = get_package_share_directory  # type: ignore[attr-defined]
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules["ament_index_python.packages"] = index


def offer_folder(xacro: Any) -> None:
    """Answer $(dirname), the folder of the file that it stands in: xacro alone never knows it."""
    substitution: Any = importlib.import_module("xacro.substitution_args")
    substitution._eval_dirname = lambda _filename: os.path.dirname(xacro.filestack[-1])


def beside(name: str) -> Any:
    """A file beside this one: this process has no packages of ours."""
    file = os.path.join(os.path.dirname(__file__), f"{name}.py")
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def guard_yaml(limits: Any) -> None:
    """Name the file of xacro.load_yaml in its errors, and refuse what would grow."""
    yaml: Any = importlib.import_module("yaml")
    load = yaml.safe_load

    def guarded(file: Any) -> Any:
        content = file.buffer.read()
        try:
            limits.refuse_growing_yaml(content)
            return load(content)
        except MemoryError:
            raise
        except Exception as error:  # whatever a tag makes of its text
            line = getattr(error, "line", None)
            said = " ".join(str(error).split())[:MAX_MESSAGE_CHARACTERS]
            where = os.path.basename(file.name) + (f", line {line}" if line else "")
            raise Refused(f"{where}: {said or type(error).__name__}", "correct the YAML file") from None

    yaml.safe_load = guarded


def guard_expressions(xacro: Any) -> None:
    """Check every expression before xacro evaluates it."""
    substitution: Any = importlib.import_module("xacro.substitution_args")
    safe_eval, evaluate = xacro.safe_eval, substitution._eval
    for name in FORBIDDEN_FUNCTIONS:
        del xacro._global_symbols["python"][name]

    def guarded(expression: str, *scopes: Any) -> Any:
        check_expression(expression)
        return safe_eval(expression, *scopes)

    def guarded_extension(expression: str, context: Any) -> Any:
        check_expression(expression)
        return evaluate(expression, context)

    xacro.safe_eval, substitution._eval = guarded, guarded_extension


def check_expression(expression: str) -> None:
    """Raise Refused for an expression that could reach beyond its own values; SyntaxError."""
    for node in ast.walk(ast.parse(expression.strip(), mode="eval")):
        hidden = isinstance(node, ast.Attribute) and (node.attr.startswith("_") or node.attr in FORBIDDEN_ATTRIBUTES)
        if hidden or isinstance(node, FORBIDDEN_NODES):
            raise Refused(f"the expression '{expression.strip()[:80]}' is not evaluated", "use plain arithmetic")


def fence(folders: list[str]) -> Callable[[str, tuple[Any, ...]], None]:
    """An audit hook that allows computing and reading below these folders, and nothing else."""
    roots = [os.path.realpath(folder) for folder in folders]

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event in HARMLESS_EVENTS or event.startswith("cpython."):
            return
        if event in ("open", "os.listdir", "os.scandir"):
            path = os.path.realpath(os.fspath(arguments[0]))
            writes = event == "open" and arguments[2] & (
                os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
            )
            if not writes and any(os.path.commonpath([root, path]) == root for root in roots):
                return
            raise Refused(
                f"the file '{path}' lies neither in the folder of this file nor in a given package",
                "give packages={NAME: FOLDER} with a folder that contains it",
            )
        raise Refused(f"the document asks for '{event}'", "use plain xacro")

    return hook


if __name__ == "__main__":
    main()
