"""Single channels of a recording, and gains of its torques."""
