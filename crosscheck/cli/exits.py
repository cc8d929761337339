"""Exit codes of the program, and which error leads to which."""

from __future__ import annotations

import os
import sys
from typing import Any

import typer
from typer.core import TyperGroup

from crosscheck.cli.console import complain, err, trace
from graphdyn import GraphDynError

AGREED, DISAGREED, BAD_INPUT, INTERNAL_ERROR = 0, 1, 2, 3
"""Exit codes: agreed or done; a disagreement; bad input or a file that cannot be read or written; an internal error."""

BROKEN_PIPE = 141
"""Exit code where the reader of a pipe has closed it, as shells report it: 128 + SIGPIPE."""


class CommandGroup(TyperGroup):
    """The commands; every error ends here, as one line and an exit code. Ctrl-C is typer's: quiet, 130."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python warns at its exit
            raise typer.Exit(BROKEN_PIPE) from None
        except (GraphDynError, OSError) as error:
            complain(error, ctx)
            raise typer.Exit(BAD_INPUT) from None
        except Exception as error:
            if hasattr(error, "exit_code"):  # typer's own: a usage error, or the end of a command
                raise
            trace(error, ctx)
            message = " ".join(f"{type(error).__name__}: {error}".split())
            err.print(f"internal error: {message}; run with --debug and report it", style="red", soft_wrap=True)
            raise typer.Exit(INTERNAL_ERROR) from None
