"""What graphdyn refuses, and the facts each refusal carries."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


class GraphDynError(Exception):
    """Base of every error that graphdyn, urdf and crosscheck raise on purpose.

    problems: of an error that tells several, each in one line
    """

    problems: tuple[str, ...] = ()


class InvalidModel(GraphDynError, ValueError):
    """A body, joint or tree that no rigid-body system can have; the message names the element."""


class InvalidInput(GraphDynError, ValueError):
    """An array argument of the wrong shape, or with NaN or infinities; the message names argument and row."""


class SingularMassMatrix(GraphDynError, ArithmeticError):
    """The joint-space mass matrix is singular: the accelerations are not determined by the torques."""


class UnknownFrame(GraphDynError, LookupError):
    """A frame name that the robot does not have; the message lists those it has."""


class InconsistentState(GraphDynError, ValueError):
    """A maximal state whose bodies are not where their joints hold them."""


class GimbalLock(GraphDynError, ArithmeticError):
    """Cardano coordinates were requested where cos(beta) of a body vanishes (det D = cos beta, Eq. 33)."""


class RankDeficientConstraints(GraphDynError, ArithmeticError):
    """The rows of φ_q are linearly dependent.

    rank: numerical rank of φ_q
    n_rows: number of constraint rows
    rows: names of the rows that take part in the dependency, strongest first ("phi_24": joint 2, row 4)
    """

    def __init__(self, rank: int, n_rows: int, rows: Sequence[str]):
        self.rank, self.n_rows, self.rows = rank, n_rows, tuple(rows)
        super().__init__(
            f"the constraint Jacobian has rank {rank}, expected {n_rows}; dependent rows: {', '.join(rows)}. "
            "The multipliers of these rows are not determined; use constraint rows that are independent in every pose"
        )


class EstimationFailed(GraphDynError, ArithmeticError):
    """An estimator has no answer for these data; the message says why."""


class IntegrationFailed(GraphDynError, ArithmeticError):
    """A simulation whose numbers are no longer finite, or whose steps became too small; the message says when."""


def install_line(extra: str) -> str:
    """What to type for the packages of an extra of pyproject.toml."""
    return f"python -m pip install 'graphdyn[{extra}]'"


def not_installed(package: str, extra: str) -> str:
    """That a package is missing, and what to type."""
    return f"the package {package} is not installed; run: {install_line(extra)}"


def in_row(index: Iterable[int]) -> str:
    """Which sample of a batch, for messages: " in row 3", " in row (1, 2)"; nothing where there is one state only."""
    row = tuple(int(k) for k in index)
    return f" in row {row[0] if len(row) == 1 else row}" if row else ""


def counted(number: int, one: str, several: str = "") -> str:
    """The number with its noun: "1 joint", "2 joints". several: the plural if it is not one + "s"."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"


def first_of(items: Iterable[object], most: int) -> str:
    """The first ones in a row, and how many there are besides: "3, 7 and 2 more"."""
    said = list(map(str, items))
    return ", ".join(said[:most]) + (f" and {len(said) - most} more" if len(said) > most else "")
