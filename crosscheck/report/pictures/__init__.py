"""Drawings of the pages, one file each; each function takes a key that keeps its ids apart and gives an <svg>."""
