"""The YAML file beside a URDF that says which frames coincide, as the package example-parallel-robots has it.

closed_loop: pairs of names of links or joints; type: of each pair, "6d" (both frames coincide: a weld) or "3d" (their
origins coincide: a ball); name_mot: the joints that have motors. A hinge is written as a "6d" pair that ends at a link
on a joint of its own: the joint is the hinge. (Gepetto/example-parallel-robots, loader_tools.py, completeRobotLoader)
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import yaml

from graphdyn.model import ChordKind
from urdf.document.connections.loops import CompanionFiles, Loop, Motor, SourceLocation, Unread
from urdf.document.xacro.yaml_limits import OddYaml, refuse_growing_yaml
from urdf.errors import InvalidLoop, URDFError, shortened

YAML_CHORD_KINDS: dict[str, ChordKind] = {"6d": "weld", "6D": "weld", "3d": "ball", "3D": "ball"}

YAML_KEYS = ("closed_loop", "type", "name_mot", "joint_name", "joint_type")

MAX_YAML_BYTES = 100_000
"""Largest size of such a file [bytes]; the largest published one has 1200."""

_IS_ONE = re.compile(rb"^closed_loop[ \t]*:", re.MULTILINE)


def beside(path: Path) -> CompanionFiles:
    """What the file of the same name that ends with .yaml states: nothing where there is none about loops."""
    file = path.with_suffix(".yaml") if path.suffix else path
    stated = file != path and file.is_file() and _IS_ONE.search(_content(file))
    return read_yaml(file) if stated else CompanionFiles()


def _content(path: Path) -> bytes:
    with path.open("rb") as opened:
        return opened.read(MAX_YAML_BYTES + 1)


def read_yaml(path: Path) -> CompanionFiles:
    """Raises InvalidLoop, with its line, for anything but what the format has; OSError."""
    content = _content(path)
    if len(content) > MAX_YAML_BYTES:
        raise InvalidLoop(
            f"the file is larger than {MAX_YAML_BYTES} bytes", "give the YAML file of the loops", path=path
        )
    try:
        refuse_growing_yaml(content)
        document = yaml.compose(content, Loader=yaml.SafeLoader)
    except OddYaml as error:
        raise InvalidLoop(str(error), "correct the file", path=path, line=error.line) from error
    except yaml.YAMLError as error:
        said = " ".join(str(error).split())
        raise InvalidLoop(f"not well-formed YAML: {said}", "correct the file", path=path) from error
    return _File(path).read(document)


class _File:
    def __init__(self, path: Path) -> None:
        self.path = path

    def place(self, node: yaml.Node, element: str | None = None) -> SourceLocation:
        return SourceLocation(self.path, node.start_mark.line + 1, element)

    def fault(self, node: yaml.Node, element: str, problem: str, remedy: str) -> URDFError:
        return self.place(node, element).error(InvalidLoop, problem, remedy)

    def read(self, document: yaml.Node | None) -> CompanionFiles:
        if not isinstance(document, yaml.MappingNode):
            raise InvalidLoop("no mapping of names to values", "state closed_loop, type and name_mot", path=self.path)
        nodes, unread = {}, []
        for key, value in document.value:
            if not isinstance(key, yaml.ScalarNode):
                raise self.fault(key, "key", "not a name", "give names as keys")
            name = shortened(key.value)
            if name in nodes:
                raise self.fault(key, name, "stated twice", "keep the one that is meant")
            nodes[name] = value
            if name not in YAML_KEYS:
                unread.append(Unread(f"{self.path.name}:{key.start_mark.line + 1}: key '{name}'"))
        for element in ("closed_loop", "type"):
            if element not in nodes:
                raise InvalidLoop(f"'{element}' is missing", "state the pairs and their types", path=self.path)
        for node, name in self.texts(nodes.get("joint_name"), "joint_name"):
            raise self.fault(
                node, "joint_name", f"joint '{name}' is to be replaced by one of another type",
                "write it into the URDF: for SPHERICAL three revolute joints, for a UJOINT two, for FIXED a fixed one",
            )  # fmt: skip
        motors = [
            Motor(name, self.place(node, "name_mot")) for node, name in self.texts(nodes.get("name_mot"), "name_mot")
        ]
        return CompanionFiles(tuple(self.loops(nodes["closed_loop"], nodes["type"])), tuple(motors), tuple(unread))

    def loops(self, pairs: yaml.Node, types: yaml.Node) -> Iterator[tuple[Loop, SourceLocation]]:
        kinds = list(self.texts(types, "type"))
        items = self.items(pairs, "closed_loop")
        if len(kinds) != len(items):
            raise self.fault(types, "type", f"{len(kinds)} types for {len(items)} pairs", "state one for each pair")
        for pair, (node, kind) in zip(items, kinds, strict=True):
            names = [name for _, name in self.texts(pair, "closed_loop")]
            if len(names) != 2:
                raise self.fault(pair, "closed_loop", f"{len(names)} names, expected 2", "name two links or joints")
            if kind not in YAML_CHORD_KINDS:
                raise self.fault(node, "type", f"type '{kind}' is unknown", "use 6d or 3d")
            yield Loop("-".join(names), YAML_CHORD_KINDS[kind], names[0], names[1]), self.place(pair, "closed_loop")

    def items(self, node: yaml.Node, element: str) -> list[yaml.Node]:
        if not isinstance(node, yaml.SequenceNode):
            raise self.fault(node, element, "not a list", "give a list: [ … ]")
        return list(node.value)

    def texts(self, node: yaml.Node | None, element: str) -> Iterator[tuple[yaml.Node, str]]:
        for item in [] if node is None else self.items(node, element):
            if not isinstance(item, yaml.ScalarNode):
                raise self.fault(item, element, "not a name", "give names in quotes")
            yield item, item.value
