"""What exact values say of judged functions: a sentence each, and the errors in detail."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.judging.exact_errors import ExactErrors
from crosscheck.judging.judgment import JudgedFunction
from crosscheck.report.error_tables import ERROR_FORMAT, error_text
from crosscheck.report.report import Block, Column, Facts, Row, Table
from graphdyn.errors import counted
from graphdyn.layout import Array


def exact_facts(functions: Sequence[JudgedFunction]) -> tuple[Block, ...]:
    """A sentence for each function that was held against exact values; nothing where there is none."""
    said = tuple((function.name, in_words(function.exact)) for function in functions if function.exact is not None)
    return (Facts(said, title="Against exact values"),) if said else ()


def in_words(errors: ExactErrors) -> str:
    """Such as "off by at least 2.3e-11 of the largest joint wrench (proven); graphdyn errs by 4e-16, …"."""
    worst = errors.worst
    said = f"right: off by at most {error_text(errors.most[worst])} of {errors.scale}"
    if errors.wrong:
        said = f"off by at least {error_text(errors.least[worst])} of {errors.scale} (proven)"
    references = ", ".join(f"{name} by {x[worst]:.0e}" for name, x in errors.references.items())
    where = "the decimals of the file" if errors.truth == "file" else "the doubles of the model"
    states = f"{'all' if errors.everywhere else 'at'} {counted(len(errors.states), 'state')}"
    digits = f"Right to {errors.digits} of {errors.given_digits} digits. " if errors.given_digits else ""
    return (
        f"{said}; {references.replace(' by', ' errs by', 1)}; half an ulp of the inputs causes "
        f"{errors.caused[worst]:.0e}. {digits}{_rounded(errors)}Exact are {where}, {states}."
    )


def _rounded(errors: ExactErrors) -> str:
    """How many numbers are correctly rounded, where all states were computed."""
    if not errors.everywhere:
        return ""
    return f"{100 * errors.rounded:.0f} % correctly rounded, the worst number is {_few(errors.ulps)} ulps off. "


def _few(ulps: float) -> str:
    return f"{ulps:.0f}" if ulps >= 10 else f"{ulps:.1g}"


def exact_table(function: JudgedFunction) -> tuple[Block, ...]:
    """The errors of the function and of the reference implementations over the states."""
    errors = function.exact
    if errors is None:
        return ()
    rows: list[tuple[str, Array]] = [
        (f"{function.name}, at least", errors.least),
        (f"{function.name}, at most", errors.most),
        ("half an ulp of all inputs", errors.caused),
        (f"counts as wrong: {errors.factor:g} times that", errors.factor * errors.caused),
        *((f"{name}, at most", x) for name, x in errors.references.items()),
    ]
    return (
        Table(
            (Column("error", "name"), *(Column(title, **ERROR_FORMAT) for title in ("median", "largest"))),
            tuple(Row((name, float(np.median(x)), float(x.max()))) for name, x in rows),
            title="Against exact values",
            caption=f"Errors at {counted(len(errors.states), 'state')}, relative to {errors.scale}",
            on=("page",),
        ),
    )
