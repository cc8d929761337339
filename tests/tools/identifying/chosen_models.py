"""Which torque models choose themselves on simulated arms: python tests/tools chosen_models [SEEDS [aside]].

Every planted model of the drives (rows of the table) is simulated on arms of six axes: 20 s at 250 Hz, each parameter
with a torque of 5 % of its joint's, 1 % white noise and 1 % noise correlated over 0.1 s, CAD with errors of up to 20 %.
Widths, velocities and deflections are others than those that are tried. The ladder is climbed on one motion, and its
model, and fixed ones, predict another. Printed are

    error      of the chosen model on the other motion, mean over the seeds [%]
    best       ratio to the fixed model with the smallest error over all seeds, mean and largest [%]
    false      parts of the chosen models that were not planted
    chosen     how often each part was taken

SEEDS is their number, 4 if left out. With `aside` other seeds and arms are used, on which nothing was tuned.
"""

import sys
from collections import Counter
from dataclasses import replace

import numpy as np
from shared_data import ARMS

from crosscheck.identifying import Preparation, virtual_robot
from crosscheck.identifying.choosing.drive_models import DriveModel, every_term
from crosscheck.identifying.choosing.ladder import LADDER_ROWS, climbed
from crosscheck.recordings import concatenated
from graphdyn.identification import TorqueModel
from graphdyn.identification.choosing import RobustFolds, TermColumns, every_row
from graphdyn.identification.terms import (
    Coulomb,
    LoadFriction,
    MaxwellSlip,
    Offset,
    RigidBodies,
    RotorInertia,
    SmoothCoulomb,
    Stribeck,
    Viscous,
)

SECONDS = 20.0

NOISE, NOISE_TIME = 0.01, 0.1
"""Correlated noise relative to the torque, and its correlation time [s]."""

PLANTED = {
    "Coulomb": ((Viscous(), Coulomb()), {"curve"}),
    "Coulomb, offsets": ((Viscous(), Coulomb(), Offset()), {"offsets"}),
    "Coulomb, rotors": ((Viscous(), Coulomb(), RotorInertia()), {"rotors"}),
    "smooth, offsets": ((Viscous(), SmoothCoulomb((0.05, 0.4)), Offset()), {"curve", "offsets"}),
    "load, offsets": ((Viscous(), Coulomb(0.03), LoadFriction(0.03), Offset()), {"load", "curve", "offsets"}),
    "Stribeck": ((Viscous(), Coulomb(), Stribeck(0.08)), {"curve"}),
    "slip, offsets": ((Viscous(), MaxwellSlip((0.02,)), Offset()), {"memory", "offsets"}),
    "smooth, load, rotors, offsets": (
        (Viscous(), SmoothCoulomb((0.05, 0.4)), LoadFriction(0.1), RotorInertia(), Offset()),
        {"curve", "load", "rotors", "offsets"},
    ),
}
"""Terms, and the parts of a DriveModel that may differ from viscous and Coulomb friction."""

FIXED = {
    "standard": DriveModel(offsets="offsets"),
    "Coulomb": DriveModel(),
    "rotors": DriveModel(rotors="rotors", offsets="offsets"),
    "Stribeck": DriveModel("Stribeck, velocity 0.05", offsets="offsets"),
    "smooth": DriveModel("smooth", offsets="offsets"),
    "load": DriveModel(load="load", offsets="offsets"),
    "slip": DriveModel(memory="slip, 0.01", offsets="offsets"),
    "everything": DriveModel("smooth", "load", "slip, 0.01", "rotors", offsets="offsets"),
    "smooth, load, rotors": DriveModel("smooth", "load", rotors="rotors", offsets="offsets"),
}

ROBOTS, ASIDE_ROBOTS = ("ur5", "ur10", "kr500"), ("m1013", "crx10ia_l", "ur10e")
"""Names of the catalog, and arms of three makers."""


def main():
    seeds, aside = int(sys.argv[1]) if len(sys.argv) > 1 else 4, "aside" in sys.argv
    print(f"{'planted':30} {'error':>6} {'best fixed':>22} {'ratio':>6} {'largest':>8} {'false':>6}  chosen")
    wrong = runs = 0
    for name, (terms, parts) in PLANTED.items():
        errors, own, chosen, false = [], [], Counter(), 0
        for k in range(seeds):
            robots = [str(ARMS / f"{arm}.urdf") for arm in ASIDE_ROBOTS] if aside else ROBOTS
            model, of_ladder, of_fixed = _measured(robots[k % len(robots)], terms, 1000 + k if aside else k)
            taken = {part for part, start in vars(DriveModel()).items() if getattr(model, part) != start}
            chosen.update(getattr(model, part) for part in taken)
            false += bool(taken - parts)
            own.append(of_ladder)
            errors.append(of_fixed)
        fixed = np.array(errors)
        best = int(np.argmin(fixed.mean(axis=0)))
        ratio = np.array(own) / fixed[:, best]
        wrong, runs = wrong + false, runs + seeds
        print(
            f"{name:30} {100 * np.mean(own):6.2f} {list(FIXED)[best]:>22} {ratio.mean():6.3f} {ratio.max():8.3f} "
            f"{false:6d}  {', '.join(f'{part} {count}' for part, count in chosen.most_common())}",
            flush=True,
        )
    print(f"parts that were not planted: in {wrong} of {runs} runs")


def _measured(robot, terms, seed):
    """The chosen model, its error on the other motion, and those of the fixed models."""
    arm, preparation = virtual_robot(robot, terms, seconds=SECONDS, seed=seed), Preparation()
    rng = np.random.default_rng(seed)
    fitted, other = (preparation.differentiated(_noisy(one, rng)) for one in (arm.fitted, arm.held_out))
    ladder = climbed(arm.subject.model, (RigidBodies(),), (), fitted, preparation)
    if ladder.reason:
        raise SystemExit(f"{robot}: {ladder.reason}")
    both = concatenated([fitted, other])
    rows = np.arange(len(both.t)) < len(fitted.t)
    every, additions = every_row(int(rows.sum()), LADDER_ROWS), every_term()
    problem = preparation.problem(TorqueModel(arm.subject.model, (RigidBodies(), Viscous())), both)
    columns = TermColumns.of(problem, additions, every)
    train = rows[::every]
    columns = replace(columns, kept=columns.kept & train[:, None])
    fits = RobustFolds(columns, additions, [(train, ~train)])
    errors = [fits.fit(model.keys).errors.mean for model in (ladder.model, *FIXED.values())]
    return ladder.model, errors[0], errors[1:]


def _noisy(recording, rng):
    """The recording with noise of the torques that is correlated in time."""
    white = rng.normal(size=recording.tau.shape)
    decay = np.exp(-float(np.median(np.diff(recording.t))) / NOISE_TIME)
    noise = np.zeros_like(white)
    for t in range(1, len(noise)):
        noise[t] = decay * noise[t - 1] + np.sqrt(1 - decay**2) * white[t]
    size = np.sqrt(np.mean(recording.tau**2, axis=0))
    return replace(recording, tau=recording.tau + NOISE * size * noise)
