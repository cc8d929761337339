"""How exactly robots come back from tables of Denavit-Hartenberg parameters: python tests/tools dh_tables [FOLDER ...].

Every serial robot by name, and every *.urdf below the folders (default: the arms of the test data), is written in both
conventions and read again. Prints the largest difference of the flange over 1,000 poses, relative to the reach, and of
the torques; at the end the number of tables, and the worst of all. The exit code is 1 where one exceeds 1e-12.
"""

import argparse
import tempfile
import warnings
from pathlib import Path

import numpy as np
from shared_data import DATA

import urdf
from graphdyn import frame_placement, inverse_dynamics

LARGEST = 1e-12
POSES = 1000


def differences(model, convention, folder):
    """Of flange and torques, relative."""
    path = Path(folder) / "arm.toml"
    urdf.save_dh(model, path, convention)
    table, other = urdf.dh_table(model, convention), urdf.load(path)
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-np.pi, np.pi, (POSES, model.nv)), *rng.normal(size=(2, POSES, model.nv))
    name = table.tool_name if table.tool_name in {frame.name for frame in model.frames} else model.bodies[-1].name
    (turn, here), (turned, there) = frame_placement(model, q, name), frame_placement(other, q, table.tool_name)
    tau, again = inverse_dynamics(model, q, v, a).tau, inverse_dynamics(other, q, v, a).tau
    flange = max(np.abs(there - here).max() / np.abs(here).max(), np.abs(turned - turn).max())
    return float(flange), float(np.abs(again - tau).max() / (np.abs(tau).max() or 1.0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path, default=[DATA / "urdf" / "arms"])
    files = [file for folder in parser.parse_args().folders for file in sorted(folder.rglob("*.urdf"))]
    worst, count = 0.0, 0
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        for robot in (*(entry.name for entry in urdf.robots()), *files):
            try:
                model = urdf.load(robot)
                found = [differences(model, convention, folder) for convention in urdf.CONVENTIONS]
            except urdf.URDFError as error:
                print(f"{Path(robot).stem:32} no table: {str(error)[:100]}")
                continue
            count += len(found)
            worst = max(worst, *(x for pair in found for x in pair))
            print(
                f"{Path(robot).stem:32} {'  '.join(f'flange {x:.1e}, torques {y:.1e}' for x, y in found)}", flush=True
            )
    print(f"{count} tables read again: largest difference {worst:.1e}")
    return worst > LARGEST
