"""How far graphdyn and Pinocchio are from exact values: python tests/tools exact_errors [ROBOT ...] [--states 100]

Prints, for each quantity, the error of every method of graphdyn and of Pinocchio at random states: median, 99 %
quantile and largest, in units of 2.2e-16 of the scale, and the ratio of the 99 % quantiles. Exact are the doubles of
the model (crosscheck.exact_values). The scale is the largest entry at the state, of torques that of all joint wrenches.
At last, the geometric mean and the largest of the ratios over all robots. A second for a robot and ten states.
"""

import argparse
import warnings

import numpy as np

import crosscheck
import graphdyn
import urdf
from crosscheck.quantities import FUNCTIONS
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn.verbs import VERBS

EPS = np.finfo(float).eps

METHODS = ("dense", "projected", "recursive")

ROBOTS = ("kr500", "ur3", "ur5", "ur10", "kinova", "z1")

COMPARED = {
    "tau": ("inverse_dynamics", "joint_torques", "tau"),
    "joint_wrenches": ("joint_wrenches", "inverse_dynamics", "joint_wrenches"),
    "a": ("forward_dynamics", "joint_accelerations", "a"),
    "multipliers": ("multipliers", "inverse_dynamics", "multipliers"),
    "mass_matrix": ("mass_matrix", "mass_matrix", "mass_matrix"),
    "mass_matrix_inverse": ("mass_matrix_inverse", "mass_matrix_inverse", "mass_matrix_inverse"),
    "bias_torque": ("bias_torque", "bias_torque", "bias_torque"),
    "momentum": ("momentum", "momentum", "about_center_of_mass"),
    "center_of_mass": ("center_of_mass", "center_of_mass", "center_of_mass"),
    "dtau_dq": ("dtau_dq", "inverse_dynamics_derivatives", "dtau_dq"),
    "da_dq": ("da_dq", "forward_dynamics_derivatives", "da_dq"),
}
"""The function in the table of the cross-check, the verb of graphdyn, and its output."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python tests/tools exact_errors")
    parser.add_argument("robots", nargs="*", default=ROBOTS)
    parser.add_argument("--states", type=int, default=100)
    asked = parser.parse_args()
    ratios = {}
    for robot in asked.robots:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = urdf.load(robot)
        print(f"{model.name}, {asked.states} states; errors in {EPS:.1e} of the scale")
        print(f"{'':22}{'method':12}{'median':>8}{'99 %':>8}{'largest':>9}   Pinocchio{'':19}ratio")
        for name in COMPARED:
            for method, ratio in compared(model, name, asked.states):
                ratios.setdefault((name, method), []).append(ratio)
    print(f"over all: {'quantity':22}{'method':12}{'geometric mean':>16}{'largest':>9}")
    for (name, method), found in ratios.items():
        print(f"{'':10}{name:22}{method:12}{np.exp(np.mean(np.log(found))):16.2f}{max(found):9.2f}")
    return 0


def compared(model: graphdyn.RobotModel, name: str, count: int) -> list[tuple[str, float]]:
    """The ratios of the 99 % quantiles, by method; prints the row of each."""
    function, verb, output = COMPARED[name]
    rng = np.random.default_rng(0)
    q, v = model.random_state(rng, count)
    a = 5 * rng.normal(size=q.shape)
    tau = graphdyn.joint_torques(model, q, v, a, method="projected")
    given = [{"q": q, "v": v, "a": a, "tau": tau}[each] for each in VERBS[verb].inputs]
    exact = crosscheck.exact_values(model, verb, *given, truth="model")[output]
    axes = tuple(range(1, exact.balls.ndim))
    scale = np.abs(exact.doubles()).max(axis=axes)
    if name == "tau":
        scale = np.abs(graphdyn.inverse_dynamics(model, q, v, a).joint_wrenches).max(axis=(1, 2))

    def errors(values: np.ndarray) -> np.ndarray:
        return exact.errors(values)[1].max(axis=axes) / scale / EPS

    row = FUNCTIONS[function]
    answers = PinocchioAnswers(PinocchioModel.from_model(model), model, q, v, a, tau, None, None)
    theirs = quantiles(errors(row.pinocchio(answers, next(row.readings({})))))
    ratios = []
    for method in (
        ("dense", "projected", "recursive") if name in ("a", "forward_multipliers") else ("projected", "recursive")
    ):
        ours = quantiles(errors(VERBS[verb].memory(VERBS[verb].function(model, *given, method=method))[output]))
        ratios.append((method, ours[1] / theirs[1]))
        both = "".join(f"{x:8.2f}" for x in ours) + "   " + "".join(f"{x:8.2f}" for x in theirs)
        print(f"{name:22}{method:12}{both}{ratios[-1][1]:9.2f}", flush=True)
    return ratios


def quantiles(errors: np.ndarray) -> tuple[float, float, float]:
    return float(np.median(errors)), float(np.quantile(errors, 0.99)), float(errors.max())
