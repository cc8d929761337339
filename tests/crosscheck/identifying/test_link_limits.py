"""Limits of links from CAD and meshes in identify, and what is told of them."""

from dataclasses import replace

import numpy as np
import pytest
from identified.identified_arm import compared, identified, virtual

import urdf
from crosscheck.commands.identify.command import new_warnings
from crosscheck.identifying.methods.link_limits import link_limits, mesh_boxes, with_limits
from crosscheck.identifying.methods.methods import method_named, method_with
from crosscheck.identifying.results import link_findings as findings_of
from crosscheck.identifying.results.link_findings import link_findings
from crosscheck.reference.subject import subject
from graphdyn import InvalidInput
from graphdyn.identification import BodyLimits, ContradictedMass, PhysicalLimits
from urdf import Reading


class TestLimits:
    def test_boxes_are_those_of_the_meshes_of_links_that_carry_others(self):
        robot = subject("ur5", Reading())
        boxes, shapes = mesh_boxes(robot), urdf.shapes("ur5")
        assert list(boxes) == list(robot.model.body_names[:-1])
        corners = np.concatenate(
            [
                shape.vertices @ shape.placement.rotation.T + shape.placement.translation
                for shape in shapes.meshes
                if shape.body == "forearm_link"
            ]
        )
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = 0.1 * (high - low).max()
        assert boxes["forearm_link"] == pytest.approx(np.stack([low - margin, high + margin]))

    def test_no_boxes_without_a_file_or_where_they_are_not_wanted(self):
        model = urdf.load("ur5")
        assert mesh_boxes(subject(model, Reading())) == {}
        assert link_limits(subject("ur5", Reading()), PhysicalLimits(in_boxes=False)).box == {}

    def test_a_link_with_a_missing_mesh_has_no_box(self, tmp_path):
        (tmp_path / "arm.urdf").write_text(ARM, encoding="utf-8")
        robot = subject(str(tmp_path / "arm.urdf"), Reading())
        assert list(mesh_boxes(robot)) == ["whole"]

    def test_a_box_that_is_given_counts(self):
        box = np.array([[-1.0, -1, -1], [1, 1, 1]])
        assert (
            link_limits(subject("ur5", Reading()), PhysicalLimits(box={"forearm_link": box})).box["forearm_link"] is box
        )

    def test_unknown_link(self):
        with pytest.raises(InvalidInput, match=r"there is no link 'wrist' to limit; robot '.*' has "):
            identified(["consistent"], limits=PhysicalLimits(cad_factors={"wrist": 2.0}))

    def test_every_method_with_limits_takes_them_unless_it_has_its_own(self):
        limits, own = PhysicalLimits(cad_factor=2.0), PhysicalLimits(cad_factor=5.0)
        methods = [
            *(method_named(name) for name in ("consistent", "entropic", "consistent-huber", "log-cholesky")),
            method_with("pullback", strength=10.0),
            replace(method_named("consistent"), limits=own),
            method_named("wls"),
        ]
        *free, labeled, fixed, plain = with_limits(methods, limits)
        assert all(method.limits is limits for method in free)
        assert labeled.estimator.limits is limits
        assert labeled.estimator.strength == 10.0
        assert fixed.limits is own
        assert plain is methods[-1]

    def test_links_of_a_result_keep_them(self):
        found = identified(["consistent", "entropic"], limits=PhysicalLimits(cad_factor=1.05))
        for result in found.comparison.results:
            ratios = found.body_parameters(result)[:, 0] / found.torque_model.model.inertial_parameters[::10]
            assert np.abs(np.log(ratios)).max() <= np.log(1.05) + 1e-5


ARM = """<robot name="arm">
  <link name="base"/>
  <link name="whole">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
  </link>
  <link name="half">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
    <visual><geometry><mesh filename="lost.stl"/></geometry></visual>
  </link>
  <link name="tip">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
  </link>
  <joint name="a" type="continuous"><parent link="base"/><child link="whole"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous"><parent link="whole"/><child link="half"/><axis xyz="0 1 0"/></joint>
  <joint name="c" type="continuous"><parent link="half"/><child link="tip"/><axis xyz="0 1 0"/></joint>
</robot>
"""
"""Three links, one of them with a mesh that is not there."""


class TestFindings:
    def test_none_for_masses_inside_their_limits(self):
        found = compared()
        assert link_findings(found, found.comparison.of("consistent, entropic prior")) == ()
        assert link_findings(found, found.comparison.of("WLS")) == ()

    def test_values_at_their_limits(self):
        found = identified(["consistent"], limits=PhysicalLimits(cad_factor=1.001))
        masses = [
            each for each in link_findings(found, found.comparison.of("consistent")) if each.code == "undetermined"
        ]
        names = found.torque_model.model.body_names
        assert [each.link for each in masses if each.link] == list(names)
        mass = found.torque_model.model.bodies[0].mass
        assert masses[0].message.startswith(f"mass of {names[0]} is {mass:.3g} kg, held by its limit of ")
        assert masses[0].message.endswith(" kg: undetermined by this recording")
        assert masses[-1].message.startswith("total mass is ")

    def test_contradictions(self, monkeypatch):
        found, result = compared(), compared().comparison.of("consistent")
        names = found.torque_model.model.body_names
        told = (ContradictedMass(names[0], 2.0, 6.0, 11.9, 0.25, 0.34),)
        monkeypatch.setattr(findings_of, "contradicted_masses", lambda *_: told)
        (only,) = link_findings(found, result)
        assert (only.link, only.code) == (names[0], "cad-mass")
        assert only.message == (
            f"the recording contradicts the mass of {names[0]} in CAD, 2 kg: 6 kg with the limit, 11.9 ± 0.2 kg "
            "without it, which makes 34 % of the squared error of rows that were not fitted vanish"
        )
        assert only.remedy == f"check CAD and what is mounted; allow it with --cad-factor {names[0]}=8"
        monkeypatch.setattr(findings_of, "contradicted_masses", lambda *_: (*told, replace(told[0], body=names[1])))
        assert link_findings(found, result)[1].message.endswith(
            "vanish; one of these masses is wrong, the recording does not tell which"
        )
        together = (replace(told[0], body="", cad=20.0, limit=35.0, mass=100.0),)
        monkeypatch.setattr(findings_of, "contradicted_masses", lambda *_: together)
        (only,) = link_findings(found, result)
        assert only.message.startswith("the recording contradicts the masses in CAD, 20 kg in the sum: ")
        assert only.remedy.endswith("allow it with --cad-factor 6")

    def test_limits_are_part_of_the_estimate(self):
        assert isinstance(compared().comparison.of("consistent").estimate.limits, BodyLimits)
        assert compared().comparison.of("WLS").estimate.limits is None


def test_new_warnings_are_those_of_the_written_file_alone(tmp_path):
    cad, same, light = (tmp_path / f"{name}.urdf" for name in ("cad", "same", "light"))
    urdf.save(virtual().subject.model.with_gravity([0, 0, -9.81]), cad)
    ten = virtual().subject.model.inertial_parameters.reshape(-1, 10).copy()
    urdf.update(cad, same, 1.1 * ten)
    assert new_warnings(str(cad), same, Reading()) == []
    ten[1] = [1e-6, 0, 0, 0, 1e-9, 0, 1e-9, 0, 0, 1e-9]
    urdf.update(cad, light, ten)
    assert "tiny-mass" in [finding.code for finding in new_warnings(str(cad), light, Reading())]
