"""Numbers that are clipped, and states that are refused."""

import numpy as np
from calls.planted import frame_of, plant

import graphdyn

KIND = "clipped"


def _level(function, model, share, count=200):
    """A limit per entry that some of the answers are beyond."""
    rng = np.random.default_rng(99)
    q, v = model.random_state(rng, count)
    a = rng.uniform(-5, 5, q.shape)
    answers = [np.abs(function(*x)) for x in zip(q, v, a, strict=True)]
    return np.quantile(answers, share, axis=0)


def _answers(model, name):
    frame = frame_of(model)
    return {
        "inverse_dynamics": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau,
        "forward_dynamics": lambda q, v, tau: graphdyn.forward_dynamics(model, q, v, tau).a,
        "gravity_torque": lambda q: graphdyn.gravity_torque(model, q),
        "bias_torque": lambda q, v: graphdyn.bias_torque(model, q, v),
        "frame_velocity": lambda q, v: graphdyn.frame_velocity(model, q, v, frame, reference="local"),
        "kinetic_energy": lambda q, v: graphdyn.kinetic_energy(model, q, v),
        "power": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau * v,
        "momentum": lambda q, v: graphdyn.momentum(model, q, v).about_center_of_mass,
        "center_of_mass": lambda q: graphdyn.center_of_mass(model, q),
        "coriolis_matrix": lambda q, v: graphdyn.coriolis_matrix(model, q, v),
    }[name]


for name, aside in (
    ("inverse_dynamics", False), ("gravity_torque", False), ("bias_torque", True), ("frame_velocity", False),
    ("kinetic_energy", False), ("power", True), ("momentum", True), ("center_of_mass", True),
    ("coriolis_matrix", False),
):  # fmt: skip

    def _clipped(model, name=name):
        f = _answers(model, name)
        arity = f.__code__.co_argcount
        limit = _level(lambda *x: f(*x[:arity]), model, 0.9)
        return lambda *x: np.clip(f(*x), -limit, limit)

    plant(KIND, "answers", name, "clipped|cut off", aside=aside)(_clipped)


@plant(KIND, "accelerations at 50", "forward_dynamics", r"clipped.*\b50\b")
def _accelerations(model):
    f = _answers(model, "forward_dynamics")
    return lambda q, v, tau: np.clip(f(q, v, tau), -50, 50)


@plant(KIND, "one acceleration at 120, one side", "forward_dynamics", r"clipped.*\b120\b", aside=True)
def _acceleration(model):
    f = _answers(model, "forward_dynamics")
    upper = np.where(np.arange(model.n_bodies) == 3, 120.0, np.inf)
    return lambda q, v, tau: np.minimum(f(q, v, tau), upper)


@plant(KIND, "torques of forward dynamics", "forward_dynamics", "torque.*clipped")
def _torques(model):
    f = _answers(model, "forward_dynamics")
    limit = _level(lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau, model, 0.8)
    return lambda q, v, tau: f(q, v, np.clip(tau, -limit, limit))


@plant(KIND, "torque of joint 2 of forward dynamics", "forward_dynamics", "torque.*clipped", aside=True)
def _torque(model):
    f = _answers(model, "forward_dynamics")
    limit = _level(lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau, model, 0.6)
    limit = np.where(np.arange(model.n_bodies) == 1, limit, np.inf)
    return lambda q, v, tau: f(q, v, np.clip(tau, -limit, limit))


def _speeds(model):
    return np.array([joint.limits.velocity or 2.0 for joint in model.joints])


for name, aside in (("inverse_dynamics", False), ("frame_velocity", False), ("forward_dynamics", True),
                    ("momentum", True), ("coriolis_matrix", True)):  # fmt: skip

    @plant(KIND, "velocities at 70 %", name, "velocit.*clipped|v.*clipped", aside=aside)
    def _velocities(model, name=name):
        f, limit = _answers(model, name), 0.7 * _speeds(model)
        return lambda q, v, *x: f(q, np.clip(v, -limit, limit), *x)

    @plant(KIND, "velocities at limits", name, "velocit.*clipped|v.*clipped", aside=aside, beyond_limits=True)
    def _velocities_at_limits(model, name=name):
        f, limit = _answers(model, name), _speeds(model)
        return lambda q, v, *x: f(q, np.clip(v, -limit, limit), *x)


@plant(KIND, "accelerations of inverse dynamics at 4", "inverse_dynamics", "acceleration.*clipped|a.*clipped")
def _given_accelerations(model):
    f = _answers(model, "inverse_dynamics")
    return lambda q, v, a: f(q, v, np.clip(a, -4, 4))


@plant(KIND, "answers scaled down", "forward_dynamics", "scaled down|clipped", aside=True)
def _scaled_down(model):
    f = _answers(model, "forward_dynamics")

    def forward_dynamics(q, v, tau):
        a = f(q, v, tau)
        return a * min(1.0, 80 / max(np.abs(a).max(), 1e-300))

    return forward_dynamics


def _bounds(model):
    lower = [x.limits.lower if x.limits.lower is not None and x.kind != "continuous" else -np.inf for x in model.joints]
    upper = [x.limits.upper if x.limits.upper is not None and x.kind != "continuous" else np.inf for x in model.joints]
    return np.array(lower), np.array(upper)


for name, aside in (("inverse_dynamics", False), ("gravity_torque", True), ("frame_velocity", True)):

    @plant("refusal", "raises beyond positions", name, "beyond the (position limits|limits of positions)",
           aside=aside, beyond_limits=True)  # fmt: skip
    def _raises(model, name=name):
        f, (lower, upper) = _answers(model, name), _bounds(model)

        def refusing(q, *x):
            if (q < lower).any() or (q > upper).any():
                raise ValueError("out of limits")
            return f(q, *x)

        return refusing

    @plant("refusal", "NaN beyond positions", name, "beyond the (position limits|limits of positions)",
           aside=aside, beyond_limits=True)  # fmt: skip
    def _nan(model, name=name):
        f, (lower, upper) = _answers(model, name), _bounds(model)
        return lambda q, *x: f(q, *x) * (1.0 if (q >= lower).all() and (q <= upper).all() else np.nan)


@plant("refusal", "raises beyond velocities", "inverse_dynamics", "beyond the velocity limits", beyond_limits=True)
def _fast(model):
    f, speed = _answers(model, "inverse_dynamics"), _speeds(model)

    def refusing(q, v, a):
        if (np.abs(v) > speed).any():
            raise ValueError("too fast")
        return f(q, v, a)

    return refusing


@plant("refusal", "raises beyond either", "frame_velocity", "beyond the .*limits", aside=True, beyond_limits=True)
def _both(model):
    f, speed, (lower, upper) = _answers(model, "frame_velocity"), _speeds(model), _bounds(model)

    def refusing(q, v):
        if (np.abs(v) > speed).any() or (q < lower).any() or (q > upper).any():
            raise ValueError("out of limits")
        return f(q, v)

    return refusing


@plant("refusal", "raises at or beyond positions", "gravity_torque", "beyond the position limits", aside=True,
       beyond_limits=True)  # fmt: skip
def _at(model):
    f, (lower, upper) = _answers(model, "gravity_torque"), _bounds(model)

    def refusing(q):
        if (q <= lower).any() or (q >= upper).any():
            raise ValueError("out of limits")
        return f(q)

    return refusing


@plant("refusal", "NaN beyond joint 2", "inverse_dynamics", "beyond the position limits", aside=True,
       beyond_limits=True)  # fmt: skip
def _second(model):
    f, (lower, upper) = _answers(model, "inverse_dynamics"), _bounds(model)
    return lambda q, v, a: f(q, v, a) * (1.0 if lower[1] <= q[1] <= upper[1] else np.nan)
