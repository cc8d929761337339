"""crosscheck.judge: what it refuses of arguments and of user code, and what it takes."""

import operator
import re
import sys

import numpy as np
import pytest

import crosscheck
from crosscheck.judging.observing.function_under_test import FunctionFailure, FunctionUnderTest
from crosscheck.quantities import FUNCTIONS
from graphdyn import InvalidInput, SingularMassMatrix, kr500

SAMPLES = 5


@pytest.mark.parametrize("batched", [False, True])
@pytest.mark.parametrize("loads", [None, 2.0])
def test_joints_in_another_order(batched, loads):
    """Each number is that of its joint; loads that are left out are zero."""
    order, weights, asked = np.array([2, 0, 1]), np.array([1.0, 20.0, 300.0]), []

    def answer(q, v, a, wrenches):
        asked.append(wrenches)
        return weights * (q + v**2 + a**3 + wrenches[..., 4])

    function = FunctionUnderTest(FUNCTIONS["inverse_dynamics"], answer, order, batched=batched, loaded=True)
    q, v, a = np.random.default_rng(0).normal(size=(3, 5, 3))
    wrenches = np.zeros((5, 3, 6)) if loads is None else loads + np.arange(90.0).reshape(5, 3, 6)
    found = function(q, v, a) if loads is None else function(q, v, a, wrenches)
    ours = weights[np.argsort(order)]  # of joint 0, whose place is 1, and so on
    np.testing.assert_allclose(found, ours * (q + v**2 + a**3 + wrenches[..., 4]))
    np.testing.assert_array_equal(np.reshape(asked, wrenches.shape), wrenches[:, order])


class TestInput:
    def test_nothing_to_judge(self):
        with pytest.raises(InvalidInput, match="no function to judge; give at least one of inverse_dynamics, forward_"):
            crosscheck.judge("ur5")

    def test_no_function(self):
        with pytest.raises(InvalidInput, match="mass_matrix is of type ndarray; give a function"):
            crosscheck.judge("ur5", mass_matrix=np.eye(6))

    @pytest.mark.parametrize("names", ["abc", ["a", "b"], ["elbow_joint"] * 6])
    def test_joint_names(self, textbook, names):
        with pytest.raises(InvalidInput, match="it must name each of the 6 joints once: shoulder_pan_joint, "):
            crosscheck.judge("ur5", inverse_dynamics=textbook.inverse_dynamics, joint_names=names)

    @pytest.mark.parametrize(
        ("option", "message"),
        [
            ({"samples": 0}, "samples is 0; give a whole number"),
            ({"seed": -1}, "seed is -1; give a whole number"),
            ({"tolerance": 0}, "tolerance is 0; give a relative error between 0 and 1"),
            ({"tolerance": "x"}, "tolerance is 'x'; give a relative error between 0 and 1"),
        ],
    )
    def test_numbers(self, textbook, option, message):
        with pytest.raises(InvalidInput, match=message):
            crosscheck.judge("ur5", inverse_dynamics=textbook.inverse_dynamics, **option)

    def test_lock_with_a_model(self, textbook, ur5):
        with pytest.raises(InvalidInput, match="a RobotModel already has its joints and gravity"):
            crosscheck.judge(ur5, inverse_dynamics=textbook.inverse_dynamics, lock=["elbow_joint"])

    def test_wrong_shape(self):
        with pytest.raises(FunctionFailure, match=r"inverse_dynamics returned shape \(6, 1\), expected \(6,\)"):
            crosscheck.judge("ur5", inverse_dynamics=lambda q, v, a: q[:, None])
        with pytest.raises(FunctionFailure, match=r"regressor returned shape \(6, 6\), expected \(6, 60\)"):
            crosscheck.judge("ur5", joint_torque_regressor=lambda q, v, a: np.eye(6))

    def test_foreign_exception_without_a_message(self):
        def silent(q, v, a):
            raise ValueError

        with pytest.raises(
            FunctionFailure, match=r"inverse_dynamics raised ValueError \(.*, line \d+, in silent\); at q"
        ):
            crosscheck.judge("ur5", inverse_dynamics=silent, samples=SAMPLES)

    def test_foreign_exception(self):
        def broken(q):
            raise KeyError("wrist")

        line = broken.__code__.co_firstlineno + 1
        words = rf"mass_matrix raised KeyError: 'wrist' \({re.escape(__file__)}, line {line}, in broken\); at q = \["
        with pytest.raises(FunctionFailure, match=words) as caught:
            crosscheck.judge("ur5", mass_matrix=broken)
        assert isinstance(caught.value.__cause__, KeyError)

    def test_the_line_is_that_of_the_file_of_the_function(self):
        """Not of NumPy, which it called."""

        def broken(q):
            return np.linalg.inv(np.zeros((6, 6)))

        words = rf"LinAlgError: Singular matrix \({re.escape(__file__)}, line \d+, in broken\)"
        with pytest.raises(FunctionFailure, match=words):
            crosscheck.judge("ur5", mass_matrix=broken)

    def test_a_compiled_function_has_no_line(self):
        with pytest.raises(FunctionFailure, match=r"mass_matrix raised TypeError: [^(]*; at q = \["):
            crosscheck.judge("ur5", mass_matrix=operator.index)

    def test_foreign_exit(self):
        """It would end the caller's program with the exit code of an agreement."""
        with pytest.raises(FunctionFailure, match="mass_matrix raised SystemExit: 0"):
            crosscheck.judge("ur5", mass_matrix=lambda q: sys.exit(0))

    @pytest.mark.parametrize("error", [KeyboardInterrupt, pytest.skip.Exception])
    def test_what_ends_more_than_the_function_passes(self, error):
        def interrupted(q):
            raise error

        with pytest.raises(error):
            crosscheck.judge("ur5", mass_matrix=interrupted)

    @pytest.mark.parametrize(
        ("returned", "words"),
        [
            (None, "NoneType, which is no array of real numbers: a return is missing"),
            (np.eye(6) + 2e-3j, "ndarray, which is no array of real numbers: it has imaginary parts of up to 0.002"),
            (
                np.ma.masked_array(np.eye(6), mask=np.eye(6) == 0),
                "MaskedArray, which is no array of real numbers: some of its entries are masked; give numbers in their",
            ),
            ([[1.0], [1.0, 2.0]], "list, which is no array of real numbers"),
            ("heavy", "str, which is no array of real numbers"),
        ],
    )
    def test_no_numbers(self, returned, words):
        with pytest.raises(FunctionFailure, match=f"mass_matrix returned {words}"):
            crosscheck.judge("ur5", mass_matrix=lambda q: returned)

    def test_no_forward_dynamics(self):
        massless = kr500().with_inertial_parameters(np.zeros(60))
        with pytest.raises(SingularMassMatrix, match="singular"):
            crosscheck.judge(massless, forward_dynamics=lambda q, v, tau: tau)

    def test_a_robot_without_mass(self):
        massless = kr500().with_inertial_parameters(np.zeros(60))
        judgment = crosscheck.judge(massless, inverse_dynamics=lambda q, v, a: 0 * q, samples=1)
        assert judgment.agrees
        assert "no body has mass: all torques vanish, and little can be judged" in judgment.notes

    def test_foreign_code_cannot_change_our_states(self, textbook):
        def destructive(q, v, a):
            tau = textbook.inverse_dynamics(q, v, a)
            q[:], v[:], a[:] = 0, 0, 0
            return tau

        assert crosscheck.judge("ur5", inverse_dynamics=destructive, samples=SAMPLES).agrees

    def test_progress(self, textbook):
        said = []
        upside_down = textbook.but(gravity=-textbook.gravity)
        crosscheck.judge("ur5", inverse_dynamics=upside_down.inverse_dynamics, samples=1, progress=said.append)
        assert said == [
            "evaluating the reference implementations",
            "judging inverse_dynamics",
            "looking for the fault of inverse_dynamics",
            "looking for the smallest example of inverse_dynamics",
        ]
