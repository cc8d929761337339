"""States of a robot, what graphdyn answers there, and the sizes that errors are relative to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

import graphdyn
from crosscheck.quantities.scales import Sizes, largest, term_sizes
from crosscheck.quantities.states import Case
from graphdyn import ForwardDynamics, MaximalState, RobotModel, maximal_state
from graphdyn.arguments import Method
from graphdyn.equations import link_origins
from graphdyn.layout import Array
from graphdyn.verbs import VERBS

METHODS: tuple[Method, ...] = ("dense", "projected", "recursive")


@dataclass(frozen=True, eq=False)
class ScaledStates:
    """N states of a robot. The sizes of errors come from graphdyn, or from a reference implementation in a subclass.

    q, v, a, tau: joint states, torques of forward dynamics  (N, n)
    loads: external wrenches, None where functions are called without   (N, n, 6)
    frame: the link of functions of one frame, None where there is no such function
    """

    model: RobotModel
    q: Array
    v: Array
    a: Array
    tau: Array
    loads: Array | None = None
    frame: str | None = None
    _answers: dict[object, Any] = field(init=False, default_factory=dict, repr=False)

    @classmethod
    def at(cls, case: Case) -> ScaledStates:
        """The states of a case, with its external wrenches; torques of zero where none are given."""
        tau = np.zeros_like(case.q) if case.tau is None else case.tau
        return ScaledStates(case.model, case.q, case.v, case.a, tau, case.external_wrenches)

    @property
    def motion(self) -> MaximalState:
        """graphdyn's maximal_state."""
        found: MaximalState = self.once("motion", lambda: maximal_state(self.model, self.q, self.v, self.a))
        return found

    @property
    def origins(self) -> Array:
        """Origins of the links, in the world (N, n, 3)."""
        found: Array = self.once("origins", lambda: link_origins(self.motion))
        return found

    @property
    def rotations(self) -> Array:
        """Rotations of the links, in the world (N, n, 3, 3)."""
        return self.motion.rotation

    @property
    def body_velocities(self) -> Array:
        """ṙ of the centers of mass in world axes, ω in body axes (N, n, 6)."""
        return self.motion.velocity

    @property
    def body_accelerations(self) -> Array:
        """r̈ of the centers of mass in world axes, ω̇ in body axes, at a (N, n, 6)."""
        assert self.motion.acceleration is not None
        return self.motion.acceleration

    @property
    def wrenches(self) -> Array:
        """Joint wrenches at a, with the external wrenches (N, n, 6)."""
        found: Array = self.answer("inverse_dynamics", loaded=True).joint_wrenches
        return found

    @property
    def mass(self) -> Array:
        """M (N, n, n)."""
        found: Array = self.answer("mass_matrix")
        return found

    @property
    def solved(self) -> tuple[Array, Array, Array]:
        """Accelerations at tau, with the external wrenches (N, n), body accelerations and joint wrenches (N, n, 6)."""
        found: ForwardDynamics = self.answer("forward_dynamics", loaded=True)
        wrenches = self.once("wrenches of the solution", lambda: self.required(found.a)[1])
        return found.a, found.body_accelerations, wrenches

    def required(self, a: Array) -> tuple[Array, Array]:
        """Torques (N, n) and joint wrenches (N, n, 6) of other accelerations, with the external wrenches."""
        found = graphdyn.inverse_dynamics(self.model, self.q, self.v, a, self.loads)
        return found.tau, found.joint_wrenches

    @property
    def all_loads(self) -> Array:
        """External wrenches, zeros where there are none (N, n, 6)."""
        return np.zeros((*self.q.shape, 6)) if self.loads is None else self.loads

    @cached_property
    def sizes(self) -> Sizes:
        """Sizes of the summed terms, at a."""
        return self._with_loads(
            term_sizes(self.model, self.v, self.a, self.origins, self.body_velocities, self.body_accelerations)
        )

    @cached_property
    def solved_sizes(self) -> Sizes:
        """Sizes of the summed terms, at the accelerations that belong to tau."""
        a, body_accelerations, _ = self.solved
        return self._with_loads(
            term_sizes(self.model, self.v, a, self.origins, self.body_velocities, body_accelerations)
        )

    def _with_loads(self, sizes: Sizes) -> Sizes:
        return sizes if self.loads is None else sizes.loaded(self.loads)

    def answer(self, verb: str, method: Method = "auto", *, loaded: bool = False, **options: Any) -> Any:
        """What a verb of graphdyn answers, computed once. loaded: with the external wrenches; options: its keywords"""

        def compute() -> Any:
            given = [getattr(self, name) for name in VERBS[verb].inputs]
            given += [self.loads] if loaded and self.loads is not None else []
            return getattr(graphdyn, verb)(self.model, *given, method=method, **options)

        return self.once((verb, method, loaded, *sorted(options.items())), compute)

    def by_methods(self, verb: str, *, loaded: bool = False) -> list[Any]:
        """What a verb answers by each method. loaded: with the external wrenches"""
        return [self.answer(verb, method, loaded=loaded) for method in METHODS]

    def once(self, key: object, compute: Callable[[], Any]) -> Any:
        """What a function answers that is called where the key is new."""
        if key not in self._answers:
            self._answers[key] = compute()
        return self._answers[key]

    def largest_wrench(self, v: Array, loads: Array | None = None) -> Array:
        """Largest entry of the joint wrenches at these velocities and without acceleration (N,)."""
        at_rest = graphdyn.inverse_dynamics(self.model, self.q, v, np.zeros_like(v), loads)
        return largest(at_rest.joint_wrenches)
