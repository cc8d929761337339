"""An exhibit: a bug that people had, as a function for the judge."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

EXHIBITS: list["Exhibit"] = []
"""All of them, in the order of the page."""

GITHUB = "https://github.com/"


@dataclass(frozen=True)
class Exhibit:
    """A bug of a library, and what is right to say about it.

    name: what the command calls it; hall: where it stands on the page
    library, year: of the report; threads: where it was reported or corrected, after https://github.com/
    story: what was wrong, in one sentence
    build: from the path of a URDF file to the faulty function
    judged_as: the argument of crosscheck.judge
    truth: expressions; each has to match a diagnosis
    robots: on which it is judged; options: further arguments of crosscheck.judge
    lines_unseen: the thread tells what was wrong, not in which lines: these are ours
    """

    name: str
    hall: str
    library: str
    year: int
    threads: tuple[str, ...]
    story: str
    build: Callable
    judged_as: str
    truth: tuple[str, ...]
    robots: tuple[str, ...] = ("arm",)
    options: Mapping[str, object] = field(default_factory=dict)
    lines_unseen: bool = False

    @property
    def links(self):
        return [GITHUB + thread for thread in self.threads]


def exhibit(
    library, year, *threads, truth, judged_as="inverse_dynamics", robots=("arm",), lines_unseen=False, **options
):
    """Puts a function into the museum: its name is that of the exhibit, its docstring the story."""

    def shown(build):
        expressions = (truth,) if isinstance(truth, str) else truth
        story = " ".join(build.__doc__.split())
        name, hall = build.__name__.replace("_", " "), build.__module__
        known = Exhibit(name, hall, library, year, threads, story, build, judged_as, expressions, robots, options)
        EXHIBITS.append(replace(known, lines_unseen=lines_unseen))
        return build

    return shown
