"""Tables of Denavit-Hartenberg parameters in TOML: what they mean by the matrices of textbooks, and what is refused."""

import json
import math
import re
import tomllib

import numpy as np
import pytest
from shared_data import DATA, REPOSITORY, existing

import urdf
from graphdyn import frame_placement, inverse_dynamics

TABLE = """
name = "puma560"
convention = "standard"
angles = "deg"
lengths = "mm"
[base]
xyz = [0, 0, 660.4]
[tool]
name = "flange"
xyz = [0, 0, 56.25]
[[joint]]
d = 0
a = 0
alpha = 90
lower = -160
upper = 160
[[joint]]
d = 0
a = 431.8
alpha = 0
theta = 30
sign = -1
[joint.link]
mass = 17.4
center = [-363.8, 6, 227.5]
inertia = { xx = 0.13, yy = 0.524, zz = 0.539 }
[[joint]]
type = "prismatic"
theta = 20
d = 150.05
a = 20.3
alpha = -90
armature = 0.8
upper = 100
lower = -50
[[joint]]
d = 431.8
a = 0
alpha = 89.5
beta = 0.2
"""
REACH = 2.0
ROUNDING = 1e-14
"""Relative; products of five transforms."""


def turn(axis, degrees):
    """By axis, in degrees."""
    s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    rows = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    found = np.eye(4)
    found[:3, :3] = rows.get(axis, [[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return found


def shift(axis, millimeters):
    found = np.eye(4)
    found["xyz".index(axis), 3] = millimeters / 1000
    return found


def by_hand(convention, q):
    """The flange, by the formula of each row."""
    rows = ((0, 0, 0, 90, 0), (30, 0, 431.8, 0, 0), (20, 150.05, 20.3, -90, 0), (0, 431.8, 0, 89.5, 0.2))
    placement = shift("z", 660.4)
    for number, (theta, d, a, alpha, beta) in enumerate(rows):
        theta += np.degrees([1, -1, 0, 1][number] * q[number])
        d += 1000 * q[2] * (number == 2)
        across = shift("x", a) @ turn("x", alpha) @ turn("y", beta)
        along = turn("z", theta) @ shift("z", d)
        placement = placement @ (along @ across if convention == "standard" else across @ along)
    return placement @ shift("z", 56.25)


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "arm.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.mark.filterwarnings("ignore::urdf.MissingInertialWarning")
@pytest.mark.parametrize("convention", urdf.CONVENTIONS)
def test_the_flange_is_that_of_the_formula(written, convention):
    model = urdf.load(written(TABLE.replace("standard", convention)))
    q = np.random.default_rng(0).uniform(-1, 1, (20, 4))
    rotation, position = frame_placement(model, q, "flange")
    expected = np.array([by_hand(convention, one) for one in q])
    np.testing.assert_allclose(rotation, expected[:, :3, :3], atol=ROUNDING)
    np.testing.assert_allclose(position, expected[:, :3, 3], atol=ROUNDING * REACH)


@pytest.mark.filterwarnings("ignore::urdf.MissingInertialWarning")
def test_numbers_of_joints_and_links(written):
    first, second, third, _ = urdf.load(written(TABLE)).joints
    assert first.limits.upper == pytest.approx(math.radians(160))
    assert second.kind == "continuous"
    assert (third.armature, third.limits.lower, third.limits.upper) == (0.8, -0.05, 0.1)


@pytest.mark.filterwarnings("ignore::urdf.MissingInertialWarning")
def test_inertias_about_the_frame_or_the_center(written):
    """The weight of the second link, and its tensor about an axis of the first joint, by hand."""
    model = urdf.load(written(TABLE))
    mass, center = 17.4, np.array([-0.3638, 0.006, 0.2275])
    about_frame = np.diag([0.13, 0.524, 0.539]) + mass * (center @ center * np.eye(3) - np.outer(center, center))
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    entries = ", ".join(f"{x} = {float(about_frame['xyz'.index(x[0]), 'xyz'.index(x[1])])!r}" for x in names)
    other = TABLE.replace("xx = 0.13, yy = 0.524, zz = 0.539", entries).replace("mass =", 'about = "frame"\nmass =')
    q, v, a = np.random.default_rng(1).normal(size=(3, 4))
    tau = inverse_dynamics(model, q, v, a).tau
    np.testing.assert_allclose(inverse_dynamics(urdf.load(written(other)), q, v, a).tau, tau, rtol=1e-12)
    arm = shift("z", 660.4) @ turn("x", 90) @ turn("z", 30) @ shift("x", 431.8)
    place = (arm @ [*center, 1])[:3]
    z = (shift("z", 660.4) @ turn("x", 90))[:3, 2]
    weight = np.cross(place - [0, 0, 0.6604], [0, 0, -9.81 * mass])
    at_rest = inverse_dynamics(model, np.zeros(4), np.zeros(4), np.zeros(4)).tau
    assert at_rest[1] == pytest.approx(z @ weight)  # the joint counts the other way, and holds


REFUSED = {
    "": "'name' is missing",
    "convention = 'standard'": "'name' is missing",
    TABLE.replace('name = "puma560"', "name = 5"): "give a name in quotes",
    TABLE.replace("standard", "classic"): "use one of 'standard', 'modified'",
    TABLE.replace('convention = "standard"\n', ""): "'convention' is missing",
    TABLE.replace('angles = "deg"\n', ""): "'angles' is missing",
    TABLE.replace('"deg"', '"degrees"'): "use one of 'rad', 'deg'",
    TABLE.replace('"deg"', '"rad"'): "are the angles in degrees?",
    TABLE.replace('lengths = "mm"\n', ""): "'lengths' is missing",
    TABLE.replace('"mm"', '"m"'): "are the lengths in mm?",
    TABLE.replace('"mm"', '"inch"'): "use one of 'm', 'mm'",
    TABLE.replace("alpha = -90", "alfa = -90"): "'alpha' is missing",
    TABLE.replace("sign = -1", "sing = -1"): "did you mean 'sign'?",
    TABLE.replace("sign = -1", "sign = 2"): "give 1 or -1",
    TABLE.replace("sign = -1", "sign = true"): "give 1 or -1",
    TABLE.replace("alpha = -90", "alpha = '-90'"): "give a finite number",
    TABLE.replace("alpha = -90", "alpha = nan"): "give a finite number",
    TABLE.replace("alpha = -90", "alpha = inf"): "give a finite number",
    TABLE.replace("alpha = -90", "alpha = true"): "give a finite number",
    TABLE.replace("alpha = -90", "alpha = [1]"): "give a finite number",
    TABLE.replace("a = 20.3\n", ""): "'a' is missing",
    TABLE.replace('"prismatic"\ntheta = 20', '"prismatic"'): "'theta' is missing",
    TABLE.replace('"prismatic"', '"ball"'): "use one of 'revolute', 'prismatic'",
    TABLE.replace("lower = -160\n", ""): "give both, or none",
    TABLE.replace("lower = -160", "lower = 170"): "exchange them",
    TABLE.replace("mass = 17.4", "mass = -17.4"): "it is below 0",
    TABLE.replace("mass = 17.4", "mas = 17.4"): "did you mean 'mass'?",
    TABLE.replace("center = [-363.8, 6, 227.5]\n", ""): "'center' is missing",
    TABLE.replace("6, 227.5]", "227.5]"): "give three numbers",
    TABLE.replace("inertia = {", "inertia = 3 #"): "not a table",
    TABLE.replace("zz = 0.539", "z = 0.539"): "'zz' is missing",
    TABLE.replace("xx = 0.13", "xx = -0.13"): "it is below 0",
    TABLE.replace("mass = 17.4", 'about = "flange"\nmass = 17.4'): "use one of 'center', 'frame'",
    TABLE.replace("[[joint]]\nd = 0", '[[joint]]\nname = "j"\nd = 0'): "joint 'j' is there twice",
    TABLE.replace("[joint.link]", '[joint.link]\nname = "flange"'): "link 'flange' is there twice",
    TABLE.replace("[[joint]]", "[joint]", 1): "is no TOML",
    TABLE[: TABLE.index("[[joint]]")]: "'joint' is missing",
    TABLE[: TABLE.index("[[joint]]")].replace("[base]", "joint = []\n[base]"): "write [[joint]] before each joint",
    TABLE[: TABLE.index("alpha = 90") + 8]: "is no TOML",
    TABLE[: TABLE.index("alpha = 90")]: "'alpha' is missing",
    TABLE.replace("xyz = [0, 0, 660.4]", "xyz = [0, 0]"): "give three numbers",
    TABLE.replace("[base]", "base = 1\n[bas]"): "not a table",
    TABLE.replace("[base]", "[bse]"): "did you mean 'base'?",
    TABLE.replace("[base]", "gravity = -9.81\n[base]"): "give three numbers",
    TABLE.replace("d = 431.8", "d = 1e9"): "more than 100",
    TABLE.replace("armature = 0.8", "armature = -0.8"): "it is below 0",
    "\x00": "is no TOML",
    "<robot/>": "is no TOML",
}


@pytest.mark.parametrize(("text", "said"), REFUSED.items(), ids=range(len(REFUSED)))
def test_refused(written, text, said):
    path = written(text)
    with pytest.raises(urdf.InvalidDH, match=re.escape(said)) as caught:
        urdf.load(path)
    assert str(caught.value).startswith(str(path))


def test_the_line_of_a_joint_is_told(written):
    path = written(TABLE.replace("armature = 0.8", "armature = -0.8"))
    with pytest.raises(urdf.InvalidDH) as caught:
        urdf.load(path)
    assert caught.value.line == TABLE[: TABLE.index('type = "prismatic"')].count("\n")
    assert caught.value.element == "joint 3"


def test_the_table_of_the_guide_is_that_of_the_robotics_toolbox(written):
    """Lengths, masses, tensors, rotors and viscous friction as in its published tables, to the digits of the guide."""
    (table,) = re.findall(r"```toml\n(.*?)```", (REPOSITORY / "docs" / "dh.md").read_text(encoding="utf-8"), re.DOTALL)
    with pytest.warns(urdf.ZeroMassWarning):
        model = urdf.load(written(table))
    known = existing(DATA / "reference" / "puma560_rtb_tables.json").read_text(encoding="utf-8")
    links = json.loads(known)["model"]["links"]
    for row, joint, link in zip(tomllib.loads(table)["joint"], model.joints, links, strict=True):
        own = row["link"]
        assert (row["d"], row["a"], own["mass"], own["center"]) == (link["d"], link["a"], link["m"], link["r"])
        assert [*own["inertia"].values(), 0, 0, 0] == link["I6"]
        assert math.radians(row["alpha"]) == pytest.approx(link["alpha"])
        assert joint.armature == pytest.approx(link["Jm"] * link["G"] ** 2, rel=1e-5)
        assert joint.damping == pytest.approx(link["B"] * link["G"] ** 2, rel=1e-4)
