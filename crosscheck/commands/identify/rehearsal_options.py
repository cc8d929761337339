"""Options of `graphdyn identify --rehearse`: the planned motion, and what its virtual recordings are like."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

if TYPE_CHECKING:
    from crosscheck.identifying import Conditions


@dataclass(frozen=True, kw_only=True)
class RehearsalOptions:
    """The planned motion, and the robots that follow it."""

    PANEL: ClassVar[str] = "Rehearsal of a planned motion, without a LOG"

    rehearse: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Simulate this motion, which `graphdyn excite --out` wrote, identify, and say what will be found "
            "within which σ. --rate is that of the recording, 250 Hz by default.",
        ),
    ] = None
    torque_noise: Annotated[
        float | None,
        typer.Option(
            metavar="X", show_default="0.05", help="Residual of each joint relative to its torque, root mean squares."
        ),
    ] = None
    noise_time: Annotated[
        float | None,
        typer.Option(metavar="S", show_default="0.1", help="Correlation time of the residual; 0 for white noise [s]."),
    ] = None
    position_noise: Annotated[
        float | None,
        typer.Option(metavar="X", show_default="2e-5", help="Noise of the positions [rad or m]."),
    ] = None
    friction: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            show_default="0.05",
            help="Torque of each drive parameter relative to that of its joint, ± 50 %.",
        ),
    ] = None
    cad_error: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            show_default="0.2",
            help="Largest relative error of the masses of the file, and of its centers of mass.",
        ),
    ] = None
    runs: Annotated[
        int | None,
        typer.Option(metavar="N", show_default="20", help="Number of virtual recordings, each of another robot."),
    ] = None

    def conditions(self, rate: float | None, seed: int | None) -> Conditions:
        """Sizes that were given, defaults for the others. Raises InvalidInput for impossible ones."""
        from crosscheck.identifying import Conditions

        given = {"rate": rate, "seed": seed, **{name: getattr(self, name) for name in CONDITION_OPTIONS}}
        return Conditions(**{name: value for name, value in given.items() if value is not None})


CONDITION_OPTIONS = ("torque_noise", "noise_time", "position_noise", "friction", "cad_error", "runs")
"""Options that say what the virtual recordings are like."""

OF_RECORDINGS = (
    *("validate", "split", "split_rows", "folds", "mapping", "drop", "derive_velocity", "torque_hold"),
    *("known_torque", "scaled_torque", "known_bodies", "payload", "payload_on", "models", "controller"),
    *("control_rate", "choose", "urdf_file", "jobs", "scheduler", "seconds", "poses", "angles_as_written"),
)
"""Options that a rehearsal has no use for."""
