"""Torque models to be compared, each also with CAD links and the same drives, which every fit has to outperform."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from numpy.typing import ArrayLike

from crosscheck.identifying.methods.methods import STANDARD_METHODS, method_named
from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES, friction_terms
from graphdyn import InvalidInput, RobotModel
from graphdyn.display import short_repr
from graphdyn.identification import Estimator, TorqueModel, WeightedLeastSquares
from graphdyn.identification.terms import CarriesBodies, KnownBodies, KnownTerm, Offset, RigidBodies, Term

CAD_NAME = "CAD links"


@dataclass(frozen=True, eq=False)
@short_repr
class CandidateModel:
    """A torque model and the methods that identify it.

    name: for tables; may be empty if there is only one
    terms: unknown parts of the torque; known: known parts, which are subtracted
    methods: names (METHODS) or estimators
    cad_of: as in IdentifiedModel
    expected, noise, exact_angles: as in TorqueModel
    choose_drives: whether the recording is to choose terms of the drives, in addition to `terms`
        (crosscheck.identifying.choosing); until it has, they are viscous and Coulomb friction and offsets
    """

    name: str
    terms: Sequence[Term]
    known: Sequence[KnownTerm] = ()
    methods: Sequence[str | Estimator] = STANDARD_METHODS
    cad_of: str | None = None
    expected: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noise: ArrayLike | None = None
    choose_drives: bool = False
    exact_angles: bool = True

    @property
    def estimators(self) -> list[Estimator]:
        """The methods, those that are given by name as well. Raises InvalidInput for an unknown name."""
        return [method_named(method) if isinstance(method, str) else method for method in self.methods]

    def of(self, robot: RobotModel) -> TorqueModel:
        """The torque model of a robot."""
        expected, drives = self.expected, friction_terms(STANDARD_TERM_NAMES) if self.choose_drives else ()
        if self.cad_of is not None:  # of the drives; the links are known
            symbols = {column.symbol for column in TorqueModel(robot, self.terms).columns}
            expected = {symbol: value for symbol, value in expected.items() if symbol in symbols}
        return TorqueModel(robot, (*self.terms, *drives), self.known, expected, self.noise, self.exact_angles)


def with_links_of_cad(models: Sequence[CandidateModel]) -> list[CandidateModel]:
    """Each model followed by that with known links, unless they are known already.

    Raises InvalidInput without a model, and for two of the same name.
    """
    names = [model.name for model in models]
    twice = [name for name in names if names.count(name) > 1]
    if twice or not names:
        what = f"two torque models are called '{twice[0]}'" if twice else "there is no torque model"
        raise InvalidInput(f"{what}; give at least one, each with a name of its own")
    everything = []
    for model in models:
        everything.append(model)
        if any(isinstance(term, RigidBodies) for term in model.terms):
            drives = tuple(term for term in model.terms if not isinstance(term, CarriesBodies)) or (Offset(),)
            name, known = f"{model.name}, {CAD_NAME}" if model.name else CAD_NAME, (KnownBodies(), *model.known)
            methods = (WeightedLeastSquares(),)
            everything.append(CandidateModel(name, drives, known, methods, model.name, model.expected, model.noise))
    return everything
