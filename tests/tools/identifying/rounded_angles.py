"""Whether an arm with rounded angles is identified like its exact twin: python tests/tools rounded_angles [ARM…].

Every right angle of a maker's arm is written with all digits, with five (1.5708) and with three (1.57); the file as it
stands is the fourth variant. Terms: bodies, rotors, viscous and dry friction. Printed per variant: base parameters
with the angles as written, and without those that only the rounding shows; then the largest relative difference of the
errors of a study of two runs from those of the exact twin. Joints that others drive are locked.
"""

import re
import sys
import tempfile
from pathlib import Path

import numpy as np
from identified.small_study import InThisProcess, study_of
from shared_data import ARMS, DATA

import urdf
from crosscheck.study.running import run_study
from crosscheck.study.statistics.outcomes import ERRORS, read_outcomes
from graphdyn import gravity_torque, mass_matrix
from graphdyn.identification import TorqueModel
from graphdyn.identification.problem.torque_model import structure
from graphdyn.identification.terms import Coulomb, RigidBodies, RotorInertia, Viscous

TERMS = (RigidBodies(), RotorInertia(), Viscous(), Coulomb())
CATALOG = ("kr500", "ur5")
DIGITS = {"exact": 17, "as written": None, "1.5708": 5, "1.57": 3}
ROUNDED = 2e-3
"""Difference from a right angle up to which an angle of a file stands for it [rad]."""

MAX_DIFFERENCE = 0.1
"""Of the errors of a study."""

STUDY = """
[study]
runs = 2
methods = ["wls", "ridge"]

[robot]
name = "arm.urdf"
mimic = "locked"
viscous = {viscous}
coulomb = {coulomb}
rotor_inertia = {rotors}

[scenario]
duration = 5
sampling_rate = 200
control_rate = 200
cutoff = 20
position_noise = 1e-5
torque_noise = {noise}
"""


def with_digits(text, digits):
    """The text of a file whose right angles are written with this many digits; None: as they stand."""

    def written(word):
        turns = round(float(word) / (np.pi / 2))
        near = turns and abs(float(word) - turns * np.pi / 2) < ROUNDED
        return f"{turns * np.pi / 2:.{digits}g}" if near else word

    def attribute(match):
        return f'rpy="{" ".join(map(written, match[1].split()))}"'

    return text if digits is None else re.sub(r'\brpy\s*=\s*"([^"]*)"', attribute, text)


def study_text(model):
    """Drives of a size that suits the robot, the same for all variants."""
    q, _ = model.random_state(np.random.default_rng(0), 50)
    inertia = np.einsum("kjj->kj", mass_matrix(model, q)).mean(axis=0)
    weight = np.abs(gravity_torque(model, q)).max(axis=0) + 10 * inertia
    lists = {"viscous": weight / 50, "coulomb": weight / 50, "rotors": inertia / 3 + 1e-6}
    words = {name: [float(f"{value:.3g}") for value in values] for name, values in lists.items()}
    return STUDY.format(noise=float(f"{weight.max() / 1000:.3g}"), **words)


def errors(text, settings):
    """(runs, methods) of each error of a study of this file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.urdf").write_text(text, encoding="utf-8")
        run_study(study_of(folder, settings), Path(folder) / "out", InThisProcess())
        (scenario,) = read_outcomes(Path(folder) / "out").scenarios
    return np.array([scenario.errors[name] for name in ERRORS])


def row(name, path):
    """Whether each variant of an arm has the rank and the errors of the exact one."""
    text = path.read_text(encoding="utf-8")
    variants = {of: with_digits(text, digits) for of, digits in DIGITS.items()}
    settings = study_text(urdf.load(variants["exact"], mimic="locked"))
    alike, shown, exact = [], [], None
    for variant in variants.values():
        model = urdf.load(variant, mimic="locked")
        written, found = (structure(TorqueModel(model, TERMS, exact_angles=k)).base.rank for k in (False, True))
        of_study = errors(variant, settings)
        exact = exact or (found, of_study)
        apart = (np.abs(of_study - exact[1]) / exact[1]).max(initial=0, where=of_study != exact[1])
        alike.append(found == exact[0] and apart <= MAX_DIFFERENCE)
        shown.append(f"{written:3} {found:3} {100 * apart:6.2f} % {'' if alike[-1] else 'DIFFERS':7}")
    print(f"{name:36}  {'  '.join(shown)}", flush=True)
    return alike


def main():
    known = {entry.name: entry.path for entry in urdf.robots() if entry.name in CATALOG}
    files = {path.stem: path for path in (*sorted(ARMS.glob("*.urdf")), DATA / "data" / "tx40" / "tx40.urdf")} | known
    print(f"{'arm':36}  {'  '.join(f'{of:24}' for of in DIGITS)}")
    alike = np.array([row(name, files[name]) for name in sys.argv[1:] or files])
    counts = ", ".join(f"{of} {n}" for of, n in zip(DIGITS, alike.sum(axis=0), strict=True))
    print(f"rank of the exact twin, and errors within {100 * MAX_DIFFERENCE:g} %: {counts} of {len(alike)} arms")
