"""Which one-line faults in small modules with figures their tests do not notice.

    python tests/tools planted_mutations [MODULE …]        # pip install cosmic-ray

For every module of MODULES, or for those named, cosmic-ray changes one number, comparison or operator after the other
in a copy of the repository and runs the tests that stand beside it. What survives is printed, but for the changes in
EQUIVALENT. Exit code 1 if anything else survived. Some seconds for each change, an hour or two for all.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_STATISTICS = "tests/graphdyn/identification/statistics/test_statistics.py"

MODULES = {
    "crosscheck/recordings/mapping/units.py": "tests/crosscheck/recordings/mapping/test_mapping.py",
    "crosscheck/quantities/scales.py": "tests/crosscheck/quantities/test_scales.py",
    "crosscheck/report/plain_text.py": "tests/crosscheck/report/test_shown_numbers.py",
    "graphdyn/identification/statistics/correlation.py": _STATISTICS,
    "urdf/reading/checks.py": "tests/urdf/reading/test_thresholds.py tests/urdf/reading/test_checks.py",
}
"""The tests of each."""

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

ROOT = Path(__file__).parents[2]
NOT_COPIED = shutil.ignore_patterns(".*", "build", "__pycache__", "*.egg-info")

LONGEST = 600
"""Seconds after which a change that makes the tests hang counts as noticed."""

LEFT_OUT = (
    ".*_BitOr_.*",  # types of annotations
    ".*_(FloorDiv|Mod|LShift|RShift|BitOr|BitAnd|BitXor|MatMul)$",  # Add, Sub, Mul, Div and Pow in their place suffice
    ".*_(Eq|NotEq|Is|IsNot)_(Lt|Gt|LtE|GtE|Is|IsNot)",  # of words; Eq for NotEq and back suffice
    "core/(RemoveDecorator|ExceptionReplacer|ZeroIterationForLoop|VariableReplacer|VariableInserter)",
)
"""Kinds of changes that are not made."""

CONFIG = """
[cosmic-ray]
module-path = "{module}"
timeout = {timeout}
excluded-modules = []
test-command = "{python} -m pytest -q -x -p no:cacheprovider {tests}"

[cosmic-ray.distributor]
name = "local"

[cosmic-ray.filters.operators-filter]
exclude-operators = {left_out}
"""


def survivors(module: str, tests: str, folder: Path) -> tuple[int, list[tuple[str, str]]]:
    """How many faults were planted in a module, and those that its tests did not notice: line as it was, and became."""
    config, session = folder / "config.toml", folder / "session.sqlite"
    session.unlink(missing_ok=True)
    text = CONFIG.format(
        module=module, timeout=LONGEST, python=sys.executable, tests=tests, left_out=json.dumps(LEFT_OUT)
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


def main() -> int:
    names = sys.argv[1:]
    unknown = set(names) - set(MODULES)
    if unknown:
        raise SystemExit(f"not among the modules of this program: {', '.join(sorted(unknown))}")
    noticed = True
    with tempfile.TemporaryDirectory(prefix="graphdyn-mutation-") as name:
        folder = Path(name, "copy")
        shutil.copytree(ROOT, folder, ignore=NOT_COPIED)
        for module in names or MODULES:
            planted, left = survivors(module, MODULES[module], folder)
            equivalent = [change for change in left if change in EQUIVALENT.get(module, {})]
            said = f"{len(left)} survived, {len(equivalent)} of them make no difference"
            print(f"{module}: {planted} planted, {said}", flush=True)
            for before, after in left:
                if (before, after) not in equivalent:
                    noticed = False
                    print(f"    {before}\n  → {after}", flush=True)
    return int(not noticed)
