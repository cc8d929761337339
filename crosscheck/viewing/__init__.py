"""Robots in three dimensions: one player, on pages without server or network and served live."""
