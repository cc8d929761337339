"""Every refusal of arguments and states, with the facts it carries: name, shape, row, remedy."""

import dataclasses
import re

import numpy as np
import pytest
from parts import SOLID, hinge
from random_trees import NAMED, random_state

import graphdyn
from graphdyn import (
    Body,
    GimbalLock,
    GraphDynError,
    InconsistentState,
    InvalidInput,
    InvalidModel,
    Joint,
    MaximalState,
    Placement,
    RankDeficientConstraints,
    RobotModel,
    SingularMassMatrix,
    UnknownFrame,
)

ROBOT = NAMED["branched"]
"""Six joints, called joint1 … joint6."""


def test_every_error_is_a_graphdyn_error_and_a_builtin_one():
    """A caller who knows nothing of graphdyn can still catch what Python would raise."""
    for error, builtin in (
        (InvalidModel, ValueError),
        (InvalidInput, ValueError),
        (InconsistentState, ValueError),
        (UnknownFrame, LookupError),
        (SingularMassMatrix, ArithmeticError),
        (GimbalLock, ArithmeticError),
        (RankDeficientConstraints, ArithmeticError),
    ):
        assert issubclass(error, GraphDynError)
        assert issubclass(error, builtin)


def three_arguments(**changes):
    x = np.zeros((5, 6))
    return {"q": x, "v": x, "tau": x} | changes


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"q": np.zeros((5, 7))}, r"q has shape \(5, 7\), expected \(…, 6\) for the 6 joints of robot 'tree6'"),
        ({"v": 1.0}, r"v has shape \(\), expected \(…, 6\)"),
        ({"tau": np.zeros((4, 6))}, r"leading dimensions do not broadcast: q \(5, 6\), v \(5, 6\), tau \(4, 6\)"),
        ({"external_wrenches": np.zeros((6, 3))}, r"external_wrenches has shape \(6, 3\), expected \(…, 6, 6\)"),
        ({"external_wrenches": np.zeros(6)}, r"external_wrenches has shape \(6,\), expected \(…, 6, 6\)"),
        ({"q": ["a"] * 6}, r"q is not an array of real numbers but of <U1"),
        ({"q": None}, r"q is not an array of real numbers but of object"),
        ({"q": np.ma.masked_equal(np.zeros(6), 0.0)}, r"q has masked entries; fill or drop them"),
        ({"q": np.zeros(6, dtype=complex)}, r"q is not an array of real numbers but of complex128"),
        ({"tau": [[0.0] * 6, [0.0]]}, r"tau is not an array of real numbers: .*inhomogeneous"),
    ],
)
def test_arguments_of_wrong_shape_or_kind_are_refused(changes, message):
    with pytest.raises(InvalidInput, match=message):
        graphdyn.forward_dynamics(ROBOT, **three_arguments(**changes))


@pytest.mark.parametrize("kind", ["bool", "uint8", "int64", "float16", "float32", ">f8", "longdouble"])
def test_real_numbers_of_every_kind_count_as_what_they_are(kind):
    """Ones and zeros are the same number in every kind; what divides is no integer division."""
    pattern = [1, 0, 0, 1, 1, 0]
    a = graphdyn.forward_dynamics(ROBOT, *(np.array(pattern, dtype=kind) for _ in range(3))).a
    assert np.array_equal(a, graphdyn.forward_dynamics(ROBOT, *(np.array(pattern, dtype=float) for _ in range(3))).a)


@pytest.mark.parametrize("kind", ["complex64", "datetime64[s]", "timedelta64[s]", "object", "S1"])
def test_what_is_no_real_number_is_refused_by_its_kind(kind):
    message = re.escape(f"v is not an array of real numbers but of {np.dtype(kind)}")
    with pytest.raises(InvalidInput, match=message):
        graphdyn.forward_dynamics(ROBOT, X, np.zeros(6, dtype="int64").astype(kind), X)


def spoiled(shape, *indices, value=np.nan):
    array = np.zeros(shape)
    for index in indices:
        array[index] = value
    return array


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"q": spoiled((5, 6), (1, 2), (1, 3), (4, 0))},
            r"q contains nan at row 1, joint 'joint3' \(2 of 5 rows are not finite\); remove or repair them",
        ),
        ({"v": spoiled(6, 5, value=np.inf)}, r"v contains inf at joint 'joint6' \(1 of 1 rows"),
        (
            {"tau": spoiled((2, 5, 6), (1, 3, 0), value=-np.inf)},
            r"tau contains -inf at row \(1, 3\), joint 'joint1' \(1 of 10",
        ),
        (
            {"external_wrenches": spoiled((5, 6, 6), (2, 4, 1))},
            r"external_wrenches contains nan at row 2, joint 'joint5' \(1 of 5 rows are not finite\)",
        ),
    ],
)
def test_first_row_that_is_not_finite_is_named(changes, message):
    with pytest.raises(InvalidInput, match=message):
        graphdyn.forward_dynamics(ROBOT, **three_arguments(**changes))


X = np.zeros(6)

VERBS = {
    "forward_dynamics": lambda bad: graphdyn.forward_dynamics(ROBOT, bad, X, X),
    "inverse_dynamics": lambda bad: graphdyn.inverse_dynamics(ROBOT, X, X, bad),
    "mass_matrix": lambda bad: graphdyn.mass_matrix(ROBOT, bad),
    "bias_torque": lambda bad: graphdyn.bias_torque(ROBOT, X, bad),
    "kkt_system": lambda bad: graphdyn.kkt_system(ROBOT, X, X, bad),
    "maximal_state": lambda bad: graphdyn.maximal_state(ROBOT, X, X, bad),
    "frame_placement": lambda bad: graphdyn.frame_placement(ROBOT, bad, "body1"),
    "body_regressor": lambda bad: graphdyn.body_regressor(ROBOT, X, bad, X),
    "joint_torque_regressor": lambda bad: graphdyn.joint_torque_regressor(ROBOT, bad, X, X),
}


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_refuses_bad_arrays(verb):
    with pytest.raises(InvalidInput, match=r"(q|v|a|tau) has shape \(5,\), expected \(…, 6\)"):
        VERBS[verb](np.zeros(5))
    with pytest.raises(InvalidInput, match=r"(q|v|a|tau) contains nan at joint 'joint2'"):
        VERBS[verb](spoiled(6, 1))


def test_unknown_choices_are_refused():
    for verb in (graphdyn.forward_dynamics, graphdyn.inverse_dynamics):
        with pytest.raises(InvalidInput, match="method is 'sparse'; use one of auto, recursive, projected, dense"):
            verb(ROBOT, X, X, X, method="sparse")
    with pytest.raises(InvalidInput, match="coordinates is 'euler'; use 'twist' or 'cardano'"):
        graphdyn.kkt_system(ROBOT, X, X, X, coordinates="euler")


def test_kkt_system_takes_one_state():
    with pytest.raises(
        InvalidInput,
        match=r"one state expected, got leading dimensions \(3,\) \(q \(3, 6\), .*pass one row at a time",
    ):
        graphdyn.kkt_system(ROBOT, np.zeros((3, 6)), X, X)


def test_maximal_state_arrays_are_refused():
    s = graphdyn.maximal_state(ROBOT, X)
    with pytest.raises(InvalidInput, match=r"rotation has shape \(6, 3\), expected \(…, 6, 3, 3\)"):
        MaximalState(ROBOT, s.position, s.position, s.velocity)
    with pytest.raises(InvalidInput, match=r"acceleration has shape \(3, 6\), expected \(…, 6, 6\)"):
        MaximalState(ROBOT, s.position, s.rotation, s.velocity, np.zeros((3, 6)))
    with pytest.raises(InvalidInput, match="velocity of the maximal state contains NaN or infinity"):
        MaximalState(ROBOT, s.position, s.rotation, spoiled((6, 6), (0, 0)))
    with pytest.raises(
        InvalidInput, match=r"leading dimensions of the maximal state differ: \{'position': \(2,\), 'rotation'"
    ):
        MaximalState(ROBOT, np.stack([s.position] * 2), s.rotation, s.velocity)


def test_open_joint_is_refused_by_name():
    q, v, _ = random_state(ROBOT, 90, size=(4,))
    s = graphdyn.maximal_state(ROBOT, q, v, v)
    position = s.position.copy()
    position[2, 3] += [1e-3, 0, 0]  # body 4 leaves joint 4 in row 2; it carries nothing
    torn = MaximalState(ROBOT, position, s.rotation, s.velocity, s.acceleration)
    message = r"joint 'joint4' is open by .* \(m or rad\) in row 2; a state of robot 'tree6' closes .* 1e-06"
    with pytest.raises(InconsistentState, match=message):
        graphdyn.joint_state(ROBOT, torn)
    with pytest.raises(InconsistentState, match=message):
        graphdyn.joint_acceleration(ROBOT, torn)
    one = MaximalState(ROBOT, position[2], s.rotation[2], s.velocity[2])
    with pytest.raises(InconsistentState, match=r"joint 'joint4' is open by [^ ]* \(m or rad\); a state"):
        graphdyn.joint_state(ROBOT, one)


def test_tilted_axis_is_refused_too():
    """The body stands at its joint but its axis does not: an error of the angle rows alone."""
    robot = NAMED["one_revolute"]
    s = graphdyn.maximal_state(robot, [0.3])
    tilt = graphdyn.maximal_state(robot.with_base(Placement(np.eye(3)[[1, 2, 0]])), [0.3]).rotation
    center = tilt[0] @ robot.bodies[0].center_of_mass
    at_joint = s.position - s.rotation[0] @ robot.bodies[0].center_of_mass + center
    with pytest.raises(InconsistentState, match="joint 'joint1' is open by"):
        graphdyn.joint_state(robot, MaximalState(robot, at_joint, tilt, s.velocity))


def test_acceleration_that_is_missing_is_asked_for():
    with pytest.raises(InvalidInput, match="the maximal state has no acceleration; call maximal_state with a"):
        graphdyn.joint_acceleration(ROBOT, graphdyn.maximal_state(ROBOT, X))


def with_weightless_tip():
    """Joint 'tip' turns a body without mass or inertia: nothing resists it."""
    nothing = Body("ghost", 0.0, np.zeros(3), np.zeros((3, 3)))
    return RobotModel("r", (SOLID, nothing), (hinge("arm"), hinge("tip", inside=1)))


def test_singular_mass_matrix_names_the_joint_and_the_bodies(method):
    message = (
        r"mass matrix of robot 'r' is singular in row 0: joint 'tip' moves without inertia, .*"
        r"\(bodies without mass or inertia: ghost\)"
    )
    x = np.zeros((3, 2))
    with pytest.raises(SingularMassMatrix, match=message):
        graphdyn.forward_dynamics(with_weightless_tip(), x, x, x, method=method)


def test_point_mass_on_its_own_axis_is_singular_in_one_row_only(method):
    """The tip turns about z a point mass on z: no inertia; mounted off the axis it has one."""
    point = Body("point", 1.0, np.array([0, 0, 0.5]), np.zeros((3, 3)))
    swivel = Joint("swivel", "revolute", 1, Placement(), [0, 0, 1.0])
    x = np.zeros(2)
    singular = RobotModel("r", (SOLID, point), (hinge("arm"), swivel))
    with pytest.raises(SingularMassMatrix, match=r"is singular: joint 'swivel' moves .*\(bodies .*: point\)"):
        graphdyn.forward_dynamics(singular, x, x, x, method=method)
    beside = dataclasses.replace(point, center_of_mass=[0.1, 0, 0.5])
    regular = RobotModel("r", (SOLID, beside), (hinge("arm"), swivel))
    assert np.all(np.isfinite(graphdyn.forward_dynamics(regular, x, x, x, method=method).a))


@pytest.mark.usefixtures("default_method")
def test_bodies_with_inertia_that_cancels_point_to_physical_consistency():
    """Negative moments are allowed in a model; where they cancel there is no massless body to name."""
    negative = Body("negative", 1.0, np.zeros(3), -np.eye(3))
    model = RobotModel(
        "r", (dataclasses.replace(SOLID, inertia=np.eye(3)), negative), (hinge("a"), hinge("b", inside=1))
    )
    x = np.zeros(2)
    with pytest.raises(SingularMassMatrix, match=r"joint '[ab]' moves without inertia.*see physical_consistency\(\)"):
        graphdyn.forward_dynamics(model, x, x, x)


def test_kkt_system_of_a_weightless_body_is_refused_when_solved():
    k = graphdyn.kkt_system(with_weightless_tip(), np.zeros(2), np.zeros(2), np.zeros(2))
    assert k.constraint_rank() == 10
    assert k.rank() < 22
    with pytest.raises(
        SingularMassMatrix,
        match=r"the 22×22 system has rank 21 although its constraints are independent: .*physical_consistency\(\)",
    ):
        k.solve()


def test_dependent_constraint_rows_are_named():
    """A row that repeats another one: exactly these two take part."""
    k = graphdyn.kkt_system(ROBOT, X, X, X)
    jacobian = k.constraint_jacobian.copy()
    jacobian[7] = 2 * jacobian[3]
    broken = dataclasses.replace(k, constraint_jacobian=jacobian)
    message = (
        r"constraint Jacobian has rank 29, expected 30; dependent rows: phi_14, phi_23\. .*independent in every pose"
    )
    with pytest.raises(RankDeficientConstraints, match=message) as caught:
        broken.solve()
    assert caught.value.rows == ("phi_14", "phi_23")  # strongest first: the null vector is (2, -1)


def test_dependent_rows_are_found_in_the_first_deficient_system_of_a_batch():
    k = graphdyn.kkt_system(ROBOT, X, X, X)
    jacobian = np.stack([k.constraint_jacobian] * 3)
    jacobian[1, 12] = 0
    broken = dataclasses.replace(
        k, constraint_jacobian=jacobian, zeta=np.stack([k.zeta] * 3), force=np.stack([k.force] * 3)
    )
    assert np.array_equal(broken.constraint_rank(), [30, 29, 30])
    with pytest.raises(RankDeficientConstraints) as caught:
        broken.solve()
    assert caught.value.rows == ("phi_33",)


def test_gimbal_lock_names_the_body_in_lock():
    """R_x(0.3) R_y(π/2): the second body has sin β = 1, the first has β = 0."""
    bodies = (SOLID, dataclasses.replace(SOLID, name="locked"))
    joints = (hinge("roll", axis=[1.0, 0, 0]), hinge("pitch", inside=1, axis=[0, 1.0, 0]))
    robot, x = RobotModel("r", bodies, joints), np.zeros(2)
    with pytest.raises(GimbalLock, match=r"body 'locked' is at .* use coordinates='twist', regular in every pose"):
        graphdyn.kkt_system(robot, [0.3, np.pi / 2], x, x, coordinates="cardano")
    assert graphdyn.kkt_system(robot, [0.3, np.pi / 3], x, x, coordinates="cardano").rank() == 22
