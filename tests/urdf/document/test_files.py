"""Files appear complete or not at all, whatever fails while they are written."""

import os

import pytest
from failing import failing

from urdf.document import write_whole


@pytest.mark.parametrize("old", [b"old", None])
@pytest.mark.parametrize(("number", "name"), [(1, "write_bytes"), (2, "fsync"), (3, "replace")])
def test_nothing_half_written(number, name, old, tmp_path):
    file = tmp_path / "x.json"
    if old:
        file.write_bytes(old)
    with failing(number) as made, pytest.raises(OSError, match=os.strerror(28)) as error:
        write_whole(file, b"new content")
    assert made[-1] == name
    assert error.value.filename == str(file)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == ([old] if old else [])
    with failing(0) as made:
        write_whole(file, b"new content")
    assert made == ["write_bytes", "fsync", "replace"]
    assert file.read_bytes() == b"new content"
