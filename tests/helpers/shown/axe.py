"""axe-core, where the machine has it: what makes a page hard to use without eyes, mouse or color."""

from importlib.util import find_spec
from pathlib import Path


def _script():
    """The file of axe-core that axe-playwright-python carries (pip install --no-deps axe-playwright-python)."""
    found = find_spec("axe_playwright_python")
    return Path(found.origin).with_name("axe.min.js") if found and found.origin else None


AXE = _script()

RUN = """(async () => {
  for (const inner of document.querySelectorAll("iframe")) inner.remove();
  const { violations } = await axe.run(document, { resultTypes: ["violations"] });
  return violations.flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target} ${node.html.slice(0, 120)}`));
})()"""


def violations(browser):
    """What axe-core finds wrong in the page that a browser shows: rule and element; frames are pages of their own."""
    browser.call("Page.setBypassCSP", enabled=True)
    browser.value(AXE.read_text(encoding="utf-8") + "; 1")
    return browser.value(RUN)
