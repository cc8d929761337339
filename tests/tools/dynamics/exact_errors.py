"""How far graphdyn and Pinocchio are from exact values: python tests/tools exact_errors FOLDER [--states 1000]

Measures the six arms of the command line and, where GRAPHDYN_TEST_DATA has them, the makers' arms, as `graphdyn
crosscheck --exact` does, in several processes (--jobs), and writes the tables of docs/accuracy.md. FOLDER keeps what
was measured of each arm; one whose file is there, with as many states, is not measured again. An arm takes half a
minute of processor time with 100 states, three with 1000.
"""

import argparse
import json
import re
import warnings
from pathlib import Path

import numpy as np
from shared_data import ARMS, REPOSITORY

from crosscheck import TrueErrors, true_errors
from crosscheck.commands.crosscheck.command import DEFAULT_ROBOTS
from crosscheck.commands.crosscheck.exact.record import TrueErrorsRecord
from crosscheck.commands.crosscheck.exact.report import eps_text
from crosscheck.distributing import LocalProcesses
from crosscheck.quantities.tolerances import EPS
from crosscheck.report.records.record import as_bytes, plain, versions, written
from graphdyn import GraphDynError

PAGE = REPOSITORY / "docs" / "accuracy.md"

CODES = ("recursive", "projected", "dense", "Pinocchio", "MuJoCo")
METHODS = CODES[:3]

LEAST_RATIO = 1e-3
"""Ratios below this count as this in a geometric mean."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python tests/tools exact_errors")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    makers = sorted(ARMS.glob("*.urdf")) if ARMS.is_dir() else []
    tasks = [(name, dict(lock), asked.states, str(asked.folder)) for name, lock in DEFAULT_ROBOTS]
    tasks += [(str(path), {}, asked.states, str(asked.folder)) for path in makers]
    todo = [task for task in tasks if not is_measured(task)]
    for k, outcome in LocalProcesses(asked.jobs).each(measured, todo):
        print(f"{Path(todo[k][0]).stem}: {outcome}", flush=True)
    arms = [json.loads(file_of(task).read_text("utf-8")) for task in tasks if is_measured(task)]
    own = {name for name, _ in DEFAULT_ROBOTS}
    write(PAGE, [arm for arm in arms if arm["robot"] in own], [arm for arm in arms if arm["robot"] not in own])
    return 0


def file_of(task) -> Path:
    robot, _, _, folder = task
    return Path(folder) / f"{Path(robot).stem}{'_file' if robot.endswith('.urdf') else ''}.json"


def is_measured(task) -> bool:
    path = file_of(task)
    return path.exists() and json.loads(path.read_text("utf-8"))["samples"] == task[2]


def measured(task) -> str:
    """Measure an arm and write its file."""
    robot, locked, states, _ = task
    try:
        with warnings.catch_warnings(action="ignore"):
            found: TrueErrors = true_errors(robot, states, lock=locked or None)
    except GraphDynError as error:
        return str(error)
    file_of(task).write_bytes(as_bytes(plain(written(TrueErrorsRecord, found))))
    return "agrees" if found.agrees else "DISAGREES"


def write(page, arms, makers) -> None:
    """Put the tables between their markers."""
    known = versions()
    states = sorted({arm["samples"] for arm in (*arms, *makers)})
    parts = {
        "versions": f"graphdyn {known['graphdyn']}, Pinocchio {known['pinocchio']}, NumPy {known['numpy']}; "
        f"{' and '.join(map(str, states))} random states of each arm, seed 0, and the special ones.",
        "largest errors": largest([*arms, *makers]),
        "counts": f"{counts(arms, 'the six arms')} {counts(makers, 'the makers’ arms')}",
        "sum of the six arms": ratios(arms),
        "sum of the makers' arms": ratios(makers),
        "six arms": "\n\n".join(f"### {arm['robot']}\n\n{table(arm)}" for arm in arms),
        "left out": left_out(makers),
    }
    text = page.read_text("utf-8")
    for name, content in parts.items():
        begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
        text = re.sub(f"{begin}.*?{end}", lambda _, c=f"{begin}\n{content}\n{end}": c, text, flags=re.DOTALL)
    page.write_text(text, "utf-8")


def largest(arms) -> str:
    """For each bound the largest error of each code, and where it occurs."""
    lines = [f"| bound | {' | '.join(CODES)} |", "|---|" + "---|" * len(CODES)]
    for bound in sorted({quantity["bound"] for arm in arms for quantity in arm["quantities"].values()}):
        cells = []
        for code in CODES:
            found = [
                (quantity["codes"][code]["largest"], name, Path(arm["robot"]).stem)
                for arm in arms
                for name, quantity in arm["quantities"].items()
                if quantity["bound"] == bound and code in quantity["codes"]
            ]
            error, name, robot = max(found)
            cells.append(f"{eps_text(error)} ({name}, {robot})")
        lines.append(f"| {eps_text(bound)} eps = {bound * EPS:.1e} | {' | '.join(cells)} |")
    return "\n".join(lines)


def table(arm) -> str:
    """Every quantity of an arm."""
    codes = [code for code in CODES if any(code in quantity["codes"] for quantity in arm["quantities"].values())]
    lines = [f"| quantity | bound | {' | '.join(codes)} |", "|---|---|" + "---|" * len(codes)]
    for name, quantity in arm["quantities"].items():
        cells = [three(quantity["codes"].get(code)) for code in codes]
        lines.append(f"| {name} | {eps_text(quantity['bound'])} | {' | '.join(cells)} |")
    return "\n".join(lines)


def three(code) -> str:
    return "–" if code is None else "; ".join(eps_text(code[key]) for key in ("median", "quantile_99", "largest"))


def ratios(arms) -> str:
    """The 99 % quantile of each method over that of Pinocchio: geometric mean, and largest."""
    lines = [
        f"| quantity | {' | '.join(METHODS)} | {' | '.join(f'{method}, of values' for method in METHODS)} |",
        "|---|" + "---|" * (2 * len(METHODS)),
    ]
    for name in names(arms):
        cells = [
            over_pinocchio(having(arms, name, method), method, key)
            for key in ("quantile_99", "quantile_99_of_values")
            for method in METHODS
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def counts(arms, words) -> str:
    """How often which method is closer."""
    said = []
    for method in METHODS[:2]:
        means = {name: mean_ratio(having(arms, name, method), method) for name in names(arms)}
        closer = sum(mean < 1 for mean in means.values())
        said.append(f"the {method} method is closer in {closer} of {len(means)} quantities")
    return f"In the mean of {words}, {' and '.join(said)}."


def names(arms) -> list[str]:
    return list(dict.fromkeys(name for arm in arms for name in arm["quantities"]))


def having(arms, name, method):
    """The errors of all codes, of the arms where the method was measured."""
    found = [arm["quantities"][name]["codes"] for arm in arms if name in arm["quantities"]]
    return [codes for codes in found if method in codes]


def ratios_of(arms, method, key="quantile_99"):
    pairs = [(codes[method][key], codes["Pinocchio"][key]) for codes in arms]
    return np.array([one / other for one, other in pairs if None not in (one, other) and other > 0])


def mean_ratio(arms, method, key="quantile_99") -> float:
    return float(np.exp(np.log(np.maximum(ratios_of(arms, method, key), LEAST_RATIO)).mean()))


def over_pinocchio(arms, method, key) -> str:
    found = ratios_of(arms, method, key)
    return f"{mean_ratio(arms, method, key):.2f}; {found.max():.2f}" if found.size else "–"


def left_out(arms) -> str:
    """What was not measured of which arm."""
    reasons: dict[str, list[str]] = {}
    for arm in arms:
        for reason in {reason for reason in arm["not_measured"].values() if reason != "no exact form"}:
            kind = "no mass at all" if reason.startswith("no body has mass") else "no forward dynamics"
            reasons.setdefault(kind, []).append(Path(arm["robot"]).stem)
    states = sum(sum(arm["not_regular"].values()) for arm in arms)
    said = "; ".join(f"{kind}: {', '.join(sorted(set(names)))}" for kind, names in reasons.items())
    whole = f"{len(arms)} arms; {said or 'all quantities of all'}."
    return f"{whole} States whose mass matrix is not proven regular: {states}."
