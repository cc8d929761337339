"""A state of a robot on the command line: numbers, a JSON file, or random."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from graphdyn.errors import counted

if TYPE_CHECKING:
    from graphdyn import RobotModel
    from graphdyn.layout import Array

StateOption = Annotated[
    str | None,
    typer.Option(
        metavar="Q[,V]|FILE|random[:SEED]",
        help="A state: n joint positions, or n positions and n velocities, with commas ('Q;V' with a semicolon) "
        "[rad or m, …/s]; a JSON file with q and v; or a random one. The default of v is 0.",
    ),
]


def given_state(text: str, model: RobotModel) -> tuple[Array, Array]:
    """q, v (n,). Raises typer.BadParameter; InvalidInput for wrong lengths, NaN and infinity."""
    from graphdyn.arguments import one_state

    q, v = _random(text, model) if text.partition(":")[0] == "random" else _written(text, model.nv)
    state = one_state(model, q=q, v=v)
    return state["q"], state["v"]


def _random(text: str, model: RobotModel) -> tuple[Any, Any]:
    import numpy as np

    seed = text.partition(":")[2] or "0"
    if not seed.isdecimal():
        raise typer.BadParameter(f"--state {text}: '{seed}' is not a seed, a whole number from 0 on")
    return model.random_state(np.random.default_rng(int(seed)))


def _written(text: str, n: int) -> tuple[Any, Any]:
    file = Path(text)
    if text.lower().endswith(".json") or file.is_file():
        return _from_file(file, n)
    first, semicolon, second = text.partition(";")
    q = _numbers(text, first)
    if semicolon:
        return q, _numbers(text, second)
    if len(q) not in (n, 2 * n):
        raise typer.BadParameter(
            f"--state has {counted(len(q), 'number')}; the robot needs {n} for q, or {2 * n} for q and v"
        )
    return q[:n], q[n:] or [0.0] * n


def _numbers(text: str, part: str) -> list[float]:
    try:
        return [float(number) for number in part.split(",")]
    except ValueError:
        wanted = "give numbers with commas, a JSON file with q and v, or random"
        raise typer.BadParameter(f"--state {text}: '{part}' is not a row of numbers; {wanted}") from None


def _from_file(file: Path, n: int) -> tuple[Any, Any]:
    """Fields q and v of the one object in a JSON file. Raises OSError too."""
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise typer.BadParameter(f"--state {file}: is not a JSON file ({error})") from None
    if not isinstance(record, dict) or "q" not in record:
        raise typer.BadParameter(f"""--state {file}: has no field q; write {{"q": […], "v": […]}}""")
    return record["q"], record.get("v", [0.0] * n)
