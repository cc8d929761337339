"""A process that ends another one with us, however we end."""

from __future__ import annotations

import subprocess


class Watcher:
    """Kills a group of processes as soon as this program has ended, even if that was killed.

    group: number of the group
    """

    def __init__(self, group: int):
        end_of_input = f"read -r _; kill -9 -{group}"  # only we hold the other end open
        self._process = subprocess.Popen(
            ["/bin/sh", "-c", end_of_input],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def close(self) -> None:
        """Watch no longer."""
        self._process.kill()
        self._process.communicate()
