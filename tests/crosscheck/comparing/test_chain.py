"""An arm cut out of a larger robot, against Pinocchio's reading of the whole robot with all other joints locked."""

import dataclasses
import json
import warnings

import numpy as np
import pytest
from long_check import LONG
from planting import flagged
from typer.testing import CliRunner
from urdf_text import joint, link, robot_text

import crosscheck
import urdf
from crosscheck.commands import app
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.report.html import page as page_of
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text
from graphdyn import InvalidInput, kr500
from urdf.document.catalog import locate

SAMPLES = 10
ARM = ("torso", "tool")

pytestmark = pytest.mark.filterwarnings(
    "ignore::urdf.ChainWarning", "ignore::urdf.MimicJointWarning", "ignore::urdf.UnreadWarning"
)


@pytest.mark.parametrize(
    ("robot", "chain", "lock", "n_bodies"),
    [
        pytest.param(
            "talos_reduced",
            ("torso_1_link", "arm_right_5_link"),
            {"arm_left_1_joint": 0.3, "torso_2_joint": 0.1},
            5,
            marks=LONG,
        ),
        pytest.param("pr2", ("torso_lift_link", "r_gripper_tool_frame"), None, 7, marks=LONG),
        ("xarm7", ("link_base", "link5"), {"joint2": -0.7}, 4),
    ],
)
def test_arms_of_robots(robot, chain, lock, n_bodies):
    comparison = crosscheck.compare(robot, SAMPLES, chain=chain, lock=lock)
    assert (comparison.n_bodies, comparison.routes) == (n_bodies, ("urdf", "model"))
    assert flagged(comparison) == set()


TILTED = robot_text(
    "tilted",
    link("ground"), link("torso", 2.0), link("arm", 1.5, xyz="0.1 0 0.2"), link("tool", 0.4, xyz="0 0.1 0"),
    link("finger", 0.2, xyz="0 0.1 0.1"), link("other"),
    joint("z_turn", "ground", "torso", "continuous", '<origin xyz="0 0 1" rpy="0.7 -0.4 0.3"/><axis xyz="0 0 1"/>'),
    joint("y_lift", "torso", "arm", "revolute", '<origin xyz="0.1 0.2 0" rpy="0.2 0 0"/><axis xyz="0 1 0"/>'
          '<limit lower="-1" upper="1" effort="1" velocity="1"/>'),
    joint("x_roll", "arm", "tool", "continuous", '<origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>'),
    joint("grip", "tool", "finger", "prismatic", '<origin xyz="0 0.03 0"/><axis xyz="0 1 0"/>'
          '<limit lower="-1" upper="1" effort="1" velocity="1"/>'),
    joint("leg", "torso", "other", "continuous", '<axis xyz="0 1 0"/>'),
)  # fmt: skip
"""One joint before the chain ("torso", "tool"), which tilts it, one on its base, one carried along."""


@pytest.fixture
def tilted(tmp_path):
    path = tmp_path / "tilted.urdf"
    path.write_text(TILTED, encoding="utf-8")
    return path


@LONG
def test_a_tilted_base_link(tilted):
    comparison = crosscheck.compare(tilted, SAMPLES, chain=ARM)
    assert comparison.model.joint_names == ("y_lift", "x_roll")
    assert flagged(comparison) == set()


def test_another_load_is_noticed(tilted):
    """The reference reads the file by itself: the gripper held elsewhere is a disagreement."""
    model = urdf.load(tilted, chain=("torso", "tool"), lock={"grip": 0.07})
    q, v = model.random_state(np.random.default_rng(0), 5)
    ours = PinocchioModel.from_model(model).rnea(q, v, v)
    readings = (urdf.Reading(chain=("torso", "tool"), lock={"grip": value}) for value in (0.07, 0.08))
    there, elsewhere = (PinocchioModel.from_urdf(tilted, model, reading).rnea(q, v, v) for reading in readings)
    assert abs(ours - there).max() < 1e-13
    assert abs(ours - elsewhere).max() > 1e-3


def test_a_link_and_a_joint_of_one_name(tilted):
    """Pinocchio cannot hold a joint in front of them: the model route remains, and the report says so."""
    tilted.write_text(TILTED.replace("y_lift", "arm"), encoding="utf-8")
    comparison = crosscheck.compare(tilted, 2, chain=ARM)
    assert (comparison.n_bodies, comparison.routes) == (2, ("model",))
    assert "route 'urdf' not taken: Pinocchio cannot read" in comparison.notes[0]
    assert "Several frames match" in comparison.notes[0]
    assert flagged(comparison) == set()


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    path = tmp_path_factory.mktemp("tilted") / "tilted.urdf"
    path.write_text(TILTED, encoding="utf-8")
    with warnings.catch_warnings(action="ignore"):
        return crosscheck.compare(path, SAMPLES, chain=ARM, lock={"grip": 0.07})


@pytest.fixture(scope="module")
def page(comparison):
    return page_of(crosscheck_report([comparison]), ["graphdyn"], {})


class TestReports:
    def test_agrees(self, comparison):
        assert comparison.routes == ("urdf", "model")
        assert comparison.model.joint_names == ("y_lift", "x_roll")
        assert flagged(comparison) == set()

    def test_heading(self, comparison):
        text = as_text(crosscheck_report([comparison]))
        assert "2 joints from torso to tool, locked: grip = 0.07; " in text

    def test_page(self, page):
        assert "2 joints from torso to tool, locked: grip = 0.07" in " ".join(page.split())

    def test_snippet(self, page):
        page = page.replace("&#39;", "'").replace("&#x27;", "'")
        assert "chain=('torso', 'tool'), lock={'grip': 0.07}" in page
        assert "model, urdf.Reading(chain=('torso', 'tool'), lock={" in page

    def test_json(self, comparison):
        assert plain(robot_record(comparison))["chain"] == list(ARM)

    @pytest.mark.usefixtures("unpictured")
    def test_without_a_chain(self, comparison):
        whole = dataclasses.replace(comparison, reading=urdf.Reading())
        assert plain(robot_record(whole))["chain"] is None
        assert "2 joints; " in as_text(crosscheck_report([whole]))
        assert "chain=" not in page_of(crosscheck_report([whole]), ["graphdyn"], {})


@pytest.mark.usefixtures("random_states_alone")
def test_command(tilted, tmp_path):
    out = tmp_path / "out.json"
    done = CliRunner().invoke(
        app, ["crosscheck", str(tilted), "--samples", "2", "--chain", "torso", "tool", "--json", str(out)]
    )
    assert done.exit_code == 0, done.output
    (record,) = json.loads(out.read_text(encoding="utf-8"))["robots"]
    assert (record["chain"], record["n_bodies"]) == (["torso", "tool"], 2)


def test_a_chain_of_a_model_is_refused():
    with pytest.raises(InvalidInput, match="chain: only for names and files; a RobotModel already"):
        crosscheck.compare(kr500(), chain=("a", "b"))


def test_xml_is_refused():
    with pytest.raises(InvalidInput, match=r"XML is given in place of a name or path; give the file, or urdf\.load"):
        crosscheck.compare(TILTED)


def test_what_is_no_robot_is_refused():
    with pytest.raises(InvalidInput, match="the robot is of type float; give a name, a path or a RobotModel"):
        crosscheck.compare(3.5)


def test_the_whole_robot_needs_no_chain():
    """Cutting from the root to the tip of a serial arm changes nothing."""
    path, _ = locate("ur5")
    assert urdf.load(path, chain=("world", "tool0")).joint_names == urdf.load(path).joint_names
