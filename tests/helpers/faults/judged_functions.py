"""Judgments of functions whose answers are those of graphdyn times a factor."""

import numpy as np
from planting import SEED
from shown.pages import COMMAND

import graphdyn
import urdf
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.judgment import Diagnosis, JudgedFunction, Judgment, WorstCall
from crosscheck.quantities import FUNCTIONS
from crosscheck.report.html import page as page_of
from crosscheck.report.records.record import versions

STATES = 40


def judged(model, name, factor=1.0, references_differ=0.0, order=None):
    """A function under test whose answer is graphdyn's times a factor; the references differ by a relative error."""
    rng = np.random.default_rng(4)
    q, v = model.random_state(rng)
    a = tau = rng.normal(size=q.shape)
    ours = {
        "inverse_dynamics": lambda: graphdyn.inverse_dynamics(model, q, v, a).tau,
        "forward_dynamics": lambda: graphdyn.forward_dynamics(model, q, v, tau).a,
        "mass_matrix": lambda: graphdyn.mass_matrix(model, q),
        "joint_torque_regressor": lambda: graphdyn.joint_torque_regressor(model, q, v, a),
    }[name]().ravel()
    names = {"forward_dynamics": ("q", "v", "tau"), "mass_matrix": ("q",)}.get(name, ("q", "v", "a"))
    values = {"q": q, "v": v, "a": a, "tau": tau}
    here = [model.joint_names.index(joint) for joint in order or model.joint_names]
    errors = np.full(STATES, abs(factor - 1))
    call = WorstCall({x: tuple(values[x][here]) for x in names}, tuple(ours), tuple(factor * ours))
    between = {"pinocchio": np.full(STATES, references_differ)}
    return JudgedFunction(
        name, {"graphdyn": errors, "pinocchio": errors}, between, 1e-9, "the largest entry", call,
        code=FUNCTIONS[name].code_for({}, None),
    )  # fmt: skip


def judgment(model, *functions, robot="some robot", file=None, diagnoses=(), order=None):
    return Judgment(
        robot, file, model, order or model.joint_names, STATES, SEED, urdf.Reading(), ("graphdyn", "pinocchio"),
        {function.name: function for function in functions}, diagnoses, ("no MuJoCo",),
    )  # fmt: skip


DIAGNOSIS = Diagnosis(
    function="inverse_dynamics",
    kind="joint_order",
    message="joints <1> and 2 are swapped",
    evidence="at 40 states",
    remedy="swap them",
    explains=3e-16,
    also=("x", "y & z"),
)


def judgment_page(judged_functions):
    return page_of(judge_report(judged_functions), COMMAND, versions())
