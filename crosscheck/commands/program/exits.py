"""Exit codes of the program, and which error leads to which.

SIGTERM and SIGHUP unwind the program as Ctrl-C does: the processes it started end, and files stay whole.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from crosscheck.commands.program.console import complain, out, say, trace, warn, warned
from crosscheck.commands.program.functions import place_in_user_code
from crosscheck.commands.program.judged_functions import FUNCTION_LIST, function_list
from crosscheck.commands.program.options import OPTIONAL_NUMBER
from crosscheck.commands.program.output_files import OutputFile, refuse_harm
from crosscheck.report.plain_text import bounded, printable
from graphdyn import GraphDynError

AGREED, DISAGREED, BAD_INPUT, INTERNAL_ERROR, PENDING = 0, 1, 2, 3, 4
"""Exit codes: agreed or done; a disagreement; bad input or a file that cannot be read or written; an internal error; a
disagreement whose cause needs answers to further questions."""

BROKEN_PIPE = 141
"""Exit code where the reader of a pipe has closed it, as shells report it: 128 + SIGPIPE."""


class Command(TyperCommand):
    """A command; files that it would destroy are refused before it begins, and - leaves standard output to a file."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """The options in groups: those of the command alone first, then what it shares with others."""
        write_options(self, ctx, formatter)

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        """The examples, and where the command takes functions, a list of these."""
        if self.epilog and FUNCTION_LIST in self.epilog:
            self.epilog = self.epilog.replace(FUNCTION_LIST, function_list())
        super().format_epilog(ctx, formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """The parameters, whose numbers are those of all other texts that are read: Python takes 1_0 and nan too."""
        typed = list(_with_empty_numbers(self.params, args))
        rest = super().parse_args(ctx, list(typed))
        texts, *_ = self.make_parser(ctx).parse_args(args=typed)
        for parameter in self.params:
            _refuse_odd_numbers(ctx, parameter, texts.get(parameter.name))
        return rest

    def invoke(self, ctx: Any) -> Any:
        refuse_harm(ctx)
        out.quiet = any(isinstance(file, OutputFile) and file.is_standard_output for file in ctx.params.values())
        try:
            return super().invoke(ctx)
        finally:
            out.quiet = False


def write_options(command: Any, ctx: Any, formatter: Any) -> None:
    """The arguments and options under their headings, into a help."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.get_params(ctx):
        record = parameter.get_help_record(ctx)
        if record is not None:
            own = "Arguments" if parameter.param_type_name == "argument" else "Options"
            groups.setdefault(getattr(parameter, "rich_help_panel", None) or own, []).append(record)
    for heading, records in groups.items():
        with formatter.section(heading):
            formatter.write_dl(records)


def _with_empty_numbers(parameters: Sequence[Any], args: Sequence[str]) -> Iterator[str]:
    """The arguments; behind an option whose number may be left out, and is, an empty text."""
    from urdf.document import finite_number

    optional = {name for each in parameters if each.metavar == OPTIONAL_NUMBER for name in each.opts}
    for k, text in enumerate(args):
        yield text
        if text in optional and finite_number("".join(args[k + 1 : k + 2])) is None:
            yield ""


def _refuse_odd_numbers(ctx: Any, parameter: Any, given: Any) -> None:
    """Raises typer.BadParameter for texts (one, or several) that typer has read as numbers and nothing else would."""
    from urdf.document import finite_number

    texts, read = (
        [one] if isinstance(one, str | int | float) else one for one in (given, ctx.params.get(parameter.name))
    )
    if not isinstance(texts, list | tuple) or not isinstance(read, list | tuple):
        return
    for text, value in zip(texts, read, strict=False):
        if isinstance(value, int | float) and isinstance(text, str) and text and finite_number(text.strip()) is None:
            raise typer.BadParameter(f"{text} is not a finite number such as 10 or -1.5e-3", ctx, parameter)


class CommandGroup(TyperGroup):
    """The commands; every error ends here, as one line and an exit code. Ctrl-C is typer's: quiet, 130."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """The commands under their headings, then the options."""
        self.format_commands(ctx, formatter)
        write_options(self, ctx, formatter)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        width = formatter.width - 6 - max(map(len, self.commands))
        groups: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            command: Any = self.commands[name]
            groups.setdefault(command.rich_help_panel, []).append((name, command.get_short_help_str(width)))
        for heading, rows in groups.items():
            with formatter.section(heading):
                formatter.write_dl(rows, col_max=len(max(self.commands, key=len)) + 2)

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        try:
            return super().make_context(*arguments, **options)
        except Exception as error:
            raise _printable(error) from None

    def invoke(self, ctx: Any) -> Any:
        warned.clear()
        try:
            with warnings.catch_warnings():
                warnings.showwarning = warn  # type: ignore[assignment]
                return super().invoke(ctx)
        except KeyboardInterrupt:
            raise
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), out.file.fileno())  # or Python warns at its exit
            raise typer.Exit(BROKEN_PIPE) from None
        except (GraphDynError, OSError) as error:
            complain(error, ctx)
            raise typer.Exit(BAD_INPUT) from None
        except BaseException as error:
            if hasattr(error, "exit_code"):  # typer's own: a usage error, or the end of a command
                raise _printable(error) from None
            trace(error, ctx)
            message = " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(":")
            place = place_in_user_code(error)
            if place or isinstance(error, SystemExit):
                say(f"error: {place or 'the code of another'} raised {message}", "red")
                raise typer.Exit(BAD_INPUT) from None
            say(f"internal error: {message}; run with --debug and report it", "red")
            raise typer.Exit(INTERNAL_ERROR) from None


REFUSED = "Invalid value: "
"""How typer begins a refusal of the program's own."""


def _printable(error: Any) -> Any:
    """The error, where it is typer's with a message: that may repeat what was typed. It is told as all others are."""
    if hasattr(error, "message"):
        error.message = printable(bounded(error.message), keep="\n")
    if hasattr(error, "format_message"):
        error.show = lambda file=None: say(f"error: {_usage_error(error)}", "red")
    return error


def _usage_error(error: Any) -> str:
    """The message in one line; the help that explains options where it is typer that refuses them."""
    said = " ".join(error.format_message().split())
    if said.startswith(REFUSED) or getattr(error, "ctx", None) is None:
        return said.removeprefix(REFUSED)
    return f"{said[:1].lower()}{said[1:].removesuffix('.')}; see {error.ctx.command_path} --help"


def refuse_closed_output() -> None:
    """End the program where standard output is closed, as by >&-: nobody would see the result.

    Other standard streams that are closed are opened to nothing: a file that is opened later would take their number,
    and libraries write to it.
    """
    if sys.stdout is None:
        say("error: standard output is closed; leave it open, or send it to a file or to /dev/null", "red")
        sys.exit(BAD_INPUT)
    while (number := os.open(os.devnull, os.O_RDWR)) <= STANDARD_ERROR:
        pass
    os.close(number)


STANDARD_ERROR = 2
"""Number of the last of the standard streams."""

SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Windows has no SIGHUP."""


class Ended(BaseException):
    """Raised wherever the program is when it receives one of the signals. exit_code: as shells report it."""

    def __init__(self, number: int) -> None:
        self.exit_code = 128 + number


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """End the program with the exit code of the signal. One that is ignored, as with nohup, stays ignored."""
    here = threading.current_thread() is threading.main_thread()
    ours = [number for number in SIGNALS if here and signal.getsignal(number) is signal.SIG_DFL]

    def unwind(number: int, _: object) -> None:
        for one in ours:
            signal.signal(one, signal.SIG_IGN)  # the first one is enough
        raise Ended(number)

    for number in ours:
        signal.signal(number, unwind)
    try:
        yield
    except Ended as ended:
        sys.exit(ended.exit_code)
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
