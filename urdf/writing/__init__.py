"""URDF from a model, and new inertial parameters into an existing file."""

from urdf.writing.writing import urdf_document

__all__ = ["urdf_document"]
