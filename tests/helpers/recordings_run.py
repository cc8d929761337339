"""All methods on the recordings of three arms, as one table: python tests/helpers/recordings_run.py FOLDER.

The commands are those of docs/identification.md with --methods all. FOLDER keeps what they write; an arm whose file is
there is not identified again. Half an hour, most of it for the UR10, of which all methods fit two torque models eight
times.
"""

import json
import subprocess
import sys
from pathlib import Path

from shared_data import DATA, REPOSITORY

MAPPINGS = REPOSITORY / "docs" / "recordings"
UR10, TX40, KR300 = (DATA / "data" / arm for arm in ("ur10", "tx40", "kr300"))

COMMANDS = {
    "ur10": [
        UR10 / "ur10_free_motion.csv", "--robot", "ur10", "--mapping", MAPPINGS / "ur10.toml", "--cutoff", 8,
        "--models", MAPPINGS / "ur10_models.toml", "--folds", 8, "--split-rows", "60:1700", "1750:",
    ],
    "tx40": [
        TX40 / "pos_read_data.csv", TX40 / "curr_data.csv", "--robot", TX40 / "tx40.urdf", "--mapping",
        MAPPINGS / "tx40.toml", "--cutoff", 20, "--decimate", "10,10", "--terms",
        "viscous,coulomb,offset,rotor,coupled-wrist", "--width", 0.05, "--split", "0:6", "6:9",
    ],
    "kr300": [
        KR300 / "kr300_A.csv", "--robot", "kr300_150.urdf", "--mapping", MAPPINGS / "kr300.toml", "--cutoff", 8,
        "--min-speed", 0.02, "--scaled-torque", f"{MAPPINGS / 'kr300.py'}:counterbalance", "--terms",
        "viscous,coulomb,offset,rotor", "--folds", 10,
    ],
}  # fmt: skip

MODELS = {"ur10": "smooth", "tx40": "", "kr300": ""}
"""The torque model of the table, where there are several."""

TITLES = {"ur10": "UR10, eight folds", "tx40": "TX40, last 3 s", "kr300": "KR300, ten folds"}


def identified(folder, arm):
    """The record of an arm."""
    path = folder / f"{arm}.json"
    if not path.exists():
        environment = {"KR300_JSON": str(KR300 / "kr300.json")}
        made = [sys.executable, MAPPINGS / "kr300.py", KR300 / "kr300.json", folder / "kr300_150.urdf", "150"]
        if arm == "kr300":
            subprocess.run(list(map(str, made)), check=True)
        command = [sys.executable, "-m", "crosscheck", "identify", *COMMANDS[arm], "--methods", "all", "--json", path]
        done = subprocess.run(list(map(str, command)), cwd=folder, env=environment_with(environment), check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"{arm}: exit code {done.returncode}")
    return json.loads(path.read_text(encoding="utf-8"))


def environment_with(more):
    import os

    return {**os.environ, **more}


def results(record, model):
    """Error, and whether all links and mass matrices can be real, by method; None for a failure."""
    rows = {c["method"]: c["mean_error"] for c in record["comparison"] if c["model"] == model and not c["cad_links"]}
    (of_model,) = [m for m in (record, *record["other_models"]) if m.get("model", m.get("name")) == model][:1]
    found = {}
    for method in of_model["methods"]:
        real = method["consistent"] and method["positive_definite"] == method["poses"]
        found[method["name"]] = None if method["failure"] else (rows[method["name"]], bool(real))
    cad = [c["mean_error"] for c in record["comparison"] if c["cad_links"] and c["name"].startswith(model)]
    return found | {"CAD links, drives by WLS": (cad[0], True)}


def cell(result):
    if result is None:
        return "–"
    error, real = result
    return f"{100 * error:.1f}" if real else f"({100 * error:.1f})"


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    arms = {arm: results(identified(folder, arm), MODELS[arm]) for arm in COMMANDS}
    print(f"| method | {' | '.join(TITLES[arm] for arm in arms)} |")
    print("|---|" + "---|" * len(arms))
    for method in next(iter(arms.values())):
        print(f"| {method} | {' | '.join(cell(found.get(method)) for found in arms.values())} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    main(Path(sys.argv[1]).resolve())
