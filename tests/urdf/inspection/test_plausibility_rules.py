"""Numbers that are possible and hardly true: from where on they are told, and by what they are known."""

import numpy as np
import pytest
from inspected.sample import ELBOW_LIMIT, changed, link_behind, mesh_file

import graphdyn
import urdf
from urdf.inspection.rules.plausibility_rules import MAX_COMPARED_BODIES

CHAIN = "heavy-link", "heaviest-link"


@pytest.fixture
def severities(tmp_path):
    """severities(changes) → the severities of the findings of each code."""

    def run(*changes):
        path = tmp_path / "arm.urdf"
        path.write_text(changed(*changes), encoding="utf-8")
        found = {}
        for finding in urdf.inspect(path).findings:
            found.setdefault(finding.code, []).append(finding.severity)
        return found

    return run


def effort(value):
    return ELBOW_LIMIT, ELBOW_LIMIT.replace('"30"', f'"{value:.6g}"')


def behind(*links):
    return "</robot>", "".join(link_behind(*link) for link in links) + "</robot>"


class TestMotors:
    """The elbow carries 1.5 kg at 0.4 m, and turns them about an axis 0.4 m away."""

    GRAVITY, INERTIA = 1.5 * 9.80665 * 0.4, 0.06 + 1.5 * 0.4**2

    def test_gravity(self, severities):
        assert "effort-below-gravity" not in severities(*effort(1.001 * self.GRAVITY))
        assert severities(*effort(0.99 * self.GRAVITY))["effort-below-gravity"] == ["note"]
        assert severities(*effort(0.51 * self.GRAVITY))["effort-below-gravity"] == ["note"]
        assert severities(*effort(0.49 * self.GRAVITY))["effort-below-gravity"] == ["warning"]

    def test_inertia(self, severities):
        assert "effort-below-inertia" not in severities(*effort(1.001 * self.INERTIA))
        assert severities(*effort(0.999 * self.INERTIA))["effort-below-inertia"] == ["warning"]

    @pytest.mark.parametrize("value", [0, -1])
    def test_no_effort_is_no_motor(self, severities, value):
        assert not {"effort-below-gravity", "effort-below-inertia"} & severities(*effort(value)).keys()

    def test_slides(self, tmp_path):
        path = tmp_path / "slide.urdf"
        slide = ('name="elbow" type="revolute"', 'name="elbow" type="prismatic"', '"0 1 0"', '"0 0 1"', '"30"', '"9"')
        text = changed(*slide[:2]).replace(*slide[2:4]).replace(*slide[4:])
        path.write_text(text, encoding="utf-8")
        (finding,) = (one for one in urdf.inspect(path).findings if one.code == "effort-below-gravity")
        assert finding.message == "gravity takes up to 14.7 N within the limits of position, the effort is 9 N"

    def test_not_of_the_largest_robots(self, severities):
        links = [("fore" if k == 0 else f"l{k - 1}", f"l{k}", "0.01") for k in range(MAX_COMPARED_BODIES)]
        assert "effort-below-inertia" in severities(*effort(0.01))
        assert "effort-below-inertia" not in severities(*effort(0.01), *behind(*links))


class TestMasses:
    def test_heavier_than_both_neighbors(self, severities):
        for mass, severity in ((5.9, None), (6.1, ["note"]), (19.9, ["note"]), (20.1, ["warning"])):
            found = severities(*behind(("fore", "a", f"{mass}"), ("a", "b", "2")))
            assert found.get("heavy-link") == severity

    def test_neither_the_ends_of_a_chain_nor_a_torso(self, severities):
        assert not set(CHAIN[:1]) & severities(*behind(("fore", "a", "60"))).keys()
        assert "heavy-link" not in severities(*behind(("fore", "a", "60"), ("a", "b", "2"), ("a", "c", "2")))
        assert "heavy-link" not in severities(*behind(("fore", "a", "60"), ("a", "b", "0")))

    def test_more_than_all_others(self, severities):
        """1.5 + 2.5 + 1 kg."""
        assert "heaviest-link" not in severities(*behind(("fore", "a", "1"), ("a", "b", "4.99")))
        assert severities(*behind(("fore", "a", "1"), ("a", "b", "5.01")))["heaviest-link"] == ["note"]
        assert "heaviest-link" not in severities(*behind(("fore", "a", "9")))


class TestEqualInertials:
    def test_one_mesh_may_be_shown_twice(self, severities):
        same = mesh_file("a.stl")
        assert "equal-inertials" not in severities(*behind(("fore", "a", "1", same), ("a", "b", "1", same)))

    def test_mirrored_links_are_equal(self, severities):
        sides = [("fore", f"{side}_hand", "1", mesh_file(f"{side}.stl")) for side in ("left", "right")]
        assert not {"equal-inertials", "unlike-twin"} & severities(*behind(*sides)).keys()

    def test_without_meshes(self, severities):
        assert "equal-inertials" not in severities(*behind(("fore", "a", "1"), ("a", "b", "1")))


@pytest.mark.parametrize(
    ("left", "right"), [("l_arm", "r_arm"), ("arm_L", "arm_R"), ("LeftArm", "RightArm"), ("LEFT", "RIGHT"), ("l", "r")]
)
def test_names_of_twins(severities, left, right):
    assert severities(*behind(("fore", left, "1"), ("fore", right, "1.0011")))["unlike-twin"] == ["note"]
    assert "unlike-twin" not in severities(*behind(("fore", left, "1"), ("fore", right, "1.0009")))


@pytest.mark.parametrize(("one", "other"), [("arm", "arm2"), ("roll", "rorr"), ("link_1", "rink_1")])
def test_other_names_are_no_twins(severities, one, other):
    assert "unlike-twin" not in severities(*behind(("fore", one, "1"), ("fore", other, "2")))


def test_loads_are_those_of_the_equations(tmp_path):
    """What the message says, at more poses than it looks at."""
    path = tmp_path / "arm.urdf"
    path.write_text(changed(*effort(1.0)), encoding="utf-8")
    (finding,) = (one for one in urdf.inspect(path).findings if one.code == "effort-below-gravity")
    model = urdf.load(path)
    q, _ = model.random_state(np.random.default_rng(5), 2000)
    largest = np.abs(graphdyn.gravity_torque(model, q)[:, 1]).max()
    said = float(finding.message.split("up to ")[1].split()[0])
    assert 0.98 * largest < said <= largest * 1.001
