"""The gallery: pages and terminal output of the commands, made by running them while the site is built."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree

import numpy as np

import graphdyn
import urdf

HERE = Path(__file__).parent
PROGRAM = Path(sys.executable).with_name("graphdyn")
WORKERS = 2


@dataclass(frozen=True)
class Exhibit:
    """One command of the gallery.

    name: of the page
    about: what it shows, in a sentence
    arguments: of the program graphdyn, without --html
    exit_code: that it has to end with
    """

    name: str
    about: str
    arguments: tuple[str, ...]
    exit_code: int = 0


EXHIBITS = (
    Exhibit("show", "A robot as it was read: bodies, joints, graph, pattern of the equations.", ("show", "ur5")),
    Exhibit(
        "crosscheck",
        "Every quantity of graphdyn beside Pinocchio, with the error and its bound.",
        ("crosscheck", "kr500", "--samples", "50"),
    ),
    Exhibit(
        "accuracy",
        "How far graphdyn and Pinocchio are from exact values, as points beside the bounds.",
        ("crosscheck", "kr500", "--exact", "5"),
    ),
    Exhibit(
        "judge",
        "An inverse dynamics with one wrong sign, and the diagnosis.",
        ("judge", "ur5", "--inverse-dynamics", "textbook.py:textbook_rnea"),
        exit_code=1,
    ),
    Exhibit(
        "diff",
        "Two descriptions of one robot laid over each other, and every difference in N m.",
        ("diff", "ur5", "ur5_joint_limited", "--samples", "100"),
        exit_code=1,
    ),
    Exhibit("inspect", "A file with faults, each with line and remedy.", ("inspect", "doubtful.urdf"), exit_code=1),
    Exhibit(
        "simulate",
        "An arm that falls freely, seen in three dimensions, with the largest loads of its joints, and its energies.",
        ("simulate", "ur5", "--duration", "2", "--3d"),
    ),
    Exhibit("view", "An arm to be moved by hand, with all reactions of its joints.", ("view", "panda")),
    Exhibit(
        "excite",
        "A motion from which a robot's parameters can be identified well, and how well.",
        ("excite", "--robot", "ur5", "--seeds", "1", "--random", "20"),
    ),
    Exhibit(
        "recording",
        "A log whose columns are recognized: what each of them is, and why.",
        ("recording", "log.csv", "--robot", "ur5"),
    ),
    Exhibit(
        "payload",
        "A load of 2.8 kg, found from motor currents without and with it.",
        ("payload", "empty.csv", "gripper.csv", "--robot", "ur5", "--gains", "12", "--gains-error", "0.03"),
    ),
    Exhibit("paper", "The tables and results of the paper, recomputed.", ("paper",)),
    Exhibit(
        "identify",
        "A simulated robot identified by four methods, one of which to trust.",
        (
            *("identify", "--robot", "kr500", "--seconds", "10", "--poses", "200"),
            *("--methods", "ols,wls,wls-pinocchio,consistent"),
        ),
    ),
)
SLOW = (
    Exhibit(
        "bench",
        "Speed and accuracy beside Pinocchio and MuJoCo on the machine that built this site, with few samples.",
        ("bench", "--quick", "--samples", "1000"),
    ),
)
"""Made on request (`-t bench`): it takes as long as all the others together, and wants a quiet machine."""
INTRODUCTION = "What the commands print, and the pages they write. All of it was made when this site was built."


class WrongExit(RuntimeError):
    """A command of the gallery that ended otherwise than it should."""


def write(folder: Path, exhibits: Sequence[Exhibit]) -> None:
    """index.md, and the pages below `pages`. Without an exhibit the index says that the gallery was left out."""
    rmtree(folder, ignore_errors=True)
    pages = folder / "pages" / "gallery-pages"
    pages.mkdir(parents=True)
    lines = ["# Gallery", ""]
    _write_inputs(folder)
    lines += [INTRODUCTION if exhibits else "This site was built without the gallery.", ""]
    with ThreadPoolExecutor(WORKERS) as pool:
        printed = pool.map(lambda exhibit: output_of(exhibit, folder, pages), exhibits)
        for exhibit, text in zip(exhibits, printed, strict=True):
            command = " ".join(("graphdyn", *exhibit.arguments, "--html", f"{exhibit.name}.html"))
            lines += [f"## {exhibit.name}", "", exhibit.about, "", "```sh", command, "```", ""]
            lines += [f'<p><a href="../gallery-pages/{exhibit.name}.html">Open the page</a></p>', ""]
            lines += [
                "<details><summary>What it prints</summary>",
                "",
                "```text",
                text.rstrip(),
                "```",
                "",
                "</details>",
                "",
            ]
    (folder / "index.md").write_text("\n".join(lines), encoding="utf-8")


def output_of(exhibit: Exhibit, folder: Path, pages: Path) -> str:
    """What the command prints; its page is written. Raises WrongExit."""
    done = subprocess.run(
        [PROGRAM, *exhibit.arguments, "--html", str(pages / f"{exhibit.name}.html")],
        cwd=folder,
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "110", "NO_COLOR": "1", "TERM": "dumb"},
        check=False,
    )
    if done.returncode != exhibit.exit_code:
        raise WrongExit(
            f"graphdyn {' '.join(exhibit.arguments)} ended with {done.returncode}, not {exhibit.exit_code}:\n"
            f"{done.stdout}{done.stderr}"
        )
    return done.stdout


def _write_inputs(folder: Path) -> None:
    """The files that the commands read: the worked example of judge.md, a URDF file with faults, logs of a UR5."""
    text = (HERE.parent / "judge.md").read_text(encoding="utf-8")
    example = re.search(r"```python\n(.*?)\n\n\njudgment = ", text, re.DOTALL)
    assert example, "docs/judge.md has no worked example that ends before 'judgment = '"
    (folder / "textbook.py").write_text(example[1] + "\n", encoding="utf-8")
    (folder / "doubtful.urdf").write_bytes((HERE / "robots" / "doubtful.urdf").read_bytes())
    _write_log(folder / "log.csv")
    for seed, (name, load) in enumerate((("empty", 0.0), ("gripper", 2.8))):
        _write_currents(folder / f"{name}.csv", load, seed)


def _write_log(path: Path) -> None:
    """Ten seconds of a UR5 that swings, by a recorder of its own: angles in degrees, no velocities."""
    robot = urdf.load("ur5")
    t, q, v, a = _swinging(10.0)
    tau = graphdyn.joint_torques(robot, q, v, a) + 3.0 * v + 2.0 * np.sign(v)
    columns = ["time", *(f"axis{k}_angle_deg" for k in range(1, 7)), *(f"axis{k}_torque_Nm" for k in range(1, 7))]
    table = np.column_stack([t, np.rad2deg(q), tau])
    np.savetxt(path, table, fmt="%.6f", delimiter=",", header=",".join(columns), comments="")


def _write_currents(path: Path, load: float, seed: int) -> None:
    """Half a minute of a UR5 whose last link carries a mass [kg]: currents, with noise."""
    robot = urdf.load("ur5")
    t, q, v, a = _swinging(30.0)
    parameters = robot.inertial_parameters.copy()
    parameters[-10:] += graphdyn.Body("load", load, (0.0, 0.02, 0.08), 0.004 * load * np.eye(3)).parameters
    tau = graphdyn.joint_torques(robot.with_inertial_parameters(parameters), q, v, a) + 3.0 * v + 2.0 * np.sign(v)
    noise = np.random.default_rng(seed).normal(size=tau.shape) * 0.03 * np.sqrt(np.mean(tau**2, axis=0))
    joints = robot.independent_joints
    columns = ["t [s]", *(f"q_{name} [rad]" for name in joints), *(f"tau_{name} [N m]" for name in joints)]
    table = np.column_stack([t, q, (tau + noise) / 12.0])
    np.savetxt(path, table, fmt="%.6f", delimiter=",", header=",".join(columns), comments="")


def _swinging(seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Times (N,), positions, velocities and accelerations (N, 6)."""
    t = np.arange(0.0, seconds, 0.01)
    frequencies, sizes = np.arange(1.0, 7.0) * 0.4, np.array([0.9, 0.7, 0.8, 1.0, 0.9, 1.2])
    turns = np.outer(t, frequencies) + np.arange(6)
    q, v = sizes * np.sin(turns), sizes * frequencies * np.cos(turns)
    return t, q, v, -(frequencies**2) * q
