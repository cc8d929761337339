"""Loops and couplings: read in every form, written as URDF+, and refused where they are malformed."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from robots.mechanisms import four_bar, palletizer
from shared_data import DATA, existing
from urdf_text import joint, link, robot_text

import graphdyn
import urdf
from crosscheck import judge
from graphdyn import Chord, Coupling, InvalidInput, Placement, RobotModel
from graphdyn.model.spatial import rotation_about

TURNED = Placement(rotation_about(np.array([0.0, 0.0, 1.0]), 0.3), np.array([1.0, 2.0, 3.0]))
PLACE = 'xyz="1 2 3" rpy="0 0 0.3"'
DRAKE = 'xmlns:drake="http://drake.mit.edu"'

TREE = [
    *(link(name) for name in ("base", "upper", "fore", "rod")),
    joint("shoulder", "base", "upper", kind="continuous"),
    joint("elbow", "upper", "fore", kind="continuous"),
    joint("crank", "base", "rod", kind="continuous"),
]


def arm(*more, links=()):
    return robot_text("arm", *TREE, *links, *more)


def loop(kind="revolute", more="", predecessor="fore", successor="rod"):
    return (
        f'<loop name="c" type="{kind}"><predecessor link="{predecessor}"><origin {PLACE}/></predecessor>'
        f'<successor link="{successor}"/>{more}</loop>'
    )


AXIS = '<axis xyz="0 2 0"/>'
FORMS = {
    "URDF+, revolute": (loop(more=AXIS), "hinge", (0, 1, 0)),
    "URDF+, continuous": (loop("continuous"), "hinge", (1, 0, 0)),
    "URDF+, prismatic": (loop("prismatic", AXIS), "slide", (0, 1, 0)),
    "URDF+, fixed": (loop("fixed"), "weld", (0, 0, 1)),
    "ours, spherical": (loop("spherical"), "ball", (0, 0, 1)),
    "ours, distance": (loop("distance", '<length value="0.5"/>'), "distance", (0, 0, 1)),
    "loop_joint": (
        f'<loop_joint name="c" type="continuous"><link1 link="fore" {PLACE}/><link2 link="rod"/>{AXIS}</loop_joint>',
        "hinge",
        (0, 1, 0),
    ),
    "constraint": (
        f'<constraint name="c" type="revolute_joint"><parent link="fore"/><parent_origin {PLACE}/>'
        '<child link="rod"/><parent_axis xyz="0 1 0"/></constraint>',
        "hinge",
        (0, 1, 0),
    ),
    "constraint, link": (
        f'<constraint name="c" type="link"><parent link="fore"/><parent_origin {PLACE}/><child link="rod"/>'
        "</constraint>",
        "weld",
        (0, 0, 1),
    ),
}
"""What stands in <robot>: the kind and axis of its chord between fore, at TURNED, and rod."""


@pytest.mark.parametrize("form", FORMS)
def test_read_and_written(form, tmp_path):
    text, kind, axis = FORMS[form]
    model, path = urdf.load(arm(text)), tmp_path / "saved.urdf"
    urdf.save(model, path)
    for (chord,) in (model.chords, urdf.load(path).chords):
        assert (chord.name, chord.kind, chord.body_i, chord.body_j) == ("c", kind, 2, 3)
        assert chord.length == (0.5 if kind == "distance" else None)
        assert_allclose(chord.placement_i.rotation, TURNED.rotation, atol=1e-15)
        assert_array_equal(chord.placement_i.translation, TURNED.translation)
        assert_array_equal(chord.placement_j.rotation, np.eye(3))
        assert_array_equal(chord.axis, axis)


def test_drake_ball():
    body, point = "drake:ball_constraint_body", "drake:ball_constraint_p"
    (chord,) = urdf.load(
        arm(
            f'<drake:ball_constraint {DRAKE}><{body}_A name="fore"/><{body}_B name="base"/>'
            f'<{point}_AP value="1 2 3"/><{point}_BQ value="4 5 6"/></drake:ball_constraint>'
        )
    ).chords
    assert (chord.name, chord.kind, chord.body_i, chord.body_j) == ("fore-base", "ball", 2, 0)
    assert_array_equal(chord.placement_j.translation, [4, 5, 6])


def test_on_fused_links():
    """The end is where the fixed link is, on the body that carries it."""
    flange = joint("flange", "fore", "tool", "fixed", '<origin xyz="0 0 0.2" rpy="0 0 0.3"/>')
    text = loop("spherical", predecessor="tool").replace(PLACE, 'xyz="1 0 0"')
    (chord,) = urdf.load(arm(link("tool"), flange, text)).chords
    assert chord.body_i == 2
    assert_allclose(chord.placement_i.translation, [np.cos(0.3), np.sin(0.3), 0.2], atol=1e-15)


def coupling(ratio="2", predecessor="fore", successor="rod", name="c"):
    ends = f'<predecessor link="{predecessor}"/><successor link="{successor}"/>'
    return f'<coupling name="{name}">{ends}<ratio value="{ratio}"/></coupling>'


def marked(text, **marks):
    for name, value in marks.items():
        text = text.replace(f'<joint name="{name}"', f'<joint name="{name}" independent="{value}"')
    return text


@pytest.mark.parametrize(
    ("text", "unbound"),
    [
        (marked(arm(), elbow="false", crank="0"), "'elbow', 'crank'"),
        (marked(arm(loop("spherical", predecessor="base", successor="fore")), elbow="false", crank="false"), "'crank'"),
        (marked(arm(coupling("1", "base", "fore")), shoulder="false", elbow="false"), "'shoulder'"),
    ],
    ids=["no loop", "another loop", "one coupling"],
)
def test_joints_whose_loops_are_missing_are_named(text, unbound):
    message = f'independent="false" move by themselves: {unbound}; the loops, couplings or mimic joints that they'
    with pytest.warns(urdf.UnboundJointWarning, match=message):
        urdf.load(text)


def test_joints_that_loops_couplings_and_mimics_bind_are_not(recwarn):
    in_loop = arm(loop("spherical"), links=[link("side"), joint("turn", "upper", "side", "continuous")])
    urdf.load(marked(in_loop, elbow="false", crank="false", turn="true"))
    urdf.load(marked(arm(coupling(), loop("spherical", predecessor="upper")), crank="false", shoulder="0"))
    urdf.load(marked(arm(), crank="false", shoulder="1"), lock=["crank"])
    assert not [warning for warning in recwarn if warning.category is urdf.UnboundJointWarning]


COUPLED = {
    "the successor's joint": (arm(coupling()), Coupling("crank", {"shoulder": 2.0, "elbow": 2.0})),
    "the one that is not independent": (
        marked(arm(coupling()), elbow="False"),
        Coupling("elbow", {"crank": 0.5, "shoulder": -1.0}),
    ),
    "not an independent one": (
        marked(arm(coupling()), crank="true"),
        Coupling("elbow", {"crank": 0.5, "shoulder": -1.0}),
    ),
    "a sum that keeps its place": (arm(coupling("1", "base", "fore")), Coupling("elbow", {"shoulder": -1.0})),
    "from the nearest common ancestor": (
        arm(coupling("3", "fore", "side"), links=[link("side"), joint("turn", "upper", "side", "continuous")]),
        Coupling("turn", {"elbow": 3.0}),
    ),
}


@pytest.mark.parametrize("case", COUPLED)
def test_coupled(case, tmp_path):
    text, wanted = COUPLED[case]
    model = urdf.load(text)
    assert model.couplings == (wanted,)
    urdf.save(model, tmp_path / "saved.urdf")
    assert urdf.load(tmp_path / "saved.urdf").couplings == (wanted,)


def test_couplings_and_locks():
    text = arm(coupling(), links=[link("side"), joint("turn", "upper", "side", "continuous")])
    assert urdf.load(text, lock={"elbow": 0.25}).couplings == (Coupling("crank", {"shoulder": 2.0}, 0.5),)
    held = urdf.load(text, lock={"elbow": 0.25, "shoulder": 1.0})
    assert held.joint_names == ("turn",)
    assert_allclose(held.frame("rod").placement.rotation[2, 1], np.sin(2.5), rtol=1e-15)  # about x, by 2 (1 + 0.25)
    with pytest.raises(
        urdf.InvalidLock, match="'crank': coupling 'c' drives it, and 'elbow', 'shoulder' are free; lock"
    ):
        urdf.load(text, lock=["crank"])


def test_couplings_that_cannot_be_written(tmp_path):
    model = urdf.load(arm())
    ratios = {"elbow": 1.0, "shoulder": 1.0}
    for other in (Coupling("crank", ratios | {"elbow": 2.0}), Coupling("crank", ratios, 1.0)):
        with pytest.raises(urdf.CannotSave, match="'crank' is driven by 2 joints, and neither <mimic> nor"):
            urdf.save(replace(model, couplings=(other,)), tmp_path / "saved.urdf")


MALFORMED = {
    "a link that there is not": (loop(predecessor="hand"), "'c': link 'hand' of <predecessor> does not exist; correct"),
    "one link": (loop(predecessor="rod"), "'c': both ends are on link 'rod'; name two links"),
    "no type": (loop().replace(' type="revolute"', ""), "'c': attribute 'type' is missing; use one of revolute,"),
    "no name": (loop().replace('name="c"', 'name=""'), "attribute 'name' is missing or empty; give it a name"),
    "a zero axis": (loop(more='<axis xyz="0 0 0"/>'), "'c': <axis> is zero; give a direction"),
    "an axis without xyz": (loop(more="<axis/>"), "'c': <axis> has no attribute 'xyz'; write it"),
    "two axes": (loop(more=AXIS + AXIS), "'c': 2 elements <axis>; keep the one that is meant"),
    "no successor": (
        '<loop name="c" type="fixed"><predecessor link="fore"/></loop>',
        "'c': <successor> is missing; wr",
    ),
    "no link": (loop().replace('link="rod"', ""), "'c': <successor> names no link; write the attribute 'link'"),
    "text": (loop().replace("1 2 3", "1 2 x"), """xyz="1 2 x" of <origin>: 'x' is not a number; correct"""),
    "infinity": (loop().replace("1 2 3", "1 2 inf"), 'xyz="1 2 inf" of <origin> is not finite; give a finite'),
    "a huge number": (loop().replace("1 2 3", "1 2 1e99"), 'xyz="1 2 1e99" is too large for a robot; give m and rad'),
    "a quaternion": (loop().replace("rpy=", "quat_xyzw="), "attribute 'quat_xyzw' is not read; give the rotation as"),
    "a length of zero": (loop("distance", '<length value="0"/>'), "'c': the length is 0 m; give a positive one"),
    "no length": (loop("distance"), "'c': <length> is missing; write it"),
    "two axes that differ": (
        FORMS["constraint"][0].replace("</con", '<child_axis xyz="1 0 0"/></con'),
        "'c': <child_axis> differs from <parent_axis>; turn <child_origin>",
    ),
    "a ratio of zero": (coupling("0"), "'c': the ratio is 0; lock the joints instead"),
    "nothing left to drive": (
        "".join(coupling(name=name) for name in "cdef"),
        "'f' has no joint to drive: 'crank', 'elbow', 'shoulder' are independent or driven already; mark",
    ),
    "one name twice": (loop() + loop("fixed"), "the name 'c' is already used by another loop; rename one of the two"),
}
"""What stands in <robot>, and what load says."""


@pytest.mark.parametrize("case", MALFORMED)
def test_malformed(case):
    text, message = MALFORMED[case]
    with pytest.raises(urdf.InvalidLoop) as caught:
        urdf.load(arm(text))
    assert message in str(caught.value)
    assert caught.value.line == 9
    (finding,) = [finding for finding in urdf.inspect(arm(text)).findings if finding.code == "invalid-loop"]
    assert (finding.severity, finding.line) == ("error", 9)


@pytest.mark.parametrize("kind", ["planar", "universal_joint"])
def test_kinds_that_are_not_modeled(kind):
    with pytest.raises(urdf.UnsupportedConstraint, match=rf":9: .*'c': type '{kind}' is not modeled; use one of"):
        urdf.load(arm(loop(kind)))


def test_independent_is_true_or_false():
    for text in (arm(coupling()), arm(loop()), arm("")):  # whether anything reads it or not
        for said in ("maybe", ""):
            with pytest.raises(
                urdf.InvalidLoop, match=rf"joint 'elbow': it has independent=\"{said}\"; write \"true\" or \"false\""
            ):
                urdf.load(marked(text, elbow=said))
    mixed = arm(coupling(), links=()).replace('"elbow" type="continuous"', '"elbow" type="prismatic"')
    with pytest.raises(
        urdf.InvalidLoop, match="'c' adds angles to lengths: joints 'elbow', 'shoulder'; couple joints of"
    ):
        urdf.load(mixed)


def test_what_is_not_known_in_a_loop():
    with pytest.warns(urdf.UnreadWarning, match="URDF knows no <orgin> in <successor>"):
        urdf.load(arm(loop().replace('"rod"/>', '"rod"><orgin/></successor>')))


def test_chains():
    assert urdf.load(arm(loop()), lock=["crank", "elbow", "shoulder"][:2]).n_bodies == 1
    with pytest.raises(
        urdf.UnsupportedConstraint, match="and the chain leaves out link 'rod'; take a chain that has both"
    ):
        urdf.load(arm(loop()), chain=("base", "fore"))
    beside = arm(loop(), links=()).replace('"base"/><child link="rod"', '"upper"/><child link="rod"')
    with pytest.raises(
        urdf.UnsupportedConstraint, match="and the chain holds its joint 'crank' still; lock it yourself"
    ):
        urdf.load(beside, chain=("base", "fore"))
    assert len(urdf.load(beside, chain=("base", "fore"), lock=["crank"]).chords) == 1
    with pytest.raises(urdf.UnsupportedConstraint, match=r"'c' couples joints .* and the chain leaves out link 'rod'"):
        urdf.load(arm(coupling()), chain=("base", "fore"))


BOMB = "a: &a [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join(['*' + before] * 10)}]\n" for before, name in zip("abcd", "bcde", strict=True)
)
YAML = "closed_loop: [['fore', 'crank']]\ntype: ['3d']\nname_mot: ['shoulder']\n"


class TestBeside:
    @pytest.fixture
    def pair(self, tmp_path):
        def write(yaml):
            (tmp_path / "arm.urdf").write_text(arm())
            (tmp_path / "arm.yaml").write_text(yaml)
            return tmp_path / "arm.urdf"

        return write

    def test_read(self, pair):
        path = pair(YAML)
        model = urdf.load(path)
        (chord,) = model.chords
        assert (chord.name, chord.kind, chord.body_i, chord.body_j) == ("fore-crank", "ball", 2, 3)
        assert model.actuated == ("shoulder",)
        assert urdf.load(path, loops=()).chords == ()
        assert len(urdf.load(arm(), loops=path.with_suffix(".yaml")).chords) == 1
        assert "loop-rows" in urdf.inspect(path).codes

    def test_another_file_of_that_name(self, pair):
        assert urdf.load(pair("controllers: [arm]\n")).chords == ()

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("'fore'", "'hand'", r"arm\.yaml:1: closed_loop: there is no link or joint 'hand'; correct the name"),
            ("'crank'", "'elbow'", "closed_loop: both ends are on link 'fore'; name two links"),
            ("'crank'", "'a', 'b'", "closed_loop: 3 names, expected 2; name two links or joints"),
            ("'3d'", "'2d'", r"arm\.yaml:2: type: type '2d' is unknown; use 6d or 3d"),
            ("['3d']", "[]", "type: 0 types for 1 pairs; state one for each pair"),
            ("['3d']", "3d", "type: not a list; give a list"),
            ("'3d'", "[]", "type: not a name; give names in quotes"),
            ("type:", "typo:", "'type' is missing; state the pairs and their types"),
            ("name_mot", "type", r"arm\.yaml:3: type: stated twice; keep the one that is meant"),
            ("'shoulder'", "'hip'", r"arm\.yaml:3: name_mot: there is no joint 'hip'; correct the name"),
            ("]]", "]", r"arm\.yaml:2: not well-formed YAML: did not find expected ',' or '\]'"),
            ("name_mot", "joint_name", "joint_name: joint 'shoulder' is to be replaced by one of another type; write"),
            ("'3d'", "'3d'" + "[" * 3000, "not well-formed YAML"),
            ("type", "x: " + "[" * 60 + "\ntype", r"arm\.yaml:2: more than 50 mappings or lists within each other"),
            ("type", "x: " + "[" * 50_000 + "\ntype", r"arm\.yaml:2: (more than 50|.*exceeded maximum nesting)"),
            ("type", BOMB + "? *e\n: 1\ntype", r"arm\.yaml:6: more than 100000 parts, once its aliases are written"),
            ("type", "? [a, b]\n: 1\ntype", r"arm\.yaml:2: key: not a name; give names as keys"),
            ("type", "x: &x [*x]\ntype", r"arm\.yaml:2: \*x stands before the end of what it names; correct the file"),
            ("type", "x: *x\ntype", r"arm\.yaml:2: \*x stands before the end of what it names"),
            ("type", "--- \ntype", "not well-formed YAML: expected a single document"),
            ("'3d'", "'3d'" + " " * 100_000, "the file is larger than 100000 bytes; give the YAML file of the loops"),
        ],
    )  # fmt: skip
    def test_malformed(self, pair, old, new, message):
        path = pair(YAML.replace(old, new, 1))
        with pytest.raises(urdf.InvalidLoop, match=message):
            urdf.load(path)
        assert "invalid-loop" in urdf.inspect(path).codes

    def test_what_is_not_read(self, pair):
        path = pair(YAML.replace("'shoulder'", "'shoulder', 'crank'") + "rotor_inertia: [1]\n")
        text = path.read_text()
        path.write_text(text.replace('<child link="rod"/>', '<child link="rod"/><mimic joint="shoulder"/>'))
        with pytest.warns(urdf.UnreadWarning) as caught:
            assert urdf.load(path).actuated == ("shoulder",)
        assert "arm.yaml:4: key 'rotor_inertia'" in str(caught[0].message)
        assert "a motor at joint 'crank', which other joints drive" in str(caught[0].message)

    def test_a_name_of_a_link_and_of_its_joint(self, pair):
        """They are one body."""
        path = pair(YAML.replace("'crank'", "'rod'"))
        path.write_text(path.read_text().replace('name="crank"', 'name="rod"'))
        (chord,) = urdf.load(path).chords
        assert (chord.body_i, chord.body_j) == (2, 3)

    def test_a_name_of_a_link_and_of_another_joint(self, pair):
        path = pair(YAML.replace("'fore'", "'upper'"))
        path.write_text(path.read_text().replace('name="crank"', 'name="upper"'))
        with pytest.raises(
            urdf.InvalidLoop, match="'upper' is a link, and a joint that carries link 'rod'; rename one"
        ):
            urdf.load(path)


def test_loops_of_the_caller():
    at = Placement(translation=[1, 0, 0])
    (chord,) = urdf.load(arm(), loops=[urdf.Loop("c", "distance", "fore", "crank", at, length=0.5)]).chords
    assert (chord.kind, chord.body_i, chord.body_j, chord.length) == ("distance", 2, 3, 0.5)
    with pytest.raises(urdf.InvalidLoop, match=r"loop 'c': there is no link or joint 'hand'; correct the name"):
        urdf.load(arm(), loops=[urdf.Loop("c", "ball", "fore", "hand")])
    with pytest.raises(
        urdf.InvalidLoop, match=r"loops has an entry of type Chord; give urdf\.Loop\(…\), or the YAML file"
    ):
        urdf.load(arm(), loops=[chord])
    with pytest.raises(graphdyn.InvalidModel, match="chord 'c': axis is zero; give a direction"):
        urdf.Loop("c", "hinge", "fore", "rod", axis=(0, 0, 0))
    with pytest.raises(graphdyn.InvalidModel, match="its name and those of its links must be strings"):
        urdf.Loop("c", "hinge", 1, "rod")
    with pytest.raises(graphdyn.InvalidModel, match="loop 'c': a placement is of type list"):
        urdf.Loop("c", "hinge", "fore", "rod", [1, 0, 0])


PUBLISHED = {
    "epr/5bar_linkage/robot": (6, 1, 6, ("mot1", "mot2")),
    "epr/robot_delta/robot": (14, 3, 18, ("mot1_rod1", "mot1_rod2")),
    "epr/cassie_like/robot": (
        19, 2, 12, ("motor_hip1", "motor_hip2", "motor_tigh", "motor_knee", "motor_ankle"),
    ),
    "strandbeest/Strandbeest": (73, 42, 210, ("joint_crossbar_crank",)),
    "urdfplus/four_bar": (3, 1, 5, None),
    "urdfplus/six_bar": (5, 1, 5, None),
    "urdfplus/planar_leg_linkage": (4, 1, 5, None),
    "urdfplus/loop_size5": (11, 1, 5, None),
    "urdfplus/loop_size4": (10, 0, 0, None),
    "urdfplus/mini_cheetah_leg": (6, 0, 0, None),
}  # fmt: skip
"""Bodies, chords, rows, motors."""


@pytest.mark.filterwarnings("ignore::urdf.ZeroMassWarning")  # of links that join two hinges
@pytest.mark.parametrize("name", PUBLISHED)
def test_published_mechanisms(name, tmp_path):
    path = existing(DATA / "loops" / f"{name}.urdf")
    model = urdf.load(path)
    assert (model.n_bodies, len(model.chords), model.n_chord_rows, model.actuated) == PUBLISHED[name]
    same(model, saved(model, tmp_path))


def saved(model, folder):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of gravity and of links without mass
        urdf.save(model, folder / "saved.urdf")
        return urdf.load(folder / "saved.urdf", gravity=model.gravity)


def same(model: RobotModel, again: RobotModel) -> None:
    assert (again.couplings, again.actuated, again.joint_names) == (model.couplings, model.actuated, model.joint_names)
    for ours, theirs in zip(model.chords, again.chords, strict=True):
        assert (theirs.name, theirs.kind, theirs.body_i, theirs.body_j) == (
            ours.name,
            ours.kind,
            ours.body_i,
            ours.body_j,
        )
        for a, b in ((ours.placement_i, theirs.placement_i), (ours.placement_j, theirs.placement_j)):
            assert_allclose(
                b.rotation, a.rotation, atol=1e-15
            )  # angles are rounded: tests/urdf/writing/test_round_trip.py
            assert_array_equal(b.translation, a.translation)
        assert_array_equal(theirs.axis, ours.axis)


def test_made_mechanisms(tmp_path):
    same(four_bar(), saved(four_bar(), tmp_path))
    model = palletizer(existing(DATA))[0]
    ground = Chord("to ground", "ball", 0, TURNED, 3, Placement())
    model = replace(model, chords=(*model.chords, ground), base=TURNED)
    again = saved(model, tmp_path)
    names, names_again = (("ground", *robot.body_names) for robot in (model, again))  # it is not numbered depth first
    for chord, chord_again in zip(model.chords, again.chords, strict=True):
        assert names_again[chord_again.body_i] == names[chord.body_i]
        assert names_again[chord_again.body_j] == names[chord.body_j]
    assert_allclose(again.chords[-1].placement_i.translation, (TURNED @ TURNED).translation, rtol=1e-15)


def test_sums_of_loop_size4():
    """q_21 + q_22 = q_11 + q_12, written out from the file."""
    model = urdf.load(existing(DATA / "loops" / "urdfplus" / "loop_size4.urdf"))
    q = np.random.default_rng(0).standard_normal((5, model.nv))
    at = dict(zip(model.joint_names, model.joint_positions(q).T, strict=True))
    assert_allclose(at["joint_2_1"] + at["joint_2_2"], at["joint_1_1"] + at["joint_1_2"], atol=1e-15)
    assert "joint_2_2" not in model.independent_joints


def test_updated(tmp_path):
    source, out = tmp_path / "arm.urdf", tmp_path / "new.urdf"
    source.write_text(arm(loop(), coupling(predecessor="upper")))
    model = urdf.load(source)
    urdf.update(source, out, 2 * model.inertial_parameters)
    again = urdf.load(out)
    same(model, again)
    assert_allclose(again.inertial_parameters, 2 * model.inertial_parameters)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("urdfplus/four_bar", ["hold 2 of 3 degrees of freedom and leave 1; redundant rows: 3", "q = 0 is singular"]),
        (
            "urdfplus/six_bar",
            ["hold 2 of 5 degrees of freedom and leave 3", "at q = 0 the loops are open by 0.3 m or rad"],
        ),
        ("epr/5bar_linkage/robot", ["leave 3", "drives: 1; with all motors held, joints 'closedloop1_A', 'closedl"]),
        ("epr/robot_delta/robot", ["leave 5; redundant rows: 9", "degrees of freedom that no motor drives: 3"]),
        ("strandbeest/Strandbeest", ["the loops have 210 rows: more than 100 are not examined"]),
    ],
)  # fmt: skip
def test_inspected(name, said):
    report = urdf.inspect(existing(DATA / "loops" / f"{name}.urdf"))
    messages = " ".join(finding.message for finding in report.findings)
    assert all(part in messages for part in said)
    idle = any("drives: " in part for part in said)
    assert ("degrees of freedom that no motor drives" in messages) == idle
    assert "independent-contradiction" not in report.codes  # in a regular pose, also where q = 0 is singular
    assert report.usable


def test_loops_are_not_judged():
    with pytest.raises(
        InvalidInput, match=r"robot 'four-bar' has loops, closed by 'closing', .* its tree: urdf.load\(…\).opened"
    ):
        judge(four_bar(), inverse_dynamics=lambda q, v, a: q)
