"""Exported C, compiled here: its own test, and the judgment of its functions as those of a shared library."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from crosscheck.judging.exchange.program import library_function
from crosscheck.judging.judge import Progress, judge_functions
from crosscheck.judging.judgment import Judgment
from crosscheck.judging.setting import Setting
from crosscheck.quantities import FUNCTIONS
from graphdyn import GraphDynError
from graphdyn.export import CCode, ExportedFunction

FLAGS = ("-std=c99", "-O2", "-fPIC")
"""How the code is compiled: as strictly as by anyone, and so that a compiler takes a second or two."""

COMPILERS = ("cc", "gcc", "clang")
"""Looked for in this order where the environment variable CC names none."""

ANSWER_TIME_LIMIT = 30.0
"""Time for each answer of a judged function, the start of its process included [s]."""

JUDGED_AS = {
    "tau": "inverse_dynamics",
    "a": "forward_dynamics",
    "kinetic": "kinetic_energy_regressor",
    "about_center_of_mass": "momentum",
}
"""Names of judged functions, of results that have another name."""


class CompilerFailed(GraphDynError):
    """The C compiler does not compile the exported code."""


@dataclass(frozen=True)
class TestedArray:
    """A result of an exported function in its test, one state at a time or all together.

    error: the largest, as a share of the largest number; states: at how many, those with a nearly singular mass matrix
        left out
    """

    name: str
    error: float
    states: int


@dataclass(frozen=True, eq=False)
class CheckedCode:
    """What became of exported code when it was tried.

    compiler: its command
    passed: whether the test of the code found all results right
    arrays: what it compared
    judgment: of the functions that can be judged; None where there are none, or the robot cannot be judged
    """

    compiler: str
    passed: bool
    arrays: tuple[TestedArray, ...]
    judgment: Judgment | None

    @property
    def agrees(self) -> bool:
        judged = self.judgment is None or (self.judgment.agrees and self.judgment.decided)
        return self.passed and judged


def c_compiler() -> list[str] | None:
    """The command of the C compiler: what CC says, or one of COMPILERS; None where there is none."""
    named = shlex.split(os.environ.get("CC", ""))
    if named:
        return named if shutil.which(named[0]) else None
    return next(([found] for found in map(shutil.which, COMPILERS) if found), None)


def check_code(code: CCode, compiler: Sequence[str], setting: Setting, progress: Progress) -> CheckedCode:
    """Compile exported code, run its test, and judge its functions.

    setting: the robot of the code, as it is judged; its precision is that of the code

    Raises CompilerFailed, and what crosscheck.judge raises.
    """
    with TemporaryDirectory(prefix="graphdyn-") as name:
        folder = Path(name)
        for file, text in code.files.items():
            (folder / file).write_text(text, encoding="ascii")
        progress("compiling")
        sources = [f"{code.name}_{function.name}.c" for function in code.functions]
        _compile(compiler, [f"{code.name}_test.c", *sources, "-o", "test", "-lm"], folder)
        progress("testing")
        done = subprocess.run([str(folder / "test")], capture_output=True, text=True, check=False)
        judgment = _judgment(code, compiler, setting, folder, sources, progress)
    return CheckedCode(shlex.join(compiler), done.returncode == 0, tuple(_tested(done.stdout)), judgment)


def _tested(printed: str) -> Iterator[TestedArray]:
    """The lines of the test."""
    for name, error, states in re.findall(r"^(\w+: \w+) +(\S+) at (\d+) states", printed, re.MULTILINE):
        yield TestedArray(name, float(error), int(states))


def _compile(compiler: Sequence[str], arguments: Sequence[str], folder: Path) -> None:
    done = subprocess.run([*compiler, *FLAGS, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        first = next(iter(done.stderr.splitlines()), f"exit code {done.returncode}")
        raise CompilerFailed(f"{shlex.join(compiler)} does not compile the code: {first}; name another one in CC")


def _judgment(
    code: CCode, compiler: Sequence[str], setting: Setting, folder: Path, sources: Sequence[str], progress: Progress
) -> Judgment | None:
    judged = dict(_judged(code, setting.external_wrenches))
    model = code.functions[0].model
    if not judged or model.chords or model.couplings:
        return None
    glue = "\n".join(_glue(code, name, *judged[name]) for name in judged)
    (folder / "judged.c").write_text(f'#include "{code.name}.h"\n{glue}', encoding="ascii")
    library = folder / "judged.so"
    _compile(compiler, ["-shared", "judged.c", *sources, "-o", str(library), "-lm"], folder)
    with ExitStack() as ended:
        functions = {
            name: ended.enter_context(library_function(library, _symbol(code, name, function), ANSWER_TIME_LIMIT))
            for name, (function, _) in judged.items()
        }
        return judge_functions(functions, replace(setting, precision=code.precision), progress)


def _judged(code: CCode, loaded: bool) -> Iterator[tuple[str, tuple[ExportedFunction, str]]]:
    """Yield names of judged functions, each with the exported function of the same arguments and its result."""
    for function in code.functions:
        for output in function.outputs:
            name = JUDGED_AS.get(output, output)
            known = FUNCTIONS.get(name)
            if known is not None and "p" not in known.shape and known.called_with(loaded) == tuple(function.inputs):
                yield name, (function, output)


def _symbol(code: CCode, name: str, function: ExportedFunction) -> str:
    """The function itself where it has the form that is judged; otherwise that which calls it."""
    return f"{code.name}_{function.name}" if _is_direct(code, function) else f"judged_{name}"


def _is_direct(code: CCode, function: ExportedFunction) -> bool:
    return code.precision == "double" and len(function.outputs) == 1


def _glue(code: CCode, name: str, function: ExportedFunction, output: str) -> str:
    """A function of doubles with one result, of one of other numbers or with several."""
    if _is_direct(code, function):
        return ""
    real = "double" if code.precision == "double" else "float"
    arguments = ", ".join(f"const double *{array}" for array in function.inputs)
    lines = [f"int judged_{name}(int n, {arguments}, double *result);"]
    lines += [f"int judged_{name}(int n, {arguments}, double *result)\n{{"]
    lines += [f"    {real} given_{array}[{function.size(array)}];" for array in function.inputs]
    lines += [f"    {real} found_{array}[{function.size(array)}];" for array in function.outputs]
    lines += ["    int status, k;"]
    for array in function.inputs:
        lines += [f"    for (k = 0; k < {function.size(array)}; ++k)\n        given_{array}[k] = ({real}) {array}[k];"]
    passed = ", ".join([*(f"given_{x}" for x in function.inputs), *(f"found_{x}" for x in function.outputs)])
    lines += [f"    status = {code.name}_{function.name}(n, {passed});"]
    lines += [f"    for (k = 0; k < {function.size(output)}; ++k)\n        result[k] = found_{output}[k];"]
    return "\n".join([*lines, "    return status;\n}\n"])
