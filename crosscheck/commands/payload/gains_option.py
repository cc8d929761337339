"""Gains as they are typed: a file, one number, or one per joint."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from crosscheck.commands.program.recording_options import numbers
from graphdyn.errors import counted

if TYPE_CHECKING:
    from graphdyn.identification.currents import JointGains


def gains_of(option: str, text: str | None, error: float | None, joints: Sequence[str]) -> JointGains | None:
    """Gains of these joints. Raises typer.BadParameter for a text of another form; InvalidInput as load_gains.

    error: relative standard deviation of numbers
    """
    import numpy as np

    from crosscheck.identifying import STATED_ERROR, load_gains
    from graphdyn.identification.currents import JointGains

    if text is None:
        return None
    if text.endswith(".toml"):
        if error is not None:
            raise typer.BadParameter(f"{option} {text}: the file has deviations of its own; leave out {option}-error")
        return load_gains(Path(text), joints)
    values = numbers(option, text)
    if len(values) not in (1, len(joints)) or not all(value > 0 for value in values):
        raise typer.BadParameter(
            f"{option} {text}: give a .toml file, one number above zero, or one for each of "
            f"{counted(len(joints), 'joint')}: {', '.join(joints)}"
        )
    relative = STATED_ERROR if error is None else error
    if not 0 < relative < 1:
        raise typer.BadParameter(
            f"{option}-error {relative:g}: give a relative deviation between 0 and 1, such as 0.05"
        )
    return JointGains.stated(np.array(values) * np.ones(len(joints)), relative)
