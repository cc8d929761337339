// Which link lies below a point of the picture, and its numbers.
"use strict";

// The figure and the number of the body that are seen at a point, from -1 to 1 to the right and upwards; or null.
function seenAt(stage, x, y) {
  const [near, far] = [-1, 1].map((z) => new THREE.Vector3(x, y, z).unproject(stage.camera));
  let nearest = Infinity, found = null;
  for (const figure of stage.figures) {
    figure.place.updateMatrixWorld(true);
    for (const mesh of [...figure.layers.shapes, ...figure.layers.collision]) {
      if (!mesh.visible) continue;
      const inverse = mesh.matrixWorld.clone().invert();
      const [from, to] = [near, far].map((point) => point.clone().applyMatrix4(inverse).toArray());
      const at = firstMet(mesh.geometry.attributes.position.array, from, minus(to, from));
      if (at < nearest) [nearest, found] = [at, [figure, mesh.userData.body]];
    }
  }
  return found;
}

// The smallest u from 0 to 1 at which from + u way lies on a triangle, of nine numbers each; Infinity where none is.
function firstMet(places, from, way) {
  let first = Infinity;
  for (let i = 0; i < places.length; i += 9) {
    const a = [places[i], places[i + 1], places[i + 2]];
    const ab = [places[i + 3] - a[0], places[i + 4] - a[1], places[i + 5] - a[2]], ac = [places[i + 6] - a[0], places[i + 7] - a[1], places[i + 8] - a[2]];
    const p = cross(way, ac), volume = dot(ab, p);
    if (volume === 0) continue;
    const s = minus(from, a), v = dot(s, p) / volume;
    if (v < 0 || v > 1) continue;
    const q = cross(s, ab), w = dot(way, q) / volume, u = dot(ac, q) / volume;
    if (w >= 0 && v + w <= 1 && u >= 0 && u <= 1 && u < first) first = u;
  }
  return first;
}

// Numbers of one kind; what is rounding beside the largest is 0.
function listed(numbers) {
  const least = ROUNDING * Math.max(...numbers.map(Math.abs));
  return `[${numbers.map((x) => written(Math.abs(x) < least ? 0 : x)).join(", ")}]`;
}

// What is told of a body of a figure as it is shown: [name, words].
function toldOf(figure, number) {
  const { robot, shown } = figure, joint = robot.joints[number - 1], body = robot.bodies[number - 1];
  if (number === 0) return [["link", `${robot.base.name}, which does not move`]];
  const J = body.inertia, [force, moment] = shown.wrenches[number - 1], unit = joint.kind === "prismatic" ? "m" : "rad";
  const limits = [joint.lower, joint.upper].map((limit) => (limit == null ? "–" : written(limit)));
  return [
    ["mass", `${written(body.mass)} kg`],
    ["center", `${listed(body.center)} m in link axes`],
    ["inertia", `xx, yy, zz ${listed([J[0], J[4], J[8]])}, xy, xz, yz ${listed([J[1], J[2], J[5]])} kg m² about the center`],
    ["joint", `${joint.name}, ${joint.kind}`],
    ["limits", `${limits[0]} to ${limits[1]} ${unit}`],
    ["origin", `${listed(shown.bodies[number].translation)} m`],
    ["force", `${listed(force)}, size ${written(Math.hypot(...force))} N`],
    ["moment", `${listed(moment)}, size ${written(Math.hypot(...moment))} N m`],
  ];
}

// The choice of a link and its numbers, in the panel; a click on the picture chooses, too.
class LinkNumbers {
  constructor(element, choice, stage, chosen) {
    Object.assign(this, { element, choice, figure: null, number: -1 });
    choice.addEventListener("change", () => this.choose(this.figure, choice.selectedIndex - 1));
    let pressed = null;
    stage.element.addEventListener("pointerdown", ({ clientX, clientY }) => { pressed = [clientX, clientY]; });
    stage.element.addEventListener("pointerup", ({ clientX, clientY }) => {
      if (!pressed || Math.hypot(clientX - pressed[0], clientY - pressed[1]) > STILL) return;  // the view was turned
      const { left, top, width, height } = stage.element.getBoundingClientRect();
      const [figure, number] = seenAt(stage, (2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height) ?? [null, -1];
      if (figure) chosen(figure);
      this.choose(figure ?? this.figure, number);
    });
    this.changed = () => { stage.changed = true; };
  }

  // Another robot: its links are offered, none is chosen.
  offer(figure) {
    if (figure === this.figure) return;
    const names = [figure.robot.base, ...figure.robot.bodies].map(({ name }) => name);
    this.choice.replaceChildren(...["none; click one", ...names].map((name) => html("option", {}, name)));
    this.choose(figure, -1);
  }

  choose(figure, number) {
    this.figure?.mark(-1);
    Object.assign(this, { figure, number });
    figure.mark(number);
    this.choice.selectedIndex = number + 1;
    this.show();
    this.changed();
  }

  show() {
    const told = this.number < 0 ? [] : toldOf(this.figure, this.number);
    this.element.hidden = told.length === 0;
    this.element.replaceChildren(...told.flatMap(([name, words]) => [html("dt", {}, name), html("dd", {}, words)]));
  }
}

const STILL = 4;  // pixels that a click may move
