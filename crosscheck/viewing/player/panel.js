// The joints of one figure as sliders and numbers, and the switches of what is shown.
"use strict";

// Key, name in the panel, switched on at first, and the layers of a figure that it shows.
const SWITCHES = [
  ["b", "robot", true, ["shapes"]],
  ["k", "collision shapes", false, ["collision"]],
  ["n", "joint names", false, []],
  ["f", "link frames", false, ["frames"]],
  ["a", "joint axes", false, ["axes"]],
  ["c", "centers of mass", false, ["centers"]],
  ["i", "inertia ellipsoids", false, ["ellipsoids"]],
  ["r", "reaction forces", true, ["force"]],
  ["m", "reaction moments", true, ["moment"]],
  ["t", "actuator torques", true, ["torques", "slide"]],
  ["l", "loops", true, ["chords"]],
];
const MOST_REASONS = 3;  // why sliders cannot be moved, that are told
const REACH = { prismatic: 0.5 };  // of sliders without limits [m]; π rad of others

const html = (name, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
};

// The range of a slider: the limits of the joint, or half a turn both ways.
function sliderRange(joint, position) {
  const reach = REACH[joint.kind] ?? Math.PI, limited = joint.kind !== "continuous" && (joint.lower || joint.upper);
  const lower = limited ? joint.lower ?? joint.upper - 2 * reach : -reach, upper = limited ? joint.upper ?? joint.lower + 2 * reach : reach;
  return [Math.min(lower, position), Math.max(upper, position)];
}

const TAIL = 8;  // characters of the end of a name that is too long, which are shown

// A name whose middle is left out where there is no room: joints often differ in the end alone.
function elided(name) {
  const cut = Math.max(0, name.length - TAIL);
  return html("span", { className: "elided" }, html("span", {}, name.slice(0, cut)), html("span", {}, name.slice(cut)));
}

// Why a joint cannot be moved by hand; "" where it can. closing: a server closes loops
function fixedBecause(robot, j, closing) {
  const drivers = robot.independent.filter((_, k) => robot.matrix[j][k] !== 0).map((i) => robot.joints[i].name);
  if (!robot.independent.includes(j)) return `${robot.joints[j].name} is driven by ${drivers.join(" and ")}`;
  if (robot.chords.length > 0 && !closing) return "a joint moved by hand would open the loops; graphdyn view without --html closes them again";
  return "";
}

// A row per joint of the figure; those that others drive, and those of robots with loops, unless a server closes them,
// cannot be moved by hand: why tells. move(q, name) is called with positions set by hand, and the joint that was moved.
class JointRows {
  constructor(element, figure, live, move) {
    this.figure = figure;
    const { robot } = figure, loads = figure.loads();
    const kind = robot.joints.every((joint) => joint.kind === "prismatic") ? "force" : "torque";
    this.scale = Math.max(LEAST * robot.usual[kind], ...loads[kind]) || 1;
    this.rows = robot.joints.map((joint, j) => {
      const k = robot.independent.indexOf(j), slides = joint.kind === "prismatic";
      const reason = fixedBecause(robot, j, live && figure.duration === 0);
      const slider = html("input", { type: "range", step: "any", ariaLabel: joint.name, disabled: reason !== "", title: reason });
      const range = sliderRange(joint, k < 0 ? 0 : figure.start[k]);
      [slider.min, slider.max] = range;
      const q = html("output"), tau = html("output");
      slider.addEventListener("input", () => {
        const position = [...figure.shown.q];
        position[k] = Number(slider.value);
        move(position, joint.name);
      });
      const swatch = html("i", { className: `c${Math.max(k, 0) % CURVE_COLORS}` });
      element.append(html("tr", {},
        html("th", { scope: "row", title: joint.name }, ...(k < 0 ? [] : [swatch]), elided(joint.name)), html("td", {}, slider),
        html("td", { className: "number" }, q), html("td", { className: "unit" }, slides ? "m" : "rad"),
        html("td", { className: "number" }, tau), html("td", { className: "unit" }, k < 0 ? "" : slides ? "N" : "N m")));
      return { slider, q, tau, k, reason };
    });
    const reasons = [...new Set(this.rows.map(({ reason }) => reason).filter(Boolean))];
    this.why = reasons.length ? `Gray sliders: ${reasons.slice(0, MOST_REASONS).join("; ")}${reasons.length > MOST_REASONS ? "; …" : ""}.` : "";
  }

  show(instant) {
    const positions = jointPositions(this.figure.robot, instant.q);
    this.rows.forEach(({ slider, q, tau, k }, j) => {
      if (!slider.matches(":active")) slider.value = positions[j];
      q.textContent = positions[j].toFixed(3).replace("-", "−");
      const lacking = this.figure.robot.lacking[k];
      tau.textContent = k < 0 ? "driven" : lacking ? "–" : besideScale(instant.tau[k], this.scale);
      tau.title = lacking ? "it moves a link without mass, whose load is not known" : "";
    });
  }
}

// What a pose that is set by hand shows.
function staticLoads({ lacking }) {
  if (!lacking.some(Boolean)) return "static gravity loads";
  return lacking.every(Boolean) ? "no loads, because links have no mass" : "static gravity loads, without the links that have no mass";
}

// Switches with their keys, sliders for see-through and arrow sizes; shown and sizes change, then change() is called.
function makeSwitches(element, switches, shown, sizes, change) {
  const boxes = {};
  for (const [key, name, on] of switches) {
    const box = html("input", { type: "checkbox", checked: on });
    shown[name] = on;
    boxes[key] = () => { box.checked = !box.checked; shown[name] = box.checked; change(); };
    box.addEventListener("change", () => { shown[name] = box.checked; change(); });
    element.append(html("label", { title: `key ${key}` }, box, html("i", { className: name.replaceAll(" ", "-") }), name));
  }
  for (const [name, text, low, high, from] of [["opacity", "opacity of the robot", 0.1, 1, 1], ["force", "size of forces", -2, 2, 0], ["moment", "size of moments", -2, 2, 0]]) {
    const slider = html("input", { type: "range", min: low, max: high, step: "any", value: from });
    slider.addEventListener("input", () => { sizes[name] = name === "opacity" ? Number(slider.value) : 10 ** Number(slider.value); change(); });
    sizes[name] = name === "opacity" ? 1 : 1;
    element.append(html("label", { className: "size" }, text, slider));
  }
  return boxes;
}
