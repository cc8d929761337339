"""Whether the stated deviations of delays cover the truth: python tests/tools recorded_delays [LOGS [ROBOT…]].

Simulated logs of random motions, 10 to 25 s long at 100 to 500 Hz, whose torques are recorded up to 40 ms early or
late. The assumed friction is viscous and Coulomb. The true one is so in a seventh of the logs; otherwise it falls with
speed (Stribeck), grows with the load, depends on the direction, is curved, waves with the position, or sets in like a
spring before a joint slips. Noise of 1 to 5 % of the torques is correlated over 3 to 160 ms. Each log is prepared with
three cutoffs.

Printed are the share of logs within two standard deviations, the root mean square of the error and the median standard
deviation, by cutoff, friction, motion and robot. The robots are names, URDF files, or `aside`: arms on which nothing
was tuned, with other seeds.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from identified.delayed_arm import delayed_log
from shared_data import ARMS

import urdf
from crosscheck.identifying import Preparation, friction_terms
from graphdyn.identification import TorqueModel
from graphdyn.identification.data_quality.search.examined import Examined
from graphdyn.identification.terms import RigidBodies

CUTOFFS = (4.0, 10.0, "residual")
"""[Hz]"""

TUNED = ("ur5", "ur10", *(str(ARMS / f"{name}.urdf") for name in ("kr210_r2700_2", "crx10ia_l", "aubo_i5")))
ASIDE = tuple(str(ARMS / f"{name}.urdf") for name in ("m1013", "z1", "ur10e", "vs060", "dof6xarm"))
FIRST_SEED_ASIDE = 100_000
SHOWN_AFTER = 50
"""Logs after which a line is printed for all so far."""


def main() -> None:
    logs = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    names = sys.argv[2:] or [*TUNED]
    first = 0
    if names == ["aside"]:
        names, first = [*ASIDE], FIRST_SEED_ASIDE
    rows = []
    print(f"{'':24} {'rows':>6} {'within 2 σ [%]':>15} {'RMS error [ms]':>15} {'median σ [ms]':>14}")
    for number in range(logs):
        name = names[number % len(names)]
        rows += measured(name, first + number)
        if (number + 1) % SHOWN_AFTER == 0 or number + 1 == logs:
            show(f"all of {number + 1} logs", rows)
    for key in ("cutoff", "friction", "motion", "robot"):
        for value in dict.fromkeys(row[key] for row in rows):
            show(f"{key} {value}", [row for row in rows if row[key] == value])


def measured(name, seed):
    """Of one log, per cutoff: the error and σ of the delay [s], and what the log is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = urdf.load(name)
    log = delayed_log(model, seed)
    assumed = TorqueModel(model, (RigidBodies(), *friction_terms(["viscous", "coulomb", "offset"])))
    rows = []
    for cutoff in CUTOFFS:
        pieces, _ = Preparation(cutoff).pieces(log.recording)
        lag = Examined.of(assumed, pieces, 0.0).delays
        kind = {"cutoff": cutoff, "friction": log.friction, "motion": log.motion, "robot": Path(name).stem}
        rows.append(kind | {"error": lag.common - log.delay, "deviation": lag.deviation})
    return rows


def show(what, rows):
    error, deviation = (np.array([row[key] for row in rows]) for key in ("error", "deviation"))
    print(
        f"{what:24} {len(rows):6} {100 * np.mean(np.abs(error) <= 2 * deviation):15.1f} "
        f"{1e3 * np.sqrt(np.mean(error**2)):15.2f} {1e3 * np.median(deviation):14.2f}",
        flush=True,
    )
