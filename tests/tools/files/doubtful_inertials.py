"""What inspect says of makers' inertials, and of mistakes in them: python tests/tools doubtful_inertials [SEED].

First the number of files with each finding about masses, tensors, meshes and motors, over the makers' arms and the
robots of example-robot-data; every warning is listed. Then mistakes are planted in a random moving link of arms, one at
a time, and counted as named where a finding appears that the sound file does not have.
"""

import re
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from lxml import etree
from shared_data import ARMS, DATA

import urdf
from urdf.inspection import compared

CODES = (
    *("inertial-density", "miswritten-inertia", "mesh-density", "center-outside-mesh", "inertia-unlike-mesh"),
    *("effort-below-gravity", "effort-below-inertia", "heavy-link", "heaviest-link"),
    *("equal-inertials", "unlike-twin", "other-density", "inertia-across-link"),
)
ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
WITH_MESHES = ("ur3", "ur5", "ur10", "kinova", "xarm7", "panda", "z1", "talos_left_arm", "tiago_dual", "solo12", "go2")
NOT_NAMED = ("off-diagonal-inertia", "inertial-rotated", "isotropic-inertia", "mass-matrix", "mesh-files", "loop-rows")
"""Findings that say how something is written, not that it is doubtful."""

MIN_MASS = 0.05
"""Lighter links are often placeholders [kg]."""


def heavier(factor):
    return lambda mass, tensor, rng: (factor * mass, tensor)


def scaled(factor):
    return lambda mass, tensor, rng: (mass, factor * tensor)


def exchanged(mass, tensor, rng):
    one, other = rng.choice(6, 2, replace=False)
    found = tensor.copy()
    found[[one, other]] = tensor[[other, one]]
    return mass, found


PLANTED = {
    "mass × 10": heavier(10),
    "mass × 1000": heavier(1000),
    "mass / 1000": heavier(0.001),
    "mass × 7.85": heavier(7.85),
    "body × 7.85": lambda mass, tensor, rng: (7.85 * mass, 7.85 * tensor),
    "tensor × 10⁶": scaled(1e6),
    "tensor × 1000": scaled(1e3),
    "tensor / 1000": scaled(1e-3),
    "two entries exchanged": exchanged,
    "xx yy zz xy xz yz": lambda mass, tensor, rng: (mass, tensor[[0, 3, 5, 1, 2, 4]]),
    "products negated": lambda mass, tensor, rng: (mass, tensor * [1, -1, -1, 1, -1, 1]),
}


def known_files():
    """The makers' arms, and the robots of example-robot-data by name."""
    arms = [*sorted(ARMS.glob("*.urdf")), DATA / "data" / "tx40" / "tx40.urdf"]
    return arms, {entry.name: entry.path for entry in urdf.robots()}


def counts(files):
    found = compared([urdf.inspect(path) for path in files])
    for severity in ("warning", "note"):
        of = Counter(
            code for report in found for code in {one.code for one in report.findings if one.severity == severity}
        )
        for code in CODES:
            print(f"{code:22} {severity:8} {of[code]:4} of {len(files)} files", flush=True)
    for report in found:
        for one in report.findings:
            if one.severity == "warning" and one.code in CODES:
                print(f"  {Path(report.robot).name}: {one.text} [{one.code}]")


def told(path):
    return {
        (one.code, one.element, one.message if one.element is None else "")
        for one in urdf.inspect(path).findings
        if one.code not in NOT_NAMED
    }


def planted(path, plant, rng):
    """The file with a mistake, as bytes; None where it would change less than a tenth of the tensor."""
    root = etree.parse(str(path)).getroot()
    moving = urdf.load(path).body_names
    inertials = {link.get("name"): link.find("inertial") for link in root.iterfind("link")}
    for name in rng.permutation([name for name in moving if inertials.get(name) is not None]):
        mass, inertia = inertials[name].find("mass"), inertials[name].find("inertia")
        before = float(mass.get("value")), np.array([float(inertia.get(entry)) for entry in ENTRIES])
        if before[0] < MIN_MASS or not before[1].any():
            continue
        after = plant(*before, rng)
        if after[0] == before[0] and np.abs(after[1] - before[1]).max() < 0.1 * np.abs(before[1]).max():
            continue
        mass.set("value", repr(float(after[0])))
        for entry, value in zip(ENTRIES, after[1], strict=True):
            inertia.set(entry, repr(float(value)))
        return etree.tostring(root)
    return None


def named(files, rng):
    for kind, plant in PLANTED.items():
        results = [result for path in files if (result := is_named(path, plant, rng)) is not None]
        print(f"{kind:22} {sum(results):3} of {len(results)} named", flush=True)
        yield from results


def is_named(path, plant, rng):
    """Whether a mistake in this file is named; None where there is none to plant."""
    content = planted(path, plant, rng)
    if content is None:
        return None
    beside = path.with_name(f"planted_{path.name}")  # where its meshes are found
    try:
        beside.write_bytes(content)
        return bool(told(beside) - told(path))
    finally:
        beside.unlink(missing_ok=True)


def copied(path, folder):
    """The file below a folder, with everything beside it that its mesh paths may name."""
    text = path.read_text(encoding="utf-8", errors="replace")
    package = re.search(r"package://example-robot-data/robots/([^/]+)/", text)
    root = next((parent for parent in path.parents if package and parent.name == package[1]), None)
    there = Path(folder) / "example-robot-data" / "robots"
    if root is None:
        return Path(shutil.copy(path, folder))
    if not (there / root.name).exists():
        shutil.copytree(root, there / root.name)
    return there / root.name / path.relative_to(root)


def main():
    arms, robots = known_files()
    counts([*arms, *robots.values()])
    rng = np.random.default_rng(int(sys.argv[1]) if len(sys.argv) > 1 else 0)
    with tempfile.TemporaryDirectory() as folder:
        chosen = [*arms, *(robots[name] for name in WITH_MESHES if name in robots)]
        sound = [copied(path, folder) for path in chosen if urdf.inspect(path).verdict == "dynamics"]
        results = list(named(sound, rng))
    print(f"{sum(results)} of {len(results)} planted mistakes named")
