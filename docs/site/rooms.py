"""The rooms of the packages and the imports between them, read from the code: what docs/architecture.md shows."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping
from functools import cache
from html import escape
from itertools import pairwise
from pathlib import Path

PACKAGES = ("crosscheck", "urdf", "graphdyn")
"""From the one that knows the others to the one that knows none."""
ROOT = Path(__file__).parents[2]
Uses = dict[str, set[str]]
"""For each room the rooms that it imports."""

WIDTH, HEIGHT, ROW = 92, 28, 58
"""Size of the box of a room, and distance of two rows [px]."""
GAP, NARROW, MARGIN, TITLE, SPACE = 12, 14, 16, 40, 28
"""Between neighbors of a row, width of a passing arrow, around a package, height of its name, between packages [px]."""
WITH_STATEMENTS = (ast.stmt, ast.excepthandler, ast.match_case)
"""Parts of a syntax tree that can be imports or contain them."""
SWEEPS = 12
"""Over the rows, to find an order with few crossings."""


@cache
def rooms(package: str) -> dict[str, Path]:
    """The folders and files directly in a package or room, by name, with the file that has their docstring."""
    found = {}
    for path in sorted((ROOT / package.replace(".", "/")).glob("*")):
        inside = path / "__init__.py" if path.is_dir() else path
        if inside.suffix == ".py" and inside.exists() and not path.stem.startswith("__"):
            found[path.stem] = inside
    return found


@cache
def parsed(path: Path) -> ast.Module:
    """A file as its syntax tree."""
    return ast.parse(path.read_text(encoding="utf-8"))


def summary(path: Path) -> str:
    """First sentence of the docstring of a module."""
    text = ast.get_docstring(parsed(path)) or ""
    return " ".join(text.split("\n\n")[0].split())


def imported(path: Path) -> Iterable[str]:
    """Full names of the modules, or of the names in them, that a file imports."""
    waiting: list[ast.AST] = [parsed(path)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from (f"{node.module}.{name.name}" for name in node.names)
        else:
            waiting += (inner for inner in ast.iter_child_nodes(node) if isinstance(inner, WITH_STATEMENTS))


@cache
def uses(package: str) -> Uses:
    """The imports between the rooms of a package."""
    names = rooms(package)
    found: Uses = {name: set() for name in names}
    for name, path in names.items():
        for file in path.parent.rglob("*.py") if path.name == "__init__.py" else [path]:
            inside = (full.removeprefix(f"{package}.") for full in imported(file) if full.startswith(f"{package}."))
            found[name] |= names.keys() & {full.partition(".")[0] for full in inside}
        found[name].discard(name)
    return found


def reach(direct: Mapping[str, set[str]], room: str) -> set[str]:
    """The rooms that a room uses, directly or through others."""
    found, waiting = set(), list(direct[room])
    while waiting:
        if (name := waiting.pop()) not in found:
            found.add(name)
            waiting += direct[name]
    return found


def reduced(direct: Mapping[str, set[str]]) -> Uses:
    """Without the imports that follow from others: the fewest arrows that show who may know whom."""
    return {
        room: {name for name in names if not any(name in reach(direct, other) for other in names - {name})}
        for room, names in direct.items()
    }


def floors(direct: Mapping[str, set[str]]) -> dict[str, int]:
    """Length of the longest chain of imports below each room."""
    found: dict[str, int] = {}

    def floor(room: str) -> int:
        if room not in found:
            found[room] = 1 + max((floor(name) for name in direct[room]), default=-1)
        return found[room]

    for room in direct:
        floor(room)
    return found


def rows(direct: Mapping[str, set[str]]) -> tuple[list[list[str]], list[list[str]]]:
    """Rooms by floor, the lowest first, and the arrows, each as the chain of places that it passes.

    An arrow over several floors gets a place of its own in each row between, so that it passes beside the boxes.
    """
    floor = floors(direct)
    found: list[list[str]] = [[] for _ in range(max(floor.values()) + 1)]
    for room in sorted(direct):
        found[floor[room]].append(room)
    arrows = []
    for room, names in direct.items():
        for name in sorted(names):
            between = range(floor[room] - 1, floor[name], -1)
            places = [f"{room}>{name}@{k}" for k in between]
            for k, place in zip(between, places, strict=True):
                found[k].append(place)
            arrows.append([room, *places, name])
    return _uncrossed(found, arrows), arrows


def _uncrossed(found: list[list[str]], arrows: list[list[str]]) -> list[list[str]]:
    """Each row in the order of the mean position of what its places are joined to, swept up and down."""
    neighbors: dict[str, list[str]] = {}
    for arrow in arrows:
        for a, b in pairwise(arrow):
            neighbors.setdefault(a, []).append(b)
            neighbors.setdefault(b, []).append(a)
    for _ in range(SWEEPS):
        for row in [*found, *reversed(found)]:
            x = {place: center for other in found for place, center in zip(other, _centers(other), strict=True)}
            means = {p: sum(x[n] for n in near) / len(near) if (near := neighbors.get(p)) else x[p] for p in row}
            row.sort(key=means.__getitem__)
    return found


def _centers(row: list[str]) -> list[float]:
    """Positions of the places of a row, about zero [px]."""
    widths = [(NARROW if "@" in place else WIDTH) + GAP for place in row]
    ends = [sum(widths[:k]) for k in range(len(widths) + 1)]
    return [(a + b) / 2 - ends[-1] / 2 for a, b in pairwise(ends)]


def drawn(package: str, left: float, top: float) -> tuple[str, float, float]:
    """SVG of a package whose upper left corner is given, its right border and its lower one."""
    found, arrows = rows(reduced(uses(package)))
    files = rooms(package)
    half = max(-_centers(row)[0] + (NARROW if "@" in row[0] else WIDTH) / 2 for row in found)
    width, height = 2 * (half + MARGIN), TITLE + ROW * (len(found) - 1) + HEIGHT + MARGIN
    place = {}
    for k, row in enumerate(reversed(found)):
        for name, x in zip(row, _centers(row), strict=True):
            place[name] = left + half + MARGIN + x, top + TITLE + k * ROW + HEIGHT / 2
    parts = [
        f'<rect class="package" x="{left:.0f}" y="{top:.0f}" width="{width:.0f}" height="{height:.0f}" rx="8"/>',
        f'<text class="name" x="{left + MARGIN:.0f}" y="{top + 25:.0f}">{package}</text>',
        *(f'<path class="arrow" marker-end="url(#tip)" d="{_curve([place[p] for p in arrow])}"/>' for arrow in arrows),
    ]
    for name, path in files.items():
        x, y = place[name]
        box = f'<rect x="{x - WIDTH / 2:.1f}" y="{y - HEIGHT / 2:.1f}" width="{WIDTH}" height="{HEIGHT}" rx="4"/>'
        parts.append(f"<g><title>{escape(summary(path))}</title>{box}")
        parts.append(f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle">{name}</text></g>')
    return "\n".join(parts), left + width, top + height


def _curve(points: list[tuple[float, float]]) -> str:
    """A path from below the first box, through the places of the rows between, to above the last box."""
    stops = [(points[0][0], points[0][1] + HEIGHT / 2)]
    for x, y in points[1:-1]:
        stops += [(x, y - HEIGHT / 2), (x, y + HEIGHT / 2)]
    stops.append((points[-1][0], points[-1][1] - HEIGHT / 2 - 5))
    path = f"M {stops[0][0]:.1f} {stops[0][1]:.1f}"
    for (x0, y0), (x1, y1) in pairwise(stops):
        middle = (y0 + y1) / 2
        path += f" C {x0:.1f} {middle:.1f} {x1:.1f} {middle:.1f} {x1:.1f} {y1:.1f}"
    return path


def picture() -> str:
    """The packages, each with its rooms and the arrows from a room to those that it uses."""
    using, right, bottom = drawn("crosscheck", 4, 4)
    between, edge, end = drawn("urdf", 4, bottom + SPACE)
    used, width, depth = drawn("graphdyn", right + SPACE, 4)
    down = f"M {MARGIN + 24} {bottom:.0f} v {SPACE - 5}"
    across = [f"M {x:.0f} {y:.0f} H {right + SPACE - 5:.0f}" for x, y in ((right, 25), (edge, bottom + SPACE + 25))]
    size = f'viewBox="0 0 {width + 4:.0f} {max(end, depth) + 4:.0f}"'
    tip = '<marker id="tip" viewBox="0 0 6 6" refX="1" refY="3" markerWidth="6" markerHeight="6" orient="auto">'
    title = "Rooms of the three packages; an arrow leads from a room to one that it imports"
    return "\n".join(
        [
            f'<svg class="rooms" xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{title}">',
            f'<defs>{tip}<path d="M 0 0 L 6 3 L 0 6 z"/></marker></defs>',
            *(f'<path class="arrow" marker-end="url(#tip)" d="{path}"/>' for path in (down, *across)),
            *(using, between, used),
            "</svg>\n",
        ]
    )


def ordered(package: str) -> list[str]:
    """The rooms of a package, those that use others before these."""
    floor = floors(uses(package))
    return sorted(floor, key=lambda room: (-floor[room], room))


def table(package: str) -> str:
    """The rooms of a package in Markdown, each with the start of its docstring."""
    files = rooms(package)
    lines = ["| room | what it is for |", "|---|---|"]
    for name in ordered(package):
        what = re.sub(r"(?<![\\])\|", r"\\|", summary(files[name]))
        lines.append(f"| `{name}` | {what} |")
    return "\n".join([*lines, ""])


def write(folder: Path) -> None:
    """The picture and the tables, for the page to include."""
    folder.mkdir(exist_ok=True)
    (folder / "picture.svg").write_text(picture(), encoding="utf-8")
    for package in PACKAGES:
        (folder / f"{package}.md").write_text(table(package), encoding="utf-8")
