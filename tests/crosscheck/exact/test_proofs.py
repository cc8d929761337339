"""What is proven of a robot, at the border between what holds and what does not."""

import sys
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from random_trees import NAMED, random_state
from robots.mechanisms import four_bar

import crosscheck
import graphdyn
from crosscheck.exact.proofs import possible_inertia
from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

POSSIBLE = "a real body can have this inertia"
EVERYWHERE = "the mass matrix is positive definite in all poses"
MASS_MATRIX = "the mass matrix is positive definite at this state"
CONSTRAINTS = "the constraints have full rank at this state"
EQUATIONS = "the equations are regular at this state"

ABOUT_Z = np.array([[Fraction(3, 5), Fraction(-4, 5), 0], [Fraction(4, 5), Fraction(3, 5), 0], [0, 0, Fraction(1)]])
ABOUT_X = ABOUT_Z[np.ix_([2, 0, 1], [2, 0, 1])]

TINY = Fraction(1, 10**30)

URDF = """<robot name="arm"><link name="ground"/>
<link name="plate"><inertial><origin xyz="0.1 0 0" rpy="0.3 0.2 0.1"/><mass value="1.5"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="IZZ"/></inertial></link>
<joint name="turn" type="continuous"><parent link="ground"/><child link="plate"/></joint></robot>"""


def told(proofs, statement):
    return {proof.of: (proof.result, proof.reason) for proof in proofs if proof.statement == statement}


def pendulum(first_mass, tensor=0.0):
    """Two points at the ends of bars of 1 m, in a plane."""
    tip = np.array([1.0, 0, 0])
    bodies = [Body(f"bar{k}", mass, tip, np.eye(3) * tensor) for k, mass in ((1, first_mass), (2, 1.0))]
    joints = [
        Joint("j1", "revolute", 0, Placement(), [0, 0, 1]),
        Joint("j2", "revolute", 1, Placement(translation=tip), [0, 0, 1]),
    ]
    return RobotModel("pendulum", tuple(bodies), tuple(joints))


class TestPossibleInertias:
    @pytest.mark.parametrize(
        ("moments", "expected"),
        [
            ((1, 1, 2 - TINY), ("proven", "each principal moment is less than the sum of the others")),
            (
                (1, 1, 2),
                ("proven", "a principal moment is equal to the sum of the others: only of a body that is flat"),
            ),
            (
                (0, 1, 1),
                ("proven", "a principal moment is equal to the sum of the others: only of a body that is a rod"),
            ),
            (
                (0, 0, 0),
                ("proven", "a principal moment is equal to the sum of the others: only of a body that is a point"),
            ),
            ((1, 1, 2 + TINY), ("disproven", "a principal moment exceeds the sum of the others by 1.00e-30 kg m²")),
            ((3, 1, 1), ("disproven", "a principal moment exceeds the sum of the others by 1.00 kg m²")),
            ((-1, 1, 1), ("disproven", "a principal moment exceeds the sum of the others by 1.00 kg m²")),
        ],
    )
    def test_at_the_border(self, moments, expected):
        """Turned by fractions, so that no principal axis is an axis of the frame."""
        turn = ABOUT_Z @ ABOUT_X
        tensor = turn @ np.diag([Fraction(x) for x in moments]) @ turn.T
        assert possible_inertia(Fraction(1, 3), tensor.tolist()) == expected

    def test_as_eigenvalues_say(self):
        """Of random tensors that are not at the border."""
        entries = np.random.default_rng(0).integers(-3, 9, size=(200, 3, 3))
        results = set()
        for matrix in entries:
            tensor = matrix + matrix.T + 6 * np.eye(3, dtype=int)
            moments = np.linalg.eigvalsh(tensor)
            margin = moments[0] + moments[1] - moments[2]
            if abs(margin) > 1e-6:
                result, _ = possible_inertia(Fraction(1), [[Fraction(int(x)) for x in row] for row in tensor])
                assert result == ("proven" if margin > 0 else "disproven")
                results.add(result)
        assert results == {"proven", "disproven"}

    @pytest.mark.parametrize(("mass", "said"), [(0, "its mass is zero, and its tensor is not"), (-1, "is negative")])
    def test_masses(self, mass, said):
        result, reason = possible_inertia(Fraction(mass), np.diag([Fraction(1)] * 3).tolist())
        assert result == "disproven"
        assert said in reason

    def test_of_decimals_that_no_double_holds(self, tmp_path):
        """0.1 + 0.2 is 0.3 in decimals, and less than 0.3 in no double."""
        path = tmp_path / "plate.urdf"
        for izz, result, said in (
            ("0.3", "proven", "flat"),
            ("0.300000000000000000000000000001", "disproven", "by 1.00e-30 kg m²"),
            ("0.299999999999999999999999999999", "proven", "less than"),
        ):
            path.write_text(URDF.replace("IZZ", izz))
            ((found, reason),) = told(crosscheck.prove(path), POSSIBLE).values()
            assert found == result
            assert said in reason
        ((found, _),) = told(crosscheck.prove(path, truth="model"), POSSIBLE).values()
        assert found == "proven"  # 0.1 + 0.2 > 0.3 as doubles


class TestMassMatrix:
    def test_in_all_poses(self):
        proofs = crosscheck.prove(NAMED["mixed_chain"])
        assert told(proofs, EVERYWHERE) == {
            "": ("proven", "each body has a positive mass and a positive definite inertia")
        }
        assert {proof.truth for proof in proofs} == {"model"}
        assert len(proofs) == 1 + NAMED["mixed_chain"].n_bodies

    def test_of_a_body_without_mass(self):
        """At the end of the chain its joint moves nothing."""
        model = NAMED["revolute_chain"]
        empty = Body("empty", 0.0, np.zeros(3), np.zeros((3, 3)))
        model = replace(model, bodies=(*model.bodies[:-1], empty))
        proofs = crosscheck.prove(model, random_state(model, 1, ())[0])
        name = model.joint_names[-1]
        assert told(proofs, EVERYWHERE)[""] == ("disproven", f"not at q = 0: joint '{name}' moves without inertia")
        assert told(proofs, MASS_MATRIX)[""] == ("disproven", f"joint '{name}' moves without inertia")
        assert told(proofs, EQUATIONS)[""] == ("disproven", f"joint '{name}' moves without inertia")
        assert told(proofs, CONSTRAINTS)[""][0] == "proven"

    def test_of_a_pose(self):
        """Without the first point the determinant is sin² of the angle between the bars: 0 where they are in line."""
        model = pendulum(0.0)
        assert told(crosscheck.prove(model), EVERYWHERE)[""] == (
            "disproven",
            "not at q = 0: a pivot of its elimination is not positive",
        )
        for angle, result in (("1e-40", "proven"), ("0", "disproven"), ("pi", "not proven")):
            proofs = crosscheck.prove(model, ["0.3", angle])
            assert told(proofs, MASS_MATRIX)[""][0] == result
            assert told(proofs, EQUATIONS)[""][0] == ("proven" if result == "proven" else "not proven")

    def test_what_is_not_decided(self):
        """Of two points the matrix is positive definite, but not for the reason that is tried."""
        ((result, reason),) = told(crosscheck.prove(pendulum(1.0)), EVERYWHERE).values()
        assert result == "not proven"
        assert reason == "mass and inertia are not proven to be positive of 'bar1', 'bar2'"
        ((result, _),) = told(crosscheck.prove(pendulum(1.0, 1e-300)), EVERYWHERE).values()
        assert result == "proven"


class TestEquations:
    @pytest.mark.parametrize("name", ["kr500", "prismatic_inside_and_out"])
    def test_rank_and_regularity(self, name):
        model = NAMED[name]
        q, v, tau = random_state(model, 1, ())
        proofs, n = crosscheck.prove(model, q), model.n_bodies
        assert told(proofs, CONSTRAINTS)[""] == ("proven", f"φ_q φ_qᵀ is positive definite: the rank is {5 * n}")
        assert told(proofs, EQUATIONS)[""] == ("proven", f"the matrix of the {11 * n} equations has an inverse")
        assert graphdyn.kkt_system(model, q, v, tau).rank() == 11 * n

    def test_of_joints_that_others_drive(self):
        model = NAMED["revolute_chain"]
        coupled = replace(model, couplings=(graphdyn.Coupling("joint3", {"joint1": 0.5}),))
        proofs = crosscheck.prove(coupled, np.zeros(3))
        assert told(proofs, EVERYWHERE)[""][0] == told(proofs, MASS_MATRIX)[""][0] == "proven"
        assert told(proofs, EQUATIONS)[""] == told(proofs, CONSTRAINTS)[""]
        assert told(proofs, EQUATIONS)[""][0] == "not proven"


def test_refused(monkeypatch):
    with pytest.raises(InvalidInput, match=r"q has shape \(2,\), expected \(1,\)"):
        crosscheck.prove(NAMED["one_revolute"], [0, 0])
    with pytest.raises(InvalidInput, match="'a' is no number"):
        crosscheck.prove(NAMED["one_revolute"], ["a"])
    with pytest.raises(InvalidInput, match="robot 'four-bar' has loops: there are no exact values of it"):
        crosscheck.prove(four_bar())
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(InvalidInput, match="exact values: the package python-flint is not installed"):
        crosscheck.prove(NAMED["one_revolute"])
