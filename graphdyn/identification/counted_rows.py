"""The rows of a recording that count, where not all of them do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from graphdyn._errors import InvalidInput
from graphdyn.identification.rows import Rows
from graphdyn.identification.samples import Samples

P = TypeVar("P", Rows, Rows | Samples)


def counted(parts: Iterable[P], used: NDArray[np.bool_] | None) -> Iterator[P]:
    """Of consecutive parts of a recording, the rows that are used (N,); all for None.

    After a gap a run of the recording starts anew. Raises InvalidInput for another number of rows.
    """
    if used is None:
        yield from parts
        return
    position = 0
    for part in parts:
        here = np.concatenate([[False], used[position : position + len(part)], [False]])
        borders = np.flatnonzero(np.diff(here)).tolist()
        for start, stop in zip(borders[::2], borders[1::2], strict=True):
            cut = part[start:stop]
            gap = start > 0 or (position > 0 and not used[position - 1])
            yield replace(cut, first=True) if gap and isinstance(cut, Rows) else cut
        position += len(part)
    if position != len(used):
        raise InvalidInput(f"used is given for {len(used)} rows; the filter leaves {position}")
