"""How busy the machine is: programs that wait for a core or have one."""

from __future__ import annotations

import os
from dataclasses import dataclass

MAX_LOAD = 0.5
"""Programs per core of the machine, over the last minute, beyond which a benchmark is disturbed."""


@dataclass(frozen=True)
class Load:
    """How busy the machine is, over the last minute.

    programs: mean number of programs that had a core or waited for one; None where the system has no figure
    cores: of the whole machine, of which this program may be allowed fewer
    """

    programs: float | None
    cores: int

    @property
    def busy(self) -> bool:
        return self.programs is not None and self.programs > MAX_LOAD * self.cores


def load() -> Load:
    try:
        programs = os.getloadavg()[0]
    except (AttributeError, OSError):  # Windows has none
        programs = None
    return Load(programs, os.cpu_count() or 1)
