"""Headless Chromium, where the machine has one."""

import shutil
import subprocess

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-quic", "--allow-file-access-from-files",
    "--enable-logging=stderr", "--v=0", "--window-size=1400,900", "--virtual-time-budget=5000", "--dump-dom",
)  # fmt: skip


def document(address, profile):
    """The page at an address as it stands after its scripts have run. Fails if one of them complains."""
    shown = subprocess.run(
        [CHROMIUM, *OPTIONS, f"--user-data-dir={profile}", address],
        capture_output=True, text=True, timeout=300, check=True, encoding="utf-8",
    )  # fmt: skip
    assert [line for line in shown.stderr.splitlines() if "CONSOLE" in line] == []
    return shown.stdout
