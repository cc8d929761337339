"""Faults of the text: what disks, editors and encodings do to it. Each function returns the new bytes."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from mutants.material import PIECES

Fault = Callable[[random.Random, bytes], bytes]

ENCODINGS = (
    "utf-16",
    "utf-16-le",
    "utf-16-be",
    "utf-32",
    "utf-8-sig",
    "latin-1",
    "cp1252",
    "cp037",
    "utf-7",
    "shift-jis",
)
DECLARED = ("UTF-8", "utf-16", "ISO-8859-1", "ascii", "windows-1252", "cp037", "nonsense", "")


def _place(rng: random.Random, content: bytes) -> int:
    return rng.randint(0, max(len(content) - 1, 0))


def truncate(rng: random.Random, content: bytes) -> bytes:
    return content[: rng.choice([_place(rng, content), len(content) - rng.randint(0, 20), 0])]


def drop_bytes(rng: random.Random, content: bytes) -> bytes:
    k = _place(rng, content)
    return content[:k] + content[k + rng.choice([1, 2, 10, 100]) :]


def repeat_bytes(rng: random.Random, content: bytes) -> bytes:
    k, n = _place(rng, content), rng.choice([1, 2, 10, 100, 1000])
    return content[: k + n] + content[k:]


def change_byte(rng: random.Random, content: bytes) -> bytes:
    k = _place(rng, content)
    return (
        content[:k]
        + bytes([rng.choice([rng.randrange(256), rng.choice(b"<>&\"'/= \n\t\r\0[]!?-.0")])])
        + content[k + 1 :]
    )


def insert_bytes(rng: random.Random, content: bytes) -> bytes:
    k = _place(rng, content)
    return (
        content[:k]
        + rng.choice([b"\0", b"\xff\xfe", b"\xe4", b"<", "ä".encode(), b"&amp;", b"&x;", b"]]>"])
        + content[k:]
    )


def insert_text(rng: random.Random, content: bytes) -> bytes:
    """Where an element may stand."""
    k = content.find(b"<", _place(rng, content))
    return content if k < 0 else content[:k] + rng.choice(PIECES).encode() + content[k:]


def delete_line(rng: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    del lines[rng.randrange(len(lines))]
    return b"\n".join(lines)


def duplicate_line(rng: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    k = rng.randrange(len(lines))
    return b"\n".join([*lines[: k + 1], *lines[k:]])


def comment_out(rng: random.Random, content: bytes) -> bytes:
    start = content.find(b"<", _place(rng, content))
    end = content.find(b">", start)
    return content if start < 0 else content[:start] + b"<!--" + content[start : end + 1] + b"-->" + content[end + 1 :]


def other_line_ends(rng: random.Random, content: bytes) -> bytes:
    return content.replace(b"\n", rng.choice([b"\r\n", b"\r", b"\n\n", b"\x0b", b" "]))


def other_quotes(rng: random.Random, content: bytes) -> bytes:
    return content.replace(b'"', rng.choice([b"'", "“".encode(), b"&quot;", b""]))


def character_references(rng: random.Random, content: bytes) -> bytes:
    """A character of an attribute written by number, which says the same."""
    values = list(re.finditer(rb'="([^"<>&]+)"', content))
    if not values:
        return content
    k = rng.choice(values).start(1)
    return content[:k] + rng.choice([b"&#%d;", b"&#x%x;", b"&#%08d;"]) % content[k] + content[k + 1 :]


def declared_entity(rng: random.Random, content: bytes) -> bytes:
    """A number or a name that an entity stands for."""
    body = content.split(b"?>", 1)[-1]
    values = list(re.finditer(rb'="([^"<>&]+)"', body))
    if values:
        value = rng.choice(values)
        body = body[: value.start(1)] + b"&v;" + body[value.end(1) :]
        return b'<!DOCTYPE robot [<!ENTITY v "' + value[1] + b'">]>' + body
    return b"<!DOCTYPE robot>" + body


def other_encoding(rng: random.Random, content: bytes) -> bytes:
    """Encoded so, said so, or both."""
    text = content.decode(errors="replace").replace("tool", "töol")
    encoding = rng.choice(ENCODINGS)
    body = text.split("?>", 1)[-1] if text.startswith("<?xml") else text
    declaration = rng.choice(["", f'<?xml version="1.0" encoding="{rng.choice([encoding, *DECLARED])}"?>'])
    return (declaration + body).encode(encoding, errors="replace")


def other_declaration(rng: random.Random, content: bytes) -> bytes:
    body = content.split(b"?>", 1)[-1] if content.startswith(b"<?xml") else content
    versions = ("1.0", "1.1", "0.0", "2.0", "")
    declaration = f'<?xml version="{rng.choice(versions)}" encoding="{rng.choice(DECLARED)}"?>'
    return rng.choice([declaration, declaration + "\n", "<?xml?>", '<?xml standalone="no"?>']).encode() + body


def around_the_document(rng: random.Random, content: bytes) -> bytes:
    more = rng.choice(
        [b"\n", b" ", b"text", b"# a comment\n", b"<!-- c -->", b"<robot/>", b"\xef\xbb\xbf", b"\0", b"<?x y?>"]
    )
    return rng.choice([more + content, content + more])


def default_namespace(rng: random.Random, content: bytes) -> bytes:
    more = rng.choice(
        [b'xmlns="http://www.ros.org"', b'xmlns:n="urn:x"', b'version="1.0"', b'version="1.2"', b'xmlns=""']
    )
    return content.replace(b"<robot ", b"<robot " + more + b" ", 1)


def prefixed_names(rng: random.Random, content: bytes) -> bytes:
    """Elements of one kind in a namespace of their own, or in that of the root by a prefix."""
    tag = rng.choice([b"link", b"joint", b"inertial", b"mass", b"origin", b"axis", b"robot"])
    root = rng.choice([b'<robot xmlns:n="urn:x" ', b'<robot xmlns="urn:x" xmlns:n="urn:x" ', b"<robot "])
    content = re.sub(rb"(</?)" + tag + rb"\b", rb"\1n:" + tag, content)
    return re.sub(rb"<(n:)?robot ", lambda found: root.replace(b"<", b"<" + (found[1] or b"")), content, count=1)


def encoded_otherwise(rng: random.Random, content: bytes) -> bytes:
    return content.decode(errors="replace").encode(rng.choice(ENCODINGS), errors="replace")


def zeros(rng: random.Random, content: bytes) -> bytes:
    """A block that was never written, or the whole file."""
    k, n = _place(rng, content), rng.choice([1, 16, 512])
    return rng.choice([content[:k] + bytes(n) + content[k + n :], bytes(len(content)), b""])


def change_bits(rng: random.Random, content: bytes) -> bytes:
    """As often as a worn disk does."""
    changed = bytearray(content)
    for _ in range(rng.choice([1, 1, 2, 8])):
        if changed:
            changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def exchange_blocks(rng: random.Random, content: bytes) -> bytes:
    first, second = sorted((_place(rng, content), _place(rng, content)))
    return content[second:] + content[first:second] + content[:first]


def names(*functions: Fault) -> dict[str, Fault]:
    """The functions by the words of their names."""
    return {function.__name__.replace("_", " "): function for function in functions}


ANYWHERE = names(
    truncate, drop_bytes, repeat_bytes, change_byte, insert_bytes, zeros, change_bits, exchange_blocks
)  # fmt: skip
"""What happens to the bytes of any file."""

ON_LINES = names(delete_line, duplicate_line, other_line_ends, encoded_otherwise, around_the_document)
"""What happens to texts."""

ON_BYTES = names(
    truncate, drop_bytes, repeat_bytes, change_byte, insert_bytes, insert_text, delete_line, duplicate_line,
    comment_out, other_line_ends, other_quotes, character_references, declared_entity, other_encoding,
    other_declaration, around_the_document, default_namespace, prefixed_names,
)  # fmt: skip
"""What happens to documents in XML."""
