"""Results as pandas tables. pandas is imported when a table is asked for, and is no requirement of the package."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from graphdyn.errors import not_installed
from graphdyn.layout import Array

if TYPE_CHECKING:
    import pandas


def data_frame(
    columns: Mapping[str, Any], index: Sequence[Any] | Array | None = None, name: str | None = None
) -> pandas.DataFrame:
    """A table of these columns, N entries each.

    index: what its rows are named by (N,), numbers from 0 if left out; name: of the index

    Raises ImportError, with the command that installs it, where pandas is missing.
    """
    try:
        import pandas
    except ImportError as error:
        raise ImportError(not_installed("pandas", "pandas")) from error
    return pandas.DataFrame(dict(columns), index=None if index is None else pandas.Index(index, name=name))


def joint_columns(channels: Mapping[str, Array | None], joints: Sequence[str]) -> dict[str, Array]:
    """Arrays (N, n) as columns such as "q shoulder", one for each joint; those that are None are left out."""
    return {
        f"{channel} {joint}": values[:, j]
        for channel, values in channels.items()
        if values is not None
        for j, joint in enumerate(joints)
    }
