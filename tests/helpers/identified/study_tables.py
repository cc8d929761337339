"""Tables of a study made by hand: methods whose bias, spread and failures are known, over noises and motions."""

from itertools import product

import numpy as np

from crosscheck.study.statistics.outcomes import DISTANCES

NAMES = ("ZZ_1 + M_2", "XX_2", "XY_2", "MX_2", "Fv_1", "Fc_1")
UNITS = ("kg m²", "kg m²", "kg m²", "kg m", "N m s", "N m")
TRUTH = np.array([4.0, 1.0, -0.2, 6.0, 10.0, 5.0])
NOISES = (1e-3, 1e-2)

METHODS = {  # name: (measures, bias / noise, spread / noise, share that fails at the largest noise, seconds)
    "ols": ("torques", 6.0, 1.0, 0.0, 0.02),
    "wls": ("torques", 3.0, 0.8, 0.0, 0.03),
    "wls-pinocchio": ("torques", 3.0, 0.8, 0.0, 0.05),
    "iv": ("torques", 0.0, 0.7, 0.0, 0.6),
    "didim": ("torques", 0.0, 0.6, 0.2, 0.7),
    "cloe": ("torques", 0.0, 0.6, 0.8, 9.0),
    "graph": ("wrenches", 0.5, 0.2, 0.0, 0.1),
}


def study_tables(runs=6, seed=0, motions=("Fourier", "paper")):
    """Rows of results, scenarios and times, as in the Parquet files; wrenches are measured in Fourier motions alone."""
    results, scenarios, times = [], [], []
    for noise, motion in product(NOISES, motions):
        name = f"position_noise={noise:g},motion={motion}"
        grid = {"position_noise": noise, "torque_noise": 50 * noise, "motion": motion}
        named = {"base_names": list(NAMES), "base_units": list(UNITS), "truth": TRUTH.tolist()}
        scenarios.append({"scenario": name, **grid, **named})
        for run in range(runs):
            shared = np.random.default_rng([seed, len(scenarios), run]).normal(size=len(TRUTH))
            methods = [method for method in METHODS if motion == "Fourier" or METHODS[method][0] == "torques"]
            rows = [_row(name, run, method, noise * (5 if motion == "paper" else 1), shared) for method in methods]
            results += rows
            times += [
                {key: row[key] for key in ("scenario", "run", "method", "redrawn", "repeat")}
                | {"processor_seconds": METHODS[row["method"]][4] * (1 + 0.1 * run**2)}
                for row in rows
            ]
    return results, scenarios, times


def _row(scenario, run, method, noise, shared):
    measures, bias, spread, failing, _ = METHODS[method]
    row = {"scenario": scenario, "run": run, "method": method, "measures": measures, "status": "found", "reason": None}
    row |= {"redrawn": None, "repeat": 0} | dict.fromkeys(DISTANCES)
    numbers = ("iterations", "simulations", "base", "sigma", "parameter_error", "torque_error", "trajectory_error")
    if noise >= NOISES[-1] and (run + 0.5) / 10 < failing / 2:
        reason = "no convergence after 50 iterations"
        return row | dict.fromkeys((*numbers, "consistent")) | {"status": "failed", "reason": reason}
    base = TRUTH * (1 + noise * (bias + spread * shared))
    error = float(np.linalg.norm((base - TRUTH) / TRUTH) / np.sqrt(len(TRUTH)))
    iterative = 4 + run % 2 if method in ("iv", "didim", "cloe") else None
    return row | {
        "iterations": iterative,
        "simulations": iterative,
        "base": base.tolist(),
        "sigma": (noise * spread * np.abs(TRUTH)).tolist(),
        "parameter_error": error,
        "torque_error": (0.2 + 0.2 * ((run + round(10 * bias)) % 4)) * error,
        "trajectory_error": 0.2 * error,
        "consistent": bool(run % 3 or bias == 0),
    }
