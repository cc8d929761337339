"""urdf.save: what is written, and that urdf.load gives the model back."""

import os
import stat
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import graphdyn
import urdf
from graphdyn import Body, Frame, Joint, JointLimits, Placement, RobotModel
from urdf.document.numbers import NO_LIMIT

E1, E2, E3 = np.eye(3)


def one_joint(joint: Joint | None = None, **changes: object) -> RobotModel:
    body = Body("body", 2.0, np.array([0.1, 0.2, 0.3]), np.diag([0.1, 0.2, 0.25]))
    joint = joint or Joint("joint", "revolute", 0, Placement(), E3)
    return RobotModel("one", (body,), (joint,), **changes)  # type: ignore[arg-type]


def reload(model: RobotModel, folder: Path) -> RobotModel:
    path = folder / "saved.urdf"
    urdf.save(model, path)
    return urdf.load(path)


def test_base_named_world(tmp_path):
    model = one_joint(base=Placement(translation=E1), base_name="world")
    assert reload(model, tmp_path).base_name == "world_1"


def test_order_of_another_numbering_becomes_depth_first(tmp_path):
    names = ("b1", "b2", "b3")
    tree = [Joint(f"j{k}", "revolute", inside, Placement(), E3) for k, inside in ((1, 0), (2, 0), (3, 1))]
    model = RobotModel("wide", tuple(Body(name, 1.0, E1, np.eye(3)) for name in names), tuple(tree))
    assert reload(model, tmp_path).body_names == ("b1", "b3", "b2")


def test_names_of_frames(tmp_path):
    frames = (
        Frame("joint", 1, Placement()),  # a joint has this name: the fixed joint gets another
        Frame("tool", 1, Placement(translation=E1), aliases=("flange", "tcp")),
    )
    again = reload(one_joint(frames=frames), tmp_path)
    assert [(frame.name, frame.aliases) for frame in again.frames] == [
        ("joint", ("joint_1",)),
        ("tool", ("flange",)),
        ("tcp", ()),
    ]
    assert_array_equal(again.frame("tcp").placement.translation, E1)


def test_missing_limits_are_written_as_the_largest_double(tmp_path):
    path = tmp_path / "saved.urdf"
    urdf.save(one_joint(), path)
    assert f'<limit effort="{NO_LIMIT!r}" velocity="{NO_LIMIT!r}"/>' in path.read_text()
    assert urdf.load(path).joints[0].limits == JointLimits()


@pytest.mark.parametrize("given", [{"lower": -1.0}, {"upper": 2.0}])
def test_a_single_bound_is_not_taken_as_zero_on_the_other_side(tmp_path, given):
    """Readers of URDF take a missing lower or upper as zero."""
    limits = JointLimits(**given)
    model = one_joint(Joint("joint", "revolute", 0, Placement(), E3, limits))
    assert reload(model, tmp_path).joints[0].limits == limits
    text = (tmp_path / "saved.urdf").read_text()
    assert 'lower="' in text
    assert 'upper="' in text


def test_position_limits_of_a_continuous_joint_are_not_written(tmp_path):
    limits = JointLimits(lower=-1, upper=1)
    model = one_joint(Joint("joint", "continuous", 0, Placement(), E3, limits))
    assert reload(model, tmp_path).joints[0].limits == JointLimits()
    assert "<limit" not in (tmp_path / "saved.urdf").read_text()


def test_body_without_mass_comes_back_with_the_warning(tmp_path):
    model = one_joint().with_inertial_parameters(np.zeros(10))
    with pytest.warns(urdf.MissingInertialWarning, match="'body'"):
        assert reload(model, tmp_path).bodies[0].mass == 0


def test_body_without_mass_keeps_its_tensor(tmp_path):
    joint = Joint("joint", "revolute", 0, Placement(), E3)
    heavy_to_turn = Body("b", 0.0, np.zeros(3), np.diag([0.1, 0.2, 0.25]))
    with pytest.warns(urdf.ZeroMassWarning, match="'b'"):
        (body,) = reload(RobotModel("r", (heavy_to_turn,), (joint,)), tmp_path).bodies
    assert body.mass == 0
    assert_array_equal(body.inertia, np.diag([0.1, 0.2, 0.25]))


def test_body_without_tensor_keeps_its_mass(tmp_path):
    joint = Joint("joint", "revolute", 0, Placement(), E3)
    (body,) = reload(RobotModel("r", (Body("b", 2.5, E1, np.zeros((3, 3))),), (joint,)), tmp_path).bodies
    assert body.mass == 2.5
    assert_array_equal(body.center_of_mass, E1)


def test_gravity_is_not_saved(tmp_path):
    path = tmp_path / "saved.urdf"
    with pytest.warns(
        urdf.GravityNotSavedWarning,
        match=r"cannot state gravity; reload with urdf.load\(..., gravity=\[0.0, 0.0, -1.62\]\)",
    ) as caught:
        urdf.save(one_joint(gravity=(0, 0, -1.62)), path)
    assert caught[0].filename == __file__
    assert path.is_file()


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (one_joint(base_name=""), r"the robot, a link, a joint or a chord has an empty name; give it a name"),
        (one_joint(frames=(Frame("a\x00b", 1, Placement()),)), r"the name 'a\\x00b' cannot stand in XML; rename it"),
        (one_joint(frames=(Frame("f", 1, Placement(), ("\x01",)),)), r"the name '\\x01' cannot stand in XML"),
    ],
)
def test_names_that_cannot_be_saved(tmp_path, model, message):
    with pytest.raises(urdf.CannotSave, match=message):
        urdf.save(model, tmp_path / "saved.urdf")
    assert list(tmp_path.iterdir()) == []


def test_special_characters_in_names(tmp_path):
    name = 'a <b> & "c"\n\té'
    assert reload(one_joint(frames=(Frame(name, 1, Placement()),)), tmp_path).frames[0].name == name


def test_nothing_is_left_behind_on_failure(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match="folder"):
        urdf.save(one_joint(), tmp_path / "folder")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


def test_an_existing_file_is_replaced(tmp_path):
    path = tmp_path / "saved.urdf"
    path.write_text("before")
    urdf.save(one_joint(), str(path))
    assert urdf.load(path).name == "one"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(os.name != "posix", reason="links and permissions of POSIX files")
def test_a_link_is_followed_and_permissions_stay(tmp_path):
    target, link = tmp_path / "target.urdf", tmp_path / "link.urdf"
    target.write_text("before")
    target.chmod(0o640)
    link.symlink_to(target)
    urdf.save(one_joint(), link)
    assert link.is_symlink()
    assert urdf.load(target).name == "one"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert sorted(tmp_path.iterdir()) == [link, target]


@pytest.mark.skipif(os.name != "posix", reason="pipes of POSIX")
def test_what_is_no_regular_file_is_written_to(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    received = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_bytes()))
    reader.start()
    urdf.save(one_joint(), pipe)
    reader.join()
    assert received[0].startswith(b"<?xml")
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_the_message_names_the_path_that_was_asked_for(tmp_path):
    path = tmp_path / "no" / "such" / "saved.urdf"
    with pytest.raises(FileNotFoundError) as caught:
        urdf.save(one_joint(), path)
    assert caught.value.filename == str(path)


def test_the_packaged_kr500_is_what_save_writes(tmp_path):
    path = tmp_path / "kr500.urdf"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.GravityNotSavedWarning)
        urdf.save(graphdyn.kr500(), path)
    (packaged,) = (entry.path for entry in urdf.robots() if entry.name == "kr500")
    assert path.read_bytes() == packaged.read_bytes()


def test_the_packaged_kr500_is_the_robot_of_the_paper():
    loaded, built = urdf.load("kr500"), graphdyn.kr500()
    assert_array_equal(loaded.inertial_parameters, built.inertial_parameters)
    assert_array_equal(loaded.gravity, built.gravity)
    for got, expected in zip(loaded.joints, built.joints, strict=True):
        assert_array_equal(got.placement.translation, expected.placement.translation)
        assert_allclose(got.placement.rotation, expected.placement.rotation, rtol=0, atol=1e-15)
        assert_array_equal(got.axis, expected.axis)
