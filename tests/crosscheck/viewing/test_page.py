"""The player in headless Chromium: what it draws and shows against graphdyn's numbers, and that it asks nobody."""

import numpy as np
import pytest
from random_trees import random_tree
from shown.browser import CHROMIUM
from shown.driven_browser import DrivenBrowser

from crosscheck.recordings import Recording
from crosscheck.viewing.figures import Figure, ShownRobot
from crosscheck.viewing.motions import closed_instant, recorded_motion
from crosscheck.viewing.page import page
from crosscheck.viewing.robots import stand_ins
from graphdyn import Body, Chord, Coupling, Joint, Placement, RobotModel, inverse_dynamics, maximal_state
from graphdyn.layout import ANGULAR, LINEAR

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")

DRAWN = 1e-6
"""Relative error of what is drawn: three.js draws with 32-bit numbers, 6e-8 each."""

PIXEL = 0.51
"""A bar of the legend is a whole number of pixels long."""

HAND = [0.3, -0.7, 0.2, 1.1, -0.4, 0.6]

PICTURE = """(() => {
  const gl = player.stage.renderer.getContext(), size = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = (t) => {
    player.seek(t);
    const found = new Uint8Array(4 * size[0] * size[1]);
    gl.readPixels(0, 0, ...size, gl.RGBA, gl.UNSIGNED_BYTE, found);
    return found;
  };
  const changed = (a, b) => a.filter((x, i) => Math.abs(x - b[i]) > 20).length;
  const [first, later, again] = [0, 0.2, 0].map(pixels);
  return [new Set(first).size, changed(first, later), changed(first, again)];
})()"""


def moving_tree():
    """Six joints of all kinds on two branches, one of them driven by two others, mounted anywhere."""
    kinds = ("revolute", "prismatic", "continuous", "revolute", "prismatic", "revolute")
    tree = random_tree(5, (0, 1, 2, 1, 4, 5), kinds)
    coupling = Coupling("joint6", {"joint1": -0.5, "joint4": 2.0}, 0.3)
    return RobotModel(
        tree.name, tree.bodies, tree.joints, tree.gravity, tree.base, frames=tree.frames, couplings=(coupling,)
    )


def four_bar():
    """A parallelogram with a motor at its crank: crank and rocker on the ground, a coupler, a hinge that closes it."""
    names, inside = ("crank", "coupler", "rocker"), (0, 1, 0)
    places = [np.zeros(3), np.array([0.5, 0.0, 0.0]), np.array([1.0, 0.0, 0.0])]
    bodies = [Body(name, 1.0, np.array([0.2, 0.0, 0.0]), np.eye(3) * 0.01) for name in names]
    joints = [
        Joint(name, "revolute", i, Placement(translation=place), np.array([0.0, 1.0, 0.0]))
        for name, i, place in zip(names, inside, places, strict=True)
    ]
    ends = Placement(translation=np.array([1.0, 0, 0])), Placement(translation=np.array([0.5, 0, 0]))
    chord = Chord("pin", "hinge", 2, ends[0], 3, ends[1], np.array([0.0, 1.0, 0.0]))
    return RobotModel("four_bar", bodies, joints, chords=(chord,), actuated=("crank",))


@pytest.fixture(scope="module")
def figures():
    """One that moves, one that stands, one with a loop."""
    tree, arm = moving_tree(), random_tree(8, (0, 1, 2), ("revolute", "prismatic", "continuous"))
    rng = np.random.default_rng(7)
    q, v, a = (size * rng.uniform(-1, 1, (11, tree.nv)) for size in (1, 2, 5))
    tau = inverse_dynamics(tree, q, v, a).tau + 1.0
    recording = Recording(tree.independent_joints, np.linspace(0.5, 0.7, 11), q, v, a, tau)
    moving = Figure("tree", ShownRobot(tree, stand_ins(tree)), *recorded_motion(tree, recording))
    bar = four_bar()
    standing = Figure("arm", ShownRobot(arm, stand_ins(arm), collision=stand_ins(arm)[:1]))
    return recording, (moving, standing, Figure("bar", ShownRobot(bar, stand_ins(bar)), *closed_instant(bar)))


@pytest.fixture(scope="module")
def shown(figures, tmp_path_factory):
    """The browser with the page of the figures, ready."""
    folder = tmp_path_factory.mktemp("view")
    file = folder / "view.html"
    file.write_text(page("a tree & <an arm>", figures[1]), encoding="utf-8")
    with DrivenBrowser(folder / "profile") as browser:
        browser.open(file.as_uri())
        yield browser


def drawn(browser, figure):
    """Placements (n, 4, 4) and arrows (2, n, 2, 3) as drawn, without the shift that sets robots apart."""
    matrices, arrows, shift = browser.value(
        f"""(() => {{
          const figure = player.figures[{figure}];
          return [
            figure.bodies.map((body) => body.matrixWorld.elements),
            ["force", "moment"].map((kind) => figure.robot.joints.map((_, j) => figure.arrow(kind, j))),
            figure.place.position.toArray(),
          ];
        }})()"""
    )
    placements = np.array(matrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    placements[:, :3, 3] -= shift
    return placements, np.array(arrows) - shift


def check(browser, number, model, state, loads):
    """Everything drawn of one figure against the maximal state, and inverse dynamics at one instant."""
    placements, arrows = drawn(browser, number)
    rotation = state.rotation
    origins = state.position - np.einsum("iab,ib->ia", rotation, [body.center_of_mass for body in model.bodies])
    size = max(1.0, np.abs(origins).max())
    assert np.abs(placements[0, :3, :3] - model.base.rotation).max() < DRAWN
    assert np.abs(placements[1:, :3, :3] - rotation).max() < DRAWN
    assert np.abs(placements[1:, :3, 3] - origins).max() < DRAWN * size
    scales = browser.value("player.scales()")
    for kind, part, ends in zip(("force", "moment"), (LINEAR, ANGULAR), arrows, strict=True):
        vectors = scales[kind] * np.einsum("iab,ib->ia", rotation, loads.joint_wrenches[:, part])
        size = max(1.0, np.abs(vectors).max() + np.abs(origins).max())
        assert np.abs(vectors).max() > 0.01
        assert np.abs(ends[:, 0] - origins).max() < DRAWN * size
        assert np.abs(ends[:, 1] - origins - vectors).max() < DRAWN * size
    tau = np.array(browser.value(f"player.figures[{number}].shown.tau"))
    assert np.abs(tau - loads.tau).max() < DRAWN * np.abs(loads.joint_wrenches).max()


@pytest.mark.parametrize("row", [0, 4, 10])
def test_recorded_instants(shown, figures, row):
    recording, (figure, *_) = figures
    model = figure.robot.model
    shown.value(f"player.seek({float(recording.t[row] - recording.t[0])})")
    loads = inverse_dynamics(model, recording.q[row], recording.v[row], recording.a[row])
    check(shown, 0, model, maximal_state(model, recording.q[row]), loads)
    recorded = shown.value("player.figures[0].shown.recorded")
    assert np.abs(recorded - recording.tau[row]).max() < DRAWN * np.abs(recording.tau[row]).max()


@pytest.mark.parametrize("number", [0, 1])
def test_by_hand(shown, figures, number):
    """Positions of the sliders, with the loads of gravity."""
    model = figures[1][number].robot.model
    q = HAND[: model.nv]
    shown.value(f"player.figures[{number}].hand = {q}; player.draw()")
    loads = inverse_dynamics(model, q, np.zeros_like(q), np.zeros_like(q))
    check(shown, number, model, maximal_state(model, q), loads)


def test_a_slider(shown, figures):
    """Moving one moves its joint, and the joint that it drives."""
    model = figures[1][0].robot.model
    shown.value("player.seek(0)")
    before = np.array(shown.value("player.figures[0].shown.q"))
    shown.value(
        """(() => {
          const sliders = document.querySelectorAll("#rows input");
          sliders[3].value = 0.25;
          sliders[3].dispatchEvent(new Event("input"));
        })()"""
    )
    expected = model.joint_positions([*before[:3], 0.25, before[4]])
    numbers = [
        float(x.replace("−", "-"))
        for x in shown.value(
            "[...document.querySelectorAll('#rows tr')].map((row) => row.querySelector('output').textContent)"
        )
    ]
    assert np.abs(numbers - expected).max() < 1e-3
    assert shown.value("document.querySelectorAll('#rows input')[5].disabled")
    assert shown.value("document.getElementById('state').textContent") == "Pose set by hand: static gravity loads."


@pytest.mark.parametrize(
    ("massless", "said", "torques", "legend"),
    [
        ([1, 2, 3], "no loads, because links have no mass", "–––", 1),
        ([2], "static gravity loads, without the links that have no mass", "––0", 4),
    ],
)
def test_torques_that_miss_a_link_are_not_shown(tmp_path, massless, said, torques, legend):
    """Of a robot without any mass the legend tells no size of forces."""
    chain = random_tree(8, (0, 1, 2), ("revolute", "revolute", "revolute"))
    bodies = [
        Body(body.name, 0.0, np.zeros(3), np.zeros((3, 3))) if k in massless else body
        for k, body in enumerate(chain.bodies, 1)
    ]
    robot = ShownRobot(RobotModel("light", bodies, chain.joints, chain.gravity), stand_ins(chain), ("no mass",))
    file = tmp_path / "view.html"
    file.write_text(page("light", [Figure("light", robot)]), encoding="utf-8")
    with DrivenBrowser(tmp_path / "profile") as browser:
        browser.open(file.as_uri())
        assert browser.value("document.getElementById('noted').open")
        assert browser.value("document.getElementById('state').textContent") == f"Pose set by hand: {said}."
        torque = "row.querySelectorAll('output')[1].textContent"
        shown = browser.value(f"[...document.querySelectorAll('#rows tr')].map((row) => {torque})")
        assert ["–" if one == "–" else "0" for one in shown] == list(torques)
        assert browser.value("document.querySelectorAll('#legend div').length") == legend


def test_what_is_asked_of_a_server(shown, figures):
    """To let go from the pose that is shown, which is said where there is no answer; the figure that is chosen."""
    q = HAND[: figures[1][1].robot.model.nv]
    kept, said = shown.value(
        f"""(async () => {{
          const kept = [], usual = window.fetch, chosen = document.getElementById("figure");
          const choose = (k) => {{ chosen.selectedIndex = k; chosen.dispatchEvent(new Event("change")); }};
          window.fetch = async (name, {{ body }}) => {{
            kept.push([name, JSON.parse(body)]);
            return {{ ok: false, text: async () => "it breaks" }};
          }};
          choose(1);
          player.figures[1].hand = {q};
          player.draw();
          await player.letGo();
          const said = document.getElementById("state").textContent;
          window.fetch = usual;
          choose(0);
          return [kept, said];
        }})()"""
    )
    assert kept == [["let-go", {"figure": 1, "q": q, "seconds": 5}]]
    assert said == "No motion: it breaks"


def test_a_loop(shown, figures):
    """It is drawn closed, and nothing moves it by hand; what statics leaves open is drawn nowhere."""
    bar = figures[1][2]
    shown.value("player.seek(0)")
    ends = shown.value(
        """player.figures[2].layers.chords.map((end) => {
          const place = end.getWorldPosition(new THREE.Vector3());
          return place.sub(player.figures[2].place.position).toArray();
        })"""
    )
    state = maximal_state(bar.robot.model, bar.motion.q[0])
    expected = state.position[1] + state.rotation[1] @ [0.8, 0.0, 0.0]  # 1 m from its joint, 0.8 m from its center
    assert np.abs(np.array(ends) - expected).max() < DRAWN
    shown.value(
        """(() => {
          document.getElementById("figure").selectedIndex = 2;
          document.getElementById("figure").dispatchEvent(new Event("change"));
        })()"""
    )
    assert shown.value("[...document.querySelectorAll('#rows input')].map((slider) => slider.disabled)") == [True] * 3
    assert np.isfinite(drawn(shown, 2)[1]).all()
    shown.value(
        """(() => {
          document.getElementById("figure").selectedIndex = 0;
          document.getElementById("figure").dispatchEvent(new Event("change"));
        })()"""
    )


def test_curves_of_multipliers(shown, figures):
    recording, (figure, *_) = figures
    model = figure.robot.model
    found = np.array(
        shown.value(
            """player.figures[0].robot.joints.map(({ name }) => {
              const found = quantities(player.figures[0]).find(([title]) => title === `multipliers of ${name}`);
              return Object.values(found[2]());
            })"""
        )
    )
    expected = inverse_dynamics(model, recording.q, recording.v, recording.a).multipliers
    assert np.abs(found.transpose(2, 0, 1) - expected).max() < DRAWN * np.abs(expected).max()


def test_curves(shown, figures):
    """Torques of the bodies and as recorded, positions, sizes of reactions, over all instants."""
    recording, (figure, *_) = figures
    loads = inverse_dynamics(figure.robot.model, recording.q, recording.v, recording.a)
    forces, moments = (np.linalg.norm(loads.joint_wrenches[..., part], axis=-1) for part in (LINEAR, ANGULAR))
    expected = {
        "torque of the rigid bodies": loads.tau, "torque, recorded": recording.tau, "position": recording.q,
        "reaction force": forces, "reaction moment": moments,
    }  # fmt: skip
    for title, values in expected.items():
        found = shown.value(f"Object.values(quantities(player.figures[0]).find(([title]) => title === {title!r})[2]())")
        assert np.abs(np.transpose(found) - values).max() < DRAWN * np.abs(values).max(), title


def test_the_chosen_quantity_is_drawn_when_a_figure_is_chosen(shown, figures):
    """The legend has the names of its curves."""
    labels = shown.value(
        """(() => {
          const of = (id) => document.getElementById(id);
          of("quantity").value = `multipliers of ${player.figures[0].robot.joints[0].name}`;
          of("figure").selectedIndex = 0;
          of("figure").dispatchEvent(new Event("change"));
          return [...document.querySelectorAll("#chart .u-legend .u-label")].map((label) => label.textContent);
        })()"""
    )
    assert [label.split()[0] for label in labels[-5:]] == ["λ₁", "λ₂", "λ₃", "λ₄", "λ₅"]


def test_shafts_begin_and_heads_end_at_their_places(shown):
    """Lowest and highest points along arrows of length 1, before they are moved."""
    found = shown.value(
        """new Arrows(1, 0, 0.01, 2, new THREE.Group()).parts.map(({ geometry }) => {
          geometry.computeBoundingBox();
          return [geometry.boundingBox.min.y, geometry.boundingBox.max.y];
        })"""
    )
    assert found == [[0, 1], [-1, 0], [-1, 0]]


@pytest.mark.parametrize("length", [0.3, 0.02])
def test_heads_of_moments(shown, length):
    """Two, one behind the other: the first at the tip, the second 3/4 of a head behind; short arrows are thinner."""
    shaft, first, second = shown.value(
        f"""(() => {{
          const arrows = new Arrows(1, 0, 0.01, 2, new THREE.Group());
          arrows.set(0, [1, 2, 3], [0, {length}, 0]);
          return arrows.parts.map((part) => {{
            const matrix = new THREE.Matrix4(), place = new THREE.Vector3(), size = new THREE.Vector3();
            part.getMatrixAt(0, matrix);
            matrix.decompose(place, new THREE.Quaternion(), size);
            return [place.toArray(), size.toArray()];
          }});
        }})()"""
    )
    thin = min(0.01, length / 9)
    head = 5 * thin
    assert np.abs(np.subtract(shaft, [[1, 2, 3], [thin, length - head, thin]])).max() < DRAWN
    for part, behind in ((first, 0), (second, 0.75 * head)):
        expected = [[1, 2 + length - behind, 3], [head / 2.2, head, head / 2.2]]
        assert np.abs(np.subtract(part, expected)).max() < DRAWN


def test_between_two_instants(shown, figures):
    """A quarter of the way from the fourth to the fifth: straight lines between both."""
    recording = figures[0]
    t = recording.t - recording.t[0]
    shown.value(f"player.seek({0.75 * t[3] + 0.25 * t[4]})")
    q, tau = (shown.value(f"player.figures[0].shown.{name}") for name in ("q", "recorded"))
    assert np.abs(q - (0.75 * recording.q[3] + 0.25 * recording.q[4])).max() < DRAWN
    size = np.abs(recording.tau).max()
    assert np.abs(tau - (0.75 * recording.tau[3] + 0.25 * recording.tau[4])).max() < DRAWN * size


def test_what_bodies_carry(shown, figures):
    """Centers of mass, axes of joints, ellipsoids with their half axes, and pushes of sliding joints, in the world."""
    recording, (figure, *_) = figures
    model = figure.robot.model
    shown.value("player.seek(0)")
    state = maximal_state(model, recording.q[0])
    shift, centers, ellipsoids, axes = shown.value(
        """(() => {
          const figure = player.figures[0], layers = ["centers", "ellipsoids", "axes"];
          const matrix = (part) => (part.updateWorldMatrix(true, false), part.matrixWorld.elements);
          return [figure.place.position.toArray(), ...layers.map((layer) => figure.layers[layer].map(matrix))];
        })()"""
    )
    centers, ellipsoids, axes = (
        np.array(part).reshape(-1, 4, 4).transpose(0, 2, 1) for part in (centers, ellipsoids, axes)
    )
    size = max(1.0, np.abs(state.position).max())
    for found in (centers, ellipsoids):
        assert np.abs(found[:, :3, 3] - shift - state.position).max() < DRAWN * size
    for found, body, rotation in zip(ellipsoids, model.bodies, state.rotation, strict=True):
        second = np.trace(body.inertia) / 2 * np.eye(3) - body.inertia  # m diag(a²) / 5 along the half axes a
        expected = rotation @ (5 * second / body.mass) @ rotation.T
        assert np.abs(found[:3, :3] @ found[:3, :3].T - expected).max() < DRAWN * np.abs(expected).max()
    along = shown.value("ALONG")
    for found, joint, rotation in zip(axes, model.joints, state.rotation, strict=True):
        assert np.abs(found[:3, :3] @ along - rotation @ joint.axis).max() < DRAWN
    loads = inverse_dynamics(model, recording.q[0], recording.v[0], recording.a[0]).joint_wrenches
    scale = shown.value("player.scales().force")
    for j, joint in enumerate(model.joints):
        start, end = np.array(shown.value(f"player.figures[0].slide.ends({j})"))
        push = (loads[j, LINEAR] @ joint.axis) * (state.rotation[j] @ joint.axis) if joint.is_prismatic else np.zeros(3)
        assert np.abs(end - start - scale * push).max() < DRAWN * max(1.0, np.abs(scale * push).max())


def test_numbers_as_they_are_written(shown):
    numbers = {0: "0", 1234.56: "1235", -0.0123456: "−0.01235", 2.5e7: "2.50e+7", -3.21e-5: "−3.21e−5"}
    assert shown.value(f"[{', '.join(map(str, numbers))}].map(written)") == list(numbers.values())
    units = {2500.0: "2.5 kN", 3.2e6: "3.2 MN", 0.05: "50 mN", 12.0: "12 N"}
    assert shown.value(f"[{', '.join(map(str, units))}].map((x) => withUnit(x, 'N'))") == list(units.values())
    assert shown.value("[0.3, 1, 4.2, 0.05].map(roundedUp)") == pytest.approx([0.5, 1, 5, 0.05])


def test_ranges_of_sliders(shown):
    """Limits of the joint; without, half a turn or half a meter both ways; with one of the two, a turn from it."""
    cases = {
        "{ kind: 'revolute', lower: -1, upper: 2 }": (-1, 2), "{ kind: 'continuous' }": (-np.pi, np.pi),
        "{ kind: 'prismatic' }": (-0.5, 0.5), "{ kind: 'revolute', lower: 1 }": (1, 1 + 2 * np.pi),
        "{ kind: 'prismatic', upper: 2 }": (1, 2),
    }  # fmt: skip
    for joint, expected in cases.items():
        middle = sum(expected) / 2
        assert shown.value(f"sliderRange({joint}, {middle})") == pytest.approx(list(expected))
    assert shown.value("sliderRange({ kind: 'revolute', lower: -1, upper: 2 }, 5)") == [-1, 5]


def test_the_legend_tells_the_scale(shown):
    """A bar is as long as an arrow of the load beside it would be at the middle of the view."""
    rows = shown.value(
        """[...document.querySelectorAll("#legend div")].slice(0, 2).map((row) =>
          [parseFloat(row.querySelector("i").style.width), row.querySelector("b").textContent])"""
    )
    scales, pixels = shown.value("[player.scales(), player.stage.pixelsPerMetre()]")
    prefixes = {"m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6}
    for (width, text), (kind, unit) in zip(rows, (("force", "N"), ("moment", "N m")), strict=True):
        number, _, prefixed = text.partition(" ")
        value = float(number) * prefixes[prefixed.removesuffix(unit)]
        assert abs(width - value * scales[kind] * pixels) < PIXEL
        assert width > 20


@pytest.mark.parametrize("torque", [-0.5, 0.25, -2.0])
def test_arcs_turn_with_the_torque(shown, torque):
    """The head of the arrow is at 3/4 of a turn times the torque, about the axis by the right hand, at most 3/4."""
    head = shown.value(
        f"""(() => {{
          const arc = new Arc(0xffffff, 0.2, 0.01);
          arc.set({torque});
          arc.place.updateMatrixWorld(true);
          return arc.head.getWorldPosition(new THREE.Vector3()).toArray();
        }})()"""
    )
    angle = 1.5 * np.pi * np.clip(torque, -1, 1)
    assert np.abs(np.subtract(head, [0.2 * np.cos(angle), 0.2 * np.sin(angle), 0])).max() < DRAWN


@pytest.fixture(scope="module")
def boxes(shown):
    """Of every figure, as the stage measures it, and what the stage has made of them."""
    return shown.value(
        """(() => {
          player.figures[1].hand = player.figures[1].start;
          player.seek(0);
          player.stage.whole();
          const { stage, figures } = player;
          const project = (point) => new THREE.Vector3(...point).project(stage.camera).toArray();
          const corner = (c) => [0, 1, 2].map((i) => (c & (1 << i) ? stage.high : stage.low)[i]);
          const { target } = stage.controls;
          return {
            boxes: figures.map(extent), size: stage.size, cell: stage.cell, instants: INSTANTS,
            places: figures.map((figure) => figure.place.position.toArray()), low: stage.low, high: stage.high,
            corners: [0, 1, 2, 3, 4, 5, 6, 7].map(corner).map(project), target: target.toArray(), air: AIR, gap: GAP,
            shapes: figures.map((figure) => figure.layers.shapes.map((mesh, k) =>
              [figure.robot.shapes[k].body, Array.from(mesh.geometry.attributes.position.array)])),
            metre: stage.pixelsPerMetre(), height: stage.element.clientHeight,
            distance: stage.camera.position.distanceTo(target),
          };
        })()"""
    )


class TestStage:
    def test_boxes(self, figures, boxes):
        """Of base, joints and centers of mass at all of 41 instants, and of the vertices of the shapes at the first."""
        recording = figures[0]
        t = recording.t - recording.t[0]
        for figure, (low, high), shapes in zip(figures[1], boxes["boxes"], boxes["shapes"], strict=True):
            model, times = figure.robot.model, [0.0]
            if figure is figures[1][0]:
                times = np.linspace(0, t[-1], boxes["instants"] + 1)
            points = [model.base.translation]
            for time in times:
                q = figure.first
                if figure is figures[1][0]:
                    q = np.array([np.interp(time, t, column) for column in recording.q.T])
                state = maximal_state(model, q)
                centers = [body.center_of_mass for body in model.bodies]
                points += [*state.position, *(state.position - np.einsum("iab,ib->ia", state.rotation, centers))]
            state = maximal_state(model, figure.first)
            for body, vertices in shapes:
                rotation, origin = model.base.rotation, model.base.translation
                if body > 0:
                    rotation = state.rotation[body - 1]
                    origin = state.position[body - 1] - rotation @ model.bodies[body - 1].center_of_mass
                points += list(origin + np.reshape(vertices, (-1, 3)) @ rotation.T)
            size = np.ptp(points, axis=0).max()
            assert np.abs(np.min(points, axis=0) - low).max() < DRAWN * size
            assert np.abs(np.max(points, axis=0) - high).max() < DRAWN * size

    def test_side_by_side(self, boxes):
        """Each in its box beside the one before, with a gap; all of them in the box of the stage."""
        halves = [np.linalg.norm(np.subtract(high, low)) / 2 for low, high in boxes["boxes"]]
        assert boxes["size"] == pytest.approx(max(halves), rel=1e-3)
        gap = boxes["gap"] * max(high[1] - low[1] for low, high in boxes["boxes"]) + 0.1 * boxes["size"]
        moved = np.array(boxes["boxes"]) + np.array(boxes["places"])[:, None]
        assert boxes["places"][0] == [0, 0, 0]
        assert moved[1:, 0, 1] - moved[:-1, 1, 1] == pytest.approx([gap, gap])
        assert boxes["low"] == pytest.approx(moved[:, 0].min(axis=0))
        assert boxes["high"] == pytest.approx(moved[:, 1].max(axis=0))
        assert boxes["size"] / 4 <= boxes["cell"] <= 2.5 * boxes["size"] / 4

    def test_the_whole_view(self, boxes):
        """Everything is in the picture, and fills it but for some air."""
        reach = np.abs(boxes["corners"])[:, :2]
        assert 0.6 < reach.max() <= 1
        assert boxes["target"] == pytest.approx(np.add(boxes["low"], boxes["high"]) / 2)
        seen = 2 * boxes["distance"] * np.tan(np.radians(34 / 2))  # meters over the height of the picture
        assert boxes["metre"] == pytest.approx(boxes["height"] / seen)

    def test_in_one_place(self, shown):
        places, names = shown.value(
            """(() => {
              const places = () => player.figures.map((figure) => figure.place.position.toArray());
              player.stage.setApart(false);
              player.stage.setNames(true);
              const found = [places(), [...document.querySelectorAll("#labels span")].map((one) => one.textContent)];
              player.stage.setApart(true);
              player.stage.setNames(false);
              return found;
            })()"""
        )
        assert places == [[0, 0, 0]] * 3
        assert names == [
            name
            for figure in shown.value("player.figures.map((figure) => figure.robot.joints.map(({ name }) => name))")
            for name in figure
        ]

    def test_names_below_robots(self, shown):
        """Where the base of each is in the picture."""
        for element, figure in shown.value(
            """(() => {
              player.stage.draw();
              const { clientWidth: width, clientHeight: height } = player.stage.element;
              return [...document.querySelectorAll("#labels span")].map((one, k) => {
                const figure = player.figures[k];
                const point = new THREE.Vector3(...figure.robot.base.translation).add(figure.place.position);
                const { x, y } = point.project(player.stage.camera);
                const place = [(x + 1) / 2 * width, (1 - y) / 2 * height];
                const drawn = [parseFloat(one.style.left), parseFloat(one.style.top)];
                return [[one.textContent, ...drawn], [figure.name, ...place]];
              });
            })()"""
        ):
            assert element[0] == figure[0]
            assert element[1:] == pytest.approx(figure[1:], abs=0.01)


def curves(shown, change):
    """Range of y, unit, time, and curves of the torques of the first figure, its motion changed."""
    return shown.value(
        f"""(async () => {{
          const figure = Object.create(player.figures[0]), tau = Float32Array.from(figure.motion.tau);
          figure.motion = {{ ...figure.motion, tau }};
          {change}
          const curves = new Curves(document.getElementById("chart"), () => 0);
          curves.show(figure, 0);
          await new Promise((done) => setTimeout(done, 20));
          const {{ plot }} = curves, found = [[plot.scales.y.min, plot.scales.y.max], plot.axes[1].label, ...plot.data];
          plot.destroy();
          return found;
        }})()"""
    )


def test_range_of_curves(shown, figures):
    """All values are in view; what is rounding beside the usual torque is one level line."""
    recording, (figure, *_) = figures
    tau = inverse_dynamics(figure.robot.model, recording.q, recording.v, recording.a).tau
    (low, high), unit, time, *found = curves(shown, "")
    assert unit == "[N m or N]"
    assert time == pytest.approx(recording.t - recording.t[0])
    assert np.abs(np.transpose(found) - tau).max() < DRAWN * np.abs(tau).max()
    assert low <= tau.min() < tau.max() <= high
    assert high - low < 2 * np.ptp(tau)
    largest = shown.value("Math.max(...player.figures[0].motion.wrenches.map(Math.abs))")
    usual = shown.value("player.figures[0].robot.usual.torque")
    for share, level in ((0.3, True), (3.0, False)):
        size = share * 1e-9 * max(usual, largest)
        (low, high), *_ = curves(shown, f"tau.fill(0); tau[0] = {size};")
        assert (high - low == pytest.approx(2)) == level


def test_time_stays_within_the_motion(shown):
    """0.2 s are played, however far keys lead."""
    assert shown.value("[-1, 0.1, 7].map((t) => (player.seek(t), player.state.t))") == pytest.approx([0, 0.1, 0.2])


def test_pixels_change(shown):
    colors, moved, repeated = shown.value(PICTURE)
    assert colors > 50
    assert moved > 1000
    assert repeated == 0


def test_it_plays(shown):
    """Frames come without being asked for, and time runs on."""
    shown.value("player.seek(0)")
    shown.value("player.toggle()")
    shown.value(
        """new Promise((done) => {
          const look = () => player.state.t > 0.05 ? done() : requestAnimationFrame(look);
          look();
        })"""
    )
    assert shown.value("document.getElementById('play').ariaLabel") == "pause"
    shown.value("player.toggle()")


def test_nothing_is_asked_for(shown):
    """No complaint, no request; the policy lets nothing out even if a script tried."""
    assert shown.complaints == []
    assert [address.split("/")[-1] for address in shown.requests] == ["view.html"]
    assert shown.value("document.querySelector('h1').textContent") == "a tree & <an arm>"
    assert shown.value("fetch('http://127.0.0.1:9/').then(() => 'answered', () => 'refused')") == "refused"
    assert any("Content Security Policy" in complaint for complaint in shown.complaints)
    assert len(shown.requests) == 1


def test_the_same_figures_give_the_same_page(figures):
    assert page("one", figures[1]) == page("one", figures[1])


def test_largest_loads(shown, figures):
    """Of every instant, and at rest where the robot starts: force, moment, torque about axes that turn."""
    recording, (figure, *_) = figures
    model, nothing = figure.robot.model, 0 * figure.first
    moving = inverse_dynamics(model, recording.q, recording.v, recording.a).joint_wrenches
    at_rest = inverse_dynamics(model, figure.first, nothing, nothing).joint_wrenches
    wrenches = np.concatenate([moving, at_rest[None]])
    turning = [j for j, joint in enumerate(model.joints) if not joint.is_prismatic]
    about = [wrenches[:, j, ANGULAR] @ model.joints[j].axis for j in turning]
    expected = {
        "force": np.linalg.norm(wrenches[..., LINEAR], axis=-1).max(axis=1),
        "moment": np.linalg.norm(wrenches[..., ANGULAR], axis=-1).max(axis=1),
        "torque": np.abs(about).max(axis=0),
    }
    found = shown.value("player.figures[0].loads()")
    for kind, wanted in expected.items():
        assert np.abs(found[kind] - wanted).max() < DRAWN * wanted.max(), kind


def test_noise_is_drawn_as_nothing(shown):
    """A full arc is at least 1e-4 of weight times reach; 5e-14 N m beside 50 N is no arc, and the panel says 0."""
    loads = "{ force: [30], moment: [2e-13], torque: [5e-14] }"
    figure = f"{{ robot: {{ usual: {{ force: 50, torque: 40 }} }}, loads: () => ({loads}) }}"
    found = shown.value(f"firstScales([{figure}], 2)")
    assert found == pytest.approx({"force": 1 / 30, "moment": 1 / 4e-3, "torque": 5e-3})
    assert shown.value("besideScale(5e-14, 40 * LEAST)") == "0.000000"
    usual = "[player.figures[0].robot.usual, player.figures[0].loads()]"
    expected, loads = shown.value(usual)
    assert max(loads["torque"]) > 1e-3 * expected["torque"]


@pytest.mark.parametrize(
    ("loads", "usual", "torque"),
    [
        ("moment: [300], torque: [6e-6]", "torque: 40", 5e-2),  # 32-bit numbers: 6e-8 of the moment
        ("moment: [300], torque: [0.3]", "torque: 40", 0.5),
        ("moment: [0], torque: [0]", "torque: 200", 2e-2),  # no mass: the largest effort
        ("moment: [0], torque: [0]", "torque: 0", 1),
        ("moment: [], torque: []", "torque: 0", 1),
    ],
)
def test_the_scale_of_arcs(shown, loads, usual, torque):
    figure = f"{{ robot: {{ usual: {{ force: 0, {usual} }} }}, loads: () => ({{ force: [0], {loads} }}) }}"
    assert shown.value(f"firstScales([{figure}], 1).torque") == pytest.approx(torque)


def first_met(triangles, near, far):
    """The smallest part of the way from near to far (3,) up to one of the triangles (k, 3, 3); inf where none is."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    way = np.broadcast_to(near - far, a.shape)
    v, w, u = np.linalg.solve(np.stack([b - a, c - a, way], axis=-1), (near - a)[..., None])[..., 0].T
    return np.where((v >= 0) & (w >= 0) & (v + w <= 1) & (u >= 0) & (u <= 1), u, np.inf).min()


def test_a_click_finds_the_link_that_is_seen(shown, figures):
    """Through the middle of every shape, and beside all, against every triangle of every shape."""
    shown.value("player.seek(0); player.stage.draw()")
    shifts = shown.value("player.figures.map((figure) => figure.place.position.toArray())")
    shapes = []
    for k, figure in enumerate(figures[1]):
        placements, _ = drawn(shown, k)
        for shape in figure.robot.shapes:
            place = placements[shape.body]
            vertices = shape.vertices @ place[:3, :3].T + place[:3, 3] + shifts[k]
            shapes.append(([k, shape.body], vertices[shape.faces]))
    middles = [triangles.mean(axis=(0, 1)).tolist() for _, triangles in shapes]
    found = shown.value(
        f"""{middles}.map((middle) => new THREE.Vector3(...middle).project(player.stage.camera))
          .concat({{ x: 0.99, y: 0.99 }}).map(({{ x, y }}) => {{
            const seen = seenAt(player.stage, x, y);
            const end = (z) => new THREE.Vector3(x, y, z).unproject(player.stage.camera).toArray();
            return [end(-1), end(1), seen && [player.figures.indexOf(seen[0]), seen[1]]];
          }})"""
    )
    for near, far, answer in found[:-1]:
        parts = [first_met(triangles, np.array(near), np.array(far)) for _, triangles in shapes]
        assert answer == shapes[int(np.argmin(parts))][0]
    assert len({tuple(answer) for _, _, answer in found[:-1]}) > 5
    assert found[-1][2] is None


def test_numbers_of_a_chosen_link(shown, figures):
    """Mass, center, tensor and loads of the joint, as they are at the instant shown."""
    recording, (figure, *_) = figures
    model, body = figure.robot.model, figure.robot.model.bodies[2]
    loads = inverse_dynamics(model, recording.q[0], recording.v[0], recording.a[0])
    told = dict(shown.value("(player.seek(0), toldOf(player.figures[0], 3))"))
    force = maximal_state(model, recording.q[0]).rotation[2] @ loads.joint_wrenches[2, LINEAR]
    read = [float(x.replace("−", "-")) for x in told["force"].split("]")[0].strip("[").split(", ")]
    assert read == pytest.approx(force, rel=1e-3, abs=1e-3 * np.abs(force).max())
    assert told["mass"] == f"{shown.value(f'written({body.mass})')} kg"
    assert told["joint"] == f"{model.joints[2].name}, {model.joints[2].kind}"
    xx, yy, zz = (shown.value(f"written({body.inertia[i, i]})") for i in range(3))
    assert told["inertia"].startswith(f"xx, yy, zz [{xx}, {yy}, {zz}], ")
    shown.value("document.getElementById('body').selectedIndex = 4")
    shown.value("document.getElementById('body').dispatchEvent(new Event('change'))")
    assert shown.value("document.getElementById('told').textContent").startswith(f"mass{told['mass']}")
    marked = (
        "player.figures[0].layers.shapes.filter((mesh) => mesh.material.emissive.getHex()).map((m) => m.userData.body)"
    )
    assert set(shown.value(marked)) == {3}
    assert set(shown.value(f"(player.figures[0].mark(-1), {marked})")) == set()


def test_the_largest_instants_are_marked(shown, figures):
    """Of force and moment, on the line of the time; a press goes there."""
    recording, (figure, *_) = figures
    wrenches = inverse_dynamics(figure.robot.model, recording.q, recording.v, recording.a).joint_wrenches
    marks = shown.value("[...document.querySelectorAll('#marks button')].map((mark) => [mark.className, mark.title])")
    assert [kind for kind, _ in marks] == ["force", "moment"]
    for k, part in enumerate((LINEAR, ANGULAR)):
        sizes = np.linalg.norm(wrenches[..., part], axis=-1)
        row, joint = np.unravel_index(sizes.argmax(), sizes.shape)
        time = float(recording.t[row] - recording.t[0])
        assert marks[k][1].endswith(f" at {figure.robot.model.joints[joint].name}, {time:.2f} s")
        shown.value(f"document.querySelectorAll('#marks button')[{k}].click()")
        assert shown.value("player.state.t") == pytest.approx(time)


def test_why_sliders_are_gray(shown):
    why = "new JointRows(document.createElement('tbody'), player.figures[{}], {}, () => 0).why"
    assert shown.value(why.format(0, "false")) == "Gray sliders: joint6 is driven by joint1 and joint4."
    assert shown.value(why.format(1, "false")) == ""
    assert "would open the loops" in shown.value(why.format(2, "false"))


def test_collision_shapes_on_demand(shown):
    visible = "player.figures[1].layers.collision.map((mesh) => mesh.visible)"
    press = "document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 'k', bubbles: true}))"
    assert shown.value(visible) == [False]
    assert shown.value(f"({press}, {visible})") == [True]
    assert shown.value(f"({press}, {visible})") == [False]


def test_the_picture_that_is_saved(shown):
    """As large as the view, with what is drawn, and the legend over it."""
    size, colors, same = shown.value(
        """(() => {
          const { stage } = player, canvas = pictureOf(stage), drawn = stage.renderer.domElement;
          const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
          return [[canvas.width, canvas.height], new Set(pixels).size, [drawn.width, drawn.height]];
        })()"""
    )
    assert size == same
    assert colors > 50
