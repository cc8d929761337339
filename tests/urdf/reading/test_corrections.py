"""Inertials that cannot be right: corrected where one change alone explains them."""

import re
from itertools import combinations, product

import numpy as np
import pytest
from lxml import etree
from shared_data import ARMS

import urdf
from urdf.document.inertial_numbers import inertial_numbers
from urdf.document.numbers import rotation_from_rpy
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.reading.corrections import choosing, mirrored_names, only_change
from urdf.reading.corrections.changes import MOMENTS

NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
PRODUCTS = ("ixy", "ixz", "iyz")
GIVEN = 'ixx="0.11" ixy="0.01" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"'
"""Of the upper arm in the sample file."""

RIGHT = dict(zip(NAMES, (0.11, 0.012, -0.004, 0.13, 0.009, 0.15), strict=True))


def element(**entries):
    inertial = etree.Element("inertial")
    etree.SubElement(inertial, "mass", value="2")
    etree.SubElement(inertial, "inertia", {name: str(entries[name]) for name in NAMES})
    return inertial


def entries_after(inertial, change):
    return {name: float(change.applied(inertial).find("inertia").get(name)) for name in NAMES}


@pytest.mark.parametrize(("one", "other"), [*product(MOMENTS, PRODUCTS)])
def test_an_exchange_is_undone(one, other):
    wrong = element(**{**RIGHT, one: RIGHT[other], other: RIGHT[one]})
    assert not inertial_numbers(wrong).is_possible(-0.02)
    found = only_change(wrong)
    assert entries_after(wrong, found) == RIGHT
    assert found.what == f"{min(one, other)} and {max(one, other)} exchanged"


@pytest.mark.parametrize("name", MOMENTS)
def test_a_sign_is_removed(name):
    wrong = element(**{**RIGHT, name: f" -{RIGHT[name]}"})
    found = only_change(wrong)
    assert (entries_after(wrong, found), found.what) == (RIGHT, f"{name} without its sign")


@pytest.mark.parametrize(
    "entries",
    [
        (0.1, 0, 0, 0.1, 0, 0.1),  # possible
        (0.1, 0, 0, 0.1, 0, 0.2039),  # up to few digits
        (0.001, 0, 0, 0.001, 0, 0.01),  # triangle inequality, which no exchange mends
        (1e-3,) * 6,  # placeholders
        (0.0391, 0.0, 0.025, 0.0395, 0.0007, 0.0123),  # a large product would be left
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ],
)
def test_everything_else_stays(entries):
    assert only_change(element(**dict(zip(NAMES, entries, strict=True)))) is None


def test_several_ways_are_candidates(arm, tmp_path):
    path = arm(GIVEN, 'ixx="0.04" ixy="0.01" ixz="0.18" iyy="0.19" iyz="0.01" izz="0.04"')
    text = path.read_text(encoding="utf-8")
    done = urdf.repair(path, tmp_path / "out.urdf", ["indefinite-inertia"])
    assert (done.path, done.changes) == (None, ())
    (told,) = done.candidates
    assert told.startswith("line 4: <inertial> of link 'upper': no body has this tensor; it fits with ")
    assert told.endswith("it fits with ixx and ixz exchanged or ixz and izz exchanged")
    assert path.read_text(encoding="utf-8") == text


def test_in_a_file(arm, tmp_path):
    path = arm(GIVEN, 'ixx="0.01" ixy="0.110" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"')
    (finding,) = (one for one in urdf.inspect(path).findings if one.code == "indefinite-inertia")
    assert finding.message.split(". ")[0].endswith("no real body has one; with ixx and ixy exchanged it is possible")
    done = urdf.repair(path, tmp_path / "out.urdf", ["indefinite-inertia"])
    assert done.changes == (
        "line 4: <inertial> of link 'upper': ixx and ixy exchanged (ixx 0.01 made 0.110, ixy 0.110 made 0.01), because "
        "no body has this tensor",
    )
    assert 'ixx="0.110" ixy="0.01" ixz' in done.path.read_text(encoding="utf-8")
    assert urdf.inspect(done.path).usable


@pytest.mark.parametrize("path", sorted(ARMS.glob("*.urdf"))[::6], ids=lambda path: path.stem)
def test_planted_in_files_of_makers(path):
    """Every exchange of two entries of every link: right or left as it is, never anything else."""
    undone = clear = 0
    for inertial in reduced(open_document(path)).robot.iter("inertial"):
        inertia, numbers = inertial.find("inertia"), inertial_numbers(inertial)
        if numbers is None or not numbers.is_possible(-0.02):
            continue
        given = dict(inertia.attrib)
        for one, other in combinations(NAMES, 2):
            inertia.attrib.update({one: given[other], other: given[one]})
            found = only_change(inertial)
            clear += not inertial_numbers(inertial).is_possible(-0.02)
            if found is not None:
                undone += 1
                assert entries_after(inertial, found) == {name: float(given[name]) for name in NAMES}
            inertia.attrib.update(given)
    assert undone >= 0.5 * clear


SIZES = ((0.3, 0.1, 0.12), (0.12, 0.4, 0.1), (0.1, 0.11, 0.5), (0.25, 0.2, 0.1), (0.1, 0.2, 0.35))
"""Boxes of the links of a chain [m]; those of the last two, left and right, are turned against their links."""

TURN = (0.3, -0.4, 0.5)


def box_arm(tmp_path, change=lambda link, inertial: None):
    """Links that are boxes of nearly the same density, and their tensors in link axes but that of the third."""
    robot = etree.Element("robot", name="boxes")
    etree.SubElement(robot, "link", name="base")
    names = [*(f"link_{k}" for k in range(len(SIZES))), "left_finger", "right_finger"]
    for k, name in enumerate(names):
        sizes, side = (*SIZES, (0.2, 0.05, 0.08))[min(k, len(SIZES))], -1 if name == "right_finger" else 1
        mass, turn = np.prod(sizes) * (900 + 40 * min(k, len(SIZES))), np.array(TURN) * [side, 1, side]
        x, y, z = np.square(sizes)
        own = mass / 12 * np.diag([y + z, x + z, x + y])
        rotation = rotation_from_rpy(*turn)
        tensor, rpy = (own, turn) if k == 2 else (rotation @ own @ rotation.T, np.zeros(3))
        link = etree.SubElement(robot, "link", name=name)
        inertial = etree.SubElement(link, "inertial")
        place = {"xyz": f"0.05 {side * 0.02} 0.1"}
        etree.SubElement(inertial, "origin", place, rpy=" ".join(map(repr, map(float, rpy))))
        etree.SubElement(inertial, "mass", value=f"{mass:.9g}")
        entries = {f"i{'xyz'[i]}{'xyz'[j]}": f"{tensor[i, j]:.9g}" for i in range(3) for j in range(i, 3)}
        etree.SubElement(inertial, "inertia", entries)
        visual = etree.SubElement(link, "visual")
        etree.SubElement(visual, "origin", place, rpy=" ".join(map(repr, map(float, turn))))
        geometry = etree.SubElement(visual, "geometry")
        etree.SubElement(geometry, "box", size=" ".join(map(str, sizes)))
        change(name, inertial)
        joint = etree.SubElement(robot, "joint", name=f"to_{name}", type="continuous")
        etree.SubElement(joint, "origin", xyz="0.1 0 0.2")
        etree.SubElement(joint, "parent", link=(["base", *names][k] if k <= len(SIZES) else f"link_{len(SIZES) - 1}"))
        etree.SubElement(joint, "child", link=name)
    path = tmp_path / "boxes.urdf"
    etree.indent(robot)
    etree.ElementTree(robot).write(path)
    return path


def opposite(text):
    return text[1:] if text.startswith("-") else f"-{text}"


def scaled(tag, name, factor):
    def change(inertial):
        part = inertial.find(tag)
        part.set(name, f"{float(part.get(name)) * factor:.9g}")

    return change


def scaled_center(factor):
    def change(inertial):
        origin = inertial.find("origin")
        origin.set("xyz", " ".join(f"{float(word) * factor:.9g}" for word in origin.get("xyz").split()))

    return change


def every(names, change):
    def all_of_them(inertial):
        inertia = inertial.find("inertia")
        for name in names:
            inertia.set(name, change(inertia.get(name)))

    return all_of_them


def exchanged(inertial):
    inertia = inertial.find("inertia")
    one, other = inertia.get("ixx"), inertia.get("izz")
    inertia.set("ixx", other)
    inertia.set("izz", one)


def transposed(inertial):
    from urdf.document.numbers import rpy_from_rotation

    inertial.find("origin").set("rpy", " ".join(map(repr, map(float, rpy_from_rotation(rotation_from_rpy(*TURN).T)))))


SLIPS = {
    "mass divided by 1,000": ("link_1", scaled("mass", "value", 1000)),
    "mass divided by 10": ("left_finger", scaled("mass", "value", 10)),
    "center of mass divided by 39.37 (inches)": ("link_1", scaled_center(1 / 0.0254)),
    "tensor divided by 1,000,000": ("link_1", every(NAMES, lambda text: f"{float(text) * 1e6:.9g}")),
    "ixx and izz exchanged": ("link_1", exchanged),
    "all products of opposite sign": ("link_0", every(PRODUCTS, opposite)),
    "rotation transposed": ("link_2", transposed),
    "ixy and iyz with the opposite sign": ("right_finger", every(("ixy", "iyz"), opposite)),
}


@pytest.mark.parametrize("what", SLIPS)
def test_a_slip_is_undone(tmp_path, what):
    """Beside the shapes of the links: in the file that is repaired stand the numbers that were there."""
    link, slip = SLIPS[what]
    right = urdf.load(box_arm(tmp_path)).inertial_parameters
    path = box_arm(tmp_path, lambda name, inertial: slip(inertial) if name == link else None)
    done = urdf.repair(path, tmp_path / "out.urdf", ["inertials"])
    (told,) = done.changes
    assert f"<inertial> of link '{link}': {what} (" in told
    np.testing.assert_allclose(urdf.load(done.path).inertial_parameters, right, rtol=1e-7, atol=1e-9)


def test_a_center_of_mass_in_millimeters(tmp_path):
    """Without shapes: it lies far beyond the joints, and nothing else brings it back."""

    def change(name, inertial):
        if name == "link_1":
            scaled("mass", "value", 1.0)(inertial)
            inertial.find("origin").set("xyz", "50 20 100")

    path = box_arm(tmp_path, change)
    path.write_text(re.sub(r"<visual>.*?</visual>", "", path.read_text(), flags=re.DOTALL), encoding="utf-8")
    (told,) = urdf.repair(path, None, ["inertials"]).changes
    assert "link 'link_1': center of mass divided by 1,000 (xyz 50 20 100 made 0.05 0.02 0.1), because the " in told


@pytest.mark.parametrize(
    ("link", "other"),
    [
        ("left_arm_1", "right_arm_1"), ("arm_l_2", "arm_r_2"), ("FL_calf", "FR_calf"), ("lf_leg", "rf_leg"),
        ("roller", None), ("FLANGE", None),
    ],
)  # fmt: skip
def test_names_of_the_other_side(link, other):
    assert list(dict.fromkeys(mirrored_names(link))) == ([] if other is None else [other])


QUARTERS = {"FL": (1, 1), "FR": (1, -1), "RL": (-1, 1), "RR": (-1, -1)}


def legs(tmp_path, changed_leg, mass):
    """Four legs without shapes, each the mirror image of the others; one has another mass."""
    robot = etree.Element("robot", name="legs")
    etree.SubElement(robot, "link", name="body")
    for leg, (x, y) in QUARTERS.items():
        link = etree.SubElement(robot, "link", name=f"{leg}_calf")
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "origin", xyz=f"{x * 0.02} {y * 0.01} -0.1")
        etree.SubElement(inertial, "mass", value=mass if leg == changed_leg else "0.3")
        products = {"ixy": x * y * 1e-4, "ixz": -x * 2e-4, "iyz": -y * 5e-5}
        moments = {"ixx": 3e-3, "iyy": 3.1e-3, "izz": 4e-4}
        etree.SubElement(inertial, "inertia", {name: f"{value:.9g}" for name, value in (moments | products).items()})
        joint = etree.SubElement(robot, "joint", name=leg, type="continuous")
        etree.SubElement(joint, "origin", xyz=f"{x * 0.2} {y * 0.1} 0")
        etree.SubElement(joint, "parent", link="body")
        etree.SubElement(joint, "child", link=f"{leg}_calf")
    path = tmp_path / "legs.urdf"
    etree.ElementTree(robot).write(path)
    return path


@pytest.mark.parametrize("leg", QUARTERS)
def test_three_legs_correct_the_fourth(tmp_path, leg):
    """Of 7.85, the density of steel, and 10, the others tell which it was."""
    assert urdf.repair(legs(tmp_path, leg, "0.3"), None, ["inertials"]).changes == ()
    (told,) = urdf.repair(legs(tmp_path, leg, "2.355"), None, ["inertials"]).changes
    assert f"link '{leg}_calf': mass divided by 7.85 (steel for water) (mass 2.355 made 0.3" in told
    assert told.endswith("_calf' have other numbers")


def test_what_two_changes_explain_is_told_and_left(tmp_path):
    """Ten and 7.85, the density of steel, are too near one another where nothing else tells the mass."""
    path = box_arm(tmp_path, lambda name, inertial: scaled("mass", "value", 9)(inertial) if name == "link_1" else None)
    done = urdf.repair(path, tmp_path / "out.urdf", ["inertials"])
    assert done.changes == ()
    (told,) = done.candidates
    assert "mass divided by 10" in told
    assert "mass divided by 7.85 (steel for water)" in told


def test_the_mass_of_the_whole_robot_is_told_and_left(tmp_path, monkeypatch):
    """No factor gives back that of the link, though one makes it usual: here every mass counts as that of the rest."""
    monkeypatch.setattr(choosing, "WHOLE_ROBOT", np.inf)
    for what, corrected in (("mass divided by 1,000", False), ("tensor divided by 1,000,000", True)):
        link, slip = SLIPS[what]
        path = box_arm(tmp_path, lambda name, inertial, link=link, slip=slip: slip(inertial) if name == link else None)
        done = urdf.repair(path, None, ["inertials"])
        assert what in (done.changes if corrected else done.candidates)[0]


def test_sound_links_are_left(tmp_path):
    assert urdf.repair(box_arm(tmp_path), None, ["inertials"]) == urdf.RepairedFile(None, ())
