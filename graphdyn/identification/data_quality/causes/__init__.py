"""Possible causes: changes of columns, sizes, gravity, and what may have changed in between."""
