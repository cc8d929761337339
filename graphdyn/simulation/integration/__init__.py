"""Integration over time: steps of fixed width, adaptive steps, events between steps, maximal coordinates."""
