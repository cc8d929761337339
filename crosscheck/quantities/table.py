"""The table of quantities, and the forms of it that the cross-check and the judge take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from crosscheck.quantities.quantity import Form, Quantity
from crosscheck.quantities.rows.derivatives import DERIVATIVES, DerivativeFunctions
from crosscheck.quantities.rows.dynamics import DYNAMICS, SOLVED_SCALE, TORQUE, DynamicsFunctions
from crosscheck.quantities.rows.energies import ENERGIES, MOMENTA, EnergyFunctions
from crosscheck.quantities.rows.frames import FRAMES, FrameFunctions
from crosscheck.quantities.rows.matrices import MATRICES, MatrixFunctions
from crosscheck.quantities.rows.regressors import BY_TYPE, REGRESSORS, RegressorFunctions
from crosscheck.quantities.tolerances import (
    ACCELERATION,
    AGREEMENT,
    CLOSED,
    CLOSED_BACKWARD,
    CLOSED_WRENCH,
    IDENTIFICATION,
    RANK,
    Tolerance,
)
from graphdyn import InvalidInput
from graphdyn.arguments import closest

QUANTITIES: dict[str, Quantity] = {
    row.name: row for row in (*DYNAMICS, *MATRICES, *FRAMES, *MOMENTA, *ENERGIES, *DERIVATIVES, *REGRESSORS)
}


class FunctionsUnderTest(
    DynamicsFunctions, MatrixFunctions, FrameFunctions, EnergyFunctions, DerivativeFunctions, RegressorFunctions
):
    """The functions that crosscheck.judge takes as keywords; docs/judge.md lists arguments and answers."""


FUNCTIONS = {name: row for name, row in QUANTITIES.items() if name in FunctionsUnderTest.__annotations__}
"""The functions that can be judged."""


def known_function(name: str) -> Quantity:
    """Raises InvalidInput with the known names."""
    if name in FUNCTIONS:
        return FUNCTIONS[name]
    near = closest(name, FUNCTIONS)
    raise InvalidInput(
        f"there is no function {name!r} to judge{f'; did you mean {near!r}?' if near else ''}; "
        f"known are {', '.join(FUNCTIONS)}"
    )


@dataclass(frozen=True, eq=False)
class ComparedQuantity:
    """A quantity as the cross-check reports it.

    against: the function of Pinocchio it is compared with, and the method of graphdyn
    scale: besides the largest reference value, what the error is relative to, in the terms of docs/notation.md
    solves: whether it needs a regular mass matrix; massive: whether it needs a body with mass
    """

    name: str
    against: str
    scale: str
    tolerance: Tolerance
    solves: bool = False
    massive: bool = False

    def __reduce__(self) -> tuple[Callable[[str], ComparedQuantity], tuple[str]]:
        """The name alone: other processes have the table, and functions cannot travel to them."""
        return compared_quantity, (self.name,)


def compared_quantity(name: str) -> ComparedQuantity:
    """The row of COMPARED, COUPLED or LOOPED."""
    return {**COMPARED, **COUPLED, **LOOPED}[name]


@dataclass(frozen=True, eq=False, kw_only=True)
class TabulatedQuantity(ComparedQuantity):
    """A row of the table in one form."""

    row: Quantity
    form: Form

    @classmethod
    def of(cls, row: Quantity, form: Form) -> TabulatedQuantity:
        function, *own = row.function.split("; ")
        words = [form.words] if form.words else own
        function = f"{function} with fext" if form.loaded and form.suffix else function
        return cls(
            name=f"{row.name}{form.suffix}",
            against="; ".join([function, *words]),
            scale=row.scale,
            tolerance=row.tolerance,
            solves=row.solves,
            massive=row.massive,
            row=row,
            form=form,
        )


def _by_name(*quantities: ComparedQuantity) -> dict[str, ComparedQuantity]:
    return {quantity.name: quantity for quantity in quantities}


COMPARED = _by_name(
    *(TabulatedQuantity.of(row, form) for row in QUANTITIES.values() for form in row.forms),
    ComparedQuantity("constraint_rank", "φ_q has rank 5n", "full rank", RANK),
    ComparedQuantity("kkt_rank", "Eq. (111) has rank 11n", "full rank", RANK, solves=True),
    ComparedQuantity(
        "base_parameters",
        "same least squares with Pinocchio's regressor",
        "only cond(W) ‖x‖ × rounding of a column, columns of W at unit length",
        IDENTIFICATION,
        massive=True,
    ),
)

_SUM = "largest entry of a tensor × (Σ∣K∣)²"
_ON_LOOPS = "(‖a‖ + ‖v‖²) × condition of J + ‖∣R∣ × forces‖ × condition of its rows; R = Z (Zᵀ M Z)⁻¹ Zᵀ"
_LOOP_FORCES = "(1 + ‖M Z (Zᵀ M Z)⁻¹ Zᵀ‖) × largest force × that ratio; the mass at the chords × what they move apart"

COUPLED = _by_name(
    ComparedQuantity("coupled_inverse_dynamics", "rnea with fext at K q + o, times Kᵀ", TORQUE, AGREEMENT),
    ComparedQuantity("coupling_multipliers", "what rnea with fext needs at driven joints", TORQUE, AGREEMENT),
    ComparedQuantity("coupled_mass_matrix", "Kᵀ crba K", _SUM, AGREEMENT),
    ComparedQuantity("coupled_joint_torque_regressor", "Kᵀ computeJointTorqueRegressor", BY_TYPE, AGREEMENT),
    ComparedQuantity("coupled_forward_dynamics", "a for which rnea gives τ", SOLVED_SCALE, ACCELERATION, True),
)
"""Compared in addition where joints drive each other; the others are then those of the robot without couplings."""

_ALONG_LOOPS = "only ∣1 - J⁺J∣ × the largest of τ, the joint wrenches of the tree and ∣M∣ ∣a∣"

LOOPED = _by_name(
    ComparedQuantity("closed_backward_error", "its accelerations by our torques", _ALONG_LOOPS, CLOSED_BACKWARD),
    ComparedQuantity("closed_forward_dynamics", "constraintDynamics of held points, refined", _ON_LOOPS, CLOSED),
    ComparedQuantity("closed_joint_wrenches", "rnea with its forces, if determined", _LOOP_FORCES, CLOSED_WRENCH),
    ComparedQuantity("closed_inverse_dynamics", "a for which constraintDynamics moves as given", _ON_LOOPS, CLOSED),
)
"""Compared in addition where chords close loops; the others are then those of the tree."""
