"""Where the files lie that are not part of this repository: makers' robots, recordings, reference numbers."""

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
DATA = (REPOSITORY / os.environ.get("GRAPHDYN_TEST_DATA", "../shared")).resolve()
ARMS = DATA / "urdf" / "arms"


def existing(path: Path) -> Path:
    """The path, or the test is skipped, saying why."""
    if not path.exists():
        pytest.skip(f"not found: {path}; set GRAPHDYN_TEST_DATA to the folder that holds the shared data")
    return path
