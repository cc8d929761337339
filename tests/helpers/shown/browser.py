"""Headless Chromium, where the machine has one."""

import re
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


WIDTHS = (1280, 400)

PROBE = """<!DOCTYPE html><html><body>
{frames}
<script>
onload = () => {{
  const measured = [...document.querySelectorAll("iframe")].map(frame =>
    frame.contentDocument.documentElement.scrollWidth + "/" + frame.contentWindow.innerWidth);
  document.body.dataset.measured = measured.join(" ");
}};
</script></body></html>
"""


def too_wide(pages, folder):
    """Which of these pages, by file name, are wider than a window of WIDTHS: name, width of the page and of the window.

    Fails if a script of a page complains.
    """
    shown, frames = [], ""
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")
        for width in WIDTHS:
            shown.append((name, width))
            frames += f'<iframe src="{name}" style="border:0;width:{width}px;height:800px"></iframe>\n'
    (folder / "probe.html").write_text(PROBE.format(frames=frames), encoding="utf-8")
    (measured,) = re.findall(r'data-measured="([^"]*)"', document((folder / "probe.html").as_uri(), folder / "profile"))
    widths = [tuple(map(int, pair.split("/"))) for pair in measured.split()]
    assert [window for _, window in widths] == [window for _, window in shown]
    return [
        (name, content, window) for (name, _), (content, window) in zip(shown, widths, strict=True) if content > window
    ]
