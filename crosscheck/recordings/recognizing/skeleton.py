"""The mapping of a recognized log as the text of its TOML file, with reasons and open choices as comments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock, RecognizedClock, Untold

RULE = "# STILL TO BE SAID: "
"""Before what has to be written into the file before it can be used."""


def skeleton(
    joints: Sequence[str],
    clock: RecognizedClock | None,
    rate: float | None,
    blocks: Iterable[RecognizedBlock],
    several_files: bool,
    untold: Untold,
    choices: Sequence[OpenChoice],
    topic: str | None = None,
) -> str:
    """The text. blocks: those that are taken; topic: of a bag, if one was named"""
    taken = {block.quantity: block for block in blocks}
    lines = ["joints = [", *(f"    {_quoted(joint)}," for joint in joints), "]"]
    if topic is not None:
        lines.append(f"topic = {_quoted(topic)}")
    if clock is None and rate is not None:
        lines.append(f"rate = {rate:.12g}")
    open_of = {quantity: [c for c in choices if c.quantity == quantity] for quantity in ("time", "q", "v", "tau")}
    if clock is None:
        lines += _open(open_of["time"])
    else:
        lines += ["", "[time]", f"# {clock.why}"]
        lines += [f"file = {_quoted(clock.file)}"] if several_files else []
        lines.append(f"column = {_written(clock.columns[0])}")
        if len(clock.columns) > 1:
            lines.append(f"nanoseconds = {_written(clock.columns[1])}")
        else:
            lines.append(f"unit = {_quoted(clock.unit)}")
    for quantity in ("q", "v", "a", "tau", "temperature"):
        block, choices_here = taken.get(quantity), open_of.get(quantity, [])
        if block is not None:
            lines += ["", *_table(block, joints, several_files, untold), *_open(choices_here)]
        elif choices_here:
            lines += ["", f"# [{quantity}]", *_open(choices_here)]
    if untold.ratio and any(block.side == "motor" for block in taken.values()):
        lines += ["", "[transmission]", f"ratio = {_numbers(untold.ratio)}"]
    return "\n".join(lines) + "\n"


def _table(block: RecognizedBlock, joints: Sequence[str], several_files: bool, untold: Untold) -> Iterator[str]:
    yield f"[{block.quantity}]"
    yield f"# {block.why}"
    if several_files:
        yield f"file = {_quoted(block.file)}"
    yield f"columns = {_columns(block, joints)}"
    if block.unit and block.quantity != "temperature":
        yield f"unit = {_quoted(block.unit)}"
    if block.side == "motor":
        yield 'side = "motor"'
    if block.quantity == "tau" and untold.gain:
        yield f"gain = {_numbers(untold.gain)}"


def _columns(block: RecognizedBlock, joints: Sequence[str]) -> str:
    """A pattern where the names follow one, otherwise a list."""
    for place, texts in (("{joint}", joints), ("{number}", [str(k) for k in range(1, len(joints) + 1)])):
        if block.columns == tuple(block.label.replace("*", text) for text in texts):
            return _quoted(block.label.replace("*", place))
    return "[" + ", ".join(map(_written, block.columns)) + "]"


def _open(choices: Sequence[OpenChoice]) -> Iterator[str]:
    for choice in choices:
        yield f"{RULE}{choice.question}"
        yield from (f"# {line}" for line in choice.lines)


def _written(column: str | int) -> str:
    return str(column) if isinstance(column, int) else _quoted(column)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'


def _numbers(values: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:.12g}" for value in values) + "]"
