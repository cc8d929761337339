"""What must be the same on all machines for answers that are the same to the last bit."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import version

LIBRARIES = ("graphdyn", "numpy", "scipy")


def versions() -> dict[str, str]:
    """Of this process."""
    python = ".".join(platform.python_version_tuple()[:2])
    return {"python": python, **{name: version(name) for name in LIBRARIES}}


def differences(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """In words; empty where there is none."""
    return ", ".join(
        f"{name} {there.get(name)} in place of {here[name]}" for name in here if there.get(name) != here[name]
    )
