"""Robots by name."""

import sys
from importlib import metadata
from pathlib import Path

import pytest
from numpy.testing import assert_array_equal

import urdf
from urdf.document import catalog, described_robots


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


@pytest.mark.parametrize("name", ["UR5", "Ur5"])
def test_capitals_make_no_difference(name):
    assert urdf.load(name).name == "ur5"


def test_close_names_have_other_capitals():
    with pytest.raises(urdf.RobotNotFound, match=r"close names: ur5[,;]"):
        urdf.load("UR5_")


@pytest.fixture
def described(tmp_path, monkeypatch, arm):
    """A package robot_descriptions that has two robots, and a cache that has the files of one."""
    package, cache = tmp_path / "packages" / "robot_descriptions", tmp_path / "cache"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "_repositories.py").write_text(
        "from types import SimpleNamespace\n"
        "REPOSITORIES = {name: SimpleNamespace(cache_path=f'{name}_files') for name in ('here', 'away')}\n"
    )
    (package / "_cache.py").write_text("def clone_to_cache(name, commit=None):\n    raise AssertionError('download')\n")
    for robot, repository in (("ur5e", "here"), ("ur16e", "away")):
        (package / f"{robot}_description.py").write_text(
            "from ._cache import clone_to_cache\n"
            f"URDF_PATH = clone_to_cache('{repository}', commit=None) + '/arm.urdf'\n"
        )
    (cache / "here_files").mkdir(parents=True)
    arm().rename(cache / "here_files" / "arm.urdf")
    monkeypatch.syspath_prepend(package.parent)
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(cache))
    for name in [name for name in sys.modules if name.partition(".")[0] == "robot_descriptions"]:
        monkeypatch.delitem(sys.modules, name)
    yield
    for name in [name for name in sys.modules if name.partition(".")[0] == "robot_descriptions"]:
        del sys.modules[name]


@pytest.mark.usefixtures("described")
@pytest.mark.parametrize("name", ["ur5e_description", "ur5e", "UR5e"])
def test_a_robot_of_robot_descriptions_that_is_in_its_cache(name):
    assert urdf.load(name).name == "arm"


@pytest.mark.usefixtures("described")
def test_a_robot_of_robot_descriptions_that_is_not_there_is_not_fetched():
    with pytest.raises(
        urdf.RobotNotFound,
        match=r"The package robot_descriptions has it; run: python -m robot_descriptions pull ur16e_description",
    ):
        urdf.load("ur16e")


def test_without_robot_descriptions(monkeypatch):
    monkeypatch.setattr(described_robots, "PACKAGE", "robot_descriptions_that_nobody_installed")
    with pytest.raises(urdf.RobotNotFound, match=r"may be one of the package robot_descriptions; run: python -m pip"):
        urdf.load("m10_description")


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
