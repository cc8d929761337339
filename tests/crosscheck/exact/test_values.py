"""Exact values: closed forms to sixty digits, two formulations that share no line, and what doubles are off by."""

import sys
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pinocchio
import pytest
from random_trees import NAMED, random_base_motion, random_state, random_wrenches
from robots.mechanisms import four_bar

import crosscheck
import graphdyn
import urdf
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import Coupling, InvalidInput, SingularMassMatrix
from graphdyn.verbs import VERBS

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

BEAM = """<robot name="beam"><link name="ground"/>
<link name="beam"><inertial><origin xyz="0.3 0 0"/><mass value="0.1"/>
  <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.003"/></inertial></link>
<link name="tip"><inertial><origin xyz="0 0 0" rpy="0.2 -0.1 1.5708"/><mass value="0.7"/>
  <inertia ixx="0.011" ixy="0.001" ixz="0" iyy="0.013" iyz="0" izz="0.017"/></inertial></link>
<joint name="turn" type="continuous"><parent link="ground"/><child link="beam"/>
  <origin xyz="0 0 1" rpy="1.5708 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="weld" type="WELD"><parent link="beam"/><child link="tip"/><origin xyz="0.6 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
"""A beam that turns about a nearly horizontal axis, with a weight at its end. All numbers but 1 are no doubles."""

FIXED = BEAM.replace("WELD", "fixed").replace(
    '<axis xyz="1 0 0"/>\n  <limit lower="-1" upper="1" effort="1" velocity="1"/>', ""
)

ROUNDING = 1e-13
"""Of doubles, relative to the largest entry of an array; measured below 3e-15 for these robots."""

NEAR = 1.5
"""99 % quantile of the errors of projected accelerations over that of aba, at 100 states of the KR500: measured 0.6 to
0.8 with three seeds, and 2.2 to 4.3 with levers that are differences of positions in the world."""

OUTPUTS = ("body_accelerations", "multipliers")


def beam_torque(angle):
    """g (m l + M L) cos q, of gravity across the axis, to 80 digits; 1.5708 about x tilts the plane of motion."""
    with mpmath.workdps(80):
        moment = mpmath.mpf(1) / 10 * 3 / 10 + mpmath.mpf(7) / 10 * 6 / 10
        return moment * mpmath.mpf(9.81) * mpmath.sin(mpmath.mpf("1.5708")) * mpmath.cos(angle)


def of_robot(robot, *arguments, digits=60, **options):
    (found,) = crosscheck.exact_values(robot, *arguments, digits=digits, **options).values()
    return found


@pytest.fixture
def beam(tmp_path):
    path = tmp_path / "beam.urdf"
    path.write_text(FIXED)
    return path


class TestDecimals:
    @pytest.mark.parametrize("angle", ["0", "pi/3", "-3pi/4", "0.1", "2/3", Fraction(1, 3), 0.1, 2])
    def test_of_the_file(self, beam, angle):
        """The moment of two weights, written as decimals, turned by rpy angles that are decimals too."""
        found = of_robot(beam, "gravity_torque", [angle])
        with mpmath.workdps(80):
            exact = {"pi/3": mpmath.pi / 3, "-3pi/4": -3 * mpmath.pi / 4, "2/3": mpmath.mpf(2) / 3}
            q = exact.get(angle) or (mpmath.mpf(1) / 3 if isinstance(angle, Fraction) else mpmath.mpf(angle))
            expected = beam_torque(q)
            assert abs(mpmath.mpf(found.decimals(60)[0]) - expected) < mpmath.mpf(10) ** -58
        assert found.truth == "file"
        assert found.radius < 1e-60

    def test_of_the_model(self, beam):
        """Its doubles instead: another number, by some 1e-17."""
        of_file, of_model = (of_robot(beam, "gravity_torque", ["0"], truth=truth) for truth in ("file", "model"))
        apart = abs(Fraction(of_file.decimals(50)[0]) - Fraction(of_model.decimals(50)[0]))
        assert 1e-19 < apart < 1e-14
        assert of_robot(urdf.load(beam), "gravity_torque", ["0"]).decimals(50) == of_model.decimals(50)

    def test_what_vanishes(self, beam):
        """The weights hang below the axis: zero, to twice as many digits, and to 300 at most."""
        for digits in (30, 250):
            found = of_robot(beam, "gravity_torque", ["pi/2"], digits=digits)
            assert found.balls[0].contains(0)
            assert found.radius <= 10.0 ** -min(2 * digits, 300)

    def test_only_proven_digits(self, beam):
        found = of_robot(beam, "gravity_torque", ["0"], digits=20)
        assert len(found.decimals(200)[0]) < 200
        with mpmath.workdps(80):
            assert found.decimals()[0] == mpmath.nstr(beam_torque(0), 20)

    def test_as_many_as_asked_for(self, beam):
        found = of_robot(beam, "gravity_torque", ["0"], digits=250)
        assert len(found.decimals()[0]) == 251
        assert found.radius < 1e-250

    def test_links_that_are_locked(self, beam):
        """At an angle that is a double: as if the joint stood there."""
        beam.write_text(BEAM.replace("WELD", "revolute"))
        locked = of_robot(beam, "mass_matrix", [0.3], lock={"weld": 0.25})
        free = of_robot(beam, "mass_matrix", [0.3, 0.25])
        assert locked.balls[0, 0].overlaps(free.balls[0, 0])

    def test_slides(self, beam):
        """Weight along an inclined slide: m g sin of its angle, m a beside it."""
        text = (
            '<robot name="slide"><link name="ground"/><link name="sled"><inertial><mass value="0.3"/>'
            '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
            '<joint name="slide" type="prismatic"><parent link="ground"/><child link="sled"/><axis xyz="3 0 4"/>'
            '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
        )
        beam.write_text(text)
        with pytest.warns(urdf.AxisNotNormalizedWarning):
            found = of_robot(beam, "joint_torques", ["0.1"], ["0"], ["0.7"])
        expected = Fraction(3, 10) * (Fraction(7, 10) + Fraction(9.81) * Fraction(4, 5))
        assert Fraction(found.decimals(50)[0]) == pytest.approx(expected, rel=0, abs=1e-49)


class TestTwoFormulations:
    @pytest.mark.parametrize(
        ("name", "base"),
        [("kr500", None), ("mixed_chain", None), ("branched", None), ("branched", 3), ("prismatic_inside_and_out", 4)],
    )
    def test_overlap(self, name, base):
        """The recursion and Eq. (111) solved in balls, with wrenches on all bodies, on bases that rest and move."""
        model = NAMED[name]
        (q, v, tau), wrenches = random_state(model, 1, ()), random_wrenches(model, 2, ())
        options = {"external_wrenches": wrenches, "base": None if base is None else random_base_motion(base)}
        ways = [
            crosscheck.exact_values(model, "solve_kkt", q, v, tau, method=method, **options)
            for method in ("recursive", "dense")
        ]
        for output in OUTPUTS:
            one, other = (way[output].balls.ravel() for way in ways)
            assert all(x.overlaps(y) for x, y in zip(one, other, strict=True))
            assert max(way[output].radius for way in ways) < 1e-30 * np.abs(ways[0][output].doubles()).max()

    def test_of_a_file(self, beam):
        beam.write_text(BEAM.replace("WELD", "revolute"))
        ways = [
            crosscheck.exact_values(beam, "solve_kkt", [0.1, 0.2], [1, "2/3"], [0.3, -0.4], method=method)
            for method in ("recursive", "dense")
        ]
        for output in OUTPUTS:
            one, other = (way[output].balls.ravel() for way in ways)
            assert all(x.overlaps(y) for x, y in zip(one, other, strict=True))


@pytest.mark.parametrize("name", VERBS)
def test_every_function_is_off_by_rounding_alone(name):
    """Of a tree with a slide on a base that moves. The balls of a first formulation, the doubles of another."""
    model, verb = NAMED["prismatic_inside_and_out"], VERBS[name]
    q, v, a = random_state(model, 5, ())
    given = [{"q": q, "v": v, "a": a, "tau": a}[each] for each in verb.inputs]
    options = {"frame": model.body_names[-1], "reference": "local"} if verb.of_frame else {}
    options["base"] = None if name in ("coriolis_matrix", "frame_jacobian_derivative") else random_base_motion(6)
    exact = crosscheck.exact_values(model, name, *given, **options)
    doubles = verb.memory(verb.function(model, *given, method="projected", **options))
    for output, array in exact.items():
        least, most = array.errors(doubles[output])
        assert np.all(least <= most)
        assert most.max(initial=0.0) < ROUNDING * max(1.0, np.abs(doubles[output]).max(initial=0.0))
        assert array.balls.shape == np.shape(doubles[output])


def test_where_frames_are():
    """On a base that moves, of joints that others drive; the doubles are off by rounding alone."""
    model = NAMED["prismatic_inside_and_out"]
    coupled = replace(model, couplings=(Coupling("joint3", {"joint1": 0.5}, 0.25),))
    base, q = random_base_motion(2), np.random.default_rng(3).normal(size=(2, 2))
    for frame in (coupled.base_name, *coupled.body_names):
        exact = crosscheck.exact_values(coupled, "frame_placement", q, frame=frame, base=base)
        for array, doubles in zip(exact.values(), graphdyn.frame_placement(coupled, q, frame, base=base), strict=True):
            assert array.errors(doubles)[1].max() < ROUNDING * 10
    with pytest.raises(InvalidInput, match="frame_placement speaks of a frame; give frame="):
        crosscheck.exact_values(coupled, "frame_placement", q)
    with pytest.raises(InvalidInput, match="frame_placement takes q; 2 arguments were given"):
        crosscheck.exact_values(coupled, "frame_placement", q, q, frame="base")


def test_joints_that_others_drive():
    """Torques and mass matrix are those of the joints without their couplings, times their ratios."""
    model = NAMED["revolute_chain"]
    coupled = replace(model, couplings=(Coupling("joint3", {"joint1": 0.5}, 0.25),))
    (q, v, a), ratios = np.random.default_rng(2).normal(size=(3, 3)), coupled.degrees_of_freedom.matrix
    positions = [q[0], q[1], Fraction(q[0]) / 2 + Fraction(1, 4), q[2]]
    free = crosscheck.exact_values(model, "joint_torques", positions, ratios @ v, ratios @ a)["tau"]  # halves are exact
    found = crosscheck.exact_values(coupled, "joint_torques", q, v, a)["tau"]
    expected = (ratios.T * Fraction(1)) @ np.array([Fraction(text) for text in free.decimals(28)])
    apart = [abs(Fraction(x) - y) for x, y in zip(found.decimals(28), expected, strict=True)]
    assert max(apart) < Fraction(1, 10**24)


class TestMimicJoints:
    """tip = 0.1 turn + 0.2, decimals that are no doubles."""

    @pytest.fixture
    def path(self, beam):
        mimic = '<mimic joint="turn" multiplier="0.1" offset="0.2"/><limit'
        beam.write_text(BEAM.replace("WELD", "revolute").replace("<limit", mimic))
        return beam

    def test_decimals_of_the_file(self, path):
        """The torques of both joints where the decimals hold them, the second a tenth as much."""
        q, v, a = Fraction(3, 10), Fraction(1, 2), Fraction(-7, 10)
        tenth = Fraction(1, 10)
        states = [q, tenth * q + 2 * tenth], [v, tenth * v], [a, tenth * a]
        with pytest.warns(urdf.MimicJointWarning):
            free = of_robot(path, "joint_torques", *states, mimic="independent").decimals(55)
        found = of_robot(path, "joint_torques", [q], [v], [a])
        expected = Fraction(free[0]) + tenth * Fraction(free[1])
        assert abs(Fraction(found.decimals(55)[0]) - expected) < Fraction(1, 10**50)
        assert found.truth == "file"
        of_model = of_robot(path, "joint_torques", [q], [v], [a], truth="model")
        assert 1e-19 < abs(Fraction(of_model.decimals(55)[0]) - expected) < 1e-15

    def test_accelerations_undo_torques(self, path):
        tau = of_robot(path, "joint_torques", ["0.3"], ["0.5"], ["-0.7"])
        a = of_robot(path, "joint_accelerations", ["0.3"], ["0.5"], [Fraction(tau.decimals(60)[0])])
        assert abs(Fraction(a.decimals(50)[0]) + Fraction(7, 10)) < Fraction(1, 10**49)

    def test_what_mimics_a_locked_joint_stands_where_its_decimals_say(self, path):
        """The tip at 0.1 · 0.25 + 0.2, and not at the double beside it."""
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        joint = '<parent link="tip"/><child link="more"/><origin xyz="0.1 0 0"/></joint>'
        more = f'<link name="more">{inertial}</link><joint name="last" type="continuous">{joint}</robot>'
        path.write_text(path.read_text().replace("</robot>", more))
        options = {"frame": "more", "reference": "world"}
        locked = of_robot(path, "frame_acceleration", ["0.3"], ["1"], ["1"], lock={"turn": 0.25}, **options)
        states = ["0.25", "0.225", "0.3"], [0, 0, 1], [0, 0, 1]
        with pytest.warns(urdf.MimicJointWarning):
            free = of_robot(path, "frame_acceleration", *states, mimic="independent", **options)
        assert all(x.overlaps(y) for x, y in zip(locked.balls, free.balls, strict=True))
        assert locked.radius < 1e-60


class TestErrors:
    def test_bounds_of_a_planted_error(self):
        model = NAMED["mixed_chain"]
        q, v, a = random_state(model, 3, (2,))
        exact = crosscheck.exact_values(model, "joint_torques", q, v, a)["tau"]
        nearest = exact.doubles()
        assert exact.is_correctly_rounded(nearest).all()
        wrong = nearest.copy()
        wrong[1, 2] += 1e-12
        least, most = exact.errors(wrong)
        assert least[1, 2] == pytest.approx(1e-12, rel=1e-2)
        assert 0 < most[1, 2] - least[1, 2] < 1e-27
        assert not exact.is_correctly_rounded(wrong)[1, 2]
        assert most[0].max() < np.spacing(np.abs(nearest[0]).max())

    def test_of_another_shape(self):
        exact = crosscheck.exact_values(NAMED["one_revolute"], "gravity_torque", [0.1])["gravity_torque"]
        with pytest.raises(InvalidInput, match=r"the values have shape \(2,\), the exact ones \(1,\)"):
            exact.errors([1.0, 2.0])


class TestPrecision:
    def test_rises_until_the_digits_are_proven(self, beam):
        """164 bits tell thirty digits of a torque, and not that it vanishes."""
        assert of_robot(beam, "gravity_torque", ["pi/3"], digits=30).bits == 164
        assert of_robot(beam, "gravity_torque", ["pi/2"], digits=30).bits == 328

    def test_of_a_light_body_beside_a_heavy_one(self):
        """Of a point mass a meter from the first joint, with 1e-60 of its inertia about the second: τ = (0, 1) gives
        a = (-1, 1e60 + 1)."""
        arm = graphdyn.Body("arm", 0.0, np.zeros(3), np.zeros((3, 3)))
        bob = graphdyn.Body("bob", 1.0, np.zeros(3), np.eye(3) * 1e-60)
        placements = [graphdyn.Placement(), graphdyn.Placement(translation=[1.0, 0, 0])]
        joints = [graphdyn.Joint(f"j{k}", "revolute", k, place, [0, 0, 1]) for k, place in enumerate(placements)]
        model = graphdyn.RobotModel("pair", (arm, bob), tuple(joints))
        exact = crosscheck.exact_values(model, "joint_accelerations", [0, 0], [0, 0], [0, 1], digits=100)["a"]
        assert exact.errors([-1.0, 1e60])[1] == pytest.approx([0.0, 1e44], abs=1e-15, rel=1)

    def test_what_is_singular_is_not_guessed(self, monkeypatch):
        """A point mass on the axis of its joint."""
        model = NAMED["one_revolute"]
        body = graphdyn.Body("body1", 1.0, np.zeros(3), np.zeros((3, 3)))
        singular = graphdyn.RobotModel("point", (body,), (model.joints[0],))
        said = r"robot 'point': 30 digits are not proven with 2000 bits.*\(bodies without mass or inertia: body1\)"
        with pytest.raises(SingularMassMatrix, match=said):
            crosscheck.exact_values(singular, "joint_accelerations", [0.1], [0], [0])
        with pytest.raises(SingularMassMatrix, match="or is not proven regular"):
            crosscheck.exact_values(singular, "solve_kkt", [0.1], [0], [0], method="dense")


class TestRefusals:
    def test_without_python_flint(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "flint", None)
        with pytest.raises(
            InvalidInput, match=r"exact values: the package python-flint is not installed.*'graphdyn\[exact\]'"
        ):
            crosscheck.exact_values(NAMED["one_revolute"], "gravity_torque", [0.1])

    def test_what_has_no_exact_form_on_a_moving_base(self):
        with pytest.raises(InvalidInput, match="coriolis_matrix takes a base at rest"):
            crosscheck.exact_values(NAMED["one_revolute"], "coriolis_matrix", [0], [0], base=random_base_motion(1))

    def test_robots_without_an_exact_form(self, beam):
        coupling = '<coupling name="gear"><predecessor link="ground"/><successor link="tip"/><ratio value="0.3"/>'
        beam.write_text(BEAM.replace("WELD", "revolute").replace("</robot>", f"{coupling}</coupling></robot>"))
        with pytest.raises(InvalidInput, match=r"robot 'beam' has a <coupling>, which drives joint 'weld': .*'model'"):
            crosscheck.exact_values(beam, "gravity_torque", [0])
        with pytest.raises(InvalidInput, match="robot 'four-bar' has loops: there are no exact values of it"):
            crosscheck.exact_values(four_bar(), "gravity_torque", np.zeros(3))

    @pytest.mark.parametrize(
        ("verb", "arguments", "options", "said"),
        [
            ("joint_torque", [[0.1]], {}, "no function 'joint_torque' of graphdyn .* did you mean joint_torques"),
            ("gravity_torque", [[0.1]], {"digits": 0}, "digits is 0; give an integer from 1 to 250"),
            ("gravity_torque", [[0.1]], {"digits": 3.5}, "digits is 3.5"),
            ("gravity_torque", [[0.1]], {"truth": "doubles"}, "truth is 'doubles'; use 'file' or 'model'"),
            ("gravity_torque", [[0.1]], {"truth": "file"}, "is a model: there is no file of it; use truth='model'"),
            (
                "gravity_torque",
                [[0.1]],
                {"method": "dense"},
                "of robot .* is not computed by the dense method",
            ),
            ("gravity_torque", [[0.1], [0.2]], {}, "gravity_torque takes q; 2 arguments were given"),
            ("gravity_torque", [[0.1, 0.2]], {}, r"q has shape \(2,\), expected \(…, 1\)"),
            ("gravity_torque", [["a"]], {}, "'a' is no number; give a decimal, a fraction, or a multiple of π"),
            ("gravity_torque", [["1/0"]], {}, "'1/0' is no number"),
            ("gravity_torque", [[float("nan")]], {}, "nan is no finite number"),
            ("gravity_torque", [[None]], {}, "None is no finite number"),
            ("gravity_torque", [[0.1]], {"method": "projected"}, "method is 'projected'; use 'recursive' or 'dense'"),
            ("gravity_torque", [[0.1]], {"frame": "body1"}, "gravity_torque speaks of no frame; omit frame"),
            ("gravity_torque", [[0.1]], {"base": 3}, "base is of type int; give a graphdyn.BaseMotion"),
            ("mass_matrix", [[0.1]], {"external_wrenches": [[0] * 6]}, "mass_matrix takes no external wrenches; omit"),
            ("bias_torque", [[[0.1]] * 2, [[0.1]] * 3], {}, r"leading dimensions do not broadcast: .*'v': \(3,\)"),
            ("frame_jacobian", [[0.1]], {}, "frame_jacobian speaks of a frame; give frame= and reference="),
        ],
    )
    def test_bad_input(self, verb, arguments, options, said):
        with pytest.raises(InvalidInput, match=said):
            crosscheck.exact_values(NAMED["one_revolute"], verb, *arguments, **options)


def aba(robot, q, v, tau):
    return pinocchio.aba(robot.native, robot.data, robot.configuration(q), v, tau)[robot.columns]


def test_projected_accelerations_are_as_near_as_those_of_the_articulated_body_algorithm():
    model, rng = urdf.load("kr500"), np.random.default_rng(0)
    q, v = model.random_state(rng, 100)
    tau = graphdyn.joint_torques(model, q, v, 5 * rng.normal(size=q.shape))
    exact = of_robot(model, "joint_accelerations", q, v, tau, digits=30)
    robot = PinocchioModel.from_model(model)
    codes = {
        "projected": graphdyn.joint_accelerations(model, q, v, tau, method="projected"),
        "aba": np.array([aba(robot, *state) for state in zip(q, v, tau, strict=True)]),
    }
    errors = {
        name: np.quantile(exact.errors(a)[1].max(axis=1) / np.abs(a).max(axis=1), 0.99) for name, a in codes.items()
    }
    assert errors["projected"] < NEAR * errors["aba"]
