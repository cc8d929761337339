"""Elements that other formats add to URDF and that are not read: refused or told where they change dynamics."""

import numpy as np
import pytest
import yourdfpy
from inspected.sample import CLEAN, TOOL, changed
from urdf_text import joint, link, robot_text

import urdf
from crosscheck.reference.pinocchio_model import PinocchioModel
from urdf.document.connections.loop_elements import ELEMENT_READERS
from urdf.document.vocabulary import CLOSING_CHILDREN, UNREAD_CHANGES

DRAKE = 'xmlns:drake="http://drake.mit.edu"'
CONSTRAINTS = {
    "drake:joint": f'<drake:joint {DRAKE} name="c" type="ball"><parent link="base"/><child link="fore"/></drake:joint>',
    "drake:tendon_constraint": f"<drake:tendon_constraint {DRAKE}/>",
    "drake:linear_bushing_rpy": f"<drake:linear_bushing_rpy {DRAKE}/>",
    "drake:linear_spring_damper": f"<drake:linear_spring_damper {DRAKE}/>",
    "joint": '<gazebo><joint name="c" type="revolute"><parent>base</parent><child>fore</child></joint></gazebo>',
    "joint:hinge": '<gazebo><joint:hinge xmlns:joint="j" name="c"><body1>base</body1><body2>fore</body2>'
    "</joint:hinge></gazebo>",
    "joint:slider": '<gazebo><joint:slider xmlns:joint="j" name="c"><body1>base</body1></joint:slider></gazebo>',
    "equality": '<mujoco><equality><connect body1="base" body2="fore"/></equality></mujoco>',
    "tendon": "<mujoco><tendon/></mujoco>",
}
"""By tag, an element that is one; written out, so that a tag lost from the table of the package shows."""


def found(path, code):
    return [finding for finding in urdf.inspect(path).findings if finding.code == code]


class TestConstraints:
    def test_all_are_tried(self):
        assert {tag for tags in CLOSING_CHILDREN.values() for tag in tags} == {*CONSTRAINTS, *ELEMENT_READERS}

    @pytest.mark.parametrize("tag", CONSTRAINTS)
    def test_refused(self, written, tag):
        path = written(changed("</robot>", CONSTRAINTS[tag] + "\n</robot>"))
        with pytest.raises(
            urdf.UnsupportedConstraint, match="which is not modeled; remove it to load the robot without it"
        ) as caught:
            urdf.load(path)
        error = caught.value
        assert (error.code, error.line) == ("unsupported-constraint", 37)
        assert error.element == ("joint 'c'" if tag == "joint" else f"<{tag}> of robot 'arm'")
        report = urdf.inspect(path)
        assert (report.verdict, report.usable) == ("refused", False)
        (finding,) = found(path, "unsupported-constraint")
        assert (finding.severity, finding.line, finding.element) == ("error", 37, error.element)

    @pytest.mark.parametrize("tag", CONSTRAINTS)
    def test_other_readers_load_the_tree_without_it(self, written, tag):
        """What the finding says of them."""
        tree = urdf.load(written(CLEAN))
        path = written(changed("</robot>", CONSTRAINTS[tag] + "</robot>"))
        ones = np.ones((1, 2))
        assert np.isfinite(PinocchioModel.from_urdf(path, tree).rnea(ones, ones, ones)).all()
        assert len(yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot.joints) == 3

    def test_a_loop_elsewhere_is_none(self, written):
        """A tag counts where the format has it: a plugin may call anything a loop."""
        odd = "<gazebo><plugin><loop>true</loop><joint>elbow</joint></plugin></gazebo>"
        transmission = '<transmission><joint name="elbow"/><coupling/></transmission>'
        assert urdf.load(written(changed("</robot>", odd + transmission + "</robot>"))).n_bodies == 2


LIMITS = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
GRIPPER = robot_text(
    "gripper",
    *(link(name) for name in ("base", "arm", "hand", "left", "right", "lever")),
    joint("shoulder", "base", "arm", more=LIMITS),
    joint("wrist", "arm", "hand", more=LIMITS),
    joint("l", "hand", "left", more=LIMITS),
    joint("r", "hand", "right", more=LIMITS),
    joint("crank", "base", "lever", more=LIMITS),
    '<loop name="c" type="planar"><predecessor link="left"/><successor link="right"/></loop>',
)


class TestConstraintsWithinOneBody:
    """A loop between links of one body, or between links that are left out, constrains nothing."""

    def test_locked(self, written):
        path = written(GRIPPER)
        assert urdf.load(path, lock=["l", "r"]).n_bodies == 3
        assert "unsupported-constraint" not in urdf.inspect(path, lock=["l", "r"]).codes
        assert "unsupported-constraint" in urdf.inspect(path, lock=["l"]).codes
        with pytest.raises(urdf.UnsupportedConstraint):
            urdf.load(path, lock=["l"])

    def test_carried_by_the_chain(self, written):
        with pytest.warns(urdf.ChainWarning, match=r"are locked at 0: 'l', 'r'"):
            assert urdf.load(written(GRIPPER), chain=("arm", "hand")).n_bodies == 1

    def test_on_the_chain(self, written):
        with pytest.raises(urdf.UnsupportedConstraint):
            urdf.load(written(GRIPPER), chain=("arm", "left"))

    def test_left_out(self, written):
        with pytest.warns(urdf.ChainWarning, match="are left out: 'shoulder'"):
            assert urdf.load(written(GRIPPER), chain=("base", "lever")).n_bodies == 1

    def test_between_the_chain_and_what_is_left_out(self, written):
        path = written(GRIPPER.replace('<successor link="right"/>', '<successor link="lever"/>'))
        with pytest.raises(urdf.UnsupportedConstraint):
            urdf.load(path, chain=("base", "lever"))

    def test_fixed_together(self, written):
        path = written(changed("</robot>", '<loop><predecessor link="fore"/><successor link="tool"/></loop></robot>'))
        assert urdf.load(path).n_bodies == 2
        assert urdf.inspect(path).usable

    def test_a_name_is_no_end(self, written):
        """The loop names one link beside its own name, which is also that of a link."""
        path = written(changed("</robot>", '<loop name="tool"><a link="fore"/></loop></robot>'))
        with pytest.raises(urdf.InvalidLoop):
            urdf.load(path)


def in_robot(text):
    return ("</robot>", f"{text}</robot>")


def on_a_link(text):
    return (TOOL, f'<link name="tool">{text}</link>')


def on_a_joint(text):
    return ('<joint name="flange" type="fixed">', f'<joint name="flange" type="fixed">{text}')


def in_gazebo(text):
    return ("</robot>", f'<gazebo reference="fore">{text}</gazebo></robot>')


def in_mujoco(text):
    return ("</robot>", f"<mujoco>{text}</mujoco></robot>")


def on_an_actuator(text):
    return ("</robot>", f"<transmission {DRAKE}><actuator>{text}</actuator></transmission></robot>")


ROTOR = '<drake:rotor_inertia value="{}"/>'
UNREAD = {
    ("link", "gravity"): (on_a_link, "<gravity>false</gravity>", "<gravity>1</gravity>"),
    ("link", "kinematic"): (on_a_link, "<kinematic>1</kinematic>", "<kinematic>0</kinematic>"),
    ("joint", "joint_properties"): (
        on_a_joint, '<joint_properties damping="0" friction="1"/>', '<joint_properties damping="0.0" friction="0"/>',
    ),
    ("gazebo", "gravity"): (in_gazebo, "<gravity>0</gravity>", "<gravity>true</gravity>"),
    ("gazebo", "turnGravityOff"): (in_gazebo, '<turnGravityOff value="True"/>', "<turnGravityOff>0</turnGravityOff>"),
    ("gazebo", "kinematic"): (in_gazebo, "<kinematic>true</kinematic>", "<kinematic>false</kinematic>"),
    ("gazebo", "static"): (in_gazebo, "<static>true</static>", "<static>false</static>"),
    ("gazebo", "dampingFactor"): (in_gazebo, "<dampingFactor>0.1</dampingFactor>", "<dampingFactor>0</dampingFactor>"),
    ("gazebo", "velocity_decay"): (in_gazebo, "<velocity_decay/>", "<implicitSpringDamper>1</implicitSpringDamper>"),
    ("gazebo", "springStiffness"): (in_gazebo, '<springStiffness value="5"/>', '<springStiffness value="0"/>'),
    ("gazebo", "inertial"): (in_gazebo, "<inertial/>", "<material>Gazebo/Red</material><selfCollide>1</selfCollide>"),
    ("gazebo", "link"): (in_gazebo, "<link/>", '<sensor name="imu" type="imu"/>'),
    ("gazebo", "model"): (in_gazebo, "<model/>", '<plugin name="p" filename="p.so"><model>a</model></plugin>'),
    ("gazebo", "include"): (in_gazebo, "<include/>", "<visual/>"),
    ("gazebo", "enable_wind"): (in_gazebo, "<enable_wind>true</enable_wind>", "<enable_wind>false</enable_wind>"),
    ("actuator", "drake:rotor_inertia"): (on_an_actuator, ROTOR.format("1e-4"), ROTOR.format("0")),
    ("mujoco", "compiler"): (
        in_mujoco, '<compiler balanceinertia="true"/>', '<compiler meshdir="m" balanceinertia="false"/>',
    ),
    ("mujoco", "option"): (in_mujoco, '<option gravity="0 0 0"/>', '<option timestep="0.002"/>'),
}  # fmt: skip
"""By element and tag: where it stands, a value that changes dynamics, and something harmless there."""


class TestWhatIsNotRead:
    def test_all_are_tried(self):
        assert {(kind, tag) for kind, tags in UNREAD_CHANGES.items() for tag in tags} == set(UNREAD)

    @pytest.mark.parametrize("place", UNREAD, ids="-".join)
    def test_told(self, written, place):
        (kind, tag), (where, text, _) = place, UNREAD[place]
        path = written(changed(*where(text)))
        with pytest.warns(urdf.UnreadWarning, match=rf"arm\.urdf: not read: line \d+: <{tag}> in <{kind}> "):
            model = urdf.load(path)
        assert model.n_bodies == 2
        report = urdf.inspect(path)
        (finding,) = (finding for finding in report.findings if finding.code == "unread-dynamics")
        assert (finding.severity, finding.line) == ("warning", path.read_text().split(text)[0].count("\n") + 1)
        assert f"<{tag}> in <{kind}> " in finding.message

    @pytest.mark.parametrize("place", UNREAD, ids="-".join)
    def test_not_told(self, written, place):
        where, _, harmless = UNREAD[place]
        path = written(changed(*where(harmless)))
        assert urdf.load(path).n_bodies == 2
        assert {"unread-dynamics", "unknown-element"}.isdisjoint(urdf.inspect(path).codes)

    def test_many_of_one_kind(self, written):
        path = written(changed("</robot>", "\n<gazebo><turnGravityOff>true</turnGravityOff></gazebo>" * 3 + "</robot>"))
        (finding,) = found(path, "unread-dynamics")
        assert finding.line == 38
        assert finding.message.startswith(
            "<turnGravityOff> in <gazebo> turns gravity off for a link: not read (3 such places). Pinocchio"
        )

    def test_a_long_list_is_shortened(self, written):
        unknown = "".join(f"<a{k}/>" for k in range(22))
        path = written(changed("</robot>", unknown + "</robot>"))
        with pytest.warns(urdf.UnreadWarning, match=r"line 37: URDF knows no <a19> in <robot> and 2 more$"):
            urdf.load(path)

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            (("<limit lower", '<limits/><limit lower'), "line 23: URDF knows no <limits> in <joint>"),
            (('<mass value="2.5"/>', '<mass value="2.5"/><Origin/>'), "line 6: URDF knows no <Origin> in <inertial>"),
            (('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"><limit/></axis>'), "line 22: URDF knows no <limit> in <axis>"),
            (("</robot>", "<robot/></robot>"), "line 37: URDF knows no <robot> in <robot>"),
            (("</robot>", '<x:loop xmlns:x="u"/></robot>'), "line 37: URDF knows no <x:loop> in <robot>"),
            (('value="2.5"/>', 'value="2.5" unit="g"/>'), "line 6: URDF knows no attribute 'unit' of <mass>"),
            (('<origin xyz="0 0 0.2"', '<origin xzy="0 0 0.2"'), "line 33: URDF knows no attribute 'xzy' of <origin>"),
        ],
    )  # fmt: skip
    def test_unknown(self, written, changes, message):
        with pytest.warns(urdf.UnreadWarning, match=f"not read: {message}$"):
            urdf.load(written(changed(*changes)))

    @pytest.mark.parametrize(
        ("where", "tags"),
        [
            (in_robot, "material transmission gazebo ros2_control mujoco sensor frame "
             "plugin group group_state end_effector virtual_joint disable_collisions author license capsule"),
            (on_a_link, "visual collision contact surface sensor origin material self_filter self_collision_checking "
             "collision_checking gravity kinematic"),
            (on_a_joint, "axis limit dynamics mimic calibration safety_controller joint_properties hardwareInterface"),
        ],
        ids=["robot", "link", "joint"],
    )  # fmt: skip
    def test_harmless(self, written, where, tags):
        path = written(changed(*where("".join(f"<{tag}/>" for tag in tags.split()))))
        assert urdf.load(path).n_bodies == 2
        assert {"unread-dynamics", "unknown-element"}.isdisjoint(urdf.inspect(path).codes)

    @pytest.mark.parametrize(
        "changes",
        [
            on_a_joint("<axis xyz='0 0 1'/><limit effort='1' velocity='1'/><mimic joint='elbow'/><calibration/>"),
            on_a_link('<visual><origin/><loop/></visual><collision><wrong/></collision><self_collision_checking/>'),
            ("</robot>", '<ros2_control><joint name="elbow"/></ros2_control><material name="m"/><sensor/></robot>'),
            ('<origin xyz="0 0 0.2"', f'<origin {DRAKE} drake:note="x" xyz="0 0 0.2"'),
            ("</robot>", '<x:macro xmlns:x="http://www.ros.org/wiki/xacro/"/></robot>'),
        ],
    )  # fmt: skip
    def test_known(self, written, changes):
        path = written(changed(*changes))
        assert urdf.load(path).n_bodies == 2
        assert {"unread-dynamics", "unknown-element", "unknown-attribute"}.isdisjoint(urdf.inspect(path).codes)


class TestQuaternions:
    """URDF 1.1 has a second way to write a rotation, which Pinocchio reads."""

    QUATERNION = ('xyz="0.3 0 0" rpy="0 0 0"', 'xyz="0.3 0 0" quat_xyzw="0 0 0.6 0.8"')

    def torque(self, path):
        ones = np.ones((1, 2))
        return PinocchioModel.from_urdf(path, urdf.load(changed())).rnea(ones, ones, ones)

    @pytest.mark.parametrize("version", ["1.0", "1.1", "1.2"])
    def test_refused(self, written, version):
        path = written(changed('name="arm"', f'name="arm" version="{version}"', *self.QUATERNION))
        with pytest.raises(urdf.InvalidRobot, match=r"attribute 'quat_xyzw' is not read; give the rotation as rpy"):
            urdf.load(path)
        read = not np.allclose(self.torque(path), self.torque(written(CLEAN)))
        assert read == (version != "1.0")

    def test_where_it_is_not_read(self, written):
        path = written(changed(*on_a_link('<visual><origin quat_xyzw="0 0 0 1"/></visual>')))
        assert urdf.load(path).n_bodies == 2
