"""Mesh files written by trimesh and by hand, and a robot that shows them."""

from pathlib import Path

import numpy as np
import trimesh
from trimesh import creation
from urdf_text import inertial, joint, robot_text

import urdf

BINDING = (
    '<bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common></bind_material>'
)
"""In an instance of geometry: the material of its triangles."""


def box(x: float = 0.2, y: float = 0.1, z: float = 0.4, center: tuple[float, float, float] = (0, 0, 0)):
    """A closed box with its center there [m]."""
    mesh = creation.box((x, y, z))
    mesh.apply_translation(center)
    return mesh


def torus():
    """800 faces."""
    return creation.torus(0.3, 0.1, major_sections=20, minor_sections=20)


def torn(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Every triangle apart from the others, a little smaller: no edge is shared."""
    corners = mesh.triangles
    middle = corners.mean(axis=1, keepdims=True)
    vertices = (middle + 0.98 * (corners - middle)).reshape(-1, 3)
    return trimesh.Trimesh(vertices, np.arange(len(vertices)).reshape(-1, 3), process=False)


def stl(path: Path, mesh: trimesh.Trimesh) -> Path:
    """A binary STL file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(mesh.export(file_type="stl"))
    return path


def collada(
    mesh: trimesh.Trimesh,
    unit: str = '<unit meter="0.001" name="millimeter"/>',
    nodes: str = '<node id="n"><instance_geometry url="#g"/></node>',
    color: str = "",
    polygons: str | None = None,
) -> str:
    """A Collada document. nodes: of the scene; polygons: instead of <triangles>"""
    corners = " ".join(f"{a} 0" for a in mesh.faces.ravel())
    positions = " ".join(map(repr, mesh.vertices.ravel().tolist()))
    if color:
        nodes = nodes.replace('url="#g"/>', f'url="#g">{BINDING}</instance_geometry>')
    faces = polygons or (
        f'<triangles material="m" count="{len(mesh.faces)}"><input semantic="VERTEX" source="#v" offset="0"/>'
        f'<input semantic="NORMAL" source="#n" offset="1"/><p>{corners}</p></triangles>'
    )
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>{unit}<up_axis>Y_UP</up_axis></asset>
  <library_effects><effect id="e"><profile_COMMON><technique sid="common"><phong>
    <diffuse>{color}</diffuse></phong></technique></profile_COMMON></effect></library_effects>
  <library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="{mesh.vertices.size}">{positions}</float_array>
      <technique_common><accessor source="#a" count="{len(mesh.vertices)}" stride="3"/></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    {faces}
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""


def visual(geometry: str, more: str = "", tag: str = "visual") -> str:
    return f"<{tag}>{more}<geometry>{geometry}</geometry></{tag}>"


def mesh(name: str, scale: str = "") -> str:
    return f'<mesh filename="{name}"{f" scale={chr(34)}{scale}{chr(34)}" if scale else ""}/>'


def one_link(inside: str, mass: float | None = 1.0, **place_and_tensor: str) -> str:
    """A robot whose only moving link, "arm", has these elements beside its <inertial>."""
    own = "" if mass is None else inertial(mass, **place_and_tensor)
    return robot_text("r", '<link name="base"/>', f'<link name="arm">{own}{inside}</link>', joint("j", "base", "arm"))


def solid(shape):
    return trimesh.Trimesh(shape.vertices, shape.faces, process=False)


def only(text):
    """The one shape of a robot; nothing is missing."""
    found = urdf.shapes(text)
    assert found.missing == ()
    (shape,) = found.meshes
    return shape
