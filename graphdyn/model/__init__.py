"""The description of a robot: bodies, joints, couplings, chords. It never changes."""
