"""How tall and large pages are, and what axe-core and the console say of them at three widths, light and dark.

`measured_pages PAGE.html …`; a folder stands for its pages. Per page: kB, its height in windows of WIDTHS [px], the
number of violations of axe-core, and that of complaints of the console and of requests. `--open` opens what is folded
before. The exit code is the number of pages with a violation, a complaint or a request. It needs Chromium, and axe-core
as axe-playwright-python has it (shown/axe.py).
"""

import sys
import tempfile
from pathlib import Path

from shown.axe import AXE, violations
from shown.driven_browser import DrivenBrowser

WIDTHS = (390, 1280, 1920)

LOADED = "new Promise((done) => setTimeout(done, 200))"
PLAYING = "document.getElementById('scene') ? new Promise((done) => setTimeout(done, 2500)) : 0"
OPEN = "for (const one of document.querySelectorAll('details')) one.open = true"


def measured(browser, page, opened):
    """Heights [px], violations and complaints of a page."""
    heights, wrong, said = [], {}, []
    for width in WIDTHS:
        for dark in (False, True):
            browser.appear(width, dark=dark)
            browser.load(page.as_uri(), LOADED)
            browser.value(PLAYING)
            if opened:
                browser.value(OPEN)
            heights += [] if dark else [browser.value("document.documentElement.scrollHeight")]
            requests = [f"asks for {address}" for address in browser.requests if address != page.as_uri()]
            said += browser.complaints + [one for one in requests if "about:srcdoc" not in one]
            wrong |= dict.fromkeys(violations(browser) if AXE else [])
    return heights, list(wrong), said


def main():
    opened, given = "--open" in sys.argv, [Path(name) for name in sys.argv[1:] if name != "--open"]
    pages = [page for path in given for page in (sorted(path.glob("*.html")) if path.is_dir() else [path])]
    print(f"{'':24}{'kB':>6}  {'  '.join(f'{width:>6} px' for width in WIDTHS)}  violations  complaints")
    bad = 0
    with tempfile.TemporaryDirectory() as folder, DrivenBrowser(Path(folder)) as browser:
        for page in pages:
            heights, wrong, said = measured(browser, page.resolve(), opened)
            sizes = "  ".join(f"{height:9}" for height in heights)
            found = f"{len(wrong) if AXE else '–':>10}"
            print(f"{page.stem:24}{page.stat().st_size / 1000:6.0f}  {sizes}  {found}  {len(said):10}", flush=True)
            print(*(f"    {one}" for one in (*wrong, *said)), sep="\n", end="\n" if wrong or said else "")
            bad += bool(wrong or said)
    return bad
