"""Torques of a joint that depend on its own position or velocity alone."""

import numpy as np
from calls.planted import plant

import graphdyn

KIND = "joint torques"


def _adding(torque):
    """torque: q, v → added torques (n,)."""
    return {
        "inverse_dynamics": lambda model: lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau + torque(q, v),
        "gravity_torque": lambda model: lambda q: graphdyn.gravity_torque(model, q) + torque(q, 0 * q),
        "bias_torque": lambda model: lambda q, v: graphdyn.bias_torque(model, q, v) + torque(q, v),
        "forward_dynamics": lambda model: (
            lambda q, v, tau: graphdyn.forward_dynamics(model, q, v, tau - torque(q, v)).a
        ),
    }


def at(k, f):
    """A torque at joint k alone."""

    def torque(q, v):
        added = np.zeros(len(q))
        added[k] = f(q[k], v[k])
        return added

    return torque


def stribeck(v, dry=8.0, breakaway=12.0, speed=0.3, viscous=4.0):
    return np.sign(v) * (dry + (breakaway - dry) * np.exp(-((v / speed) ** 2))) + viscous * v


def wire(q, stiffness=2000.0, lever=0.1, height=0.5, length=0.35, offset=0.3):
    """The torque of a spring between a point of the inside link and a crank."""
    x = np.sqrt(lever**2 + height**2 - 2 * lever * height * np.cos(q - offset))
    return stiffness * (x - length) * lever * height * np.sin(q - offset) / x


NAMES = {
    "Stribeck with sign": (lambda q, v: stribeck(v), "Stribeck|velocity of joint", False),
    "Stribeck, linear exponent": (
        lambda q, v: np.sign(v) * (3 + 2 * np.exp(-abs(v) / 0.2)) + v,
        "Stribeck|velocity of joint",
        True,
    ),
    "square of the velocity": (lambda q, v: 2.0 * v * abs(v), "velocity of joint", True),
    "friction, other in either direction": (
        lambda q, v: 4.0 * (v > 0) - 3.0 * (v < 0) + np.where(v > 0, 1.5, 2.5) * v,
        "velocity of joint|friction",
        True,
    ),
    "compensator k sin": (lambda q, v: -35.0 * np.sin(q - 0.4), "position of joint|spring|sin|cos", False),
    "wire spring": (lambda q, v: wire(q), "position of joint|spring", False),
    "end stop": (lambda q, v: 50.0 * np.maximum(0, q - 1.8), "position of joint|spring", False),
    "cubic spring": (lambda q, v: 5.0 * q + 2.0 * q**3, "position of joint|spring", True),
    "cogging": (lambda q, v: 0.8 * np.sin(12 * q + 0.5), "position of joint|sin|cos|ripple", True),
    "two harmonics": (
        lambda q, v: 3 * np.cos(q) + 1.5 * np.sin(2 * q) + 4,
        "position of joint|sin|cos",
        True,
    ),
    "magnetic detents": (lambda q, v: np.exp(-((q - 1) ** 2) / 0.01) * 6, "position of joint", True),
}

for name, (f, truth, aside) in NAMES.items():
    for function in ("inverse_dynamics", "forward_dynamics"):
        for k in (1,) if function == "forward_dynamics" else (1, 4):
            plant(KIND, f"{name} at joint {k + 1}", function, truth, aside=aside)(_adding(at(k, f))[function])
for name in ("compensator k sin", "wire spring", "cogging"):
    f, truth, aside = NAMES[name]
    plant(KIND, name, "gravity_torque", truth, aside=aside)(_adding(at(1, f))["gravity_torque"])
    plant(KIND, name, "bias_torque", truth, aside=True)(_adding(at(2, f))["bias_torque"])


@plant(KIND, "Stribeck with sign at every joint", "inverse_dynamics", "Stribeck")
def _every(model):
    return lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau + stribeck(v) * np.linspace(1, 0.2, len(q))


@plant(KIND, "two springs", "inverse_dynamics", "position of joint|spring", aside=True)
def _two(model):
    return lambda q, v, a: (
        graphdyn.inverse_dynamics(model, q, v, a).tau
        + at(1, NAMES["wire spring"][0])(q, v)
        + at(2, NAMES["end stop"][0])(q, v)
    )


@plant(KIND, "spring and Stribeck at one joint", "inverse_dynamics", "joint", aside=True)
def _sum(model):
    return lambda q, v, a: (
        graphdyn.inverse_dynamics(model, q, v, a).tau + at(1, lambda q, v: wire(q) + stribeck(v))(q, v)
    )
