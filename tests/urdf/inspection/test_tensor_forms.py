"""Tensors that are those of a mesh if they are written otherwise."""

import numpy as np
import pytest
from robots.mesh_files import box, mesh, one_link, stl, visual

import urdf
from urdf.document.numbers import rotation_from_rpy
from urdf.inspection.rules.tensor_forms import distance, forms, meant

MESH = rotation_from_rpy(0.1, 0.2, -1.0) @ np.diag([0.05, 0.21, 0.24]) @ rotation_from_rpy(0.1, 0.2, -1.0).T
TURN = rotation_from_rpy(0.5, 0.9, -0.4)
WAYS = [form.words for form in forms(MESH, np.eye(3))]


@pytest.mark.parametrize("way", WAYS)
def test_every_way_is_undone(way):
    written = next(form.tensor for form in forms(MESH, np.eye(3)) if form.words == way)
    apart, found, off = meant(0.9 * written, np.eye(3), MESH)
    assert apart == pytest.approx(distance(written, MESH)[0])
    assert apart > 0.12
    assert distance(found.tensor, MESH) == pytest.approx((0, 0.9))
    assert off < 1e-12
    if way.startswith(("with its products of inertia", "mirrored")):  # each undoes itself
        assert found.words == way


@pytest.mark.parametrize(
    ("written", "words"),
    [
        (MESH, "without the rotation of <origin>"),
        (TURN @ MESH @ TURN.T, "with the opposite rotation of <origin>"),
    ],
)
def test_rotations(written, words):
    assert meant(written, TURN, MESH)[1].words == words


def test_what_is_no_mistake():
    assert meant(MESH, np.eye(3), MESH) is None
    other = TURN @ MESH @ TURN.T
    assert meant(other, np.eye(3), MESH) is None
    negated = 2 * np.diag(np.diag(MESH)) - MESH
    assert meant(2 * negated, np.eye(3), MESH) is None  # another size: a hollow body, or another one


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
            "center of mass it has; with its products of inertia negated it differs by 0.0 %"
        )
        assert finding.remedy == (
            "compare it with CAD; SolidWorks, for one, writes products of inertia with the opposite sign unless told "
            "otherwise"
        )

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
