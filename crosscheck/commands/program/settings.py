"""A settings class as the options of a command: every field of a frozen dataclass, annotated for typer, is an option.

    @dataclass(frozen=True, kw_only=True)
    class CompareOptions(ReportOptions):
        samples: Annotated[int, typer.Option(min=1, metavar="N", help="Random states per robot.")] = 1000

    def run(options: CompareOptions) -> None: ...

Classes that a command inherits from are shared by commands; their PANEL is the heading of their options in its help.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from copy import copy
from dataclasses import MISSING, Field, fields, is_dataclass
from inspect import Parameter, Signature, signature
from typing import Annotated, Any, get_args, get_type_hints

import typer


def as_command(run: Callable[..., None]) -> Callable[..., None]:
    """The function that typer reads: in place of the settings class, a parameter for each of its fields."""
    hints = get_type_hints(run, include_extras=True)
    parameters: list[Parameter] = []
    classes: list[tuple[str, Any]] = []
    for given in signature(run).parameters.values():
        kind = hints[given.name]
        if is_dataclass(kind):
            classes.append((given.name, kind))
            parameters += _options(kind)
        else:
            parameters.append(given.replace(annotation=kind, kind=Parameter.KEYWORD_ONLY))

    def command(**values: Any) -> None:
        made = {name: kind(**{each.name: values.pop(each.name) for each in fields(kind)}) for name, kind in classes}
        run(**values, **made)

    command.__doc__, command.__module__ = run.__doc__, run.__module__
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    command.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    return command


def _options(settings: Any) -> Iterator[Parameter]:
    """One for each field: those of the class itself first, then those that it inherits, class by class."""
    known: dict[str, Field[Any]] = {each.name: each for each in fields(settings)}
    hints = get_type_hints(settings, include_extras=True)
    owners = {name: owner for owner in settings.__mro__ for name in vars(owner).get("__annotations__", {})}
    for owner in settings.__mro__:
        for name in [name for name in known if owners[name] is owner]:
            default = known[name].default
            default = Parameter.empty if default is MISSING else default
            annotation = _in_panel(hints[name], vars(owner).get("PANEL"))
            yield Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _in_panel(annotated: Any, panel: str | None) -> Any:
    """The annotation of an option, under this heading unless it has one of its own."""
    kind, *options = get_args(annotated)
    placed = [copy(option) for option in options]
    for option in placed:
        option.rich_help_panel = option.rich_help_panel or panel
    return Annotated[(kind, *placed)]


def refuse(options: object, names: Iterable[str], why: str) -> None:
    """Raise typer.BadParameter for the first of these fields that is not left at its default.

    why: what is wrong with giving it, after the name of the option
    """
    defaults = {each.name: each.default for each in fields(options)}  # type: ignore[arg-type]
    for name in names:
        if getattr(options, name) != defaults[name]:
            raise typer.BadParameter(f"--{name.replace('_', '-')} {why}")
