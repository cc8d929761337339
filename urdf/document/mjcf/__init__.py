"""MJCF files, read by MuJoCo itself, as URDF."""

from urdf.document.mjcf.expanding import Compiled, compiled_mjcf, expand_mjcf, is_mjcf

__all__ = ["Compiled", "compiled_mjcf", "expand_mjcf", "is_mjcf"]
