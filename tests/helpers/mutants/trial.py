"""One file through inspect, load and Pinocchio: nothing may be raised, contradictory, or different without a word."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from inspected.mends import MENDS, NEW_NAME, mended
from mutants.outcomes import Trial, Unexpected, captured, quiet, tried

import urdf
from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.quantities import COMPARED, RECURSIVE, TabulatedQuantity
from crosscheck.quantities.scales import SHORTEST_LEVER, relative
from crosscheck.quantities.states import Case
from crosscheck.quantities.tolerances import AGREEMENT
from crosscheck.reference.pinocchio_model import UNIVERSE, PinocchioModel, PinocchioRefuses
from crosscheck.reference.pinocchio_model.native import read
from graphdyn import Placement, RobotModel
from graphdyn.layout import Array

LOSES_DIGITS = ("suspicious-lengths", "far-center-of-mass")
"""Findings that explain a number other than Pinocchio's by rounding alone: the lengths are beyond reason."""

SIZES = {"mass": 0.0, "center": SHORTEST_LEVER, "tensor": 0.0, "rotation": 0.0, "translation": SHORTEST_LEVER}
"""Parts of a model of Pinocchio, and the size below which their errors are not relative."""

STATES = 3
"""Random states per file; one wrong number shows at any of them."""

WARNINGS = {
    urdf.MissingInertialWarning: ("missing-inertial",),
    urdf.AxisNotNormalizedWarning: ("axis-not-normalized",),
    urdf.UnboundJointWarning: ("unbound-joints",),
    urdf.UnreadWarning: ("unread-dynamics", "unknown-element", "unknown-attribute"),
}
"""What load warns of, and the findings of which one must say the same."""


def trial(path: Path) -> Trial:
    """Inspect, load and compare one file."""
    return tried(_trial, path)


def _trial(path: Path) -> Trial:
    with quiet("the inspection"):
        report = urdf.inspect(path)
    model, refusal, said = _loaded(path)
    errors = [finding for finding in report.findings if finding.severity == "error"]
    if refusal is not None:
        if not any((e.code, e.line, e.element) == (refusal.code, refusal.line, refusal.element) for e in errors):
            raise Unexpected(f"load refuses ({refusal}), inspect says {[e.code for e in errors]}")
        _check_claims(path, errors)
        return Trial("refused", (refusal.code,))
    assert model is not None
    if errors:
        raise Unexpected(f"load accepts what inspect refuses: {report.reasons}")
    for warning, codes in WARNINGS.items():
        if (warning in said) != any(code in report.codes for code in codes):
            raise Unexpected(f"load warns of {sorted(kind.__name__ for kind in said)}, inspect finds {report.codes}")
    doubtful = {finding.code for finding in report.findings if finding.severity == "warning"}
    if (urdf.ZeroMassWarning in said) != ("zero-mass" in doubtful):
        raise Unexpected(f"load warns of {sorted(kind.__name__ for kind in said)}, inspect doubts {doubtful}")
    return _compared(path, model, report)


CLAIMS = ("Pinocchio refuses the file", "Pinocchio and yourdfpy refuse the file")


def _check_claims(path: Path, errors: list[urdf.Finding]) -> None:
    """Where an error says that Pinocchio refuses the file too, it does; it may not see what a first element hides."""
    if any(error.code == "duplicate-element" for error in errors):
        return
    claims = [error.text for error in errors if any(claim in error.message for claim in CLAIMS)]
    if claims and _is_built(path):
        raise Unexpected(f"Pinocchio loads the file, though: {claims}")


def _is_built(path: Path) -> bool:
    with captured():
        try:
            read(path)
        except Exception:  # Pinocchio raises bare C++ exceptions of several types
            return False
    return True


def _loaded(path: Path) -> tuple[RobotModel | None, urdf.URDFError | None, set[type[Warning]]]:
    with quiet("load"), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("error")
        for kind in (*WARNINGS, urdf.ZeroMassWarning):
            warnings.simplefilter("always", kind)
        try:
            model = urdf.load(path)
        except urdf.URDFError as error:
            return None, error, set()
    return model.uncoupled, None, {warning.category for warning in caught}


def _compared(path: Path, model: RobotModel, report: urdf.Inspection) -> Trial:
    different = _difference(path, model)
    if different is None:
        return Trial("kinematics only" if report.verdict == "kinematics only" else "agrees")
    explaining = [finding for finding in report.findings if finding.severity == "warning"]
    codes = list(dict.fromkeys(finding.code for finding in explaining if finding.code in MENDS))
    content = mended(path.read_bytes(), explaining)
    if content is not None:
        path = path.with_suffix(".mended")
        path.write_bytes(content)
        joints = (replace(j, name=NEW_NAME) if j.name == UNIVERSE else j for j in model.joints)
        model = replace(model, joints=tuple(joints))
    still = different if content is None else _difference(path, model)
    digits = [code for code in report.codes if code in LOSES_DIGITS]
    if still is None:
        return Trial("explained", tuple(codes))
    if digits and _is_rounding(path, model):
        return Trial("explained", (*codes, *digits))
    if content is None:
        raise Unexpected(f"without a finding: {different}; findings {report.codes}")
    raise Unexpected(f"{different}, not explained by {tuple(codes)}: {still} also when that is mended")


def _difference(path: Path, model: RobotModel) -> str | None:
    """What Pinocchio makes of the file that this model of it does not say."""
    with quiet("Pinocchio"):
        try:
            pinocchio = PinocchioModel.from_urdf(path, model)
            with np.errstate(all="ignore"):
                wrong = _wrong(model, pinocchio)
        except PinocchioRefuses as refusal:
            return f"{refusal}; its reader wrote {refusal.said}"
    return f"{wrong}; Pinocchio's reader wrote {pinocchio.said}" if wrong else None


def _wrong(model: RobotModel, pinocchio: PinocchioModel) -> dict[str, float]:
    """The quantities that miss their bound, and how far off they are."""
    case = _case(model)
    states = ComparedStates.of(case, np.ones(len(case.q), dtype=bool), pinocchio)
    errors = {
        name: states.errors(quantity)
        for name, quantity in COMPARED.items()
        if isinstance(quantity, TabulatedQuantity)
        and quantity.form.when == "all"
        and not (quantity.solves or name.endswith(RECURSIVE))
        and (model.frames or not quantity.row.from_file)
    }
    worst = {name: float(np.where(np.isnan(x), np.inf, x).max()) for name, x in errors.items()}
    return {name: error for name, error in worst.items() if error > COMPARED[name].tolerance.bound}


def _is_rounding(path: Path, model: RobotModel) -> bool:
    """Pinocchio reads the same bodies and joints from the file as are in the model: what differs is lost in computing.

    The models are compared, not their results: where long levers cancel, the last digit of a placement becomes the
    fifth of a torque.
    """
    here, there = (
        _parts(pinocchio, model)
        for pinocchio in (PinocchioModel.from_model(model), PinocchioModel.from_urdf(path, model))
    )
    errors = [relative(there[name], here[name], np.full(len(here[name]), size)) for name, size in SIZES.items()]
    return bool(np.max(errors) <= AGREEMENT.bound)


def _parts(pinocchio: PinocchioModel, model: RobotModel) -> dict[str, Array]:
    """What Pinocchio's model consists of: a row per state and body. Placements are those in the inside body."""
    native, data = pinocchio.native, pinocchio.data
    rows = []
    for q in _case(model).q[:, None]:
        pinocchio.rnea(q, 0 * q, 0 * q)  # places the bodies
        for k in pinocchio.ids:
            body, placement = native.inertias[k], data.liMi[k]
            rows.append((body.mass, body.lever, body.inertia, placement.rotation, placement.translation))
    columns = zip(*rows, strict=True)
    return {name: np.array(column).reshape(len(rows), -1) for name, column in zip(SIZES, columns, strict=True)}


def _case(model: RobotModel) -> Case:
    rng = np.random.default_rng(0)
    q, v = model.random_state(rng, STATES)
    a, tau = rng.uniform(-10, 10, (2, *q.shape))
    return Case("random", model, Placement(), q, v, a, tau, rng.normal(size=(*q.shape, 6)))
