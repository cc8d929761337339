"""Damaged MJCF files: each is refused with its line, what is wrong there, and what to do about it."""

import re

import pytest

import urdf

GOOD = """<mujoco model="arm">
  <compiler angle="radian"/>
  <worldbody>
    <body name="upper" pos="0 0 0.1">
      <inertial pos="0 0 0.1" mass="2" diaginertia="0.02 0.02 0.01"/>
      <joint name="shoulder" axis="0 0 1" range="-1 1"/>
      <body name="fore" pos="0 0 0.3">
        <inertial pos="0 0 0.1" mass="1" fullinertia="0.01 0.01 0.01 0 0 0"/>
        <joint name="elbow" axis="0 1 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

TENSOR, ELBOW, FORE = '"0.01 0.01 0.01 0 0 0"', 'axis="0 1 0"', 'pos="0 0 0.3"'
REFUSED = "MuJoCo refuses the file"


def put(old, new):
    assert GOOD.count(old) == 1
    return GOOD.replace(old, new)


def beside(element):
    return put("</worldbody>", f"</worldbody>{element}")


DAMAGED = {
    "cut in an element": (GOOD[: GOOD.index("fullinertia")], 8, "not well-formed XML: Couldn't find end of Start Tag"),
    "cut between elements": (GOOD[: GOOD.index('<joint name="elbow')], 9, "Premature end of data in tag body"),
    "two roots": (GOOD + GOOD, 14, "Extra content at the end of the document"),
    "no body": ("<mujoco><worldbody/></mujoco>", None, "no moving body: every joint is fixed or locked; leave a joint"),
    "entity": ('<!DOCTYPE a [<!ENTITY b "c">]>' + GOOD, None, "the document declares XML entities; write their text"),
    "element": (put('<joint name="elbow"', '<hinge name="elbow"'), 9, f"{REFUSED}: .*unrecognized element .*'hinge'"),
    "attribute": (put('mass="1"', 'mas="1"'), 8, f"{REFUSED}: .*unrecognized attribute: 'mas' .*'inertial'"),
    "joint twice": (put('"elbow"', '"shoulder"'), 9, f"{REFUSED}: .*repeated name 'shoulder' in joint"),
    "body twice": (put('"fore"', '"upper"'), 7, f"{REFUSED}: .*repeated name 'upper' in body"),
    "axis of zeros": (put(ELBOW, 'axis="0 0 0"'), 9, f"{REFUSED}: axis too small .*'elbow'"),
    "axis of two": (put(ELBOW, 'axis="0 1"'), 9, f"{REFUSED}: attribute 'axis' does not have enough data"),
    "axis of four": (put(ELBOW, 'axis="0 1 0 0"'), 9, f"{REFUSED}: attribute 'axis' has too much data"),
    "axis in words": (put(ELBOW, 'axis="y"'), 9, f"{REFUSED}: bad format in attribute 'axis'"),
    "type": (put(ELBOW, 'type="revolute"'), 9, f"{REFUSED}: invalid keyword: 'revolute'"),
    "range": (put('range="-1 1"', 'range="1"'), 6, f"{REFUSED}: attribute 'range' does not have enough data"),
    "armature": (put(ELBOW, 'armature="-1"'), 9, "joint 'elbow': armature is -1; give the inertia of the rotor, or 0"),
    "unit": (put('mass="1"', 'mass="1 kg"'), 8, f"{REFUSED}: bad format in attribute 'mass'"),
    "no mass": (put('mass="1" ', ""), 8, f"{REFUSED}: required attribute missing: 'mass'"),
    "negative mass": (put('mass="1"', 'mass="-1"'), 7, f"{REFUSED}: mass and inertia of moving bodies must be larger"),
    "mass too large": (put('mass="1"', 'mass="1e999"'), 8, f"{REFUSED}: number is too large in attribute 'mass'"),
    "mass absurd": (put('mass="1"', 'mass="1e300"'), 7, r"<mass> of link 'fore': .*1e\+300.* is too large for a robot"),
    "length absurd": (put(FORE, 'pos="0 0 1e200"'), 9, r"<origin> of joint 'elbow': .*1e\+200.* is too large"),
    "no number": (put('mass="1"', 'mass="nan"'), 8, "<inertial>: attribute 'mass' is not a number; give a finite"),
    "infinite mass": (put('mass="1"', 'mass="inf"'), 8, "<inertial>: attribute 'mass' is infinite; give a finite"),
    "infinite length": (put(FORE, 'pos="0 0 -inf"'), 7, "<body>: attribute 'pos' is infinite; give a finite number"),
    "infinite turn": (put(FORE, 'quat="inf 0 0 0"'), 7, "<body>: attribute 'quat' is infinite; give a finite number"),
    "infinite ref": (put(ELBOW, 'ref="Infinity"'), 9, "<joint>: attribute 'ref' is infinite; give a finite number"),
    "infinite default": (
        beside('<default><joint armature="inf"/></default>'),
        12,
        "<joint>: attribute 'armature' is infinite; give a finite number",
    ),
    "infinite gravity": (beside('<option gravity="0 0 -inf"/>'), 12, "<option>: attribute 'gravity' is infinite"),
    "triangle": (put(TENSOR, '"1 0.01 0.01 0 0 0"'), 7, rf"{REFUSED}: inertia must satisfy A \+ B >= C; .*'fore'"),
    "eigenvalues": (put(TENSOR, '"0.01 0.01 0.01 1 0 0"'), 7, f"{REFUSED}: .*must have positive eigenvalues.*'fore'"),
    "five entries": (put(TENSOR, '"1 1 1 0 0"'), 8, f"{REFUSED}: attribute 'fullinertia' does not have enough data"),
    "two tensors": (put(TENSOR, f'{TENSOR} diaginertia="1 1 1"'), 7, f"{REFUSED}: fullinertia and diagonal inertia"),
    "class": (put(ELBOW, 'class="gone"'), 9, f"{REFUSED}: unknown default class name 'gone'"),
    "orientations": (put(FORE, 'quat="1 0 0 0" euler="0 0 1"'), 7, f"{REFUSED}: multiple orientation specifiers"),
    "zero quaternion": (put(FORE, 'quat="0 0 0 0"'), 7, f"{REFUSED}: zero quaternion is not allowed"),
    "angle": (put('"radian"', '"grad"'), 2, f"{REFUSED}: invalid keyword: 'grad'"),
    "equality": (beside('<equality><joint joint1="knee"/></equality>'), 12, f"{REFUSED}: unknown element 'knee'"),
    "weld": (beside('<equality><weld body1="foot"/></equality>'), 12, f"{REFUSED}: unknown element 'foot'"),
    "include": (beside('<include file="gone.xml"/>'), 12, "<include>: there is no file 'gone.xml'; correct its name"),
    "include itself": (beside('<include file="arm.xml"/>'), 12, "<include>: 'arm.xml' is included twice"),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_damage_is_told_with_its_line(case, tmp_path):
    content, line, said = DAMAGED[case]
    path = tmp_path / "arm.xml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(urdf.URDFError, match=re.escape(str(path)) + f".*{said}") as caught:
        urdf.load(path)
    assert (caught.value.path, caught.value.line) == (path, line)
    assert caught.value.remedy


def test_the_file_before_the_damage_is_read(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(GOOD, encoding="utf-8")
    assert urdf.load(path).joint_names == ("shoulder", "elbow")
    path.write_text(put('range="-1 1"', 'range="1 -1"'), encoding="utf-8")
    with pytest.warns(urdf.UnreadWarning, match="joint 'shoulder' has the range 1 to -1, which MuJoCo takes for no"):
        assert urdf.load(path).joints[0].kind == "continuous"
