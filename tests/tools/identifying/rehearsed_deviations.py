"""Whether the deviations that a rehearsal states cover the truth of further robots.

    python tests/tools rehearsed_deviations [RUNS] [--robot ROBOT] [--seconds S] [--methods NAME,…]

A random Fourier motion is rehearsed as `graphdyn identify --rehearse` does by default, and then with RUNS further
robots, 60 unless given. Prints, for each method, the share of the further errors within twice the stated deviation:
of base parameters, and of masses and centers of mass where all links were physically consistent.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

import urdf
from crosscheck.identifying import REHEARSED_METHODS, Conditions, rehearse
from graphdyn.excitation import TabulatedCourse

PERIOD = 0.01
"""Time between two points of the motion [s]."""


def course(robot: str, seconds: float) -> TabulatedCourse:
    """Five harmonics of 0.1 Hz in every joint."""
    n, rng = urdf.load(robot).nv, np.random.default_rng(1)
    t = np.arange(0, seconds + PERIOD / 2, PERIOD)
    amplitude, phase = rng.normal(size=(2, n, 5)) * np.array([0.35, 3.0])[:, None, None]
    angle = 2 * np.pi * 0.1 * np.arange(1, 6)[:, None] * t
    return TabulatedCourse(t, np.einsum("nk,nkt->tn", amplitude, np.sin(angle + phase[..., None])))


def main() -> int:
    """Exit code: 0."""
    asked = argparse.ArgumentParser(prog="rehearsed_deviations")
    asked.add_argument("runs", nargs="?", type=int, default=60)
    asked.add_argument("--robot", default="ur5")
    asked.add_argument("--seconds", type=float, default=10.0)
    asked.add_argument("--methods", default=",".join(REHEARSED_METHODS))
    options = asked.parse_args()
    motion, methods, conditions = course(options.robot, options.seconds), options.methods.split(","), Conditions()
    stated = rehearse(options.robot, motion, methods=methods, conditions=conditions)
    further = replace(conditions, seed=1, runs=options.runs)
    errors = rehearse(options.robot, motion, methods=methods, conditions=further)
    print(f"{options.robot}, {options.seconds:g} s: errors of {options.runs} robots within 2 σ of a rehearsal")
    for name, outcome in stated.outcomes.items():
        of = errors.outcomes[name]
        shares = [_share(of.base, outcome.base_deviations)]
        if outcome.consistent:
            shares += [_share(of.masses, outcome.mass_deviations), _share(of.centers, outcome.center_deviations)]
        words = zip(("base parameters", "masses", "centers"), shares, strict=False)
        told = f"; stated by time blocks {100 * of.covered:.1f} %" if np.isfinite(of.covered) else ""
        print(f"{name:30} {', '.join(f'{what} {100 * share:.1f} %' for what, share in words)}{told}")
    return 0


def _share(errors: np.ndarray, deviations: np.ndarray) -> float:
    return float(np.mean(np.abs(errors) <= 2 * deviations))
