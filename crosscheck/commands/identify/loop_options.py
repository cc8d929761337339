"""IdentifyOptions of `graphdyn identify` that say in which control loop a recording was made."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from crosscheck.commands.program.functions import user_function

if TYPE_CHECKING:
    from graphdyn.identification import ClosedLoop


@dataclass(frozen=True, kw_only=True)
class LoopOptions:
    """The controller of the recordings."""

    PANEL: ClassVar[str] = "Control loop of the recordings, for iv, didim, cloe and clie"

    controller: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.py:NAME",
            help="A function without arguments that makes the PDControl or ComputedTorqueControl of the recording, its "
            "target over the time of the LOG; or a control law (t, q, v) → τ.",
        ),
    ] = None
    control_rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Rate of the controller; its torque is held in between.")
    ] = None

    @property
    def loop(self) -> ClosedLoop | None:
        """Raises typer.BadParameter for a rate that is none, or has no controller, and for other answers."""
        from inspect import signature

        from graphdyn import ComputedTorqueControl, PDControl
        from graphdyn.identification import ClosedLoop

        text, rate = self.controller, self.control_rate
        if rate is not None and (text is None or not rate > 0):
            raise typer.BadParameter(f"--control-rate {rate:g}: give Hz above zero, and a --controller")
        if text is None:
            return None
        function: Any = user_function("--controller", text)
        period = None if rate is None else 1 / rate
        if len(signature(function).parameters) > 0:
            return ClosedLoop(function, period=period)
        controller = function()
        if not isinstance(controller, PDControl | ComputedTorqueControl):
            raise typer.BadParameter(
                f"--controller {text} makes a {type(controller).__name__}; a PDControl or ComputedTorqueControl is "
                "needed, or a control law with the arguments t, q and v"
            )
        return ClosedLoop(controller if period is None else replace(controller, period=period))
