"""Findings about the links of a result: values that a limit holds, and masses of CAD that the recording contradicts."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crosscheck.identifying.results.identified_model import IdentifiedModel
from crosscheck.identifying.results.result import Identified
from graphdyn.identification import ContradictedMass, MethodResult, ReachedLimit

FACTOR_MARGIN = 1.2
"""Factor by which the proposed CAD factor exceeds the one that the recording asks for."""

REMEDY = "move so that it shows, or say with --cad-factor how well CAD is known"


@dataclass(frozen=True)
class LinkFinding:
    """A finding about one link, or about all of them.

    link: empty for all; code: "undetermined" or "cad-mass"; message: what was found; remedy: what to do
    """

    link: str
    code: str
    message: str
    remedy: str


def reached_limits(found: Identified, result: MethodResult) -> tuple[ReachedLimit, ...]:
    """Values of a result that its limits hold; none for a method without limits."""
    estimate = result.estimate
    if estimate is None or estimate.limits is None:
        return ()
    return estimate.limits.reached(estimate.parameters)


def contradicted_masses(found: Identified, result: MethodResult) -> tuple[ContradictedMass, ...]:
    """Masses of CAD that the recording contradicts, by the torque model of a result, with unknown links."""
    return _with_unknown_links(found, result).contradicted_masses


def _with_unknown_links(found: Identified, result: MethodResult) -> IdentifiedModel:
    model = found.model_of(result)
    return next((other for other in found.models if other.name == model.cad_of), model)


def link_findings(found: Identified, result: MethodResult) -> tuple[LinkFinding, ...]:
    """Findings about the links of a result, contradictions to CAD first."""
    contradicted = contradicted_masses(found, result)
    findings = [_contradiction(each, len(contradicted)) for each in contradicted]
    told = {each.body for each in contradicted}
    for each in reached_limits(found, result):
        if each.quantity == "mass" and each.body in told:
            continue
        whose = f"{each.quantity} of {each.body}" if each.body else each.quantity
        unit = "kg" if each.quantity in ("mass", "total mass") else "m"
        message = f"{whose} is {each.value:.3g} {unit}, held by its limit of {each.limit:.3g} {unit}"
        findings.append(LinkFinding(each.body, "undetermined", f"{message}: undetermined by this recording", REMEDY))
    return tuple(findings)


def _contradiction(found: ContradictedMass, several: int) -> LinkFinding:
    whose = f"the mass of {found.body}" if found.body else "the masses"
    factor = math.ceil(FACTOR_MARGIN * found.factor)
    option = f"{found.body}={factor}" if found.body else str(factor)
    sums = "" if found.body else " in the sum"
    alternatives = "; one of these masses is wrong, the recording does not tell which" if several > 1 else ""
    return LinkFinding(
        found.body,
        "cad-mass",
        f"the recording contradicts {whose} in CAD, {found.cad:.3g} kg{sums}: {found.limit:.3g} kg with the limit, "
        f"{found.mass:.3g} ± {found.deviation:.1g} kg without it, which makes {100 * found.gain:.0f} % of the squared "
        f"error of rows that were not fitted vanish{alternatives}",
        f"check CAD and what is mounted; allow it with --cad-factor {option}",
    )
