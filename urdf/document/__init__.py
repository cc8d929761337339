"""A URDF file before it is a robot: sources, xacro, the XML tree, its elements and numbers."""

from urdf.document.catalog import locate
from urdf.document.document import UNNAMED_SOURCES
from urdf.document.files import write_whole
from urdf.document.numbers import NUMBER, finite_number, rpy_from_rotation
from urdf.document.opening import content_of, is_expanded, path_of
from urdf.document.toml_text import parsed_toml, toml_document
from urdf.document.xacro.yaml_limits import refuse_growing_yaml

__all__ = [
    "NUMBER",
    "UNNAMED_SOURCES",
    "content_of",
    "finite_number",
    "is_expanded",
    "locate",
    "parsed_toml",
    "path_of",
    "refuse_growing_yaml",
    "rpy_from_rotation",
    "toml_document",
    "write_whole",
]
