"""From the document to the model: repair, check, cut, lock, fuse, and the warnings of urdf.load."""

from urdf.reading.cutting import Chain
from urdf.reading.misreading import Misreadings

__all__ = ["Chain", "Misreadings"]
