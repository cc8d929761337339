"""MJCF files, read by MuJoCo itself, as URDF."""

from urdf.document.mjcf.expanding import MJCFExpansion, expand_mjcf, is_mjcf

__all__ = ["MJCFExpansion", "expand_mjcf", "is_mjcf"]
