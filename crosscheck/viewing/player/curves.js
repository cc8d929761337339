// Curves over the time of the motion, with a cursor; a press or a drag on them moves the time.
"use strict";

const CURVE_COLORS = 8;
const CURVE_HEIGHT = 210;
const ROUNDING = 1e-9;  // part of the largest or usual load below which a curve is level
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// What can be drawn of a figure: title, unit, and a function that gives its curves, {name: numbers}.
function quantities(figure) {
  const { robot, motion } = figure, free = robot.independent;
  const slides = free.map((j) => robot.joints[j].kind === "prismatic");
  const unit = (turns, slide) => [...new Set(slides.map((is) => (is ? slide : turns)))].join(" or ");
  const instants = () => Array.from(motion.time, (t) => figure.moving(t));
  const perDof = (array) => Object.fromEntries(free.map((j, k) => [robot.joints[j].name, Array.from(motion.time, (_, row) => array[row * free.length + k])]));
  const perJoint = (part) => {
    const all = instants();
    return Object.fromEntries(robot.joints.map((joint, j) => [joint.name, all.map((instant) => Math.hypot(...instant.wrenches[j][part]))]));
  };
  const ofJoint = (j) => () => {
    const rows = instants().map((instant) => multipliers(robot, instant.bodies, instant.wrenches[j], j));
    const names = robot.joints[j].kind === "prismatic" ? ["f·t₁", "f·t₂", "m·t₁", "m·t₂", "m·p"] : ["f_x", "f_y", "f_z", "m·t₁", "m·t₂"];
    return Object.fromEntries(names.map((name, i) => [`λ${"₁₂₃₄₅"[i]} ${name}`, rows.map((row) => row[i])]));
  };
  const found = [["torque of the rigid bodies", unit("N m", "N"), () => perDof(motion.tau)]];
  if (motion.recorded) found.push(["torque, recorded", unit("N m", "N"), () => perDof(motion.recorded)]);
  found.push(["position", unit("rad", "m"), () => perDof(motion.q)], ["reaction force", "N", () => perJoint(0)], ["reaction moment", "N m", () => perJoint(1)]);
  robot.joints.forEach((joint, j) => found.push([`multipliers of ${joint.name}`, "N, N m", ofJoint(j)]));
  return found;
}

class Curves {
  constructor(element, seek) {
    this.element = element;
    this.seek = seek;
    this.cursor = document.createElement("div");
    this.cursor.className = "cursor";
  }

  show(figure, index) {
    this.figure = figure;
    this.index = index;
    this.plot?.destroy();
    const [, unit, curves] = quantities(figure)[index], named = Object.entries(curves());
    const least = ROUNDING * Math.max(figure.robot.usual.torque, ...figure.motion.wrenches.map(Math.abs));
    const reach = (_, low, high) => (high - low > least ? uPlot.rangeNum(low, high, 0.1, true) : [low - 1, high + 1]);
    const ink = css("--ink"), line = css("--line"), font = "11px system-ui, sans-serif";
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1, size: 4 }, font, labelFont: font, labelSize: 16 };
    const series = named.map(([label], k) => ({ label, stroke: css(`--c${k % CURVE_COLORS}`), width: 1.6, dash: k < CURVE_COLORS ? [] : [6, 3], points: { show: false } }));
    this.plot = new uPlot({
      width: this.element.clientWidth || 360, height: CURVE_HEIGHT, scales: { x: { time: false }, y: { range: reach } }, legend: { live: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
      axes: [{ ...axis, label: "t [s]", size: 30 }, { ...axis, label: `[${unit}]`, size: 52, values: (_, at) => at.map((y) => written(y)) }],
      series: [{}, ...series],
    }, [Array.from(figure.motion.time), ...named.map(([, values]) => values)], this.element);
    this.plot.over.append(this.cursor);
    const seek = (event) => {
      const { left } = this.plot.over.getBoundingClientRect();
      this.seek(this.plot.posToVal(event.clientX - left, "x"));
    };
    this.plot.over.addEventListener("pointerdown", (event) => { this.plot.over.setPointerCapture(event.pointerId); seek(event); });
    this.plot.over.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
  }

  at(t) {
    if (!this.plot) return;
    const x = this.plot.valToPos(Math.min(t, this.figure.duration), "x");
    this.cursor.style.transform = `translateX(${x}px)`;
  }

  resize() {
    if (this.plot && this.element.clientWidth) this.plot.setSize({ width: this.element.clientWidth, height: CURVE_HEIGHT });
  }

  again() {
    if (this.plot) this.show(this.figure, this.index);
  }
}
