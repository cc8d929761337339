"""Whatever urdf.inspect calls good for dynamics loads, and agrees with Pinocchio on the same file."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from inspected.cases import CASES
from inspected.sample import changed
from long_check import few
from shared_data import ARMS, existing

import crosscheck
import graphdyn
import urdf
from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.quantities import COMPARED, TabulatedQuantity
from crosscheck.quantities.states import cases
from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses
from graphdyn.compiler import interpreted

SAMPLES = 5

REFUSES = "Pinocchio refuses the file"

READ_OTHERWISE = {"number-spacing"}
"""Pinocchio reads other numbers than stand there, and the finding says so; only our own reading is compared."""

NOT_BY_PINOCCHIO = {"reserved-name"}
"""It cannot have a robot with such a name, and the finding says why."""

OTHER_NAMES = {"other-encoding", "name-spacing"}
"""Pinocchio reads other names than stand there, and the finding says so; it does not know the links by ours."""

ARMS_REFUSED = {"aubo_i5", "mk3"}


def states_beside(pinocchio, model, shared=None):
    """Random states at the torques that cause their accelerations. shared: the same beside another"""
    case = next(cases(model, SAMPLES, 0))
    tau = graphdyn.inverse_dynamics(model, case.q, case.v, case.a).tau
    return ComparedStates.of(replace(case, tau=tau), np.ones(len(case.q), dtype=bool), pinocchio, shared)


def errors(states):
    """The quantities that miss their bounds, and by how much."""
    found = {
        name: states.errors(quantity)
        for name, quantity in COMPARED.items()
        if isinstance(quantity, TabulatedQuantity) and quantity.form.when == "all" and not quantity.row.from_file
    }
    assert {"inverse_dynamics", "forward_dynamics", "joint_torque_regressor", "joint_wrenches"} <= set(found)
    return {name: error.max() for name, error in found.items() if not error.max() <= COMPARED[name].tolerance.bound}


def agrees(path, otherwise=False):
    """Compare; whether Pinocchio read the file. otherwise: it does, and reads other numbers."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        model = replace(urdf.load(path).uncoupled, chords=(), actuated=None)  # Pinocchio's is the tree
    with interpreted():
        states = states_beside(PinocchioModel.from_model(model), model)
        assert errors(states) == {}
        try:
            pinocchio = PinocchioModel.from_urdf(path, model)
        except PinocchioRefuses:
            return False
        missed = errors(states_beside(pinocchio, model, states))
    assert ("inverse_dynamics" in missed) if otherwise else missed == {}
    return True


@pytest.mark.parametrize("code", few(CASES, *{*list(CASES)[::2], *READ_OTHERWISE, *NOT_BY_PINOCCHIO, *OTHER_NAMES}))
def test_oddities(code, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(changed(*CASES[code].changes), encoding="utf-8")
    report = urdf.inspect(path)
    verdict = report.verdict
    if code in NOT_BY_PINOCCHIO:
        with pytest.raises(PinocchioRefuses, match="Pinocchio calls the ground 'universe' and confuses it"):
            agrees(path)
        return
    if verdict == "dynamics":
        refuses = code in OTHER_NAMES or any(REFUSES in finding.message for finding in report.findings)
        assert agrees(path, code in READ_OTHERWISE) != refuses
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        if verdict == "kinematics only":
            assert urdf.load(path).n_bodies == 2
            return
        with pytest.raises(urdf.URDFError):
            urdf.load(path)


@pytest.mark.parametrize("step", few([1, 4], 4))
def test_makers_arms(step):
    """Every fourth of them, or all; test_agreement compares every quantity at awkward states too."""
    paths = sorted(existing(ARMS).glob("*.urdf"))
    fit = [path for path in paths if urdf.inspect(path).verdict == "dynamics"]
    assert len(fit) == 16
    compared = {*fit[::step]} | {path for path in fit if path.stem in ARMS_REFUSED}
    assert {path.stem for path in compared if not agrees(path)} == ARMS_REFUSED


def test_axes_that_are_almost_parallel(tmp_path):
    """A right angle cut off: base parameters are small differences of sums a hundred thousand times as large."""
    path = tmp_path / "arm.urdf"
    path.write_text(changed(*CASES["rpy-truncated"].changes), encoding="utf-8")
    identified = crosscheck.compare(path, samples=SAMPLES).quantities["base_parameters"]
    assert identified.agrees
    assert identified.max_relative_error > 0
