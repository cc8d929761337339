"""How all methods predict the recordings of three industrial arms, as one table.

    python tests/tools industrial_arms FOLDER           of all methods, some minutes
    python tests/tools industrial_arms FOLDER wls,ml    of these, named as in --methods

The commands are those of docs/industrial_arms.md with --methods all, but that every arm is fitted once and the rest of
its recording predicted: ‖e‖ / ‖τ‖ in percent over moving rows, mean over the joints, in brackets where bodies cannot be
real. FOLDER keeps what they write; an arm whose file is there is not identified again.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

from shared_data import DATA, REPOSITORY

MAPPINGS = REPOSITORY / "docs" / "recordings"
UR10, TX40, KR300 = (DATA / "data" / arm for arm in ("ur10", "tx40", "kr300"))

COMMANDS = {
    "ur10": [
        UR10 / "ur10_free_motion.csv", "--robot", "ur10", "--mapping", MAPPINGS / "ur10.toml", "--cutoff", 8,
        "--models", "smooth.toml", "--split-rows", "60:1700", "1750:",
    ],
    "tx40": [
        TX40 / "pos_read_data.csv", TX40 / "curr_data.csv", "--robot", TX40 / "tx40.urdf", "--mapping",
        MAPPINGS / "tx40.toml", "--cutoff", 20, "--decimate", "10,10", "--terms",
        "viscous,coulomb,offset,rotor,coupled-wrist", "--width", 0.05, "--split", "0:6", "6:9",
    ],
    "kr300": [
        KR300 / "kr300_A.csv", "--robot", "kr300_150.urdf", "--mapping", MAPPINGS / "kr300.toml", "--cutoff", 8,
        "--min-speed", 0.02, "--scaled-torque", f"{MAPPINGS / 'kr300.py'}:counterbalance", "--terms",
        "viscous,coulomb,offset,rotor", "--split", "0:7", "7:10",
    ],
}  # fmt: skip

TITLES = {"ur10": "UR10", "tx40": "TX40", "kr300": "KR300"}


def inputs(folder):
    """What the commands read and the shared data do not have: a robot file, and the second torque model of the UR10."""
    figures = [MAPPINGS / "kr300.py", KR300 / "kr300.json", folder / "kr300_150.urdf", "150"]
    subprocess.run([sys.executable, *map(str, figures)], check=True)
    models = (MAPPINGS / "ur10_models.toml").read_text(encoding="utf-8")
    (folder / "smooth.toml").write_text(models[models.index("[smooth]") :], encoding="utf-8")


def identified(folder, arm, methods):
    """The record of an arm."""
    path = folder / f"{arm}-{methods}.json"
    if not path.exists():
        inputs(folder)
        command = [sys.executable, "-m", "crosscheck", "identify", *COMMANDS[arm], "--methods", methods, "--json", path]
        environment = {**os.environ, "KR300_JSON": str(KR300 / "kr300.json")}
        done = subprocess.run(list(map(str, command)), cwd=folder, env=environment, check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"{arm}: exit code {done.returncode}")
    return json.loads(path.read_text(encoding="utf-8"))


def results(record):
    """Error, and whether all links and mass matrices can be real, by method; None for a failure."""
    rows = {(one["method"], one["cad_links"]): one["mean_error"] for one in record["comparison"]}
    found = {}
    for method in record["methods"]:
        real = method["consistent"] and method["positive_definite"] == method["poses"]
        found[method["name"]] = None if method["failure"] else (rows[method["name"], False], bool(real))
    return found | {"CAD links, drives by WLS": (rows["WLS", True], True)}


def cell(result):
    if result is None:
        return "–"
    error, real = result
    return f"{100 * error:.1f}" if real else f"({100 * error:.1f})"


def main():
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    folder, methods = Path(sys.argv[1]).resolve(), (sys.argv[2:] or ["all"])[0]
    folder.mkdir(parents=True, exist_ok=True)
    arms = {arm: results(identified(folder, arm, methods)) for arm in COMMANDS}
    print(f"| method | {' | '.join(TITLES[arm] for arm in arms)} |")
    print("|---|" + "---|" * len(arms))
    for method in next(iter(arms.values())):
        print(f"| {method} | {' | '.join(cell(found.get(method)) for found in arms.values())} |")
