"""Which versions of which libraries made a report."""

from __future__ import annotations

from importlib.metadata import version

REPORTED_LIBRARIES = ("graphdyn", "numpy", "scipy", "yourdfpy", "example-robot-data")


def versions() -> dict[str, str]:
    """Versions of everything that takes part in a comparison."""
    from crosscheck.reference.pinocchio_model import PINOCCHIO_VERSION

    return {**{name: version(name) for name in REPORTED_LIBRARIES}, "pinocchio": PINOCCHIO_VERSION}
