"""From the document to the model: repair, check, cut, lock, fuse, and the warnings of urdf.load."""
