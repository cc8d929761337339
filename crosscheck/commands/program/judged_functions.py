"""Options of `graphdyn judge`, and the functions that can be judged in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

import typer

FUNCTIONS_HELP = """\b
Functions, after their arguments:
  q, v, a               inverse_dynamics power joint_wrenches multipliers frame_acceleration
                        dtau_dq dtau_dv dwrenches_dq dwrenches_dv dwrenches_da
                        dmultipliers_dq dmultipliers_dv dmultipliers_da
                        regressor base_regressor body_regressor
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

InverseOption = Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → τ, arrays of shape (n,).")]
ForwardOption = Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, τ) → a.")]
MassOption = Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="q → M, shape (n, n).")]
RegressorOption = Annotated[str | None, typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → W, shape (n, 10n).")]
JointsOption = Annotated[
    str | None,
    typer.Option(metavar="NAME,NAME,…", help="Order of the joints in the functions; the file's if left out."),
]
FunctionOption = Annotated[
    list[str] | None,
    typer.Option(metavar=f"NAME={FUNCTION_FORM}", help="Any function of the list below, by its name. Repeatable."),
]
FrameOption = Annotated[str | None, typer.Option(metavar="LINK", help="Frame of the functions that belong to one.")]
ConventionOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=WAY",
        help="A convention that the functions must follow, such as reference=local; found out if left out. Repeatable.",
    ),
]
ExternalWrenchesOption = Annotated[
    bool,
    typer.Option(
        "--external-wrenches",
        help="Torques, accelerations and reactions take wrenches on the links (n, 6) as their last argument.",
    ),
]
BatchedOption = Annotated[bool, typer.Option("--batched", help="The functions take all states at once, arrays (N, n).")]
PrecisionOption = Annotated[
    Literal["double", "single"],
    typer.Option(help="In which the functions compute; single: errors up to 1e-5 are agreement."),
]
ToleranceOption = Annotated[
    float | None, typer.Option(metavar="X", help="Largest relative error that is agreement; by precision if left out.")
]
BeyondLimitsOption = Annotated[
    bool, typer.Option("--beyond-limits", help="Add states outside the limits of positions and velocities.")
]
GravityOption = Annotated[
    tuple[float, float, float] | None,
    typer.Option(metavar="X Y Z", help="Gravity in world axes [m/s²]; 0 0 -9.81 if left out."),
]


def names(text: str | None) -> list[str] | None:
    """NAME,NAME,… as a list; None where the option is left out."""
    return None if text is None else [name.strip() for name in text.split(",")]


def pairs(option: str, texts: list[str] | None, form: str) -> Iterator[tuple[str, str]]:
    """NAME=VALUE of a repeatable option. Raises typer.BadParameter for another form, and a name given twice."""
    seen = set()
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise typer.BadParameter(f"{option} {text}: give {form}")
        if name in seen:
            raise typer.BadParameter(f"{option} {text}: {name} is given twice")
        seen.add(name)
        yield name, value
