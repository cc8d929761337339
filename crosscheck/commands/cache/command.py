"""`graphdyn cache`: the folder of compiled programs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.options import EXAMPLES, JsonOptions

EPILOG = f"""{EXAMPLES}  graphdyn cache
  graphdyn cache --clear
"""


@dataclass(frozen=True, kw_only=True)
class CacheOptions(JsonOptions):
    """What `graphdyn cache` is asked for."""

    clear: Annotated[bool, typer.Option("--clear", help="Remove all compiled programs.")] = False


def run(options: CacheOptions) -> None:
    """Show or clear the compiled programs kept on disk.

    What was compiled once is not compiled again. GRAPHDYN_CACHE names another folder, or is "off".
    """
    from crosscheck.commands.cache.record import cache_report
    from graphdyn.compiler import clear_code_cache, code_cache

    deliver(cache_report(clear_code_cache() if options.clear else code_cache(), options.clear), options)
