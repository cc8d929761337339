"""`graphdyn excite`: planned motions and what they promise, as a report."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.commands.excite.record import excite_record
from crosscheck.exciting.excited import Excited, PlannedMotion
from crosscheck.report.pictures.parameter_rows import put_key, put_rows, size
from crosscheck.report.pictures.svg import BAR, CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.report import (
    Block,
    Column,
    Facts,
    Group,
    Note,
    Notes,
    Panel,
    Picture,
    Plot,
    Report,
    Row,
    Section,
    Series,
    State,
    Table,
    Verdict,
)
from crosscheck.report.robot_parts import reading_text, robot_picture
from graphdyn import joint_torques
from graphdyn.errors import counted
from graphdyn.excitation import CHECK_RATE, LIMIT_KINDS, ExcitationPlan, FourierBasis, sample_times
from graphdyn.model import unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MAX_NAMED_LINKS = 3
"""Links without shapes that are named, of either kind."""


def collisions_text(found: Excited) -> str:
    """One line on what was checked, and what was found."""
    known = found.collisions
    if known is None:
        return "not looked at (--no-collisions)"
    if not known.meshes:
        return "not looked at: no shapes of links can be read"
    poses = sum(motion.poses for motion in found.motions)
    checked = f"{counted(len(known.meshes), 'link')}, {counted(len(known.pairs), 'pair')}, {poses} poses at 1 kHz"
    near = f" nearer than {1000 * known.margin:g} mm" if known.margin else ""
    hits = ", ".join(f"{hit.name} in {counted(hit.poses, 'pose')}" for hit in found.hits)
    bare = [*known.missing, *known.without_shapes]
    passed = f"; links without shapes pass unchecked: {_some(bare, ', ')}" if bare else ""
    near += f", but for {len(known.near)} pairs that always are," if known.near else ""
    return f"{hits or 'none'}{near} on the meshes ({checked}){passed}"


def collision_sections(found: Excited) -> tuple[Section, ...]:
    """What was left out, and what collides; nothing where all was checked and nothing found."""
    known = found.collisions
    if known is None:
        return ()
    notes = [
        Note(f"{words}: {', '.join(names)}")
        for words, names in (
            (f"Kept from touching alone, because they are always nearer than {1000 * known.margin:g} mm", known.near),
            ("Not checked, because they always collide", known.touching),
            ("Not checked, because the SRDF file disables them", known.disabled),
        )
        if names
    ]
    if known.missing:
        told = [f"{link} ({reason})" for link, reason in known.missing.items()]
        notes.append(Note(f"Not checked, because their shapes cannot be read: {_some(told, '; ')}"))
    if known.without_shapes:
        notes.append(Note(f"Not checked, because the file gives them no shapes: {_some(known.without_shapes, ', ')}"))
    rows = tuple(Row((hit.name, hit.poses, hit.first / CHECK_RATE), "disagrees") for hit in found.hits)
    columns = (Column("links", "name"), Column("poses", "number"), Column("first", "number", "s", ".3f"))
    blocks = (*((Table(columns, rows),) if rows else ()), *((Notes(tuple(notes)),) if notes else ()))
    return (Section("collisions", "Collisions of links", blocks),) if blocks else ()


def _some(told: Sequence[str], between: str) -> str:
    others = [f"and {len(told) - MAX_NAMED_LINKS} others"] if len(told) > MAX_NAMED_LINKS else []
    return between.join([*told[:MAX_NAMED_LINKS], *others])


CURVE_RATE = 100.0
"""[Hz] Rate of the curves."""

DETERMINATION_VERDICTS: dict[str, State] = {"well": "agrees", "roughly": "undecided", "not": "disagrees"}

GAINS_NOTE = (
    "Where torques are measured as motor currents, a common factor on all torques of a joint, its drive gain, is in "
    "all its parameters; no motion shows it, but a known payload on the last link does."
)


MORE_SEEDS = "The best random motion determines the parameters better than the one found: search from more --seeds."


def excite_report(found: Excited, written: Sequence[str]) -> Report:
    """written: names of the files of the motions."""
    name, many = Path(found.robot).name, len(found.motions) > 1
    motions = tuple(
        Section(f"motion-{number}", f"Motion {number}" if many else "Motion", (_limits(motion), _curves(found, motion)))
        for number, motion in enumerate(found.motions, start=1)
    )
    return Report(
        f"{name}: exciting motion",
        _verdict(found),
        (
            Section("plan", "", _overview(found, name, written)),
            *motions,
            _parameters(found),
            *collision_sections(found),
        ),
        record=partial(excite_record, found, written),
    )


def _verdict(found: Excited) -> Verdict:
    if found.hits:
        most = max(found.hits, key=lambda hit: hit.poses)
        margin = found.collisions.margin if found.collisions else 0.0
        words, near = ("LINKS COME TOO NEAR", f" nearer than {1000 * margin:g} mm") if margin else ("LINKS COLLIDE", "")
        return Verdict(
            "disagrees", words, f"{most.name}{near} in {most.poses} of the poses at 1 kHz", f"{words.capitalize()}."
        )
    if found.violated:
        worst = max(found.violated, key=lambda usage: usage.used)
        return Verdict(
            "disagrees",
            "VIOLATES LIMITS",
            f"{worst.kind} of {worst.name}: {100 * worst.used:.4g} % of its limit",
            "The motion violates limits.",
        )
    verdicts = found.plan.verdicts
    words = ", ".join(
        f"{verdicts.count(word)} {meaning}" for word, meaning in _DETERMINATIONS.items() if word in verdicts
    )
    reason = f"of {len(verdicts)} base parameters: {words}"
    return Verdict("agrees", "keeps all limits", reason, "The motion keeps all limits.")


_DETERMINATIONS = {"well": "well determined", "roughly": "roughly", "not": "not"}


def _overview(found: Excited, name: str, written: Sequence[str]) -> tuple[Block, ...]:
    problem, plan = found.problem, found.plan
    basis = problem.basis
    shape = f"Fourier series of {basis.harmonics} harmonics" if isinstance(basis, FourierBasis) else "quintic B-splines"
    if found.motions[0].seed is None:
        shape = "as given"
    seconds = " + ".join(f"{motion.course.duration:g}" for motion in found.motions)
    noise = f"{', '.join(f'{x:.3g}' for x in problem.noise)} {unit_of(problem.torque_model.model.joints, 'N m', 'N')}"
    size = counted(problem.torque_model.model.n_bodies, "joint")
    facts = [
        ("robot", f"{found.robot}: {size}{reading_text(found.locked, found.chain)}"),
        ("motion", f"{seconds} s, {shape}"),
        ("noise", f"{noise}: {found.noise_words}; {problem.rate:g} Hz"),
        ("minimized", found.criterion),
        ("geometric mean σ", f"{100 * plan.geometric_mean:.3g} % of what is unknown before the experiment"),
    ]
    facts += [
        (title, f"geometric mean σ {other.geometric_mean / plan.geometric_mean:.2f} × as large")
        for title, other in _others(found, f"best of {found.random} random").items()
    ]
    if found.encoder is not None:
        of_positions, encoder = found.encoder
        largest = np.abs(encoder.bias / plan.sigma).max()
        scatter = np.exp(np.log(encoder.sigma / plan.sigma).mean())
        said = (
            f"{of_positions.position:g} of positions: standard deviations {scatter:.2f} × σ, bias up to {largest:.2g} σ"
        )
        facts.append(("encoder", said))
    facts.append(("condition number", _conditions(found)))
    facts.append(("collisions", collisions_text(found)))
    if written:
        facts.append(("written to", ", ".join(written)))
    start = found.motions[0].course.motion(np.zeros(1)).q[0]
    return robot_picture(problem.torque_model.model, name, start), Group((Facts(tuple(facts)),))


def _conditions(found: Excited) -> str:
    others = [f"{found.best_random.condition_number:.3g} of the best random motion"] if found.best_random else []
    others += [f"{found.recorded.condition_number:.3g} of the recorded one"] if found.recorded else []
    return ", ".join([f"{found.plan.condition_number:.3g}", *others])


def _limits(motion: PlannedMotion) -> Table:
    """Joints by rows, kinds of limits by columns."""
    used = {(usage.name, usage.kind): 100 * usage.used for usage in motion.usages if usage.kind != "plane"}
    kinds = [kind for kind in LIMIT_KINDS if any(kind == key[1] for key in used)]
    rows = [
        Row((name, *(used.get((name, kind)) for kind in kinds)), _state([used.get((name, kind)) for kind in kinds]))
        for name in dict.fromkeys(key[0] for key in used)
    ]
    for usage in motion.usages:
        if usage.kind == "plane":
            cells = (100 * usage.used, *[None] * (len(kinds) - 1))
            rows.append(Row((usage.name, *cells), _state([100 * usage.used])))
    return Table(
        (Column("joint", "name"), *(Column(kind, "number", "%", ".4g") for kind in kinds)),
        tuple(rows),
        title="Limits used",
        caption="largest part of each limit, at 1 kHz; of positions and planes, 100 % is at the limit",
        failures_first=False,
    )


def _state(used: Sequence[float | None]) -> State:
    return "disagrees" if any(x is not None and x > 100 for x in used) else "plain"


def _curves(found: Excited, motion: PlannedMotion) -> Plot:
    model = found.problem.torque_model.model
    times = sample_times(motion.course.duration, CURVE_RATE)
    q, v, a, _ = motion.course.motion(times)
    names, unit = model.independent_joints, partial(unit_of, model.joints)

    def series(values: Any) -> tuple[Series, ...]:
        return tuple(Series(name, values[:, j], color=j) for j, name in enumerate(names))

    return Plot(
        times,
        "t [s]",
        (
            Panel("position", series(q), unit("rad", "m")),
            Panel("velocity", series(v), unit("rad/s", "m/s")),
            Panel("acceleration", series(a), unit("rad/s²", "m/s²")),
            Panel("torque of the bodies", series(joint_torques(model, q, v, a)), unit("N m", "N")),
        ),
        f"Positions, velocities, accelerations and torques of {model.name} over {motion.course.duration:g} s",
        on=("page",),
    )


def _parameters(found: Excited) -> Section:
    plan = found.plan
    bars = Picture(partial(sigma_bars, found=found), on=("page",))
    sums = len(plan.only_in_sums)
    notes = [Note(GAINS_NOTE)]
    if "not" in plan.verdicts:
        notes.insert(0, Note("Parameters that are not determined need another motion, a longer one, or less noise."))
    if random_is_better(found):
        notes.insert(0, Note(MORE_SEEDS))
    if sums:
        notes.append(Note(f"{sums} parameters of the bodies are determined in sums alone, by whatever motion."))
    return Section("parameters", "What the motion will determine", (_table(found), bars, Notes(tuple(notes))))


def _others(found: Excited, best: str = "best random") -> dict[str, ExcitationPlan]:
    """The plans that are shown beside that of the motions, by their titles."""
    plans = {best: found.best_random, "median random": found.median_random, "recorded": found.recorded}
    return {title: plan for title, plan in plans.items() if plan is not None}


def random_is_better(found: Excited) -> bool:
    """Whether the search has ended in a worse motion than one of those that were drawn for comparison."""
    searched = found.motions[0].seed is not None
    return searched and found.best_random is not None and found.best_random.geometric_mean < found.plan.geometric_mean


ENCODER_COLUMNS = (
    Column("with encoder", "number", "× σ", ".2f", meaning="standard deviation with the noise of the positions too"),
    Column("bias", "number", "× σ", ".2f", meaning="mean error with that noise; more recordings do not reduce it"),
)


def _with_encoder(found: Excited, k: int) -> tuple[float, ...]:
    """Scatter and bias of a base parameter with noise of positions, in its σ."""
    if found.encoder is None:
        return ()
    return found.encoder[1].sigma[k] / found.plan.sigma[k], found.encoder[1].bias[k] / found.plan.sigma[k]


def _table(found: Excited) -> Table:
    plan = found.plan
    others = _others(found)
    rows = []
    for k, name in enumerate(plan.names):
        verdict = plan.verdicts[k]
        ratios = [other.sigma[k] / plan.sigma[k] for other in others.values()]
        known = plan.prior[k] if plan.prior[k] else None
        rows.append(
            Row(
                (name, plan.units[k], known, plan.sigma[k], 100 * plan.relative[k],
                 Verdict(DETERMINATION_VERDICTS[verdict], verdict), *_with_encoder(found, k), *ratios)
            )
        )  # fmt: skip
    return Table(
        (
            Column("base parameter", "name"),
            Column("unit"),
            Column("file", "number", form=".4g", meaning="value in the robot's file"),
            Column("σ", "number", form=".2g", meaning="standard deviation after the experiment"),
            Column("σ", "number", "%", ".2g", "of the file's value, or of the prior spread where that is more"),
            Column("determined", "verdict"),
            *(ENCODER_COLUMNS if found.encoder else ()),
            *(Column(title, "number", "× σ", ".2f", from_width=100) for title in others),
        ),
        tuple(rows),
        caption="for independent errors of the torques with the given noise; × σ: how many times as large with others",
        failures_first=False,
    )


MAX_AXIS_PERCENT = 1e4
"""[%] Largest end of the axis: beyond, nothing is determined."""


MARKERS = {"best": ("o", CURVES[1]), "median": ("x", CURVES[2]), "recorded": ("s", CURVES[3])}
"""Marker and color of each of the other motions, by the first word of its title."""


def sigma_bars(key: str, found: Excited) -> Markup:
    count = len(found.plan.sigma)
    label = f"Standard deviations of {count} base parameters, in percent of their size, beside other motions"
    return picture(key, label, size(count), lambda axes: _draw(axes, found))


def _draw(axes: Axes, found: Excited) -> None:
    plan = found.plan
    scale = np.maximum(np.abs(plan.prior), plan.spread)
    own = 100 * plan.relative
    others = {
        title: 100 * other.sigma / scale for title, other in _others(found, f"best of {found.random} random").items()
    }
    there = np.concatenate([own, *others.values()])
    there = there[np.isfinite(there)]
    reach = (there.min() / 2, min(2 * there.max(), MAX_AXIS_PERCENT)) if there.size else (1.0, MAX_AXIS_PERCENT)
    axes.set(xscale="log", xlim=reach)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    put_rows(axes, plan.names)
    axes.tick_params(labelsize=8)
    axes.grid(axis="x", color=FAINT_COLOR, linewidth=0.5)
    axes.set_axisbelow(True)
    y = np.arange(len(plan.sigma)) + 0.5
    left = reach[0]
    axes.barh(y, np.minimum(own, reach[1]) - left, left=left, height=0.6, color=BAR, label="this motion")
    for title, values in others.items():
        marker, color = MARKERS[title.split()[0]]
        hollow = "none" if marker != "x" else color
        axes.plot(values, y, linestyle="", marker=marker, markersize=4.5, mfc=hollow, mec=color, mew=1.1, label=title)
    axes.set_xlabel("σ [% of the parameter's size]", fontsize=9, color=INK)
    put_key(axes, 4)
