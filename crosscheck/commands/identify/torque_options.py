"""Options of `graphdyn identify` that say what makes up the torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.identify.model_file import models_of
from crosscheck.commands.identify.models import (
    DEFAULT_TERMS,
    FUNCTION_FORM,
    drives_of,
    known_torques,
    links,
    payload_of,
    scaled_torques,
)

if TYPE_CHECKING:
    from crosscheck.identifying import CandidateModel
    from graphdyn.identification import Estimator


@dataclass(frozen=True, kw_only=True)
class TorqueOptions:
    """What makes up the torque."""

    PANEL: ClassVar[str] = "Torque model"

    terms: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,…",
            rich_help_panel="Options",
            show_default=DEFAULT_TERMS,
            help="Terms of the drives: viscous, coulomb, stribeck, load, smooth-coulomb, offset, rotor, "
            "asymmetric-viscous, asymmetric-coulomb, coupled-wrist, slip, spring, or none; NAME*time and "
            "NAME*temperature for terms that drift. Repeatable: torque models to compare.",
        ),
    ] = None
    models: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="TOML file of torque models to compare (docs/identification.md), instead of --terms.",
        ),
    ] = None
    width: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", help="Use tanh(v/X) instead of the sign of v in friction [rad/s or m/s]."),
    ] = None
    stribeck_velocity: Annotated[
        str | None,
        typer.Option(
            metavar="X|X,X,…", show_default="0.1", help="Speed V at which Stribeck friction fades [rad/s, m/s]."
        ),
    ] = None
    stribeck_exponent: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="2", help="Stribeck friction fades as exp(-|v/V|^X)."),
    ] = None
    term: Annotated[
        list[str] | None,
        typer.Option(
            metavar=FUNCTION_FORM, help="A function without arguments that returns a further term. Repeatable."
        ),
    ] = None
    known_torque: Annotated[
        list[str] | None,
        typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → known torque (N, n), which is subtracted. Repeatable."),
    ] = None
    scaled_torque: Annotated[
        list[str] | None,
        typer.Option(
            metavar=FUNCTION_FORM, help="The same with an unknown factor: springs, counterbalances. Repeatable."
        ),
    ] = None
    known_bodies: Annotated[
        bool, typer.Option("--known-bodies", help="Keep the links of the URDF; identify drives and payload only.")
    ] = False
    payload: Annotated[
        str | None,
        typer.Option(
            metavar="unknown|unknown@X,Y,Z|M@X,Y,Z",
            help="Load on the last link: ten unknowns, an unknown mass with known center, or a known point mass.",
        ),
    ] = None
    payload_on: Annotated[str | None, typer.Option(metavar="LINK", help="Link that carries the payload.")] = None

    def candidates(self, methods: Sequence[str | Estimator]) -> list[CandidateModel]:
        """One torque model for every --terms, or those of --models. Raises InvalidInput and typer.BadParameter.

        methods: of the models that do not say
        """
        from crosscheck.identifying import CandidateModel

        load, known_load = payload_of(self.payload, self.payload_on)
        load += scaled_torques(self.scaled_torque)
        known = (*known_torques(self.known_torque), *known_load)
        if self.models is not None:
            return models_of(self.models, methods, load, known, self.known_bodies)
        bodies, known_links = links(self.known_bodies)
        given = list(self.terms or [DEFAULT_TERMS])
        drives = drives_of(given, self.width, (self.stribeck_velocity, self.stribeck_exponent), self.term)
        names = given if len(given) > 1 else [""]
        return [
            CandidateModel(name, (*bodies, *load, *own), (*known_links, *known), methods)
            for name, own in zip(names, drives, strict=True)
        ]
