"""Which one-line faults in modules with figures their tests do not notice.

    python tests/tools planted_mutations [--sample N] [--seed S] [MODULE or ROOM …]        # pip install cosmic-ray

cosmic-ray changes one number, comparison or operator after the other in a copy of the repository and runs the tests
that stand beside the module. Of the small modules in MODULES every change is made: some seconds each, an hour or two
for all. Of the rooms in ROOMS, with thousands of changes each, N are drawn, the same for the same seed. Without names:
all of both. What survives is printed, but for the changes in EQUIVALENT. Exit code 1 if anything else survived.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

_STATISTICS = "tests/graphdyn/identification/statistics/test_statistics.py"

MODULES = {
    "crosscheck/recordings/mapping/units.py": "tests/crosscheck/recordings/mapping/test_mapping.py",
    "crosscheck/quantities/scales.py": "tests/crosscheck/quantities/test_scales.py",
    "crosscheck/report/plain_text.py": "tests/crosscheck/report/test_shown_numbers.py",
    "graphdyn/identification/statistics/correlation.py": _STATISTICS,
    "urdf/reading/checks.py": "tests/urdf/reading/test_thresholds.py tests/urdf/reading/test_checks.py",
}
"""The tests of each."""

_COMMANDS = "crosscheck/commands"
_NUMBERS = "tests/crosscheck/commands/test_every_number.py"

ROOMS = {
    "graphdyn/simulation": "tests/graphdyn/simulation",
    "graphdyn/excitation": "tests/graphdyn/excitation tests/crosscheck/commands/test_excite.py",
    "graphdyn/identification/statistics": _STATISTICS,
    "graphdyn/identification/closed_loop": "tests/graphdyn/identification/closed_loop",
    "graphdyn/identification/estimators": f"tests/graphdyn/identification/estimators {_STATISTICS}",
    "crosscheck/study/statistics": "tests/crosscheck/study/test_statistics.py",
    "crosscheck/study/simulated": "tests/crosscheck/study/test_simulated.py",
    "crosscheck/identifying/results": "tests/crosscheck/identifying",
    "crosscheck/report": "tests/crosscheck/report",
    f"{_COMMANDS}/bench": f"tests/{_COMMANDS}/test_bench.py {_NUMBERS}",
    f"{_COMMANDS}/crosscheck": f"tests/{_COMMANDS}/crosscheck {_NUMBERS}",
    f"{_COMMANDS}/excite": f"tests/{_COMMANDS}/test_excite.py {_NUMBERS}",
    f"{_COMMANDS}/export": f"tests/{_COMMANDS}/test_export.py",
    f"{_COMMANDS}/identify": f"tests/{_COMMANDS}/identify {_NUMBERS}",
    f"{_COMMANDS}/inspect": f"tests/{_COMMANDS}/test_inspect.py {_NUMBERS}",
    f"{_COMMANDS}/judge": f"tests/{_COMMANDS}/judge {_NUMBERS}",
    f"{_COMMANDS}/paper": f"tests/{_COMMANDS}/test_paper.py {_NUMBERS}",
    f"{_COMMANDS}/show": f"tests/{_COMMANDS}/show {_NUMBERS}",
    f"{_COMMANDS}/simulate": f"tests/{_COMMANDS}/test_simulate.py {_NUMBERS}",
    f"{_COMMANDS}/study": f"tests/{_COMMANDS}/study {_NUMBERS}",
}
"""Folders of modules too large to change everything in them, and the tests of each."""

_SQUARE = "the matrices are square"
_SYMMETRIC = "the inverse of a symmetric matrix is symmetric"
_INVERSE_NORM = "inverse_norm = np.abs(np.linalg.inv(mass)).sum(axis=-1).max(axis=-1)"
_UNIT_MATRIX = "mass = np.where(finite[:, None, None], mass, np.eye(mass.shape[-1]))"

EQUIVALENT: dict[str, dict[tuple[str, str], str]] = {
    "crosscheck/report/plain_text.py": {
        (
            'return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"',
            'return f"{ratio:.3g}×" if ratio < 998.5 else f"{ratio:.0f}×"',
        ): "between these, both forms have three digits and no exponent",
        (
            'return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"',
            'return f"{ratio:.3g}×" if ratio <= 999.5 else f"{ratio:.0f}×"',
        ): "999.5 itself is printed as 1e+03 or as 1000, which no measured ratio is",
    },
    "crosscheck/quantities/scales.py": {
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[+1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[~1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[- 2]")): _SQUARE,
        (_INVERSE_NORM, _INVERSE_NORM.replace("sum(axis=-1)", "sum(axis=+1)")): _SYMMETRIC,
        (_INVERSE_NORM, _INVERSE_NORM.replace("sum(axis=-1)", "sum(axis=~1)")): _SYMMETRIC,
        (_INVERSE_NORM, _INVERSE_NORM.replace("max(axis=-1)", "max(axis=+1)")): "the last axis is the second one",
        (
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=-1)",
            "sizes: Array = np.abs(x).reshape(len(x), - 2).max(axis=-1)",
        ): "NumPy takes any negative length as the one that is left",
        (
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=-1)",
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=+1)",
        ): "the last axis is the second one",
        (
            "@dataclass(frozen=True, eq=False)",
            "@dataclass(frozen=False, eq=False)",
        ): "nothing assigns to it",
        (
            "@dataclass(frozen=True, eq=False)",
            "@dataclass(frozen=True, eq=True)",
        ): "nothing compares it",
    },
}
"""Changes that no test can notice, by module: the line before and after, and why."""

ROOT = Path(__file__).parents[3]
NOT_COPIED = shutil.ignore_patterns(".*", "build", "__pycache__", "*.egg-info")

LONGEST = 600
"""Seconds after which a change that makes the tests hang counts as noticed."""

LEFT_OUT = (
    ".*_BitOr_.*",  # types of annotations
    ".*_BitAnd_Mul$",  # the same of truth values
    ".*_(FloorDiv|Mod|LShift|RShift|BitOr|BitAnd|BitXor|MatMul)$",  # Add, Sub, Mul, Div and Pow in their place suffice
    ".*_(Eq|NotEq|Is|IsNot)_(Lt|Gt|LtE|GtE|Is|IsNot)",  # of words; Eq for NotEq and back suffice
    "core/(RemoveDecorator|ExceptionReplacer|ZeroIterationForLoop|VariableReplacer|VariableInserter)",
)
"""Kinds of changes that are not made."""

WITHOUT_EFFECT = (
    *("strict=", "frozen=", "eq=", "kw_only=", "slots="),  # where nothing else is wrong
    *("fontsize=", "labelsize=", "linewidth=", "markersize=", "alpha=", "zorder="),  # of pictures
)
"""What stands before a value that no answer depends on."""

CONFIG = """
[cosmic-ray]
module-path = {modules}
timeout = {timeout}
excluded-modules = []
test-command = "{python} -m pytest -q -x -p no:cacheprovider {tests}"

[cosmic-ray.distributor]
name = "local"

[cosmic-ray.filters.operators-filter]
exclude-operators = {left_out}
"""


def survivors(
    modules: Sequence[str], tests: str, folder: Path, sample: int | None, seed: int
) -> tuple[int, list[tuple[str, str]]]:
    """How many faults were planted in modules, and those that their tests did not notice: line as it was, and became.

    sample: how many are drawn; None: every one is planted
    """
    config, session = folder / "config.toml", folder / "session.sqlite"
    session.unlink(missing_ok=True)
    text = CONFIG.format(
        modules=json.dumps(modules), timeout=LONGEST, python=sys.executable, tests=tests, left_out=json.dumps(LEFT_OUT)
    )
    config.write_text(text, encoding="utf-8")
    environment = {
        **os.environ,
        "PYTHONPATH": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
        "GRAPHDYN_TEST_DATA": str((ROOT / os.environ.get("GRAPHDYN_TEST_DATA", "../shared")).resolve()),
    }

    def call(*command: str) -> str:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
        return done.stdout

    program = str(Path(sys.executable).with_name("cosmic-ray"))
    call(program, "init", str(config), str(session))
    call(str(Path(sys.executable).with_name("cr-filter-operators")), str(session), str(config))
    _leave_out(session, folder, sample, seed)
    call(program, "baseline", str(config))
    call(program, "exec", str(config), str(session))
    outcomes = [json.loads(line)[1] for line in call(program, "dump", str(session)).splitlines()]
    outcomes = [outcome for outcome in outcomes if outcome and outcome["worker_outcome"] != "skipped"]
    return len(outcomes), [
        changed_line(outcome["diff"]) for outcome in outcomes if outcome["test_outcome"] == "survived"
    ]


def changed_line(diff: str) -> tuple[str, str]:
    before, after = (
        " ".join(line[1:].strip() for line in diff.splitlines() if line[:1] == sign and line[:3] != 3 * sign)
        for sign in "-+"
    )
    return before, after


def _leave_out(session: Path, folder: Path, sample: int | None, seed: int) -> None:
    """Skip what has no effect, and all but the drawn changes."""
    from cosmic_ray.work_db import WorkDB, use_db
    from cosmic_ray.work_item import WorkerOutcome, WorkResult

    def effective(item: Any) -> bool:
        (change,) = item.mutations
        line, column = change.start_pos
        before = (folder / change.module_path).read_text("utf-8").splitlines()[line - 1][:column]
        return not before.endswith(WITHOUT_EFFECT)

    with use_db(session, WorkDB.Mode.open) as planted:
        pending = sorted(planted.pending_work_items, key=lambda item: repr(item.mutations))
        chosen = [item for item in pending if effective(item)]
        if sample is not None and sample < len(chosen):
            chosen = random.Random(seed).sample(chosen, sample)
        kept = {item.job_id for item in chosen}
        for item in pending:
            if item.job_id not in kept:
                planted.set_result(item.job_id, WorkResult(worker_outcome=WorkerOutcome.SKIPPED))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="MODULE or ROOM")
    parser.add_argument("--sample", type=int, default=20, help="changes drawn in every room (20)")
    parser.add_argument("--seed", type=int, default=0, help="of the draw (0)")
    options = parser.parse_args()
    known = MODULES | ROOMS
    unknown = set(options.names) - set(known)
    if unknown:
        parser.error(f"not among the modules and rooms of this program: {', '.join(sorted(unknown))}")
    noticed = True
    with tempfile.TemporaryDirectory(prefix="graphdyn-mutation-") as name:
        folder = Path(name, "copy")
        shutil.copytree(ROOT, folder, ignore=NOT_COPIED)
        for module in options.names or known:
            modules = [module] if module in MODULES else _modules_of(folder, module)
            sample = None if module in MODULES else options.sample
            planted, left = survivors(modules, known[module], folder, sample, options.seed)
            equivalent = [change for change in left if change in EQUIVALENT.get(module, {})]
            said = f"{len(left)} survived, {len(equivalent)} of them make no difference"
            print(f"{module}: {planted} planted, {said}", flush=True)
            for before, after in left:
                if (before, after) not in equivalent:
                    noticed = False
                    print(f"    {before}\n  → {after}", flush=True)
    return int(not noticed)


def _modules_of(folder: Path, room: str) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in (folder / room).rglob("*.py"))
