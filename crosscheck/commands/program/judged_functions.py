"""Options of the commands that judge or ask functions, and the functions that can be judged in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from crosscheck.commands.program.options import RobotArgument, SamplesOption, SeedOption
from crosscheck.commands.program.reading_options import ReadingOptions, pairs

if TYPE_CHECKING:
    from crosscheck.judging.setting import Setting

FUNCTIONS_HELP = """\b
Functions, after their arguments:
  q, v, a               inverse_dynamics power joint_wrenches multipliers frame_acceleration
                        dtau_dq dtau_dv dwrenches_dq dwrenches_dv dwrenches_da
                        dmultipliers_dq dmultipliers_dv dmultipliers_da
                        joint_torque_regressor base_regressor body_regressor
  q, v, tau             forward_dynamics da_dq da_dv forward_dynamics_parameter_derivatives
  q, v                  bias_torque coriolis_matrix frame_velocity frame_jacobian_derivative
                        center_of_mass_velocity momentum kinetic_energy
                        momentum_regressor kinetic_energy_regressor
  q                     gravity_torque mass_matrix mass_matrix_inverse frame_placement frame_jacobian
                        center_of_mass center_of_mass_jacobian centroidal_map potential_energy
                        potential_energy_regressor
  q, external_wrenches  static_torque
"""
"""Shapes and units are in docs/judge.md. Written out, because the help must not import what computes."""

FUNCTION_FORM = "FILE.py:NAME"

CONVENTION_PANEL = "Conventions and precision"

JointsOption = Annotated[
    str | None,
    typer.Option(
        metavar="NAME,NAME,…",
        rich_help_panel=CONVENTION_PANEL,
        show_default="that of the file",
        help="Joint order of the functions.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class SettingOptions(ReadingOptions):
    """The robot, and the states at which functions are asked."""

    PANEL: ClassVar[str] = "States"

    robot: RobotArgument
    samples: SamplesOption = 100
    seed: SeedOption = 0
    beyond_limits: Annotated[
        bool, typer.Option("--beyond-limits", help="Add states outside the limits of position and velocity.")
    ] = False
    frame: Annotated[str | None, typer.Option(metavar="LINK", help="Frame of the functions that refer to one.")] = None
    external_wrenches: Annotated[
        bool,
        typer.Option(
            "--external-wrenches",
            help="Torques, accelerations and reactions take wrenches on the links (n, 6) as their last argument.",
        ),
    ] = False

    @property
    def setting(self) -> Setting:
        from crosscheck.judging.setting import Setting

        return Setting(
            robot=self.robot,
            reading=self.reading,
            samples=self.samples,
            seed=self.seed,
            beyond_limits=self.beyond_limits,
            frame=self.frame,
            external_wrenches=self.external_wrenches,
        )


@dataclass(frozen=True, kw_only=True)
class ConventionOptions:
    """The conventions of the functions, and their precision."""

    PANEL: ClassVar[str] = CONVENTION_PANEL

    convention: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=WAY",
            show_default="detected",
            help="A convention that the functions must follow, such as reference=local. Repeatable.",
        ),
    ] = None
    precision: Annotated[
        Literal["double", "single"],
        typer.Option(help='Precision of the functions; with "single", errors up to 1e-5 count as agreement.'),
    ] = "double"

    @property
    def conventions(self) -> dict[str, str]:
        return dict(pairs("--convention", self.convention, "NAME=WAY"))


def names(text: str | None) -> list[str] | None:
    """NAME,NAME,… as a list; None where the option is left out."""
    return None if text is None else [name.strip() for name in text.split(",")]
