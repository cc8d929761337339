"""How well loads are found from currents with unknown gains: python tests/tools loads_from_currents [RUNS [ROBOT…]].

A load of 2.8 kg on simulated six-axis arms. Friction, links and gains are unknown; the currents have a residual of 5 %
of their size, correlated by 0.7 from row to row (50 Hz, 40 s a recording). The size of torques comes from a known mass
of 4 kg in a third recording, fitted together; from gains that this mass gave before, with an empty recording of its
own; from links whose masses and centers are trusted to 5 % each (the true links deviate by as much); or from gains that
a data sheet states to 3 %. Printed are the error of the mass as root mean square, and how often twice the standard
deviation covers the truth, of the mass and of all ten parameters.

The robots are names, URDF files, or `aside`: arms on which nothing was tuned.
"""

import sys
from pathlib import Path

import numpy as np
from identified.loaded_arm import WANTED, WEIGHED, LoadedArm, random_gains
from shared_data import ARMS

import urdf
from graphdyn.identification.currents import JointGains, KnownLoad, TrustedGravity, fit_currents

ASIDE = ("m1013", "gp8l", "kr16_r1610_2", "irb2400", "tx2_60l", "rv7frl")
"""Arms of six axes from six makers."""

SECONDS = 40.0
RUNS_PER_MOTION = 10
TRUSTED, SHEET = 0.05, 0.03


def main() -> None:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    names = sys.argv[2:] or ["ur5", "ur10"]
    if names == ["aside"]:
        names = [str(ARMS / f"{name}.urdf") for name in ASIDE]
    print(f"Load of 2.8 kg, {runs} runs each: error of its mass [%], parts within two standard deviations [%]")
    print(f"{'arm':14} {'known':18} {'RMS':>6} {'mean σ':>7} {'mass covered':>13} {'ten parameters':>15} {'gains':>6}")
    for name in names:
        for known, rows in measured(urdf.load(name), runs).items():
            errors, sigma, inside, of_gains = (np.array(part) for part in zip(*rows, strict=True))
            print(
                f"{Path(name).stem:14} {known:18} {100 * np.sqrt(np.mean(errors**2)):6.2f} {100 * sigma.mean():7.2f} "
                f"{100 * inside[:, 0].mean():13.1f} {100 * inside.mean():15.1f} {100 * np.nanmean(of_gains):6.1f}",
                flush=True,
            )


def measured(model, runs):
    """By what is known: error of the mass, its σ, which parameters are covered (10,), which gains (n,)."""
    rng = np.random.default_rng(0)
    found = {}
    for run in range(runs):
        if run % RUNS_PER_MOTION == 0:
            arm = LoadedArm.of(model, rng)
            motions = [arm.motion(rng, SECONDS, load) for load in (None, WEIGHED, WANTED, None)]
        gains = random_gains(rng, model.nv)
        loads = (None, "weighed", "wanted", None)
        empty, weighed, wanted, other = (
            arm.recorded(motion, gains, rng, load) for motion, load in zip(motions, loads, strict=True)
        )
        mass = {"weighed": KnownLoad(WEIGHED[0])}
        before = fit_currents(arm.torque_model, [empty, weighed], known_loads=mass).gains
        stated = JointGains.stated(gains * np.exp(SHEET * rng.normal(size=model.nv)), SHEET)
        trusted = LoadedArm.of(model, rng, TRUSTED)
        pair = [
            trusted.recorded(trusted.motion(rng, SECONDS, load), gains, rng, name)
            for load, name in ((None, None), (WANTED, "wanted"))
        ]
        fits = {
            "mass, together": fit_currents(arm.torque_model, [empty, weighed, wanted], known_loads=mass),
            "mass, before": fit_currents(arm.torque_model, [other, wanted], gains=before),
            "links to 5 %": fit_currents(trusted.torque_model, pair, gravity=TrustedGravity(TRUSTED)),
            "gains to 3 %": fit_currents(arm.torque_model, [other, wanted], gains=stated),
        }
        for known, fit in fits.items():
            load = fit.loads["wanted"]
            inside = np.abs(load.parameters - WANTED) <= 2 * np.sqrt(np.diag(load.covariance))
            of_gains = np.abs(np.log(fit.gains.values / gains)) <= 2 * fit.gains.relative_deviations
            row = (load.mass / WANTED[0] - 1, load.mass_deviation / WANTED[0], inside, of_gains)
            found.setdefault(known, []).append(row)
    return found
