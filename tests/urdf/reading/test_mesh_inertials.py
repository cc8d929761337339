"""repair=(InertialsFromMeshes(…),): inertials of shapes filled uniformly, against closed forms and trimesh."""

import re
import warnings

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose
from robots.mesh_files import box, mesh, one_link, stl, torn, torus, visual
from trimesh import creation
from urdf_text import joint, link, robot_text

import urdf

DENSITY = 2700.0


def load(source, *repair, **numbers):
    """The model with this repair, and what RepairWarning tells."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = urdf.load(source, repair=(*repair, urdf.InertialsFromMeshes(**numbers or {"density": DENSITY})))
    assert {warning.filename for warning in caught} <= {__file__}
    return model, [str(each.message) for each in caught if each.category is urdf.RepairWarning]


def drawn(geometry, more="", mass=None):
    return one_link(visual(geometry, more), mass)


def across(x, y):
    return (x * x + y * y) / 12


@pytest.mark.parametrize(
    ("geometry", "volume", "moments"),
    [
        ('<box size="0.2 0.4 0.6"/>', 0.048, (across(0.4, 0.6), across(0.2, 0.6), across(0.2, 0.4))),
        ('<sphere radius="0.3"/>', 4 / 3 * np.pi * 0.027, (0.4 * 0.09,) * 3),
        ('<cylinder radius="0.3" length="2"/>', np.pi * 0.18, (0.0225 + 4 / 12, 0.0225 + 4 / 12, 0.045)),
    ],
)
def test_simple_solids(geometry, volume, moments):
    """By the formulas, not the triangles; turned by 90° about y, which exchanges x and z."""
    model, _ = load(drawn(geometry, '<origin xyz="0.1 0.2 0.3" rpy="0 1.5707963267948966 0"/>'))
    (body,) = model.bodies
    assert_allclose(body.mass, DENSITY * volume, rtol=1e-14)
    assert_allclose(body.center_of_mass, [0.1, 0.2, 0.3], rtol=1e-14)
    assert_allclose(body.inertia, np.diag(moments[::-1]) * body.mass, rtol=1e-13, atol=1e-15 * body.mass)


def test_a_capsule():
    """Of its triangles: they lie inside it by at most 2 %."""
    model, _ = load(drawn('<capsule radius="0.5" length="3"/>'))
    assert_allclose(model.bodies[0].mass, DENSITY * np.pi * (0.75 + 1 / 6), rtol=0.02)


class TestMeshes:
    @pytest.fixture
    def of(self, tmp_path):
        """The body of a mesh file, mirrored and placed, and the text of the warning."""

        def run(form, scale="1 -1 1"):
            stl(tmp_path / "a.stl", form)
            robot = tmp_path / "r.urdf"
            placed = '<origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/>'
            robot.write_text(drawn(mesh("a.stl", scale), placed), encoding="utf-8")
            model, told = load(robot)
            return model.bodies[0], told[0]

        return run

    @staticmethod
    def witness(form):
        """The same by trimesh, from vertices that are scaled and placed."""
        moved = form.copy()
        moved.apply_transform(np.diag([1, -1, 1, 1]))
        turned = trimesh.transformations.euler_matrix(0.3, 0.2, 0.1)
        turned[:3, 3] = 0.1, 0.2, 0.3
        moved.apply_transform(turned)
        moved.density = DENSITY
        return moved

    @pytest.mark.parametrize("name", ["ring", "torn", "inside out", "two that overlap"])
    def test_any_mesh(self, of, name):
        """A closed one is filled, wherever its normals point; the hull of any other, and of one that counts twice."""
        lopsided = creation.cone(0.2, 0.5, transform=trimesh.transformations.rotation_matrix(0.7, [1, 2, 3]))
        form = {
            "ring": torus(),
            "torn": torn(lopsided),
            "inside out": trimesh.Trimesh(lopsided.vertices, lopsided.faces[:, ::-1]),
            "two that overlap": trimesh.util.concatenate([box(center=(0.001 * k, 0, 0)) for k in range(2)]),
        }[name]
        body, told = of(form)
        hull = name in ("torn", "two that overlap")
        expected = self.witness(form.convex_hull if hull else torus() if name == "ring" else lopsided)
        assert_allclose(body.mass, expected.mass, rtol=1e-5)
        assert_allclose(body.center_of_mass, expected.center_mass, atol=1e-6)
        assert_allclose(body.inertia, expected.moment_inertia, rtol=1e-4, atol=1e-5 * body.mass)
        assert told.endswith(f"from {'the convex hull of ' if hull else ''}its visual mesh, 2700 kg/m³")

    @pytest.mark.parametrize("size", [0.0, 1e-12])
    def test_a_flat_mesh(self, of, size):
        flat = box()
        flat.apply_scale((1, 1, size))
        body, told = of(flat)
        assert body.mass == 0
        assert told.endswith("link 'arm': left as it is, because the mesh is flat: it has no volume")


TWO = robot_text(
    "r",
    '<link name="base"/>',
    f'<link name="arm">{visual("<box size=" + chr(34) + "1 1 1" + chr(34) + "/>")}</link>',
    link("fore", 2.0).replace("</link>", f"{visual('<box size=' + chr(34) + '1 1 2' + chr(34) + '/>')}</link>"),
    '<link name="tool"/>',
    joint("a", "base", "arm"),
    joint("b", "arm", "fore"),
    joint("c", "fore", "tool", "fixed"),
)


class TestWhichLinks:
    def test_those_without_inertial(self):
        model, told = load(TWO, density=10.0)
        assert [body.mass for body in model.bodies] == [10.0, 2.0]
        assert told == [
            "<text>: repaired: line 3: link 'arm': no <inertial> → mass 10, xyz 0 0 0, rpy 0 0 0, ixx 1.66667, "
            "ixy 0, ixz 0, iyy 1.66667, iyz 0, izz 1.66667, from its visual shape, 10 kg/m³"
        ]

    def test_all_or_some(self):
        for links in ("all", ("fore", "arm")):
            model, told = load(TWO, density=10.0, links=links)
            assert [body.mass for body in model.bodies] == [10.0, 20.0]
            assert "line 4: link 'fore': mass 2, xyz 0 0 0, rpy 0 0 0, ixx 0.1, ixy 0, " in told[0]
            assert "→ mass 20, xyz 0 0 0, rpy 0 0 0, ixx 8.33333, ixy 0, ixz 0, iyy 8.33333" in told[0]
        model, _ = load(TWO, density=10.0, links=["fore"])
        assert [body.mass for body in model.bodies] == [0.0, 20.0]

    def test_total_mass(self):
        """The links that keep their inertial count."""
        model, told = load(TWO, total_mass=7.0)
        assert [body.mass for body in model.bodies] == [5.0, 2.0]
        assert told[0].endswith("5 kg/m³")
        model, _ = load(TWO, total_mass=7.5, links="all")
        assert_allclose([body.mass for body in model.bodies], [2.5, 5.0], rtol=1e-15)

    def test_collision_shapes_stand_in(self):
        """Where a visual one is missing: never a part of them."""
        both = visual(mesh("/gone.stl")) + visual('<box size="9 9 9"/>')
        model, told = load(one_link(both + visual('<box size="1 1 1"/>', tag="collision"), None), density=1.0)
        assert_allclose(model.bodies[0].mass, 1.0, rtol=1e-15)
        assert told[0].endswith("from its collision shape, 1 kg/m³")
        model, told = load(one_link(both, None), density=1.0)
        assert model.bodies[0].mass == 0
        assert told == ["<text>: repaired: link 'arm': left as it is, because line 3: no such file"]

    def test_several_shapes_of_a_link(self):
        """As one box of twice the height."""
        halves = [visual('<box size="1 1 1"/>', f'<origin xyz="0 0 {z}"/>') for z in (0.5, 1.5)]
        model, _ = load(one_link("".join(halves), None), density=3.0)
        (whole,) = load(one_link(visual('<box size="1 1 2"/>', '<origin xyz="0 0 1"/>'), None), density=3.0)[0].bodies
        assert_allclose(model.bodies[0].parameters, whole.parameters, rtol=1e-14, atol=1e-14)

    def test_together_with_another_repair(self):
        model, told = load(TWO.replace('<child link="arm"/>', '<child link="arm"/><axis xyz="0 0 0.9999"/>'), "axis")
        assert "xyz 0 0 0.9999 made 0.0 0.0 1.0, of length 1, line 3: link 'arm'" in told[0]
        assert model.bodies[0].mass == DENSITY


REFUSED = {
    "neither": ({"links": "all"}, "one of density and total_mass is needed; give InertialsFromMeshes(density=…)"),
    "both": ({"density": 1.0, "total_mass": 1.0}, "one of density and total_mass is needed"),
    "zero": ({"density": 0.0}, "0.0 is no density or mass; give a positive number, in kg/m³ or kg"),
    "infinite": ({"total_mass": np.inf}, "inf is no density or mass"),
    "text": ({"density": "1"}, "'1' is no density or mass"),
    "too little": ({"total_mass": 2.0}, "total_mass is 2 kg, but the links that keep their <inertial> have 2 kg; give"),
    "a string": (
        {"density": 1.0, "links": "arm"},
        "links is the string 'arm'; give 'missing', 'all' or names: ('arm',)",
    ),
    "unknown": ({"density": 1.0, "links": ["arm", "x"]}, "there is no link 'x'; known: 'base', 'arm', 'fore', 'tool'"),
    "no shape": ({"total_mass": 9.0, "links": ["tool"]}, "no link without <inertial> has a shape; give the links that"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    numbers, message = REFUSED[name]
    with pytest.raises(urdf.InvalidRepair, match=re.escape(f"inertials-from-meshes: {message}")):
        load(TWO, **numbers)


def test_a_total_mass_needs_every_volume():
    text = TWO.replace('<box size="1 1 1"/>', mesh("/gone.stl"))
    with pytest.raises(urdf.InvalidRepair, match="the volume of link 'arm' is not known: line 3: no such file; give a"):
        load(text, total_mass=9.0)


def test_the_name_alone():
    with pytest.raises(urdf.InvalidRepair, match=r"needs a density or a total mass; give urdf.InertialsFromMeshes\("):
        urdf.load(TWO, repair=("inertials-from-meshes",))
    with pytest.raises(urdf.InvalidRepair, match="repair is one InertialsFromMeshes; give a tuple: "):
        urdf.load(TWO, repair=urdf.InertialsFromMeshes(density=1.0))


def test_into_the_file(tmp_path):
    """urdf.update writes the repaired inertials, and keeps everything else."""
    source, target = tmp_path / "a.urdf", tmp_path / "b.urdf"
    source.write_text(TWO, encoding="utf-8")
    model, _ = load(source, density=10.0)
    with pytest.warns(urdf.MissingInertialWarning):
        urdf.update(source, target, [body.parameters for body in model.bodies])
    for body, same in zip(model.bodies, urdf.load(target).bodies, strict=True):
        assert_allclose(body.parameters, same.parameters, rtol=1e-15)
    assert target.read_text(encoding="utf-8").count("<visual>") == 2


def test_other_functions_take_the_repair():
    repair = (urdf.InertialsFromMeshes(density=1.0),)
    assert len(urdf.shapes(TWO, repair=repair).meshes) == 2
    assert urdf.fused_links(TWO, repair=repair) == {}
