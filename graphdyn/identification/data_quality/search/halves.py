"""Faults of a recording whose halves contradict each other: those of both halves, and those of one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from graphdyn.identification.data_quality.fits.thinning import Piece, TooShort
from graphdyn.identification.data_quality.search.deciding import DataFault, kind_of


@dataclass(frozen=True, eq=False)
class FaultsByHalves:
    """Faults of a recording in which something changed.

    of_both: of the whole recording, because each half alone shows them
    of_one: of the first half alone, and of the second, at joints where the halves contradict each other
    doubtful: what the whole recording shows, but neither half; and what one half shows at other joints
    """

    of_both: tuple[DataFault, ...]
    of_one: tuple[tuple[DataFault, ...], tuple[DataFault, ...]]
    doubtful: tuple[DataFault, ...]


def faults_by_halves(
    pieces: Sequence[Piece],
    whole: Sequence[DataFault],
    contradicting: Collection[int],
    search: Callable[[Sequence[Piece]], tuple[DataFault, ...]],
) -> FaultsByHalves:
    """The faults of each half.

    whole: those that the whole recording shows
    contradicting: joints where the halves contradict each other
    search: the faults of some pieces

    All are doubtful if the halves are too short to be searched.
    """
    try:
        first, second = (search(half) for half in halved(pieces))
    except TooShort:
        return FaultsByHalves((), ((), ()), tuple(whole))
    in_first, in_second = ({kind_of(fault.change) for fault in half} for half in (first, second))
    both = in_first & in_second
    known = {kind_of(fault.change) for fault in whole}
    of_both = [fault for fault in whole if kind_of(fault.change) in both]
    of_both += [fault for fault in first if kind_of(fault.change) in both - known]
    doubtful = [fault for fault in whole if kind_of(fault.change) not in in_first | in_second]
    of_one: tuple[list[DataFault], list[DataFault]] = ([], [])
    for half, kept in zip((first, second), of_one, strict=True):
        for fault in half:
            if kind_of(fault.change) not in both:
                (kept if set(fault.change.joints) & set(contradicting) else doubtful).append(fault)
    return FaultsByHalves(tuple(of_both), (tuple(of_one[0]), tuple(of_one[1])), tuple(doubtful))


def halved(pieces: Sequence[Piece]) -> tuple[list[Piece], list[Piece]]:
    """The first and the second half of the samples."""
    middle = sum(len(piece.samples) for piece in pieces) // 2
    first: list[Piece] = []
    second: list[Piece] = []
    for piece in pieces:
        count = len(piece.samples)
        cut = min(max(middle, 0), count)
        if cut:
            first.append(replace(piece, samples=piece.samples[:cut]))
        if cut < count:
            second.append(replace(piece, samples=piece.samples[cut:]))
        middle -= count
    return first, second
