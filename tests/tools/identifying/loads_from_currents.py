"""How well loads are found from currents with unknown gains: python tests/tools loads_from_currents [RUNS [ROBOT…]].

A load of 2.8 kg on simulated six-axis arms. Friction, links and gains are unknown; the currents have a residual of 5 %
of their size, correlated by 0.7 from row to row (50 Hz, 40 s a recording). The size of torques comes from a known mass
of 4 kg in a third recording, fitted together; from gains that this mass gave before, with an empty recording of its
own; or from gains that a data sheet states to 3 %. With --links it comes from masses and centers of the links that are
trusted to 5 % each, and the true links deviate by as much. Printed are the error of the mass as root mean square, its
mean deviation, and how often twice the deviation covers the truth: of the mass, of the center of mass, of the tensor
about the origin of the link, and of the gains.

The robots are names, URDF files, or `aside`: arms on which nothing was tuned. --mass, --seconds, --amplitude and --seed
change the load, the length and the speed of the motions, and the random numbers.
"""

import argparse
from collections import defaultdict
from pathlib import Path

import numpy as np
from identified.loaded_arm import AMPLITUDE, LoadedArm, random_gains
from shared_data import ARMS

import urdf
from graphdyn.identification.currents import JointGains, KnownLoad, TrustedGravity, fit_currents
from graphdyn.model import parameters_from_inertia

ASIDE = ("m1013", "kr16_r1610_2", "irb2400", "tx2_60l", "ur10e")
"""Arms of six axes from five makers."""

RUNS_PER_MOTION = 5
TRUSTED, SHEET, KNOWN = 0.05, 0.03, 4.0


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("runs", type=int, nargs="?", default=400)
    parser.add_argument("robots", nargs="*", default=["ur5", "ur10"])
    parser.add_argument("--links", action="store_true")
    for name, default in (("mass", 2.8), ("seconds", 40.0), ("amplitude", AMPLITUDE)):
        parser.add_argument(f"--{name}", type=float, default=default)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    names = [str(ARMS / f"{name}.urdf") for name in ASIDE] if asked.robots == ["aside"] else asked.robots
    print(f"Load of {asked.mass:g} kg, {asked.runs} runs each: mass [%], parts within two standard deviations [%]")
    print(f"{'arm':14} {'known':15} {'RMS':>6} {'mean σ':>7} {'mass':>6} {'center':>7} {'tensor':>7} {'gains':>6}")
    for name in names:
        measured = of_links if asked.links else of_gains
        for known, fits in measured(urdf.load(name), asked).items():
            print(f"{Path(name).stem:14} {known:15} {line(fits)}", flush=True)


def line(fits) -> str:
    """Errors and coverage of pairs of a fit and the truth: load and gains."""
    mass = np.array([fit.loads["x"].mass / load[0] - 1 for fit, load, _ in fits])
    sigma = np.array([fit.loads["x"].mass_deviation / load[0] for fit, load, _ in fits])
    centers = [
        np.abs(fit.loads["x"].center_of_mass - load[1:4] / load[0]) <= 2 * fit.loads["x"].center_deviations
        for fit, load, _ in fits
    ]
    tensors = [
        np.abs(fit.loads["x"].parameters - load)[4:] <= 2 * np.sqrt(np.diag(fit.loads["x"].covariance))[4:]
        for fit, load, _ in fits
    ]
    gains = [
        (np.abs(np.log(fit.gains.values / true)) <= 2 * fit.gains.relative_deviations)[fit.gains.determined]
        for fit, _, true in fits
    ]
    covered = [np.abs(mass) <= 2 * sigma, np.concatenate(centers), np.concatenate(tensors), np.concatenate(gains)]
    shares = " ".join(f"{100 * np.mean(part):{width}.1f}" for part, width in zip(covered, (6, 7, 7, 6), strict=True))
    return f"{100 * np.sqrt(np.mean(mass**2)):6.2f} {100 * sigma.mean():7.2f} {shares}"


def of_gains(model, asked):
    """By what is known of the gains: fits, true loads and true gains."""
    rng, found = np.random.default_rng(asked.seed), defaultdict(list)
    weighed = parameters_from_inertia(KNOWN, np.array([-0.01, 0.01, 0.1]), np.diag([0.02, 0.02, 0.01]))
    for run in range(asked.runs):
        if run % RUNS_PER_MOTION == 0:
            arm = LoadedArm.of(model, rng)
            load = wanted(rng, asked.mass)
            motions = [
                arm.motion(rng, asked.seconds, carried, amplitude=asked.amplitude)
                for carried in (None, weighed, load, None)
            ]
        gains = random_gains(rng, model.nv)
        names = (None, "w", "x", None)
        empty, known, loaded, other = (
            arm.recorded(motion, gains, rng, name) for motion, name in zip(motions, names, strict=True)
        )
        stated = JointGains.stated(gains * np.exp(SHEET * rng.normal(size=model.nv)), SHEET)
        mass = {"w": KnownLoad(KNOWN)}
        before = fit_currents(arm.torque_model, [empty, known], known_loads=mass).gains
        fits = {
            "mass, together": fit_currents(arm.torque_model, [empty, known, loaded], known_loads=mass),
            "mass, before": fit_currents(arm.torque_model, [other, loaded], gains=before),
            "gains to 3 %": fit_currents(arm.torque_model, [other, loaded], gains=stated),
        }
        for name, fit in fits.items():
            found[name].append((fit, load, gains))
    return found


def of_links(model, asked):
    """With trusted links: fits, true loads and true gains."""
    rng, found = np.random.default_rng(asked.seed), []
    for _ in range(asked.runs):
        arm, load, gains = LoadedArm.of(model, rng, TRUSTED), wanted(rng, asked.mass), random_gains(rng, model.nv)
        pair = [
            arm.recorded(arm.motion(rng, asked.seconds, carried, amplitude=asked.amplitude), gains, rng, name)
            for carried, name in ((None, None), (load, "x"))
        ]
        fit = fit_currents(arm.torque_model, pair, gravity=TrustedGravity(TRUSTED))
        found.append((fit, load, gains))
    return {"links to 5 %": found}


def wanted(rng, mass):
    """A load of this mass, at a random distance from the last link (10,)."""
    center = np.array([0.02, -0.01, 0.08]) * rng.uniform(0.3, 2)
    return parameters_from_inertia(mass, center, np.diag([0.01, 0.012, 0.008]) * mass / 2.8)
