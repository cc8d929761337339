"""Files and lines in which the elements of an expansion are written: part of the process that expands.

xacro forgets lines. Here every element keeps its file and the line where its tag begins, also when xacro copies it.
Where all its numbers come from one other place, such as the call of a macro or a property, that place is the
element's: there it is changed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from typing import Any

Place = tuple[str, int]
"""File, and line from 1."""

KEY = "place"
"""Name of the data that an element keeps."""

REFERENCES = ("name", "link", "joint", "type", "filename")
"""Attributes that are no numbers: prefixes come to them through every macro."""

EXPRESSION = re.compile(r"\$\{([^}]*)\}|\$\([^)]*\)")
VARIABLE = re.compile(r"[A-Za-z_]\w*")
NONZERO = re.compile(r"[1-9]|[A-Za-z]")


class Places:
    """The places of all elements that xacro reads from now on."""

    def __init__(self, xacro: Any, builder: Any):
        """xacro: the module; builder: the class with which it reads XML"""
        self.xacro = xacro
        self.setting: list[Callable[[str], set[Place]]] = []  # where the values come from that are being set
        self._note_lines(builder)
        self._follow_values()

    def handle(self, _operation: int, key: str, place: Place, _source: Any, copy: Any) -> None:
        """Called by a document when it copies an element."""
        if copy is not None:
            copy.setUserData(key, place, self)

    def of(self, document: Any) -> list[Place | None]:
        """Per element of an expanded document, in its order."""
        return [element.getUserData(KEY) for element in document.getElementsByTagName("*")]

    def _note_lines(self, builder: Any) -> None:
        start, xacro = builder.start_element_handler, self.xacro

        def start_element(reader: Any, name: str, attributes: Any) -> None:
            start(reader, name, attributes)
            place = os.path.normpath(xacro.filestack[-1]), reader.getParser().CurrentLineNumber
            reader.curNode.setUserData(KEY, place, self)

        builder.start_element_handler = start_element

    def _follow_values(self) -> None:
        xacro = self.xacro
        evaluate, grab, call, put = (
            xacro.eval_all, xacro.grab_property, xacro.handle_macro_call, xacro.Table._setitem
        )  # fmt: skip

        def eval_all(node: Any, macros: Any, symbols: Any) -> None:
            texts = [text for name, text in node.attributes.items() if name not in REFERENCES]
            if any("$" in text for text in texts):
                found = {place for text in texts for place in self._sources(text, symbols, node)}
                if len(found) == 1:
                    node.setUserData(KEY, found.pop(), self)
            evaluate(node, macros, symbols)

        def grab_property(node: Any, symbols: Any) -> None:
            text = node.getAttribute("value") or node.getAttribute("default")
            found = self._sources(text, symbols, node) or {node.getUserData(KEY)}
            self._setting(lambda _: found, grab, node, symbols)

        def handle_macro_call(node: Any, macros: Any, symbols: Any) -> Any:
            def argument(name: str) -> set[Place]:
                if node.hasAttribute(name):
                    return self._sources(node.getAttribute(name), symbols, node) or {node.getUserData(KEY)}
                return _places(symbols, name) or {xacro.macrostack[-1].body.getUserData(KEY)}  # a default

            return self._setting(argument, call, node, macros, symbols)

        def setitem(table: Any, name: str, value: Any, unevaluated: bool) -> None:
            put(table, name, value, unevaluated)
            if self.setting:
                table.__dict__.setdefault("places", {})[name] = self.setting[-1](name)

        xacro.eval_all, xacro.grab_property, xacro.handle_macro_call = eval_all, grab_property, handle_macro_call
        xacro.Table._setitem = setitem

    def _setting(self, sources: Callable[[str], set[Place]], function: Any, *arguments: Any) -> Any:
        self.setting.append(sources)
        try:
            return function(*arguments)
        finally:
            self.setting.pop()

    def _sources(self, text: str, symbols: Any, node: Any) -> set[Place]:
        """The places that its numbers come from: none for zeros, its own for what stands there."""
        names = [name for expression in EXPRESSION.findall(text) for name in VARIABLE.findall(expression)]
        found = {place for name in names for place in _places(symbols, name)}
        if NONZERO.search(EXPRESSION.sub("", text)) or ("$" in text and not found):
            found.add(node.getUserData(KEY))
        return found


def _places(symbols: Any, name: str) -> set[Place]:
    """The places of a value by its name, in the nearest of the tables that has it."""
    for table in _tables(symbols):
        if dict.__contains__(table, name):
            found: set[Place] = table.__dict__.get("places", {}).get(name, set())
            return found
    return set()


def _tables(symbols: Any) -> Iterator[Any]:
    while hasattr(symbols, "__dict__"):
        yield symbols
        symbols = symbols.__dict__.get("parent")
