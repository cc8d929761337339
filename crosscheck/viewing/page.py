"""A scene and its player as one page, which plays without server and network.

Its content security policy allows the scripts and styles on it, by their hashes, and nothing else: a browser that
honors it lets the page load nothing. Served live, it may ask its own server.
"""

from __future__ import annotations

import hashlib
import json
from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from crosscheck.viewing.figures import Figure
from crosscheck.viewing.scene import NumberStore, compressed, scene

PLAYER = Path(__file__).parent / "player"
VENDOR = Path(__file__).parents[1] / "vendor"

SCRIPT_LIBRARIES = (VENDOR / "three.iife.min.js", VENDOR / "uPlot.iife.min.js")
SCRIPT_NAMES = (
    *("numbers", "libraries", "mechanics", "arrows", "figure", "stage", "curves"),
    *("panel", "link", "marks", "picture", "player"),
)
PLAYER_SCRIPTS = tuple(PLAYER / f"{name}.js" for name in SCRIPT_NAMES)
STYLE_SHEETS = (VENDOR / "uPlot.min.css", PLAYER / "player.css")


def page(title: str, figures: Sequence[Figure], *, live: bool = False, warnings: Sequence[str] = ()) -> str:
    """The page of these figures. The same figures give the same characters.

    live: whether a server of crosscheck.viewing.server shows it; warnings: shown above all else
    """
    store = NumberStore()
    shown = scene(title, figures, store) | {"live": live}
    scripts = [Markup(file_text(path)) for path in PLAYER_SCRIPTS]
    styles = [Markup(file_text(path)) for path in STYLE_SHEETS]
    return (
        _environment()
        .get_template("page.html")
        .render(
            title=title,
            live=live,
            warnings=warnings,
            scripts=scripts,
            styles=styles,
            libraries=_compressed_libraries(),
            script_hashes=script_hashes(),
            style_hashes=[policy_hash(style) for style in styles],
            scene=Markup(json.dumps(shown, separators=(",", ":")).replace("<", "\\u003c")),
            numbers=store.text(),
        )
    )


def script_hashes() -> list[str]:
    """Hashes of all scripts of the page, as a content security policy names them: a page around it must allow them
    too."""
    return [policy_hash(script) for script in (_libraries(), *map(file_text, PLAYER_SCRIPTS))]


def _libraries() -> str:
    return "".join(map(file_text, SCRIPT_LIBRARIES))


@cache
def _compressed_libraries() -> str:
    return compressed(_libraries().encode())


def policy_hash(text: str) -> str:
    """A script or style as a content security policy names it."""
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def file_text(path: Path) -> str:
    """The text of a file that the program brings along."""
    return path.read_text(encoding="utf-8")


@cache
def _environment() -> Environment:
    return Environment(loader=PackageLoader("crosscheck.viewing", "player"), autoescape=True, undefined=StrictUndefined)
