"""Robots by name."""

from importlib import metadata
from pathlib import Path

import pytest
from numpy.testing import assert_array_equal

import urdf
from urdf.document import catalog


@pytest.fixture
def nothing_installed(monkeypatch):
    """A world in which the distribution example-robot-data is not installed."""
    monkeypatch.setattr(catalog, "DISTRIBUTION", "example-robot-data-that-nobody-installed")
    catalog.robots.cache_clear()
    yield
    monkeypatch.undo()
    catalog.robots.cache_clear()


def entries() -> dict[str, urdf.RobotEntry]:
    return {entry.name: entry for entry in urdf.robots()}


def test_every_name_is_one_existing_file():
    listed = urdf.robots()
    assert len(entries()) == len(listed) > 60
    assert len({entry.path for entry in listed}) == len(listed)
    assert all(entry.path.is_file() for entry in listed)
    assert all(entry.licence and entry.origin for entry in listed)


@pytest.mark.parametrize(
    ("name", "end"),
    [
        ("ur3", "ur_description/urdf/ur3_robot.urdf"),
        ("ur_description/ur3", "ur_description/urdf/ur3.urdf"),
        ("ur5", "ur5_robot.urdf"),
        ("ur10_joint_limited", "ur10_joint_limited_robot.urdf"),
        ("anymal_b_simple_description/anymal", "anymal_b_simple_description/robots/anymal.urdf"),
        ("anymal_c_simple_description/anymal", "anymal_c_simple_description/urdf/anymal.urdf"),
        ("panda", "panda_description/urdf/panda.urdf"),
    ],
)
def test_names(name, end):
    assert entries()[name].path.as_posix().endswith(end)


def test_ambiguous_name_is_not_taken():
    assert "anymal" not in entries()


def test_origin_and_licence():
    kr500, ur5, panda = (entries()[name] for name in ("kr500", "ur5", "panda"))
    assert (kr500.origin, kr500.licence) == ("graphdyn: geometry of the paper's KR500", "BSD-3-Clause")
    version = metadata.version("example-robot-data")
    assert ur5.origin == f"example-robot-data {version}: robots/ur_description/urdf/ur5_robot.urdf"
    assert ur5.licence == "BSD-3-Clause"
    assert panda.licence == "see robots/panda_description/LICENSE of example-robot-data"


@pytest.mark.parametrize("name", ["ur3", "ur5", "ur10", "kinova", "z1", "talos_left_arm", "solo12"])
def test_robots_load(name):
    assert_array_equal(urdf.load(name).gravity, [0, 0, -9.81])


def test_a_robot_that_is_refused_says_why():
    with pytest.raises(urdf.MissingEntry, match=r"ur3.urdf:6: <robot>: attribute 'name' is missing"):
        urdf.load("ur_description/ur3")


def test_gravity_of_the_paper():
    assert_array_equal(urdf.load("kr500").gravity, [0, 0, -9.80665])
    assert_array_equal(urdf.load("kr500", gravity=(0, 0, -1)).gravity, [0, 0, -1])
    assert_array_equal(urdf.load(entries()["kr500"].path).gravity, [0, 0, -9.81])


def test_unknown_name_lists_close_ones():
    with pytest.raises(
        urdf.RobotNotFound,
        match=r"'kinowa' is neither a file nor a robot .*; close names: kinova.*; `graphdyn robots` lists",
    ):
        urdf.load("kinowa")


@pytest.mark.parametrize("name", ["UR5", "Ur5", "ur5_"])
def test_close_names_have_other_capitals(name):
    with pytest.raises(urdf.RobotNotFound, match=r"close names: ur5[,;]"):
        urdf.load(name)


def test_nothing_close():
    with pytest.raises(urdf.RobotNotFound, match=r"'@@@' is neither .*; `graphdyn robots` lists all names$"):
        urdf.load("@@@")


def test_missing_path_is_not_a_name(tmp_path):
    with pytest.raises(urdf.RobotNotFound, match=r"'ur5' is not a file; give a file, or a robot's name as a string"):
        urdf.load(Path("ur5"))
    with pytest.raises(urdf.RobotNotFound, match=r"' is a folder; give a URDF file in it$"):
        urdf.load(tmp_path)


def test_string_that_is_a_file(arm):
    assert urdf.load(str(arm())).name == "arm"


@pytest.mark.usefixtures("nothing_installed")
def test_without_the_robots_of_others():
    assert [entry.name for entry in urdf.robots()] == ["kr500"]
    assert urdf.load("kr500").n_bodies == 6
    with pytest.raises(
        urdf.RobotNotFound, match=r"Most robots come with the package example-robot-data.*not installed"
    ):
        urdf.load("ur5")
