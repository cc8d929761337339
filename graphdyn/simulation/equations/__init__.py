"""The equations of motion that a simulation integrates: trees with friction, robots with loops."""
