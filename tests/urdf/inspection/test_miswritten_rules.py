"""Tensors that are those of a mesh if they are written otherwise."""

import numpy as np
import pytest
from robots.mesh_files import box, mesh, one_link, stl, visual

import urdf
from graphdyn import Body
from urdf.document.inertial_numbers import inertial_numbers
from urdf.document.numbers import inertial_element, rotation_from_rpy, rpy_from_rotation
from urdf.inspection.rules.miswritten_rules import distance, meant
from urdf.inspection.structure import LinkInertial
from urdf.reading.corrections import changes

MESH = rotation_from_rpy(0.1, 0.2, -1.0) @ np.diag([0.05, 0.21, 0.24]) @ rotation_from_rpy(0.1, 0.2, -1.0).T
TURN = rotation_from_rpy(0.5, 0.9, -0.4)


def written(tensor, turn=None, center=(0.0, 0.0, 0.0), mass=1.0):
    element = inertial_element(Body("a", mass, np.array(center), tensor))
    if turn is not None:
        element.find("origin").set("rpy", " ".join(map(repr, map(float, rpy_from_rotation(turn)))))
    return element


def read(element):
    found = inertial_numbers(element)
    return LinkInertial(found.mass, found.center, found.rotation, found.tensor, "a", element)


SLIPS = [change for change in changes(written(0.9 * MESH)) if change.turns]


@pytest.mark.parametrize("slip", SLIPS, ids=lambda slip: slip.what)
def test_every_slip_is_undone(slip):
    wrong = read(slip.applied(written(0.9 * MESH)))
    found = meant(wrong, MESH)
    if distance(wrong.turned, MESH)[0] > 0.12:
        change, off = found
        assert distance(inertial_numbers(change.applied(wrong.element)).turned, MESH) == pytest.approx((0, 0.9))
        assert off < 1e-12


@pytest.mark.parametrize(
    ("tensor", "what"), [(MESH, "rotation left out"), (TURN @ MESH @ TURN.T, "rotation transposed")]
)
def test_rotations(tensor, what):
    assert meant(read(written(tensor, TURN)), MESH)[0].what == what


def test_what_is_no_mistake():
    assert meant(read(written(MESH)), MESH) is None
    assert meant(read(written(TURN @ MESH @ TURN.T)), MESH) is None
    negated = 2 * np.diag(np.diag(MESH)) - MESH
    assert meant(read(written(2 * negated)), MESH) is None  # another size: a hollow body, or another one


class TestFiles:
    """A box of 0.2, 0.1 and 0.4 m that is turned by 0.5 rad about its y axis."""

    MASS = 8.0
    TURNED = rotation_from_rpy(0, 0.5, 0)
    TENSOR = TURNED @ np.diag([0.17, 0.2, 0.05]) @ TURNED.T * MASS / 12
    NEGATED = 2 * np.diag(np.diag(TENSOR)) - TENSOR

    def told(self, folder, tensor, mass=MASS, xyz="0 0 0"):
        stl(folder / "box.stl", box(0.2, 0.1, 0.4))
        entries = " ".join(repr(float(x)) for x in tensor[np.triu_indices(3)])
        drawn = visual(mesh("box.stl"), '<origin xyz="0 0 0" rpy="0 0.5 0"/>')
        path = folder / "arm.urdf"
        path.write_text(one_link(drawn, mass, xyz=xyz, tensor=entries), encoding="utf-8")
        return [one for one in urdf.inspect(path).findings if one.code == "miswritten-inertia"]

    def test_products_of_the_opposite_sign(self, tmp_path):
        (finding,) = self.told(tmp_path, self.NEGATED)
        assert (finding.severity, finding.element) == ("warning", "<inertial> of link 'arm'")
        assert finding.message == (
            "the tensor differs by 51 % from that of the visual mesh, filled uniformly with 8 kg (1000 kg/m³), whose "
            "center of mass it has; ixz with the opposite sign, it differs by 0.0 %"
        )
        assert finding.remedy == (
            "compare it with CAD; SolidWorks, for one, writes products of inertia with the opposite sign unless told "
            "otherwise"
        )

    @pytest.mark.parametrize(
        ("sign", "what"),
        [
            (1, "shifted from the origin of the link to the center of mass"),
            (-1, "shifted back, as it was shifted to the center of mass twice"),
        ],
    )
    def test_a_tensor_about_another_point(self, tmp_path, sign, what):
        """SolidWorks gives both. A box with its center at (0.1, 0.05, -0.2) m of the link."""
        center = np.array([0.1, 0.05, -0.2])
        tensor = self.TENSOR + sign * self.MASS * (center @ center * np.eye(3) - np.outer(center, center))
        found = meant(read(written(tensor, center=center, mass=self.MASS)), self.TENSOR)
        assert found[0].what == what
        assert found[1] < 1e-6

    @pytest.mark.parametrize("factor", [1e-9, 0.001, 0.1, 10, 1000])
    def test_powers_of_ten(self, tmp_path, factor):
        (finding,) = self.told(tmp_path, factor * self.TENSOR)
        assert finding.message == (
            f"the tensor is {factor:.3g} times that of the visual mesh, filled uniformly with 8 kg (1000 kg/m³), and "
            "else the same up to 0.0 %: mass or tensor is off by a power of ten or by the density of another material"
        )

    @pytest.mark.parametrize(
        "given",
        [
            {"tensor": TENSOR},
            {"tensor": 1.3 * TENSOR},
            {"tensor": 3 * TENSOR},
            {"tensor": NEGATED, "xyz": "0.05 0 0"},
            {"tensor": 10 * TENSOR, "xyz": "0.05 0 0"},
            {"tensor": 9.5 * NEGATED, "mass": 9.5 * MASS},
            {"tensor": 0 * TENSOR},
        ],
        ids=["sound", "hollow", "of another size", "center", "center and size", "denser than steel", "none"],
    )
    def test_silence(self, tmp_path, given):
        assert self.told(tmp_path, **given) == []
