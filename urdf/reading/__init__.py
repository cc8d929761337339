"""The model from the document: repair, check, cut, lock, fuse, and the warnings of urdf.load."""

from urdf.loops.mimics import Mimic
from urdf.reading.cutting import Chain
from urdf.reading.loading import Misreadings, held_positions
from urdf.reading.reading import AS_IT_STANDS

__all__ = ["AS_IT_STANDS", "Chain", "Mimic", "Misreadings", "held_positions"]
