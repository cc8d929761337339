"""The expander of .xacro files in a process that a warm one forks, which imports what takes a tenth of a second once.

Everything else is as in urdf.document.xacro: the same script with the same barriers, a process for each file.
"""

from __future__ import annotations

import atexit
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from urdf.document.xacro.files import SCRIPT

_SERVER = f"""
import importlib, json, os, runpy, sys
for name in ("xacro", "xacro.substitution_args", "yaml", "xml.dom.expatbuilder", "encodings.latin_1", "encodings.idna"):
    importlib.import_module(name)
main = runpy.run_path({str(SCRIPT)!r}, run_name="expander")["main"]
for folder in sys.stdin:
    child = os.fork()
    if not child:
        os.chdir(folder.strip())
        for number, (name, flags) in enumerate((("in", os.O_RDONLY), ("out", os.O_WRONLY), ("err", os.O_WRONLY))):
            os.dup2(os.open(name, flags), number)
        try:
            main()
            sys.stdout.flush()
            sys.__stdout__.flush()
        finally:
            sys.stderr.flush()
            os._exit(1 if sys.exc_info()[0] else 0)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


@cache
def _server() -> subprocess.Popen[bytes]:
    """One of this process, which ends with it."""
    command = [sys.executable, "-I", "-X", "utf8", "-c", _SERVER]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={})
    atexit.register(server.communicate)
    return server


def run(command: list[str], *, input: bytes, **_: Any) -> subprocess.CompletedProcess[bytes]:
    """What subprocess.run answers of the expander. Its processor time is limited by itself."""
    server = _server()
    assert server.stdin
    assert server.stdout
    with tempfile.TemporaryDirectory() as folder:
        for name, content in (("in", input), ("out", b""), ("err", b"")):
            Path(folder, name).write_bytes(content)
        server.stdin.write(f"{folder}\n".encode())
        server.stdin.flush()
        code = int(server.stdout.readline())
        out, err = (Path(folder, name).read_bytes() for name in ("out", "err"))
    return subprocess.CompletedProcess(command, code, out, err)
