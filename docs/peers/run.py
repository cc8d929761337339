"""Judge the dynamics libraries that are installed, and undo what makes them differ.

    python docs/peers/run.py                                   every peer that is installed, every robot
    python docs/peers/run.py --peers mujoco drake --robots ur5 arm.urdf --json peers.json

Each peer_NAME.py loads a URDF file with one library and gives functions for crosscheck.judge; CAUSES are the
differences that it can undo. Where a library does not agree, the smallest set of causes is sought without which it
does; of several causes, each is judged alone, with the others undone.
Each pair runs in a process of its own. Exit code 0: every peer answered; 1: one ended without an answer.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

HERE = Path(__file__).parent
ROBOTS = ("ur5", "kr500", "kinova", "z1")
ARMS = ("kr210_r2700_2", "ur5e", "crx10ia_l", "vs060")
"""Of the folder urdf/arms in GRAPHDYN_TEST_DATA, where it is set."""
TIME_LIMIT = 300  # s


def main():
    known = {path.stem.removeprefix("peer_"): path for path in sorted(HERE.glob("peer_*.py"))}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", nargs="+", choices=known, default=list(known), help="default: those installed")
    parser.add_argument("--robots", nargs="+", default=None, help="names or files; default: " + ", ".join(ROBOTS))
    parser.add_argument("--json", type=Path, help="write all verdicts to this file")
    given = parser.parse_args()
    robots = [*ROBOTS, *_arms()] if given.robots is None else given.robots
    packages = {peer: re.search(r'^PACKAGE = "(.+)"$', known[peer].read_text(), re.M)[1] for peer in given.peers}
    present = {peer: found for peer, package in packages.items() if (found := _version(package))}
    rows = []
    for peer in present:
        for robot in robots:
            rows.append({"peer": peer, "robot": Path(robot).stem, **_judged(peer, robot)})
            print(_line(rows[-1], present[peer]), flush=True)
    for peer in sorted(packages.keys() - present.keys()):
        print(f"{peer}: not installed; pip install {packages[peer]}")
    if given.json:
        absent = {peer: package for peer, package in packages.items() if peer not in present}
        given.json.write_text(json.dumps({"rows": rows, "absent": absent}, indent=1) + "\n")
    return int(any("failure" in row for row in rows))


def _arms():
    data = os.environ.get("GRAPHDYN_TEST_DATA")
    files = [Path(data, "urdf", "arms", f"{name}.urdf") for name in ARMS] if data else []
    return [str(file) for file in files if file.exists()]


def _version(package):
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _judged(peer, robot):
    command = [sys.executable, str(HERE / "one.py"), peer, robot]
    try:
        ended = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return {"failure": f"no answer within {TIME_LIMIT} s"}
    if ended.returncode or not ended.stdout:
        last = ended.stderr.strip().splitlines()[-1:] or [""]
        return {"failure": f"ended with code {ended.returncode}: {last[0]}"}
    return json.loads(ended.stdout)


def _line(row, installed):
    start = f"{row['peer']} {installed}, {row['robot']}: "
    if "failure" in row:
        return start + row["failure"]
    if row["agrees"]:
        return start + f"agrees, error at most {max(row['errors'].values()):.0e}"
    if "refusal" in row:
        lines = [f"{start}does not read the file: {row['refusal']}"]
    else:
        lines = [f"{start}does not agree, error up to {max(row['errors'].values()):.0e}"]
        lines += [f"    {x['function']}: {x['status']}: {x['message']}" for x in row["diagnoses"]]
    if row["undone"] is None:
        return "\n".join([*lines, "    no set of causes undone makes it agree"])
    for cause, messages in row["alone"].items():
        lines += [f"    {cause} alone: {message}" for message in messages]
    undone = " and ".join(row["undone"])
    return "\n".join([*lines, f"    agrees without {undone}: {max(row['errors_undone'].values()):.0e}"])


if __name__ == "__main__":
    sys.exit(main())
