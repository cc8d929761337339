"""graphdyn and Pinocchio agree: on the robots of the command line, on random trees, on the makers' files."""

import functools
import re
import warnings
from itertools import product

import numpy as np
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from long_check import LONG, few
from planting import flagged, mixed_tree
from random_trees import SEEDS, random_rotation, random_tree, topologies
from shared_data import ARMS

import crosscheck
import urdf
from crosscheck.commands.crosscheck.command import DEFAULT_ROBOTS
from crosscheck.quantities import COMPARED, QUANTITIES, RECURSIVE
from crosscheck.quantities.states import RANDOM, cases
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.model.parts import JOINT_KINDS

SAMPLES = 20
TREE_SAMPLES = 5
VENDOR_SAMPLES = 10

MAX_BODIES = 6
EXAMPLES = examples(2)
"""Few: each example is compared at six kinds of states and two for every body."""

VENDOR_ARMS = {"gp8l", "kr16_r1610_2"}
"""Arms that stand for the others, which are long: one without mass, one whose last bodies have none. A link and a joint
of one name are in test_chain. Of those that Pinocchio refuses, test_pinocchio_model has one, and test_inspected all."""

MANIFEST = ARMS.parent / "manifest.tsv"

ROUTES = {"urdf", "model"}
"""Pinocchio builds the same file; Pinocchio is built from our model."""

OF_ONE_ROUTE = {"constraint_rank": "model", "kkt_rank": "model", "base_parameters": "model", "frame_placement": "urdf"}
"""The rest is compared along every route."""

DERIVED = {name for name, row in QUANTITIES.items() if any(form.when != "all" for form in row.forms)}
"""Compared at the random states alone."""


@functools.cache
def comparison_of(robot):
    return crosscheck.compare(robot, SAMPLES, lock=dict(DEFAULT_ROBOTS)[robot] or None)


@functools.cache
def model_of(robot):
    return urdf.load(robot, lock=dict(DEFAULT_ROBOTS)[robot] or None)


@pytest.fixture(params=few([name for name, _ in DEFAULT_ROBOTS], "z1"))
def robot(request):
    return request.param


class TestRobotsOfTheCommandLine:
    def test_agrees(self, robot):
        comparison = comparison_of(robot)
        assert flagged(comparison) == set()
        assert comparison.agrees
        assert comparison.n_bodies == 6
        assert comparison.notes == ()

    def test_nothing_is_left_out(self, robot):
        expected = set(COMPARED) - ({"frame_placement"} if not model_of(robot).frames else set())
        comparison = comparison_of(robot)
        assert set(comparison.quantities) == expected
        assert comparison.not_compared == {}
        assert list(comparison.quantities) == [name for name in COMPARED if name in expected]

    def test_both_routes(self, robot):
        comparison = comparison_of(robot)
        assert set(comparison.routes) == ROUTES
        for name, result in comparison.quantities.items():
            expected = {OF_ONE_ROUTE[name]} if name in OF_ONE_ROUTE else ROUTES
            assert set(result.by_route) == expected

    def test_all_cases(self, robot):
        expected = {case.name for case in cases(model_of(robot), 1, 0)}
        for name, result in comparison_of(robot).quantities.items():
            at_random = name.endswith(RECURSIVE) or name in DERIVED
            only = {"all states"} if name == "base_parameters" else {RANDOM} if at_random else expected
            assert set(result.by_case) == only

    def test_largest_error_is_the_largest(self, robot):
        for result in comparison_of(robot).quantities.values():
            assert result.max_relative_error == max(result.by_case.values()) == max(result.by_route.values())
            if result.worst is not None:
                assert result.by_case[result.worst.case] == result.max_relative_error
                assert result.by_route[result.worst.route] == result.max_relative_error

    def test_gimbal_lock_is_no_worse(self, robot):
        """Where the Cardano form of the paper fails, the same bounds hold."""
        for result in comparison_of(robot).quantities.values():
            locked = [error for case, error in result.by_case.items() if case.startswith("gimbal lock of ")]
            name = result.quantity.name
            without = name == "base_parameters" or name.endswith(RECURSIVE) or name in DERIVED
            assert len(locked) == (0 if without else 6)
            assert max(locked, default=0.0) <= result.quantity.tolerance.bound

    def test_full_rank_everywhere(self, robot):
        conditioning = comparison_of(robot).conditioning
        assert conditioning.constraint_rank == (30, 30)
        assert conditioning.kkt_rank == (66, 66)
        assert 1 <= conditioning.constraint_condition[0] <= conditioning.constraint_condition[1]

    def test_base_parameters(self, robot):
        """36 for the six-joint arms with parallel axes 2 and 3, by both regressors, with a clear gap."""
        identification = comparison_of(robot).identification
        assert identification.rank == identification.rank_there == 36
        accepted, rejected = identification.gap
        assert rejected < 1e-9 < accepted


@pytest.mark.usefixtures("random_states_alone")
def test_robot_model_takes_one_route():
    tree = mixed_tree()
    comparison = crosscheck.compare(tree, 2)
    assert comparison.agrees
    assert comparison.routes == ("model",)
    assert comparison.robot == tree.name
    assert any("RobotModel" in note for note in comparison.notes)
    assert {route for result in comparison.quantities.values() for route in result.by_route} == {"model"}


class TestScalesThatCouldVanish:
    """One joint at the origin: levers, origin accelerations, moments are exactly zero on one side of the comparison."""

    @pytest.mark.parametrize(
        ("kind", "center", "gravity"),
        few(
            [*product(JOINT_KINDS, ("centered", "eccentric"), ("weight", "weightless"))],
            ("revolute", "centered", "weight"), ("prismatic", "centered", "weightless"),
            ("continuous", "eccentric", "weightless"), ("prismatic", "eccentric", "weight"),
        ),
    )  # fmt: skip
    def test_one_joint_at_the_origin(self, kind, center, gravity):
        at, weight = np.array([0.3, -0.5, 0.2]), np.array([0.0, 0.0, -9.81])
        body = Body("only", 7.0, at * (center == "eccentric"), np.diag([0.2, 0.3, 0.25]))
        joint = Joint("joint", kind, 0, Placement(random_rotation(np.random.default_rng(3))), (0.3, 0.5, -0.8))
        model = RobotModel("one joint", (body,), (joint,), gravity=weight * (gravity == "weight"))
        comparison = crosscheck.compare(model, TREE_SAMPLES)
        assert flagged(comparison) == set()
        assert comparison.not_compared == {}

    def test_point_mass_on_a_rail(self):
        """No inertia, no lever: every moment is rounding."""
        point = Body("point", 2.0, np.zeros(3), np.zeros((3, 3)))
        rail = Joint("rail", "prismatic", 0, Placement(random_rotation(np.random.default_rng(1))), (0.3, 0.5, -0.8))
        comparison = crosscheck.compare(RobotModel("rail", (point,), (rail,)), TREE_SAMPLES)
        assert flagged(comparison) == set()


@st.composite
def any_trees(draw, max_bodies=MAX_BODIES):
    """A robot of any topology with joints of all kinds, mounted anywhere, under any gravity."""
    inside, _ = draw(topologies(max_bodies))
    return random_tree(draw(SEEDS), inside, [draw(st.sampled_from(JOINT_KINDS)) for _ in inside])


@EXAMPLES
@given(model=any_trees())
def test_random_trees(model):
    comparison = crosscheck.compare(model, TREE_SAMPLES)
    assert flagged(comparison) == set()
    assert comparison.not_compared == {}


@EXAMPLES
@given(model=any_trees(max_bodies=4))
def test_random_trees_through_a_file(tmp_path_factory, model):
    """Saved, loaded and read by Pinocchio; the base placement becomes a fixed joint, gravity is told again."""
    path = tmp_path_factory.mktemp("trees") / "tree.urdf"
    with pytest.warns(urdf.GravityNotSavedWarning):
        urdf.save(model, path)
    comparison = crosscheck.compare(path, TREE_SAMPLES, gravity=model.gravity)
    assert flagged(comparison) == set()
    assert comparison.routes == ("urdf", "model")
    assert comparison.not_compared == {}


def vendor_files():
    """One parameter per file; a single skipped one where the files are not there."""
    if files := sorted(ARMS.glob("*.urdf")):
        return [pytest.param(path, id=path.stem, marks=[LONG] * (path.stem not in VENDOR_ARMS)) for path in files]
    reason = f"not found: {ARMS}; set GRAPHDYN_TEST_DATA to the folder that holds the shared data"
    return [pytest.param(None, marks=pytest.mark.skip(reason=reason), id="none")]


@functools.cache
def manifest():
    """What the survey of the files found, by file name."""
    head, *rows = (line.split("\t") for line in MANIFEST.read_text(encoding="utf-8").splitlines())
    return {row[0]: dict(zip(head, row, strict=True)) for row in rows}


@pytest.mark.parametrize("path", vendor_files())
def test_vendor_arm(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)  # asserted in the tests of urdf
        model = urdf.load(path)
        comparison = crosscheck.compare(path, VENDOR_SAMPLES)
    assert flagged(comparison) == set()
    entry = manifest()[path.name]
    refused = entry["pinocchio_4.1_loads"].startswith("no")
    assert comparison.routes == (("model",) if refused else ("urdf", "model"))
    assert refused == any("route 'urdf' not taken" in note and path.name in note for note in comparison.notes)
    assert ("frame_placement" in comparison.quantities) == (bool(model.frames) and not refused)
    absent = set(COMPARED) - set(comparison.quantities) - {"frame_placement"}
    assert absent == set(comparison.not_compared)
    forward = {name for name, quantity in COMPARED.items() if quantity.solves}
    massless = not any(body.mass for body in model.bodies)
    if massless:
        assert absent == forward | {name for name, quantity in COMPARED.items() if quantity.massive}
        assert comparison.identification is None
        assert any("no body has mass" in note for note in comparison.notes)
    else:
        assert absent in (set(), forward)
    for name in absent & forward:
        assert re.search(
            "mass matrix .* is singular.*: joint '.+' moves without inertia", comparison.not_compared[name]
        )
    if absent:  # the survey computed the condition number of the mass matrix with Pinocchio
        assert refused or np.isinf(float(entry["cond_mass_matrix"]))
