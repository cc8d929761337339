"""Joint states as `ros2 topic echo --csv` prints them: no header; names of the joints in every line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crosscheck.recordings.errors import noted
from crosscheck.recordings.table import RecordedTable, in_words

STAMP = ("header.stamp.sec", "header.stamp.nanosec", "header.frame_id")
FIELDS = ("position", "velocity", "effort")


def named(table: RecordedTable) -> RecordedTable:
    """The table with names where its lines are seconds, nanoseconds, frame, n joints, and one or three fields of n.

    Two fields would be position and velocity or position and effort, so they stay without names.
    """
    words = [k for k in range(len(table.names)) if np.isnan(table.values[:, k]).all()]
    n = len(words) - 1
    fields = (len(table.names) - len(words) - 2) / n if n > 0 else 0
    if words != list(range(2, 3 + n)) or fields not in (1, len(FIELDS)):
        return table
    joints = [{text for text in table.texts.get(k, {}).values() if text} for k in words[1:]]
    nanoseconds = table.values[:, 1]
    if any(len(names) != 1 for names in joints) or np.any((nanoseconds < 0) | (nanoseconds >= 1e9)):
        return table
    order = [names.pop() for names in joints]
    columns = [f"{field}.{joint}" for field in FIELDS[: int(fields)] for joint in order]
    message = f"joint states as `ros2 topic echo --csv` prints them, of {in_words(order)}"
    remedy = "read as such; otherwise give a mapping with the numbers of the columns"
    finding = noted(str(table.path), "echoed-messages", message, remedy)
    others = tuple(other for other in table.findings if other.code != "no-header")
    names = (*STAMP, *(f"name[{k}]" for k in range(n)), *columns)
    return replace(table, names=names, findings=(*others, finding))
