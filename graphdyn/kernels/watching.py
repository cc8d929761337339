"""What has to be watched to know that all inputs are finite: few outputs instead of many inputs.

What is not finite stays so in sums, products and numerators, and becomes NaN in sine and cosine; in a denominator only
NaN survives, since 1 / ∞ is zero. An output that is finite therefore vouches for every input that reaches it so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.expressions import Expression, Recorder


def sufficient(recorder: Recorder, inputs: Sequence[Expression], outputs: Sequence[Any]) -> list[Expression]:
    """Outputs that vouch for several inputs each, and the inputs for which none does."""
    vouched = _vouched(recorder, [x.number for x in inputs])
    candidates = [output for output in outputs if isinstance(output, Expression)]
    chosen, missing = [], (1 << len(inputs)) - 1
    while candidates:
        best = max(candidates, key=lambda output: (vouched[output.number] & missing).bit_count())
        if (vouched[best.number] & missing).bit_count() < 2:
            break
        chosen.append(best)
        missing &= ~vouched[best.number]
    return [*chosen, *(x for place, x in enumerate(inputs) if missing >> place & 1)]


def _vouched(recorder: Recorder, inputs: Sequence[int]) -> list[int]:
    """Per operation, the inputs that are finite if it is: a bit for each."""
    finite: list[int] = []
    not_nan: list[int] = []  # those that are finite if it is not NaN
    bits = {number: 1 << place for place, number in enumerate(inputs)}
    for number, (kind, *arguments) in enumerate(recorder.operations):
        if kind in ("constant", "input"):
            finite.append(bits.get(number, 0))
            not_nan.append(0)
            continue
        first, *others = arguments
        if kind in ("sine", "cosine"):
            survives = reaches = finite[first]
        else:
            survives, reaches = not_nan[first], finite[first]
            for k in others:
                survives |= not_nan[k]
                reaches |= not_nan[k] if kind == "/" else finite[k]
        not_nan.append(survives)
        finite.append(reaches)
    return finite
