"""Whatever urdf.inspect calls fit for dynamics loads, and agrees with Pinocchio on the same file."""

import warnings

import pytest
from inspection_cases import CASES, changed
from shared_data import ARMS, existing

import urdf
from crosscheck.pinocchio_model import PinocchioModel, PinocchioRefuses
from crosscheck.quantities import BY_NAME, forward_errors, passive_errors
from crosscheck.states import cases

SAMPLES = 5

REFUSED_BY_PINOCCHIO = {"duplicate-material", "effort-negative", "velocity-negative"}
"""Oddities with which it reads no file; it is then built from our model."""

ARMS_REFUSED = {"aubo_i5", "mk3"}


def agrees(path):
    """Compare at random states; whether Pinocchio read the file."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        model = urdf.load(path)
    (case, *_) = cases(model, SAMPLES, 0)
    try:
        referee, read = PinocchioModel.from_urdf(path, model, {}), True
    except PinocchioRefuses:
        referee, read = PinocchioModel.from_model(model), False
    tau = referee.rnea(case.q, case.v, case.a)
    reference = referee.evaluate(case.q, case.v, case.a, tau, case.external_wrenches)
    errors = passive_errors(case, reference) | forward_errors(case, tau, reference)
    assert {"torque", "acceleration", "torque_regressor", "joint_wrench"} <= set(errors)
    assert {
        name: error.max() for name, error in errors.items() if not error.max() <= BY_NAME[name].tolerance.bound
    } == {}
    return read


@pytest.mark.parametrize("code", CASES)
def test_oddities(code, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(changed(*CASES[code].changes), encoding="utf-8")
    verdict = urdf.inspect(path).verdict
    if verdict == "dynamics":
        assert agrees(path) == (code not in REFUSED_BY_PINOCCHIO)
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        if verdict == "kinematics only":
            assert urdf.load(path).n_bodies == 2
            return
        with pytest.raises(urdf.URDFError):
            urdf.load(path)


def test_makers_arms():
    """All of them; test_crosscheck_agreement compares every quantity at awkward states too."""
    paths = sorted(existing(ARMS).glob("*.urdf"))
    fit = [path for path in paths if urdf.inspect(path).verdict == "dynamics"]
    assert len(fit) == 16
    assert {path.stem for path in fit if not agrees(path)} == ARMS_REFUSED
